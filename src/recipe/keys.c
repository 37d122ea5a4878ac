/* recipe/keys.c - the keys of a recipe, and how JSON becomes their fields. */
#include "recipe/keys.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- numbers -------------------------------------------------------------- */

static bool refuse(char wrong[WRONG_BYTES], const char *text) {
    snprintf(wrong, WRONG_BYTES, "must be %s", text);
    return false;
}

static bool refuse_range(const recipe_key *key, char wrong[WRONG_BYTES],
                         const char *what) {
    if (key->low == 0 && key->high == 0)
        snprintf(wrong, WRONG_BYTES, "must be %s", what);
    else
        snprintf(wrong, WRONG_BYTES, "must be %s from %.17g to %.17g", what,
                 key->low, key->high);
    return false;
}

static bool in_range(const recipe_key *key, double value) {
    return isfinite(value) && ((key->low == 0 && key->high == 0) ||
                               (value >= key->low && value <= key->high));
}

static bool read_real(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    double number = json_number_value(value);
    if (!json_is_number(value) || !in_range(key, number))
        return refuse_range(key, wrong, "a number");
    *(double *)field = number;
    return true;
}

static json_t *write_real(const recipe_key *key, const void *field) {
    (void)key;
    return json_real(*(const double *)field);
}

static bool read_whole(const recipe_key *key, const json_t *value, int64_t *out,
                       char wrong[WRONG_BYTES]) {
    json_int_t number = json_integer_value(value);
    if (!json_is_integer(value) || !in_range(key, (double)number))
        return refuse_range(key, wrong, "a whole number");
    *out = number;
    return true;
}

static bool read_int(const recipe_key *key, const json_t *value, void *field,
                     char wrong[WRONG_BYTES]) {
    int64_t number;
    if (!read_whole(key, value, &number, wrong))
        return false;
    *(int *)field = (int)number;
    return true;
}

static json_t *write_int(const recipe_key *key, const void *field) {
    (void)key;
    return json_integer(*(const int *)field);
}

/* A number that is omitted if it is 0. */
static json_t *write_told_int(const recipe_key *key, const void *field) {
    return *(const int *)field ? write_int(key, field) : NULL;
}

/* int64_t and, for numbers from 0 on, uint64_t. */
static bool read_long(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    return read_whole(key, value, field, wrong);
}

static json_t *write_told_long(const recipe_key *key, const void *field) {
    (void)key;
    int64_t value = *(const int64_t *)field;
    return value ? json_integer(value) : NULL;
}

static bool read_flag(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    (void)key;
    if (!json_is_boolean(value))
        return refuse(wrong, "true or false");
    *(bool *)field = json_is_true(value);
    return true;
}

static json_t *write_flag(const recipe_key *key, const void *field) {
    (void)key;
    return *(const bool *)field ? json_true() : NULL;
}

/* --- arrays of numbers ---------------------------------------------------- */

static bool refuse_array(const recipe_key *key, char wrong[WRONG_BYTES]) {
    snprintf(wrong, WRONG_BYTES, "must be an array of %d numbers", key->count);
    return false;
}

static bool read_reals(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    double numbers[3];
    if (json_array_size(value) != (size_t)key->count)
        return refuse_array(key, wrong);
    for (int i = 0; i < key->count; i++)
        if (!read_real(key, json_array_get(value, (size_t)i), &numbers[i],
                       wrong))
            return refuse_array(key, wrong);
    memcpy(field, numbers, (size_t)key->count * sizeof *numbers);
    return true;
}

static json_t *write_reals(const recipe_key *key, const void *field) {
    const double *numbers = field;
    json_t *array = json_array();
    for (int i = 0; i < key->count; i++)
        json_array_append_new(array, json_real(numbers[i]));
    return array;
}

static json_t *write_told_reals(const recipe_key *key, const void *field) {
    const double *numbers = field;
    return numbers[0] != 0 ? write_reals(key, field) : NULL;
}

/* For numbers that are NaN if not given. */
static json_t *write_place(const recipe_key *key, const void *field) {
    const double *numbers = field;
    return isnan(numbers[0]) ? NULL : write_reals(key, field);
}

