/* parse_data.c - the readers of options that say which data to read. */
#include "options/parse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The library knows which components there are. */
bool read_component(const option_row *row, const char *text, void *field,
                    char wrong[WRONG_BYTES]) {
    return read_text(row, text, field, wrong);
}

bool read_z_scale(const option_row *row, const char *text, void *field,
                  char wrong[WRONG_BYTES]) {
    *(double *)field = 0;
    return strcmp(text, "auto") == 0 || read_real(row, text, field, wrong);
}

bool read_channels(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    (void)row;
    return channels_parse(text, field, wrong);
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

bool read_time(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    options *out = (options *)(void *)((char *)field - row->field);
    int64_t value = 0;
    moment given;
    const bool timed = moment_read(text, &given);
    const char *colon = timed ? NULL : strchr(text, ':');
    out->moment = given;
    out->time = 0;
    out->time_range = colon != NULL;
    if (timed)
        return true;
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
    return parse_refuse(wrong,
                        "is not a time step; give its number, last, a range "
                        "such as 2:8, or a time such as 0.3s or 2005-08-28");
}

/* There is no upper limit: the library checks the product, and the memory. */
bool read_dims(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    int64_t dims[3];
    if (!value_integers(text, 'x', 3, dims) || dims[0] < 1 || dims[1] < 1 ||
        dims[2] < 1)
        return parse_refuse(wrong,
                            "are not dimensions; give voxels along x, y and "
                            "z, at least 1 each, such as 256x256x110");
    memcpy(field, dims, sizeof dims);
    return true;
}

/* The library knows the volume's size, so it checks the upper bounds. */
bool read_crop(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    int64_t crop[3][2];
    if (!value_crop(text, crop))
        return parse_refuse(
            wrong, "is not a box; give the first voxel and one past the "
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
        return parse_refuse(wrong,
                            "is not a list of labels; give up to 256 whole "
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
        return parse_refuse(wrong,
                            "are not planes; give A,B,C,D, four numbers for "
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
        return parse_refuse(wrong,
                            "is not a spacing; give voxel sizes above 0 along "
                            "x, y and z, such as 0.5x0.5x2");
    memcpy(field, spacing, sizeof spacing);
    return true;
}

/* The names come from the library's list of types; frames have one of their
 * own. */
bool read_type(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    snow_type type = snow_type_from_name(text);
    if (strcmp(row->name, "as") == 0 && strcmp(text, "rgb24") == 0)
        type = AS_RGB24;
    if (type == SNOW_TYPE_NONE) {
#define TYPE_NAME(name, type, text) " " text
        static const char names[] = SNOW_TYPE_MAP(TYPE_NAME);
#undef TYPE_NAME
        char near[128];
        parse_near(names, text, near, sizeof near);
        snprintf(wrong, WRONG_BYTES, "is not a voxel type%s; choose from:%s",
                 near, names);
        return false;
    }
    *(snow_type *)field = type;
    return true;
}
