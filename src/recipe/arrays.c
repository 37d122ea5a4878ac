/* recipe/arrays.c - arrays of numbers. */
#include "recipe/kinds.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool refuse_array(const recipe_key *key, char wrong[WRONG_BYTES]) {
    snprintf(wrong, WRONG_BYTES, "must be an array of %d numbers", key->count);
    return false;
}

bool recipe_read_reals(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    double numbers[4];
    if (json_array_size(value) != (size_t)key->count)
        return refuse_array(key, wrong);
    for (int i = 0; i < key->count; i++)
        if (!recipe_read_real(key, json_array_get(value, (size_t)i),
                              &numbers[i], wrong))
            return refuse_array(key, wrong);
    memcpy(field, numbers, (size_t)key->count * sizeof *numbers);
    return true;
}

json_t *recipe_write_reals(const recipe_key *key, const void *field) {
    const double *numbers = field;
    json_t *array = json_array();
    for (int i = 0; i < key->count; i++)
        json_array_append_new(array, json_real(numbers[i]));
    return array;
}

static json_t *write_given_reals(const recipe_key *key, const void *field) {
    const double *numbers = field;
    return numbers[0] != 0 ? recipe_write_reals(key, field) : NULL;
}

/* For numbers that are NaN if not given. */
static json_t *write_place(const recipe_key *key, const void *field) {
    const double *numbers = field;
    return isnan(numbers[0]) ? NULL : recipe_write_reals(key, field);
}

static bool read_longs(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    int64_t numbers[3];
    if (json_array_size(value) != (size_t)key->count)
        return refuse_array(key, wrong);
    for (int i = 0; i < key->count; i++)
        if (!recipe_read_whole(key, json_array_get(value, (size_t)i),
                               &numbers[i], wrong))
            return refuse_array(key, wrong);
    memcpy(field, numbers, (size_t)key->count * sizeof *numbers);
    return true;
}

static json_t *write_given_longs(const recipe_key *key, const void *field) {
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
        return recipe_refuse(wrong,
                             "[[x0, x1], [y0, y1], [z0, z1]]: from the first "
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
            good = recipe_read_real(key, json_array_get(plane, i),
                                    &planes[n][i], wrong);
        good = good &&
               (planes[n][0] != 0 || planes[n][1] != 0 || planes[n][2] != 0);
    }
    if (!good)
        return recipe_refuse(wrong,
                             "[[a, b, c, d], ...], up to 6 planes whose a, b "
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

/* Width and height, which follow each other in the record, or both by one. */
static bool read_size(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    int64_t sides[3];
    if (recipe_read_whole(key, value, &sides[0], wrong))
        sides[1] = sides[0];
    else if (!read_longs(key, value, sides, wrong))
        return recipe_refuse(wrong, "[width, height], each from 1 to 32768, or "
                                    "one number for both");
    ((int *)field)[0] = (int)sides[0];
    ((int *)field)[1] = (int)sides[1];
    return true;
}

static json_t *write_size(const recipe_key *key, const void *field) {
    (void)key;
    const int *sides = field;
    return json_pack("[i,i]", sides[0], sides[1]);
}

const recipe_kind recipe_reals = {recipe_read_reals, recipe_write_reals};
const recipe_kind recipe_given_reals = {recipe_read_reals, write_given_reals};
const recipe_kind recipe_point = {recipe_read_reals, write_place};
const recipe_kind recipe_longs = {read_longs, write_given_longs};
const recipe_kind recipe_crop = {read_crop, write_crop};
const recipe_kind recipe_clip = {read_clip, write_clip};
const recipe_kind recipe_size = {read_size, write_size};
