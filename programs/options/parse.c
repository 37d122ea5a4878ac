/* parse.c - parses an option's argument into its field, or writes the end of an
 * error message that says what is valid.
 *
 * All errors of a single argument are found here, before anything is opened.
 * Checks that need the volume or another option come later. */
#include "options/parse.h"
#include "options/guess.h"

#include <math.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The limit of snow_image_new, checked here before any volume is read. */
#define IMAGE_SIDE_MAX 32768

/* Ends every reader that cannot accept the text. */
static bool refuse(char wrong[WRONG_BYTES], const char *text) {
    snprintf(wrong, WRONG_BYTES, "%s", text);
    return false;
}

/* An empty word usually comes from a shell variable that was never set. */
bool read_text(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    if (!*text)
        return refuse(wrong, "is empty; give a value");
    *(const char **)field = text;
    return true;
}

/* The library knows which components there are. */
bool read_component(const option_row *row, const char *text, void *field,
                    char wrong[WRONG_BYTES]) {
    return read_text(row, text, field, wrong);
}

bool read_channels(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    (void)row;
    return channels_parse(text, field, wrong);
}

/* Flags have no text; getopt has refused --flag=text already. */
bool read_flag(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    (void)text;
    (void)wrong;
    *(bool *)field = true;
    return true;
}

/* For pairs such as -v and -q, which write one field. */
bool read_constant(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    (void)text;
    (void)wrong;
    *(int *)field = (int)row->low;
    return true;
}

/* Writes "a|b|c" as "a, b, c". */
static void spell_choices(const char *choices, char *out, size_t size) {
    size_t used = 0;
    for (; *choices && used + 3 < size; choices++) {
        out[used++] = *choices == '|' ? ',' : *choices;
        if (*choices == '|')
            out[used++] = ' ';
    }
    out[used] = '\0';
}

/* Writes " (did you mean a?)" for a word that is near a choice, else "". */
static void guess_choice(const char *choices, const char *text, char *out,
                         size_t size) {
    char words[128], near[96];
    guess nearest;
    guess_begin(&nearest, text);
    snprintf(words, sizeof words, "%s", choices);
    for (char *rest = words, *word; (word = strtok_r(rest, "| ", &rest));)
        guess_offer(&nearest, word);
    out[0] = '\0';
    if (guess_write(&nearest, "", near, sizeof near))
        snprintf(out, size, " (did you mean %s?)", near);
}

/* A planned choice is not unknown: its user has read a manual and need not look
 * for a misspelling. */
bool read_choice(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    if (value_is_choice(row->argument, text)) {
        *(const char **)field = text;
        return true;
    }
    char choices[128], near[128];
    bool later = value_is_choice(row->later, text);
    spell_choices(row->argument, choices, sizeof choices);
    guess_choice(later ? "" : row->argument, text, near, sizeof near);
    snprintf(wrong, WRONG_BYTES, "%s%s; choose from: %s",
             later ? "is not built yet" : "is unknown", near, choices);
    return false;
}

/* A row with both limits 0 has none; written so that NaN is never within. */
static bool is_within(const option_row *row, double value) {
    bool any = row->low == 0 && row->high == 0;
    return any || (value >= row->low && value <= row->high);
}

/* Names the limits, so that the second attempt succeeds. */
static bool refuse_number(const option_row *row, const char *kind,
                          char wrong[WRONG_BYTES]) {
    if (row->low == 0 && row->high == 0)
        snprintf(wrong, WRONG_BYTES, "is not a finite number; give %s", kind);
    else
        snprintf(wrong, WRONG_BYTES,
                 "is out of range; give %s from %.10g to "
                 "%.10g",
                 kind, row->low, row->high);
    return false;
}

bool read_real(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    double value;
    if (!value_real(text, &value) || !is_within(row, value))
        return refuse_number(row, "a decimal number", wrong);
    *(double *)field = value;
    return true;
}

bool read_fov(const option_row *row, const char *text, void *field,
              char wrong[WRONG_BYTES]) {
    if (*text)
        return read_real(row, text, field, wrong);
    *(double *)field = SNOW_FOV_DEFAULT;
    return true;
}

