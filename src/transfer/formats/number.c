/* transfer/formats/number.c - parses numbers of untrusted text, the same in
 * every locale. */
#include "transfer/formats/tf.h"

#include <locale.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The longest number that is parsed; a double needs 24 characters. */
#define NUMBER_BYTES 64

bool tf_take_number(const char **at, const char *end, double *out) {
    char text[2 * NUMBER_BYTES], *stop;
    const char *from = *at, *point = localeconv()->decimal_point;
    size_t count = 0;
    while (from < end && strchr(" \t\r\n", *from) && *from)
        from++;
    *at = from;
    for (; from < end && *from && strchr("0123456789+-.eE", *from); from++) {
        size_t length = *from == '.' ? strlen(point) : 1;
        if (count + length >= sizeof text || from - *at >= NUMBER_BYTES)
            return false;
        memcpy(text + count, *from == '.' ? point : from, length);
        count += length;
    }
    text[count] = 0;
    double value = strtod(text, &stop);
    if (stop == text || *stop || !isfinite(value))
        return false;
    *at = from;
    *out = value;
    return true;
}
