/* option_values.c - parses numbers, sizes, colours, ranges and control points.
 *
 * strtod alone would accept "0x10", "nan", "inf" and leading blanks, so the
 * characters are checked first.  The locale is never set, so the decimal sign
 * is always a point. */
#include "options/option_values.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The longest number or word that is parsed; a double needs 24 characters, so
 * longer text is not sensible input. */
#define NUMBER_BYTES 64

/* At least one character, and only the given ones: keeps blanks, hex digits,
 * nan and inf away from the C library's lenient parsers. */
static bool has_only(const char *text, const char *characters) {
    return *text && text[strspn(text, characters)] == '\0';
}

bool value_real(const char *text, double *out) {
    if (!has_only(text, "0123456789+-.eE"))
        return false;
    char *end;
    double value = strtod(text, &end);
    if (*end || end == text || !isfinite(value))
        return false;
    *out = value;
    return true;
}

bool value_integer(const char *text, int64_t *out) {
    if (!has_only(text, "0123456789+-"))
        return false;
    char *end;
    errno = 0;
    intmax_t value = strtoimax(text, &end, 10);
    if (*end || end == text || errno || value > INT64_MAX || value < INT64_MIN)
        return false;
    *out = (int64_t)value;
    return true;
}

/* A minus sign is refused here because strtoumax would wrap it around. */
bool value_count(const char *text, uint64_t *out) {
    if (!has_only(text, "0123456789"))
        return false;
    errno = 0;
    uintmax_t value = strtoumax(text, NULL, 10);
    if (errno || value > UINT64_MAX)
        return false;
    *out = (uint64_t)value;
    return true;
}

bool value_bytes(const char *text, uint64_t *out) {
    static const char letters[] = "KMGT";
    char number[NUMBER_BYTES];
    size_t length = strspn(text, "0123456789.");
    const char *unit = text + length;
    const char *letter = *unit ? strchr(letters, toupper(*unit)) : NULL;
    double value, factor = 1;
    if (!*unit)
        return value_count(text, out);
    const char *rest = unit + (letter != NULL);
    if (length >= sizeof number ||
        (*rest && strcasecmp(rest, "B") != 0 && strcasecmp(rest, "iB") != 0))
        return false;
    memcpy(number, text, length);
    number[length] = '\0';
    if (!value_real(number, &value) || value < 0)
        return false;
    for (long i = letter ? letter - letters : -1; i >= 0; i--)
        factor *= 1024;
    if (value * factor >= 0x1p63)
        return false;
    *out = (uint64_t)(value * factor);
    return true;
}

/* Copies the text up to `separator` (or the end) into `part`.  Returns what
 * follows it, or NULL if it is too long to be a number. */
static const char *next_part(const char *text, char separator,
                             char part[NUMBER_BYTES], bool *more) {
    const char *end = strchr(text, separator);
    size_t length = end ? (size_t)(end - text) : strlen(text);
    if (length >= NUMBER_BYTES)
        return NULL;
    memcpy(part, text, length);
    part[length] = '\0';
    *more = end != NULL;
    return end ? end + 1 : text + length;
}

/* Splits a text into so many parts. */
static bool split(const char *text, char separator, int count,
                  char (*parts)[NUMBER_BYTES]) {
    bool more = true;
    for (int i = 0; i < count; i++)
        if (!more || !(text = next_part(text, separator, parts[i], &more)))
            return false;
    return !more;
}

/* "1/0" is refused, although C would compute it. */
bool value_quotient(const char *text, double *out) {
    const char *slash = strchr(text, '/');
    if (!slash)
        return value_real(text, out);
    double pair[2];
    if (!value_reals(text, '/', 2, pair) || !isfinite(pair[0] / pair[1]))
        return false;
    *out = pair[0] / pair[1];
    return true;
}

bool value_reals(const char *text, char separator, int count, double *out) {
    char parts[VALUES_MOST][NUMBER_BYTES];
    double values[VALUES_MOST];
    bool good = split(text, separator, count, parts);
    for (int i = 0; i < count && good; i++)
        good = value_real(parts[i], &values[i]);
    if (good)
        memcpy(out, values, (size_t)count * sizeof *out);
    return good;
}

bool value_integers(const char *text, char separator, int count, int64_t *out) {
    char parts[3][NUMBER_BYTES];
    int64_t values[3];
    bool good = split(text, separator, count, parts);
    for (int i = 0; i < count && good; i++)
        good = value_integer(parts[i], &values[i]);
    if (good)
        memcpy(out, values, (size_t)count * sizeof *out);
    return good;
}

/* "16:48", "16:", ":48", ":"; an explicit end of 0 is not a box. */
static bool read_ends(const char *text, int64_t out[2]) {
    char part[NUMBER_BYTES];
    int64_t ends[2] = {0, 0};
    bool more;
    if (!(text = next_part(text, ':', part, &more)) || !more ||
        (*part && !value_integer(part, &ends[0])) || ends[0] < 0)
        return false;
    if (*text && (!value_integer(text, &ends[1]) || ends[0] >= ends[1]))
        return false;
    memcpy(out, ends, sizeof ends);
    return true;
}

bool value_crop(const char *text, int64_t out[3][2]) {
    int64_t crop[3][2];
    for (int i = 0; i < 3; i++) {
        char axis[2 * NUMBER_BYTES];
        size_t length = strcspn(text, ",");
        if (length >= sizeof axis || (i < 2) != (text[length] == ','))
            return false;
        memcpy(axis, text, length);
        axis[length] = '\0';
        if (!read_ends(axis, crop[i]))
            return false;
        text += length + 1; /* not used after the last one */
    }
    memcpy(out, crop, sizeof crop);
    return true;
}

