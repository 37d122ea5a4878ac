/* recipe/looks.c - what stands for several fields of the record: units, ranges,
 * points, colours. */
#include "recipe/kinds.h"

#include <assert.h>
#include <math.h>
#include <snowglass/extend.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

typedef struct unit_fields {
    bool mm, voxel;
} unit_fields;

static bool read_unit(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    (void)key;
    const char *text = json_string_value(value);
    bool mm = text && strcasecmp(text, "mm") == 0;
    if (!mm && (!text || strcasecmp(text, "voxel") != 0))
        return recipe_refuse(wrong, "\"voxel\" or \"mm\"");
    *(unit_fields *)field = (unit_fields){mm, !mm};
    return true;
}

static json_t *write_unit(const recipe_key *key, const void *field) {
    (void)key;
    const unit_fields *unit = field;
    return unit->mm      ? json_string("mm")
           : unit->voxel ? json_string("voxel")
                         : NULL;
}

/* The value of mode iso follows the mode in the record, and is written only
 * with it. */
typedef struct iso_fields {
    snow_mode mode;
    double iso;
} iso_fields;

static_assert(offsetof(snow_settings, iso) - offsetof(snow_settings, mode) ==
                  offsetof(iso_fields, iso),
              "the fields of the record have the same order");

static bool read_iso(const recipe_key *key, const json_t *value, void *field,
                     char wrong[WRONG_BYTES]) {
    iso_fields *fields = field;
    return recipe_read_real(key, value, &fields->iso, wrong);
}

static json_t *write_iso(const recipe_key *key, const void *field) {
    const iso_fields *fields = field;
    return fields->mode == SNOW_MODE_ISO ? recipe_write_real(key, &fields->iso)
                                         : NULL;
}

/* --- ranges, points, colours ---------------------------------------------- */

/* A percentile "p99"; false for any other text. */
static bool read_percent(const json_t *value, double *out) {
    const char *text = json_string_value(value);
    size_t digits = text ? strspn(text + (*text == 'p'), "0123456789.") : 0;
    return digits && text[0] == 'p' && !text[1 + digits] &&
           snow_text_scan(text + 1, "%lf", out) == 1 && *out >= 0 &&
           *out <= 100;
}

/* Range, low and high follow each other in the record. */
typedef struct range_fields {
    snow_range kind;
    double low, high;
} range_fields;

static_assert(offsetof(snow_recipe, high) - offsetof(snow_recipe, range) ==
                  offsetof(range_fields, high),
              "the fields of the record have the same order");

static bool read_range(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    (void)key;
    range_fields *range = field, r = {SNOW_RANGE_VALUES, 0, 0};
    const char *text = json_string_value(value);
    const json_t *low = json_array_get(value, 0),
                 *high = json_array_get(value, 1);
    bool known = json_array_size(value) == 2 && json_is_number(low) &&
                 json_is_number(high);
    if (known) {
        r.low = json_number_value(low);
        r.high = json_number_value(high);
    } else if (read_percent(low, &r.low) && read_percent(high, &r.high)) {
        r.kind = SNOW_RANGE_PERCENTILES;
        known = json_array_size(value) == 2;
    } else if (text && strcasecmp(text, "full") == 0) {
        r = (range_fields){SNOW_RANGE_FULL, 0, 1};
        known = true;
    }
    if (!known || !(r.low < r.high))
        return recipe_refuse(wrong,
                             "[low, high], [\"p1\", \"p99\"] or \"full\"");
    *range = r;
    return true;
}

static json_t *write_range(const recipe_key *key, const void *field) {
    (void)key;
    const range_fields *range = field;
    char low[40], high[40];
    switch (range->kind) {
    case SNOW_RANGE_VALUES:
        return json_pack("[f,f]", range->low, range->high);
    case SNOW_RANGE_PERCENTILES:
        snow_text_print(low, sizeof low, "p%.17g", range->low);
        snow_text_print(high, sizeof high, "p%.17g", range->high);
        return json_pack("[s,s]", low, high);
    case SNOW_RANGE_FULL:
        return json_string("full");
    default:
        return NULL;
    }
}

/* The points behind a count: where sizes have 32 bits, the one may follow the
 * other with a gap or without. */
static snow_opacity_point *points_of(const void *count) {
    const uintptr_t step = _Alignof(snow_opacity_point);
    uintptr_t end = (uintptr_t)count + sizeof(size_t);
    return (snow_opacity_point *)((end + step - 1) / step * step);
}

static bool read_point(const json_t *pair, const snow_opacity_point *before,
                       snow_opacity_point *out) {
    const json_t *value = json_array_get(pair, 0),
                 *opacity = json_array_get(pair, 1);
    if (json_array_size(pair) != 2 || !json_is_number(value) ||
        !json_is_number(opacity))
        return false;
    out->value = json_number_value(value);
    out->opacity = json_number_value(opacity);
    return isfinite(out->value) && out->opacity >= 0 && out->opacity <= 1 &&
           (!before || out->value >= before->value);
}