bool read_strength(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    return read_real(row, *text ? text : "1", field, wrong);
}

bool read_symlog(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    if (*text)
        return read_real(row, text, field, wrong);
    *(double *)field = -1;
    return true;
}

/* Differences are of values from 0 to 1, but people often think in steps of
 * 1/255. */
bool read_tolerance(const option_row *row, const char *text, void *field,
                    char wrong[WRONG_BYTES]) {
    double value;
    if (!value_quotient(text, &value) || !is_within(row, value))
        return refuse(wrong, "is not a difference; give a number from 0 to 1 "
                             "such as 0.004 or 1/255");
    *(double *)field = value;
    return true;
}

/* The limits are doubles below 2^53, where whole numbers are exact. */
bool read_integer(const option_row *row, const char *text, void *field,
                  char wrong[WRONG_BYTES]) {
    int64_t value;
    if (!value_integer(text, &value) || !is_within(row, (double)value))
        return refuse_number(row, "a whole number", wrong);
    *(int64_t *)field = value;
    return true;
}

/* A bound of A:B; an empty one is the end of all. */
static bool read_bound(const char *text, size_t length, int64_t empty,
                       int64_t *out) {
    char word[24];
    *out = empty;
    if (!length)
        return true;
    if (length >= sizeof word)
        return false;
    memcpy(word, text, length);
    word[length] = '\0';
    return value_integer(word, out);
}

/* "0.3", "0.3s", "6 h": a number, and a unit or a point in it. */
static bool read_moment(const char *text, options *out) {
    char *end;
    double value = strtod(text, &end);
    bool point = memchr(text, '.', (size_t)(end - text)) != NULL;
    end += strspn(end, " ");
    size_t letters = strspn(end, "abcdefghijklmnopqrstuvwxyz");
    if (end == text || !isfinite(value) || end[letters] ||
        letters >= sizeof out->moment_unit || (!letters && !point))
        return false;
    out->moment = value;
    memcpy(out->moment_unit, end, letters + 1);
    return true;
}

bool read_time(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    options *out = (options *)(void *)((char *)field - row->field);
    const char *colon = strchr(text, ':');
    int64_t value = 0;
    out->time = 0;
    out->time_range = colon != NULL;
    out->moment = NAN;
    if (colon ? read_bound(text, (size_t)(colon - text), 0, &out->time) &&
                    read_bound(colon + 1, strlen(colon + 1), INT64_MAX,
                               &out->time_end)
              : value_integer(text, &value)) {
        out->time = colon ? out->time : value;
        return true;
    }
    if (strcmp(text, "last") == 0) {
        out->time = -1;
        return true;
    }
    if (!colon && read_moment(text, out))
        return true;
    return refuse(wrong, "is not a time step; give its number, last, a range "
                         "such as 2:8, or a time such as 0.3s");
}

bool read_count(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_count(text, (uint64_t *)field))
        return refuse(wrong,
                      "is not a whole number of 0 or more; use digits only");
    return true;
}

bool read_size(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    int64_t size[2];
    bool square = value_integer(text, &size[0]);
    if (square)
        size[1] = size[0];
    if ((!square && !value_integers(text, 'x', 2, size)) || size[0] < 1 ||
        size[1] < 1 || size[0] > IMAGE_SIDE_MAX || size[1] > IMAGE_SIDE_MAX)
        return refuse(wrong,
                      "is not a picture size; give WIDTHxHEIGHT of 1 to "
                      "32768 pixels each, such as 640x480, or one number "
                      "for both");
    memcpy(field, size, sizeof size);
    return true;
}

/* W, or W,L for the level too, unless --level gives another. */
bool read_window(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    options *out = (options *)(void *)((char *)field - row->field);
    double pair[2];
    const bool both = value_reals(text, ',', 2, pair);
    if (!both && strchr(text, ','))
        return refuse(wrong, "is not a window; give its width, or width and "
                             "level such as 400,40");
    if (!both)
        return read_real(row, text, field, wrong);
    if (!is_within(row, pair[0]))
        return refuse_number(row, "a width", wrong);
    out->window = pair[0];
    if (!options_given(out, "level"))
        out->level = pair[1];
    return true;
}