static bool read_longs(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    int64_t numbers[3];
    if (json_array_size(value) != (size_t)key->count)
        return refuse_array(key, wrong);
    for (int i = 0; i < key->count; i++)
        if (!read_whole(key, json_array_get(value, (size_t)i), &numbers[i],
                        wrong))
            return refuse_array(key, wrong);
    memcpy(field, numbers, (size_t)key->count * sizeof *numbers);
    return true;
}

static json_t *write_told_longs(const recipe_key *key, const void *field) {
    const int64_t *numbers = field;
    if (!numbers[0])
        return NULL;
    json_t *array = json_array();
    for (int i = 0; i < key->count; i++)
        json_array_append_new(array, json_integer(numbers[i]));
    return array;
}

/* [[first, one past the last], ...] along x, y, z; 0 for the end. */
static bool read_crop(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    int64_t crop[3][3];
    bool good = json_array_size(value) == 3;
    for (size_t i = 0; i < 3 && good; i++)
        good = read_longs(key, json_array_get(value, i), crop[i], wrong) &&
               (crop[i][1] == 0 || crop[i][0] < crop[i][1]);
    if (!good)
        return refuse(wrong, "[[x0, x1], [y0, y1], [z0, z1]]: from the first "
                             "voxel to one past the last, 0 for the end");
    for (int i = 0; i < 3; i++)
        memcpy((int64_t *)field + 2 * i, crop[i], 2 * sizeof(int64_t));
    return true;
}

static json_t *write_crop(const recipe_key *key, const void *field) {
    (void)key;
    const int64_t *c = field;
    if (!c[0] && !c[1] && !c[2] && !c[3] && !c[4] && !c[5])
        return NULL;
    return json_pack("[[I,I],[I,I],[I,I]]", (json_int_t)c[0], (json_int_t)c[1],
                     (json_int_t)c[2], (json_int_t)c[3], (json_int_t)c[4],
                     (json_int_t)c[5]);
}

/* [[a, b, c, d], ...]; a plane of zeros is not a plane. */
static bool read_clip(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    double planes[SNOW_CLIPS_MAX][4] = {{0}};
    size_t count = json_array_size(value);
    bool good = count > 0 && count <= SNOW_CLIPS_MAX;
    for (size_t n = 0; n < count && good; n++) {
        const json_t *plane = json_array_get(value, n);
        good = json_array_size(plane) == 4;
        for (size_t i = 0; i < 4 && good; i++)
            good =
                read_real(key, json_array_get(plane, i), &planes[n][i], wrong);
        good = good &&
               (planes[n][0] != 0 || planes[n][1] != 0 || planes[n][2] != 0);
    }
    if (!good)
        return refuse(wrong, "[[a, b, c, d], ...], up to 6 planes whose a, b "
                             "and c are not all 0");
    memcpy(field, planes, sizeof planes);
    return true;
}

static json_t *write_clip(const recipe_key *key, const void *field) {
    (void)key;
    const double *p = field;
    json_t *list = json_array();
    for (int n = 0; n < SNOW_CLIPS_MAX; n++, p += 4)
        if (p[0] != 0 || p[1] != 0 || p[2] != 0)
            json_array_append_new(
                list, json_pack("[f,f,f,f]", p[0], p[1], p[2], p[3]));
    if (json_array_size(list))
        return list;
    json_decref(list);
    return NULL;
}

/* Width and height, which follow each other in the record. */
static bool read_size(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    int64_t sides[3];
    if (!read_longs(key, value, sides, wrong))
        return refuse(wrong, "[width, height], each from 1 to 32768");
    ((int *)field)[0] = (int)sides[0];
    ((int *)field)[1] = (int)sides[1];
    return true;
}

static json_t *write_size(const recipe_key *key, const void *field) {
    (void)key;
    const int *sides = field;
    return json_pack("[i,i]", sides[0], sides[1]);
}

/* --- names ---------------------------------------------------------------- */

static bool read_text(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    (void)key;
    const char *text = json_string_value(value);
    if (!text)
        return refuse(wrong, "a text");
    *(const char **)field = text;
    return true;
}

static json_t *write_text(const recipe_key *key, const void *field) {
    (void)key;
    const char *text = *(const char *const *)field;
    return text ? json_string(text) : NULL;
}