static bool read_points(const recipe_key *key, const json_t *value, void *field,
                        char wrong[WRONG_BYTES]) {
    snow_opacity_point *points = points_of(field);
    size_t count = json_array_size(value);
    (void)key;
    bool good = count > 0 && count <= SNOW_RECIPE_POINTS_MAX;
    for (size_t i = 0; i < count && good; i++)
        good = read_point(json_array_get(value, i), i ? points + i - 1 : NULL,
                          points + i);
    if (!good)
        return recipe_refuse(wrong,
                             "[[value, opacity], ...], up to 256 of them, "
                             "values that do not decrease, opacities 0 to 1");
    *(size_t *)field = count;
    return true;
}

static json_t *write_points(const recipe_key *key, const void *field) {
    size_t count = *(const size_t *)field;
    const snow_opacity_point *points = points_of(field);
    if (!count)
        return NULL;
    (void)key;
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(
            array, json_pack("[f,f]", points[i].value, points[i].opacity));
    return array;
}

/* "#rrggbb"; false for any other text. */
static bool read_hex(const char *text, double rgb[3]) {
    unsigned parts[3];
    if (!text || text[0] != '#' || strlen(text) != 7 ||
        strspn(text + 1, "0123456789abcdefABCDEF") != 6 ||
        sscanf(text, "#%2x%2x%2x", &parts[0], &parts[1], &parts[2]) != 3)
        return false;
    for (int i = 0; i < 3; i++)
        rgb[i] = parts[i] / 255.0;
    return true;
}

static bool read_color(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    snow_image_options *image = field;
    const char *text = json_string_value(value);
    image->flatten = false;
    if (text && strcasecmp(text, "none") == 0)
        return true;
    if (!read_hex(text, image->background) &&
        !recipe_read_reals(key, value, image->background, wrong))
        return recipe_refuse(wrong,
                             "\"none\", \"#rrggbb\" or [red, green, blue] "
                             "from 0 to 1");
    image->flatten = true;
    return true;
}

static json_t *write_color(const recipe_key *key, const void *field) {
    const snow_image_options *image = field;
    return image->flatten ? recipe_write_reals(key, image->background) : NULL;
}

static bool read_bits(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    int bits;
    if (!recipe_read_int(key, value, &bits, wrong) || (bits != 8 && bits != 16))
        return recipe_refuse(wrong, "8 or 16");
    *(int *)field = bits;
    return true;
}

/* A name, or two angles. */
static bool read_light(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    snow_settings *settings = field;
    const char *text = json_string_value(value);
    double angles[2] = {0};
    if (text && strcasecmp(text, "key") == 0)
        settings->light = SNOW_LIGHT_KEY;
    else if (text && strcasecmp(text, "head") == 0)
        settings->light = SNOW_LIGHT_HEAD;
    else if (recipe_read_reals(key, value, angles, wrong))
        settings->light = SNOW_LIGHT_DIRECTION;
    else
        return recipe_refuse(
            wrong, "\"key\", \"head\" or [azimuth, elevation] in degrees");
    settings->light_azimuth = angles[0];
    settings->light_elevation = angles[1];
    return true;
}

static json_t *write_light(const recipe_key *key, const void *field) {
    const snow_settings *s = field;
    const double angles[2] = {s->light_azimuth, s->light_elevation};
    if (s->light == SNOW_LIGHT_KEY)
        return json_string("key");
    if (s->light == SNOW_LIGHT_HEAD)
        return json_string("head");
    if (s->light == SNOW_LIGHT_AUTO && angles[0] == 0 && angles[1] == 0)
        return NULL;
    return recipe_write_reals(key, angles);
}

static bool read_material(const recipe_key *key, const json_t *value,
                          void *field, char wrong[WRONG_BYTES]) {
    snow_settings *s = field;
    double parts[4];
    if (!recipe_read_reals(key, value, parts, wrong) || parts[0] > 1 ||
        parts[1] > 1 || parts[2] > 1)
        return recipe_refuse(wrong, "[ambient, diffuse, specular, shininess], "
                                    "from 0 to 1 and the last to 1000");
    s->ambient = parts[0];
    s->diffuse = parts[1];
    s->specular = parts[2];
    s->shininess = parts[3];
    return true;
}

static json_t *write_material(const recipe_key *key, const void *field) {
    const snow_settings *s = field;
    const double parts[4] = {s->ambient, s->diffuse, s->specular, s->shininess};
    return recipe_write_reals(key, parts);
}

const recipe_kind recipe_material = {read_material, write_material};
const recipe_kind recipe_unit = {read_unit, write_unit};
const recipe_kind recipe_iso = {read_iso, write_iso};
const recipe_kind recipe_range = {read_range, write_range};
const recipe_kind recipe_points = {read_points, write_points};
const recipe_kind recipe_color = {read_color, write_color};
const recipe_kind recipe_light = {read_light, write_light};
const recipe_kind recipe_bits = {read_bits, recipe_write_given_int};
