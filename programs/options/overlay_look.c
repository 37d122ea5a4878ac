/* overlay_look.c - parses the look of an overlay: parts between commas, each
 * known by its form.  Colours are names, or values with a # behind a colon; a
 * range is two numbers or percentiles, or the word full; opacities are a single
 * number, or pairs with a colon. */
#include "options/option_values.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#define PART_BYTES 64
#define OUTLINE "outline" /* stands among the names */

/* What parts are, in the order in which they may stand. */
typedef enum part_kind {
    PART_NAME,
    PART_COLOR,
    PART_RANGE,
    PART_OPACITY,
    PART_WRONG
} part_kind;

static bool take_part(const char **at, char part[PART_BYTES]) {
    const size_t length = strcspn(*at, ",");
    if (!length || length >= PART_BYTES)
        return false;
    memcpy(part, *at, length);
    part[length] = 0;
    *at += length + ((*at)[length] == ',');
    return true;
}

static bool is_end(const char *part) {
    double number;
    return value_real(part, &number) ||
           (*part == 'p' && value_real(part + 1, &number));
}

/* A number is the first of a range where another one follows. */
static part_kind kind_of(const char *part, const char *rest) {
    char next[PART_BYTES];
    if (strstr(part, ":#"))
        return PART_COLOR;
    if (strchr(part, ':'))
        return PART_OPACITY;
    if (strcasecmp(part, "full") == 0)
        return PART_RANGE;
    if (is_end(part))
        return take_part(&rest, next) && is_end(next) ? PART_RANGE
                                                      : PART_OPACITY;
    return strcasecmp(part, OUTLINE) == 0 || snow_preset_from_name(part) >= 0 ||
                   snow_colormap_from_name(part) >= 0
               ? PART_NAME
               : PART_WRONG;
}

static bool append(char *list, size_t size, const char *part) {
    const size_t used = strlen(list);
    return snprintf(list + used, size - used, "%s%s", used ? "," : "", part) <
           (int)(size - used);
}

static bool take_name(const char *part, overlay_look_value *out) {
    const int preset = snow_preset_from_name(part);
    if (strcasecmp(part, OUTLINE) == 0 && !out->outline)
        out->outline = true;
    else if (preset >= 0 && !out->preset)
        out->preset = snow_preset_name((size_t)preset);
    else if (*out->colormap || snow_colormap_from_name(part) < 0)
        return false;
    else
        snprintf(out->colormap, sizeof out->colormap, "%s", part);
    return true;
}

static bool take_range(const char *part, const char **rest,
                       overlay_look_value *out) {
    char ends[2 * PART_BYTES], next[PART_BYTES];
    snprintf(ends, sizeof ends, "%s", part);
    return (strcasecmp(part, "full") == 0 ||
            (take_part(rest, next) && append(ends, sizeof ends, next))) &&
           value_range(ends, &out->range);
}

bool value_overlay_look(const char *text, overlay_look_value *out) {
    char points[POINTS_MAX * PART_BYTES] = "";
    overlay_look_value look = {.text = text};
    part_kind before = PART_NAME;
    char part[PART_BYTES];
    const char *at = text;
    while (*at) {
        if (!take_part(&at, part))
            return false;
        const part_kind kind = kind_of(part, at);
        if (kind < before || kind == PART_WRONG ||
            (kind == before && kind == PART_RANGE))
            return false;
        before = kind;
        if (!(kind == PART_NAME ? take_name(part, &look)
              : kind == PART_COLOR
                  ? append(look.colormap, sizeof look.colormap, part)
              : kind == PART_RANGE ? take_range(part, &at, &look)
                                   : append(points, sizeof points, part)))
            return false;
    }
    if (*points && !value_factor(points, &look.opacity) &&
        !value_points(points, &look.opacity))
        return false;
    if (*look.colormap && snow_colormap_from_name(look.colormap) < 0)
        return false;
    *out = look;
    return *text != 0;
}