/* Labels of a mask, stored as text. */
static bool read_labels(const recipe_key *key, const json_t *value, void *field,
                        char wrong[WRONG_BYTES]) {
    snow_label_range ranges[SNOW_LABELS_MAX];
    size_t count;
    const char *text = json_string_value(value);
    if (!text || !snow_labels_parse(text, ranges, SNOW_LABELS_MAX, &count))
        return refuse(wrong, "a text of whole numbers and ranges such as "
                             "\"1,4-7\"");
    return read_text(key, value, field, wrong);
}

static json_t *write_labels(const recipe_key *key, const void *field) {
    return write_text(key, field);
}

/* Lists names, "a, b or c", after "must be ". */
static bool refuse_name(const recipe_key *key, char wrong[WRONG_BYTES]) {
    size_t at = (size_t)snprintf(wrong, WRONG_BYTES, "must be one of");
    for (int i = 0; key->name_of(i) && at < WRONG_BYTES; i++)
        at += (size_t)snprintf(wrong + at, WRONG_BYTES - at, "%s %s",
                               i ? "," : "", key->name_of(i));
    return false;
}

/* A text that must be a known name; it is stored as text. */
static bool read_known(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    const char *text = json_string_value(value);
    if (!text || key->named(text) < 0)
        return refuse_name(key, wrong);
    return read_text(key, value, field, wrong);
}

/* The value of a name: all enumerations here are as wide as an int. */
static bool read_name(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    const char *text = json_string_value(value);
    int named = text ? key->named(text) : -1;
    if (named < 0)
        return refuse_name(key, wrong);
    memcpy(field, &named, sizeof named);
    return true;
}

static json_t *write_name(const recipe_key *key, const void *field) {
    int value;
    memcpy(&value, field, sizeof value);
    return json_string(key->name_of(value));
}

static json_t *write_told_name(const recipe_key *key, const void *field) {
    int value;
    memcpy(&value, field, sizeof value);
    return value ? json_string(key->name_of(value)) : NULL;
}

/* Adapters between the library's tables, of enumerations and of plain indices,
 * and the rows. */
#define NAMES(word)                                    \
    static const char *word##_name(int value) {        \
        return snow_##word##_name((snow_##word)value); \
    }
NAMES(method)
NAMES(encoding)
NAMES(kernel)
NAMES(quality)
NAMES(isa)
NAMES(mode)

static const char *preset_name(int value) {
    return snow_preset_name((size_t)value);
}

static const char *colormap_name(int value) {
    return snow_colormap_name((size_t)value);
}

static const char *view_name(int value) {
    return snow_view_name((size_t)value);
}

static int find_name(const char *(*name_of)(int value), const char *name) {
    for (int i = 0; name_of(i); i++)
        if (strcmp(name_of(i), name) == 0)
            return i;
    return -1;
}

static int view_named(const char *name) {
    return find_name(view_name, name);
}

/* The first type is "none". */
static const char *type_name(int value) {
    return value > SNOW_TYPE_FLOAT64 ? NULL : snow_type_name((snow_type)value);
}

static int type_named(const char *name) {
    snow_type type = snow_type_from_name(name);
    return type == SNOW_TYPE_NONE ? -1 : (int)type;
}

static const char *of_list(const char *const *list, int count, int value) {
    return value >= 0 && value < count ? list[value] : NULL;
}

static const char *shade_name(int value) {
    static const char *const names[] = {"phong", "none"};
    return of_list(names, 2, value);
}

static int shade_named(const char *name) {
    return find_name(shade_name, name);
}

static const char *endian_name(int value) {
    static const char *const names[] = {"", "little", "big"};
    return of_list(names, 3, value);
}

static int endian_named(const char *name) {
    return find_name(endian_name, name);
}

typedef struct unit_fields {
    bool mm, voxel;
} unit_fields;

static bool read_unit(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    (void)key;
    const char *text = json_string_value(value);
    bool mm = text && strcmp(text, "mm") == 0;
    if (!mm && (!text || strcmp(text, "voxel") != 0))
        return refuse(wrong, "\"voxel\" or \"mm\"");
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
    return read_real(key, value, &fields->iso, wrong);
}

