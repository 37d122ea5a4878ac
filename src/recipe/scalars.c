/* recipe/scalars.c - numbers and flags. */
#include "recipe/kinds.h"

#include <math.h>
#include <snowglass/extend.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

bool recipe_refuse(char wrong[WRONG_BYTES], const char *text) {
    snprintf(wrong, WRONG_BYTES, "must be %s", text);
    return false;
}

static bool refuse_range(const recipe_key *key, char wrong[WRONG_BYTES],
                         const char *what) {
    if (key->low == 0 && key->high == 0)
        snprintf(wrong, WRONG_BYTES, "must be %s", what);
    else
        snow_text_print(wrong, WRONG_BYTES, "must be %s from %.17g to %.17g",
                        what, key->low, key->high);
    return false;
}

static bool in_range(const recipe_key *key, double value) {
    return isfinite(value) && ((key->low == 0 && key->high == 0) ||
                               (value >= key->low && value <= key->high));
}

bool recipe_read_real(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    double number = json_number_value(value);
    if (!json_is_number(value) || !in_range(key, number))
        return refuse_range(key, wrong, "a number");
    *(double *)field = number;
    return true;
}

json_t *recipe_write_real(const recipe_key *key, const void *field) {
    (void)key;
    return json_real(*(const double *)field);
}

static json_t *write_given_real(const recipe_key *key, const void *field) {
    return *(const double *)field > 0 ? recipe_write_real(key, field) : NULL;
}

bool recipe_read_whole(const recipe_key *key, const json_t *value, int64_t *out,
                       char wrong[WRONG_BYTES]) {
    json_int_t number = json_integer_value(value);
    if (!json_is_integer(value) || !in_range(key, (double)number))
        return refuse_range(key, wrong, "a whole number");
    *out = number;
    return true;
}

bool recipe_read_int(const recipe_key *key, const json_t *value, void *field,
                     char wrong[WRONG_BYTES]) {
    int64_t number;
    if (!recipe_read_whole(key, value, &number, wrong))
        return false;
    *(int *)field = (int)number;
    return true;
}

/* A number that is omitted if it is 0. */
json_t *recipe_write_given_int(const recipe_key *key, const void *field) {
    const int value = *(const int *)field;
    (void)key;
    return value ? json_integer(value) : NULL;
}

/* int64_t and, for numbers from 0 on, uint64_t. */
static bool read_long(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    return recipe_read_whole(key, value, field, wrong);
}

static json_t *write_given_long(const recipe_key *key, const void *field) {
    (void)key;
    int64_t value = *(const int64_t *)field;
    return value ? json_integer(value) : NULL;
}

/* A number, in a field of its own, or a text in this one. */
static bool read_either(const recipe_key *key, const json_t *value, void *field,
                        int64_t *number, const char *what,
                        char wrong[WRONG_BYTES]) {
    if (json_is_integer(value))
        return recipe_read_whole(key, value, number, wrong);
    return recipe_text.read(key, value, field, wrong) ||
           recipe_refuse(wrong, what);
}

static snow_recipe *recipe_at(const void *field, size_t offset) {
    return (snow_recipe *)(uintptr_t)((const char *)field - offset);
}

static bool read_channel(const recipe_key *key, const json_t *value,
                         void *field, char wrong[WRONG_BYTES]) {
    snow_recipe *r = recipe_at(field, offsetof(snow_recipe, channels));
    return read_either(key, value, field, &r->data.channel,
                       "a number, or a list as text", wrong);
}

static json_t *write_channel(const recipe_key *key, const void *field) {
    const snow_recipe *r = recipe_at(field, offsetof(snow_recipe, channels));
    return r->channels ? recipe_text.write(key, field)
                       : write_given_long(key, &r->data.channel);
}

static bool read_time(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    snow_recipe *r = recipe_at(field, offsetof(snow_recipe, steps));
    return read_either(key, value, field, &r->data.time,
                       "a number, or a text such as \"2:8\" or \"0.3s\"",
                       wrong);
}

static json_t *write_time(const recipe_key *key, const void *field) {
    const snow_recipe *r = recipe_at(field, offsetof(snow_recipe, steps));
    return r->steps ? recipe_text.write(key, field)
                    : write_given_long(key, &r->data.time);
}

static bool read_flag(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    (void)key;
    if (!json_is_boolean(value))
        return recipe_refuse(wrong, "true or false");
    *(bool *)field = json_is_true(value);
    return true;
}

static json_t *write_flag(const recipe_key *key, const void *field) {
    (void)key;
    return *(const bool *)field ? json_true() : NULL;
}

/* A number with as few digits as bring it back. */
static void spell_real(double value, char text[40]) {
    double again = NAN;
    for (int digits = 6; digits <= 17 && !(again <= value && again >= value);
         digits++) {
        snow_text_print(text, 40, "%.*g", digits, value);
        snow_text_scan(text, "%lf", &again);
    }
}

/* Where symlog begins is chosen if it is not said, which is -1 in the record.
 */
static bool read_scale(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    snow_recipe *r = recipe_at(field, offsetof(snow_recipe, symlog));
    const char *text = json_string_value(value);
    double from = 0;
    int used = -1; /* of a number */
    const bool is_log = text && strcasecmp(text, "log") == 0;
    if (text && strcasecmp(text, "symlog") == 0)
        from = -1;
    else if (text && strncasecmp(text, "symlog:", 7) == 0)
        used = snow_text_scan(text + 7, "%lf%n", &from, &used) == 1 ? used : 0;
    if (used >= 0 ? !used || text[7 + used] || !in_range(key, from)
                  : !text || (!is_log && from == 0 &&
                              strcasecmp(text, "linear") != 0))
        return recipe_refuse(wrong, "\"linear\", \"log\", \"symlog\" or "
                                    "\"symlog:X\", X from 1e-300 to 1e300");
    r->log = is_log;
    r->symlog = from;
    return true;
}

static json_t *write_scale(const recipe_key *key, const void *field) {
    const snow_recipe *r = recipe_at(field, offsetof(snow_recipe, symlog));
    char number[40];
    (void)key;
    if (r->symlog > 0)
        spell_real(r->symlog, number);
    return r->symlog < 0   ? json_string("symlog")
           : r->symlog > 0 ? json_sprintf("symlog:%s", number)
           : r->log        ? json_string("log")
                           : NULL;
}

const recipe_kind recipe_scale = {read_scale, write_scale};
const recipe_kind recipe_real = {recipe_read_real, recipe_write_real};
const recipe_kind recipe_given_real = {recipe_read_real, write_given_real};
const recipe_kind recipe_int = {recipe_read_int, recipe_write_given_int};
const recipe_kind recipe_channel = {read_channel, write_channel};
const recipe_kind recipe_time = {read_time, write_time};
const recipe_kind recipe_long = {read_long, write_given_long};
const recipe_kind recipe_flag = {read_flag, write_flag};
