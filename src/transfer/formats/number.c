/* transfer/formats/number.c - parses numbers of untrusted text, the same in
 * every locale. */
#include "transfer/formats/tf.h"

#include <math.h>
#include <string.h>

/* The longest number that is parsed; a double needs 24 characters. */
#define NUMBER_BYTES 64

bool tf_take_number(const char **at, const char *end, double *out) {
    char text[NUMBER_BYTES];
    const char *from = *at;
    size_t count = 0;
    while (from < end && strchr(" \t\r\n", *from) && *from)
        from++;
    *at = from;
    for (; from < end && *from && strchr("0123456789+-.eE", *from); from++) {
        if (count + 1 >= sizeof text)
            return false;
        text[count++] = *from;
    }
    text[count] = 0;
    double value;
    int used = 0;
    if (snow_text_scan(text, "%lf%n", &value, &used) != 1 || text[used] ||
        !isfinite(value))
        return false;
    *at = from;
    *out = value;
    return true;
}
