/* option_facts.c - what several options mean together, and what a word of one
 * stands for. */
#include "options/options.h"

#include <math.h>
#include <string.h>

bool mode_is_projection(const char *mode) {
    return strcmp(mode, "over") != 0 && strcmp(mode, "iso") != 0;
}

int options_bits(const options *opts) {
    if (!opts->bits)
        return 0;
    return opts->bits[0] == '8' ? 8 : 16;
}

bool options_place_colors(const options *opts) {
    return opts->colormap && strchr(opts->colormap, ':');
}

bool options_has_axes(const options *opts) {
    return opts->box && strcmp(opts->box, "axes") == 0;
}

range_value options_range(const options *opts) {
    const double half = opts->window[0] / 2, centre = opts->window[1];
    if (isnan(half))
        return opts->range;
    return (range_value){SNOW_RANGE_VALUES, centre - half, centre + half};
}