/* The CSS names that a background is likely to have. */
static const struct {
    const char *name;
    unsigned rgb;
} colors[] = {
    {"black", 0x000000},  {"white", 0xffffff},   {"grey", 0x808080},
    {"gray", 0x808080},   {"silver", 0xc0c0c0},  {"red", 0xff0000},
    {"green", 0x008000},  {"blue", 0x0000ff},    {"navy", 0x000080},
    {"yellow", 0xffff00}, {"magenta", 0xff00ff}, {"cyan", 0x00ffff},
    {"orange", 0xffa500},
};

static void set_color(color_value *out, unsigned rgb) {
    out->given = true;
    out->automatic = false;
    out->rgb[0] = (rgb >> 16 & 255) / 255.0;
    out->rgb[1] = (rgb >> 8 & 255) / 255.0;
    out->rgb[2] = (rgb & 255) / 255.0;
}

/* As in CSS, so that colours can be copied from a web page. */
static bool hex_color(const char *digits, color_value *out) {
    size_t length = strlen(digits);
    if (!has_only(digits, "0123456789abcdefABCDEF") ||
        (length != 3 && length != 6))
        return false;
    unsigned rgb = (unsigned)strtoul(digits, NULL, 16);
    if (length == 3) /* each digit is doubled: #18f is #1188ff */
        rgb = (rgb >> 8 & 15) * 0x110000 + (rgb >> 4 & 15) * 0x1100 +
              (rgb & 15) * 0x11;
    set_color(out, rgb);
    return true;
}

/* The common notations of colours, but without transparency: a background must
 * be opaque. */
bool value_color(const char *text, color_value *out) {
    bool automatic = strcasecmp(text, "auto") == 0;
    if (automatic || strcasecmp(text, "none") == 0) {
        *out = (color_value){.automatic = automatic};
        return true;
    }
    if (text[0] == '#')
        return hex_color(text + 1, out);
    for (size_t i = 0; i < sizeof colors / sizeof *colors; i++) {
        if (strcasecmp(text, colors[i].name) == 0) {
            set_color(out, colors[i].rgb);
            return true;
        }
    }
    double rgb[3];
    if (!value_reals(text, ',', 3, rgb))
        return false;
    for (int i = 0; i < 3; i++) {
        if (rgb[i] < 0 || rgb[i] > 1)
            return false;
    }
    *out = (color_value){true, false, {rgb[0], rgb[1], rgb[2]}};
    return true;
}

void value_color_names(char *out, size_t size) {
    size_t used = 0;
    out[0] = '\0';
    for (size_t i = 0; i < sizeof colors / sizeof *colors && used < size; i++) {
        int more = snprintf(out + used, size - used, "%s%s", i ? " " : "",
                            colors[i].name);
        used += more > 0 ? (size_t)more : size;
    }
}

/* Both ends need the p: "p1,99" could mean a percentile and a value, so it is
 * refused. */
static bool percentiles(const char *text, range_value *out) {
    char parts[2][NUMBER_BYTES];
    double values[2];
    if (!split(text, ',', 2, parts))
        return false;
    for (int i = 0; i < 2; i++)
        if (parts[i][0] != 'p' || !value_real(parts[i] + 1, &values[i]))
            return false;
    if (values[0] < 0 || values[1] > 100 || values[0] >= values[1])
        return false;
    *out = (range_value){SNOW_RANGE_PERCENTILES, values[0], values[1]};
    return true;
}

/* An empty range is refused, as is a reversed one: neither has a width to
 * spread colours over. */
bool value_range(const char *text, range_value *out) {
    if (strcasecmp(text, "full") == 0) {
        *out = (range_value){SNOW_RANGE_FULL, 0, 0};
        return true;
    }
    if (text[0] == 'p')
        return percentiles(text, out);
    double values[2];
    if (!value_reals(text, ',', 2, values) || values[0] >= values[1])
        return false;
    *out = (range_value){SNOW_RANGE_VALUES, values[0], values[1]};
    return true;
}

/* The library checks the points again; this check names the form. */
bool value_points(const char *text, point_list *out) {
    point_list list = {.count = 0};
    bool more = true;
    while (more) {
        char part[NUMBER_BYTES];
        double pair[2];
        if (list.count == POINTS_MAX ||
            !(text = next_part(text, ',', part, &more)) ||
            !value_reals(part, ':', 2, pair) || pair[1] < 0 || pair[1] > 1)
            return false;
        if (list.count > 0 && pair[0] < list.points[list.count - 1].value)
            return false;
        list.points[list.count++] = (snow_opacity_point){pair[0], pair[1]};
    }
    *out = list;
    return true;
}

bool value_factor(const char *text, point_list *out) {
    double factor;
    if (!value_real(text, &factor) || factor < 0 || factor > 1)
        return false;
    *out = (point_list){{{NAN, factor}}, 1};
    return true;
}

bool points_are_factor(const point_list *list) {
    return list->count == 1 && isnan(list->points[0].value);
}

/* Compares whole words: "crs|rle" and "" are not choices although they occur.
 * Case does not matter. */
bool value_is_choice(const char *choices, const char *text) {
    size_t length = strlen(text);
    if (!choices || length == 0 || strchr(text, '|'))
        return false;
    for (const char *at = choices; at; at = strchr(at, '|')) {
        at += *at == '|';
        if (strncasecmp(at, text, length) == 0 &&
            (at[length] == '|' || at[length] == '\0'))
            return true;
    }
    return false;
}