/* There is no upper limit: the library checks the product, and the memory. */
bool read_dims(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    int64_t dims[3];
    if (!value_integers(text, 'x', 3, dims) || dims[0] < 1 || dims[1] < 1 ||
        dims[2] < 1)
        return refuse(wrong, "are not dimensions; give voxels along x, y and "
                             "z, at least 1 each, such as 256x256x110");
    memcpy(field, dims, sizeof dims);
    return true;
}

/* 1G is 1024 M, as memory is sold. */
bool read_bytes(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    uint64_t bytes;
    if (!value_bytes(text, &bytes) || !bytes)
        return refuse(wrong, "is not an amount of memory; give bytes, or a "
                             "number with K, M, G or T, such as 800M");
    *(uint64_t *)field = bytes;
    return true;
}

/* The library knows the volume's size, so it checks the upper bounds. */
bool read_crop(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    int64_t crop[3][2];
    if (!value_crop(text, crop))
        return refuse(wrong,
                      "is not a box; give the first voxel and one past the "
                      "last along x, y and z, such as 0:64,16:48,5:6 (an "
                      "omitted number is the volume's end)");
    memcpy(field, crop, sizeof crop);
    return true;
}

/* The library parses them again, for the mask. */
bool read_labels(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    snow_label_range ranges[SNOW_LABELS_MAX];
    size_t count;
    if (!snow_labels_parse(text, ranges, SNOW_LABELS_MAX, &count))
        return refuse(wrong, "is not a list of labels; give up to 256 whole "
                             "numbers and ranges, such as 1,4-7");
    return read_text(row, text, field, wrong);
}

/* A plane of zeros is no plane and ends the list. */
bool read_clip(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    double planes[SNOW_CLIPS_MAX][4] = {{0}};
    int count = 1;
    for (const char *at = text; (at = strchr(at, ',')); at++)
        count++;
    bool good = count % 4 == 0 && count <= 4 * SNOW_CLIPS_MAX &&
                value_reals(text, ',', count, planes[0]);
    for (int n = 0; n < count / 4 && good; n++)
        good = planes[n][0] != 0 || planes[n][1] != 0 || planes[n][2] != 0;
    if (!good)
        return refuse(wrong, "are not planes; give A,B,C,D, four numbers for "
                             "each of up to six planes, with A, B and C not "
                             "all 0: 0,0,1,50 removes what is above z = 50");
    memcpy(field, planes, sizeof planes);
    return true;
}

/* value_reals accepts no NaN or inf, so only the sign is left to check. */
bool read_spacing(const option_row *row, const char *text, void *field,
                  char wrong[WRONG_BYTES]) {
    (void)row;
    double spacing[3];
    if (!value_reals(text, 'x', 3, spacing) || spacing[0] <= 0 ||
        spacing[1] <= 0 || spacing[2] <= 0)
        return refuse(wrong, "is not a spacing; give voxel sizes above 0 along "
                             "x, y and z, such as 0.5x0.5x2");
    memcpy(field, spacing, sizeof spacing);
    return true;
}

/* The names come from the library's list of types. */
bool read_type(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    snow_type type = snow_type_from_name(text);
    if (type == SNOW_TYPE_NONE) {
#define TYPE_NAME(name, type, text) " " text
        static const char names[] = SNOW_TYPE_MAP(TYPE_NAME);
#undef TYPE_NAME
        char near[128];
        guess_choice(names, text, near, sizeof near);
        snprintf(wrong, WRONG_BYTES, "is not a voxel type%s; choose from:%s",
                 near, names);
        return false;
    }
    *(snow_type *)field = type;
    return true;
}

/* Ends an error message with the nearest of the library's names, or with all of
 * them. */
static bool refuse_name(const option_row *row, const char *text,
                        const char *(*name)(size_t), char wrong[WRONG_BYTES]) {
    char near[128];
    guess nearest;
    guess_begin(&nearest, text);
    guess_offer_all(&nearest, name);
    if (guess_write(&nearest, "", near, sizeof near)) {
        snprintf(wrong, WRONG_BYTES,
                 "is unknown; did you mean %s? snowglass help %s lists all",
                 near, row->name);
        return false;
    }
    size_t used = (size_t)snprintf(wrong, WRONG_BYTES,
                                   "is unknown; choose from: %s", name(0));
    for (size_t i = 1; name(i) && used < WRONG_BYTES; i++)
        used +=
            (size_t)snprintf(wrong + used, WRONG_BYTES - used, ", %s", name(i));
    return false;
}