static json_t *write_iso(const recipe_key *key, const void *field) {
    const iso_fields *fields = field;
    return fields->mode == SNOW_MODE_ISO ? write_real(key, &fields->iso) : NULL;
}

/* --- ranges, points, colours ---------------------------------------------- */

/* A percentile "p99"; false for any other text. */
static bool read_percent(const json_t *value, double *out) {
    const char *text = json_string_value(value);
    size_t digits = text ? strspn(text + (*text == 'p'), "0123456789.") : 0;
    return digits && text[0] == 'p' && !text[1 + digits] &&
           sscanf(text + 1, "%lf", out) == 1 && *out >= 0 && *out <= 100;
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
    } else if (text && strcmp(text, "full") == 0) {
        r = (range_fields){SNOW_RANGE_FULL, 0, 1};
        known = true;
    }
    if (!known || !(r.low < r.high))
        return refuse(wrong, "[low, high], [\"p1\", \"p99\"] or \"full\"");
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
        snprintf(low, sizeof low, "p%.17g", range->low);
        snprintf(high, sizeof high, "p%.17g", range->high);
        return json_pack("[s,s]", low, high);
    case SNOW_RANGE_FULL:
        return json_string("full");
    default:
        return NULL;
    }
}

/* A count followed by the points. */
typedef struct point_fields {
    size_t count;
    snow_opacity_point points[SNOW_RECIPE_POINTS_MAX];
} point_fields;

static_assert(offsetof(snow_recipe, opacities) -
                          offsetof(snow_recipe, opacity_count) ==
                      offsetof(point_fields, points) &&
                  offsetof(snow_recipe, gradient_opacities) -
                          offsetof(snow_recipe, gradient_opacity_count) ==
                      offsetof(point_fields, points),
              "the fields of the record have the same order");

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
    (void)key;
    point_fields *points = field;
    size_t count = json_array_size(value);
    bool good = count > 0 && count <= SNOW_RECIPE_POINTS_MAX;
    for (size_t i = 0; i < count && good; i++)
        good =
            read_point(json_array_get(value, i),
                       i ? &points->points[i - 1] : NULL, &points->points[i]);
    if (!good)
        return refuse(wrong, "[[value, opacity], ...], up to 256 of them, "
                             "values that do not decrease, opacities 0 to 1");
    points->count = count;
    return true;
}

static json_t *write_points(const recipe_key *key, const void *field) {
    (void)key;
    const point_fields *points = field;
    if (!points->count)
        return NULL;
    json_t *array = json_array();
    for (size_t i = 0; i < points->count; i++)
        json_array_append_new(array, json_pack("[f,f]", points->points[i].value,
                                               points->points[i].opacity));
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
    if (text && strcmp(text, "none") == 0)
        return true;
    if (!read_hex(text, image->background) &&
        !read_reals(key, value, image->background, wrong))
        return refuse(wrong, "\"none\", \"#rrggbb\" or [red, green, blue] "
                             "from 0 to 1");
    image->flatten = true;
    return true;
}

static json_t *write_color(const recipe_key *key, const void *field) {
    const snow_image_options *image = field;
    return image->flatten ? write_reals(key, image->background) : NULL;
}

static bool read_bits(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    int bits;
    if (!read_int(key, value, &bits, wrong) || (bits != 8 && bits != 16))
        return refuse(wrong, "8 or 16");
    *(int *)field = bits;
    return true;
}

/* --- the table ------------------------------------------------------------ */

#define AT(name) offsetof(snow_recipe, name)
#define REAL(name, field, low, high) \
    { name, read_real, write_real, AT(field), low, high, 0, NULL, NULL }
#define TEXT(name, field) \
    { name, read_text, write_text, AT(field), 0, 0, 0, NULL, NULL }
#define NAME(name, field, names, named) \
    { name, read_name, write_name, AT(field), 0, 0, 0, names, named }
#define KNOWN(name, field, names, named) \
    { name, read_known, write_text, AT(field), 0, 0, 0, names, named }
