/* annotate/length.c - see length.h. */
#include "annotate/length.h"

#include <string.h>

double snow_length_factor(double length, double least, double below,
                          const char **unit) {
    static const char *const units[] = {"nm", "\xc2\xb5m", "mm", "m", "km"};
    const int last = sizeof units / sizeof *units - 1;
    double factor = 1;
    int at = strcmp(*unit, "um") == 0 ? 1 : -1;
    if (strcmp(*unit, "angstrom") == 0)
        *unit = "\xc3\x85";
    for (int i = 0; i <= last; i++)
        if (strcmp(*unit, units[i]) == 0)
            at = i;
    if (at < 0)
        return 1;
    for (; at < last && length * factor >= below; at++)
        factor /= 1000;
    for (; at > 0 && length > 0 && length * factor < least; at--)
        factor *= 1000;
    *unit = units[at];
    return factor;
}