/* The library would refuse wrong names too, but only after reading the
 * volume. */
bool read_preset(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    if (snow_preset_from_name(text) < 0)
        return refuse_name(row, text, snow_preset_name, wrong);
    return read_text(row, text, field, wrong);
}

bool read_colormap(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    const bool known = snow_colormap_from_name(text) >= 0;
    if (!known && strchr(text, ':')) {
        snprintf(wrong, WRONG_BYTES,
                 "is no list of colours: must be at most %d VALUE:#RRGGBB, "
                 "values rising; correct it",
                 SNOW_COLORMAP_POINTS_MAX);
        return false;
    }
    return known ? read_text(row, text, field, wrong)
                 : refuse_name(row, text, snow_colormap_name, wrong);
}

/* The library knows all spellings of a view, but needs a context for its
 * message. If there is no memory for one, the name is accepted: the command
 * will fail for the same reason. */
bool read_view(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    snow_context *context = NULL;
    snow_view view = {.size = sizeof view};
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_view_from_name(context, text, &view);
    snow_context_free(context);
    if (status == SNOW_STATUS_BAD_USAGE)
        return refuse_name(row, text, snow_view_name, wrong);
    return read_text(row, text, field, wrong);
}

bool read_color(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    if (value_color(text, field))
        return true;
    char names[128], near[128];
    value_color_names(names, sizeof names);
    guess_choice(names, text, near, sizeof near);
    snprintf(wrong, WRONG_BYTES,
             "is not a colour%s; give auto, none, #rgb, #rrggbb, "
             "red,green,blue from 0 to 1, or a name: %s",
             near, names);
    return false;
}

bool read_range(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_range(text, field))
        return refuse(wrong, "is not a range; give LOW,HIGH in data values, "
                             "pLOW,pHIGH in percent such as p1,p99, or full");
    return true;
}

bool read_points(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_points(text, field))
        return refuse(
            wrong,
            "are not control points; give VALUE:OPACITY pairs, values rising, "
            "opacities 0 to 1, at most 256, such as 80:0,200:0.5");
    return true;
}

bool read_factor_points(const option_row *row, const char *text, void *field,
                        char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_factor(text, field) && !value_points(text, field))
        return refuse(
            wrong,
            "is neither a factor from 0 to 1, such as 0.6, nor control points; "
            "give VALUE:OPACITY pairs, values rising, opacities 0 to 1, at "
            "most "
            "256, such as 80:0,200:0.5");
    return true;
}

bool read_gradient_points(const option_row *row, const char *text, void *field,
                          char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_points(text, field))
        return refuse(
            wrong,
            "are not control points; give MAGNITUDE:FACTOR pairs, magnitudes "
            "rising, factors 0 to 1, at most 256, such as 0:0,20:1");
    return true;
}

/* Any angle is valid: full turns do not matter. */
bool read_light(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    double pair[2] = {0};
    light_value light = {.light = SNOW_LIGHT_DIRECTION};
    if (strcasecmp(text, "key") == 0)
        light.light = SNOW_LIGHT_KEY;
    else if (strcasecmp(text, "head") == 0)
        light.light = SNOW_LIGHT_HEAD;
    else if (!value_reals(text, ',', 2, pair)) {
        char near[128];
        guess_choice("key|head", text, near, sizeof near);
        snprintf(wrong, WRONG_BYTES,
                 "is not a light%s; give key, head, or AZIMUTH,ELEVATION in "
                 "degrees, such as 30,45",
                 near);
        return false;
    }
    light.azimuth = pair[0];
    light.elevation = pair[1];
    *(light_value *)field = light;
    return true;
}

bool read_place(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    place_value place = {.given = true};
    if (!value_reals(text, ',', 3, place.at))
        return refuse(wrong, "is not a position; give X,Y,Z in the volume's "
                             "world, such as 0,250,-12.5");
    *(place_value *)field = place;
    return true;
}