#define MADE(name, word, field, low, high, count) \
    { name, read_##word, write_##word, AT(field), low, high, count, NULL, NULL }

/* clang-format off */
const recipe_key recipe_keys[] = {
    TEXT("input", input),
    TEXT("output", output),
    TEXT("depth", depth),
    MADE("overwrite", flag, image.overwrite, 0, 0, 0),
    MADE("size", size, width, 1, 32768, 2),
    MADE("background", color, image, 0, 1, 3),
    {"bits", read_bits, write_told_int, AT(image.bits), 8, 16, 0, NULL, NULL},
    NAME("mode", settings.mode, mode_name, snow_mode_from_name),
    {"iso", read_iso, write_iso, AT(settings.mode), 0, 0, 0, NULL, NULL},
    REAL("threshold", settings.threshold, 0, 255),
    NAME("encoding", settings.encoding, encoding_name, snow_encoding_from_name),
    NAME("method", settings.method, method_name, snow_method_from_name),
    NAME("kernel", settings.kernel, kernel_name, snow_kernel_from_name),
    {"footprint", read_int, write_told_int, AT(settings.footprint), 2, 9, 0,
     NULL, NULL},
    KNOWN("preset", preset, preset_name, snow_preset_from_name),
    KNOWN("colormap", colormap, colormap_name, snow_colormap_from_name),
    TEXT("tf", tf),
    MADE("log", flag, log, 0, 0, 0),
    MADE("opacity", points, opacity_count, 0, 0, 0),
    MADE("gradient-opacity", points, gradient_opacity_count, 0, 0, 0),
    MADE("range", range, range, 0, 0, 0),
    MADE("opacity-unit", unit, opacity_per_mm, 0, 0, 0),
    NAME("shade", settings.shade, shade_name, shade_named),
    MADE("light", reals, settings.light_azimuth, 0, 0, 2),
    REAL("ambient", settings.ambient, 0, 1),
    REAL("diffuse", settings.diffuse, 0, 1),
    REAL("specular", settings.specular, 0, 1),
    REAL("shininess", settings.shininess, 0, 1000),
    NAME("quality", settings.quality, quality_name, snow_quality_from_name),
    KNOWN("view", view, view_name, view_named),
    REAL("azimuth", azimuth, 0, 0),
    REAL("elevation", elevation, 0, 0),
    REAL("roll", roll, 0, 0),
    REAL("zoom", zoom, 1e-6, 1e6),
    REAL("perspective", fov, 0, SNOW_FOV_MAX),
    {"position", read_reals, write_place, AT(position), 0, 0, 3, NULL, NULL},
    {"target", read_reals, write_place, AT(target), 0, 0, 3, NULL, NULL},
    {"up", read_reals, write_place, AT(up), 0, 0, 3, NULL, NULL},
    MADE("no-labels", flag, no_labels, 0, 0, 0),
    MADE("legend", flag, legend, 0, 0, 0),
    MADE("time-label", flag, time_label, 0, 0, 0),
    {"threads", read_int, write_told_int, AT(settings.threads), 1, 4096, 0,
     NULL, NULL},
    MADE("deterministic", flag, settings.deterministic, 0, 0, 0),
    NAME("isa", settings.isa, isa_name, snow_isa_from_name),
    {"dims", read_longs, write_told_longs, AT(data.dims), 1, 9e15, 3, NULL,
     NULL},
    {"type", read_name, write_told_name, AT(data.type), 0, 0, 0, type_name,
     type_named},
    {"spacing", read_reals, write_told_reals, AT(data.spacing), 1e-300, 1e300,
     3, NULL, NULL},
    {"endian", read_name, write_told_name, AT(data.endian), 0, 0, 0,
     endian_name, endian_named},
    {"offset", read_long, write_told_long, AT(data.offset), 0, 9e15, 0, NULL,
     NULL},
    MADE("crop", crop, data.crop, 0, 9e15, 2),
    {"channel", read_long, write_told_long, AT(data.channel), 0, 9e15, 0, NULL,
     NULL},
    TEXT("dataset", data.dataset),
    TEXT("series", data.series),
    TEXT("mask", data.mask),
    MADE("labels", labels, data.labels, 0, 0, 0),
    MADE("clip", clip, data.clip, 0, 0, 4),
    {"time", read_long, write_told_long, AT(data.time), 0, 9e15, 0, NULL, NULL},
    {NULL, NULL, NULL, 0, 0, 0, 0, NULL, NULL},
};
/* clang-format on */
