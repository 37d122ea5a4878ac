/* recipe/names.c - texts, and names of values. */
#include "recipe/kinds.h"

#include <snowglass/overlay.h>

#include <stdio.h>
#include <string.h>
#include <strings.h>

static bool read_text(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    (void)key;
    const char *text = json_string_value(value);
    if (!text)
        return recipe_refuse(wrong, "a text");
    *(const char **)field = text;
    return true;
}

static json_t *write_text(const recipe_key *key, const void *field) {
    (void)key;
    const char *text = *(const char *const *)field;
    return text ? json_string(text) : NULL;
}

/* A movie has several inputs; the record has room for the first. */
static bool read_input(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    for (size_t i = 0; i < json_array_size(value); i++)
        if (!json_is_string(json_array_get(value, i)))
            return recipe_refuse(wrong, "a text or a list of texts");
    const json_t *first = json_array_get(value, 0);
    return read_text(key, first ? first : value, field, wrong);
}

/* Labels of a mask, stored as text. */
static bool read_labels(const recipe_key *key, const json_t *value, void *field,
                        char wrong[WRONG_BYTES]) {
    snow_label_range ranges[SNOW_LABELS_MAX];
    size_t count;
    const char *text = json_string_value(value);
    if (!text || !snow_labels_parse(text, ranges, SNOW_LABELS_MAX, &count))
        return recipe_refuse(wrong,
                             "a text of whole numbers and ranges such as "
                             "\"1,4-7\"");
    return read_text(key, value, field, wrong);
}

/* Lists names, "a, b or c", after "must be ". */
static bool refuse_name(const recipe_key *key, char wrong[WRONG_BYTES]) {
    size_t at = (size_t)snprintf(wrong, WRONG_BYTES, "must be one of");
    for (int i = 0; key->name_of(i) && at < WRONG_BYTES; i++)
        at += (size_t)snprintf(wrong + at, WRONG_BYTES - at, "%s %s",
                               i ? "," : "", key->name_of(i));
    return false;
}

/* The value of a name; -1: unknown. */
static int value_named(const recipe_key *key, const char *text) {
    if (key->named)
        return key->named(text);
    for (int i = 0; key->name_of(i); i++)
        if (strcasecmp(key->name_of(i), text) == 0)
            return i;
    return -1;
}

/* A text that must be a known name; it is stored as text. */
static bool read_known(const recipe_key *key, const json_t *value, void *field,
                       char wrong[WRONG_BYTES]) {
    const char *text = json_string_value(value);
    if (!text || value_named(key, text) < 0)
        return refuse_name(key, wrong);
    return read_text(key, value, field, wrong);
}

/* The value of a name: all enumerations here are as wide as an int. */
static bool read_name(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]) {
    const char *text = json_string_value(value);
    int named = text ? value_named(key, text) : -1;
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

static json_t *write_given_name(const recipe_key *key, const void *field) {
    int value;
    memcpy(&value, field, sizeof value);
    return value ? json_string(key->name_of(value)) : NULL;
}

/* "gauss", or "gauss:5" with its support. */
static bool read_kernel(const recipe_key *key, const json_t *value, void *field,
                        char wrong[WRONG_BYTES]) {
    snow_settings *s = field;
    const char *text = json_string_value(value);
    const char *colon = text ? strchr(text, ':') : NULL;
    char name[32] = "";
    if (text)
        snprintf(name, sizeof name, "%.*s", (int)strcspn(text, ":"), text);
    const int kernel = snow_kernel_from_name(name);
    if (kernel < 0)
        return refuse_name(key, wrong);
    if (colon && (colon[1] < '2' || colon[1] > '9' || colon[2]))
        return recipe_refuse(wrong, "NAME:N, N from 2 to 9");
    s->kernel = (snow_kernel)kernel;
    s->footprint = colon ? colon[1] - '0' : 0;
    return true;
}

static json_t *write_kernel(const recipe_key *key, const void *field) {
    const snow_settings *s = field;
    (void)key;
    return s->footprint ? json_sprintf("%s:%d", snow_kernel_name(s->kernel),
                                       s->footprint)
                        : json_string(snow_kernel_name(s->kernel));
}

/* true: with the file's title; the word scale: the scale bar alone. */
static bool read_legend(const recipe_key *key, const json_t *value, void *field,
                        char wrong[WRONG_BYTES]) {
    snow_recipe *r = (snow_recipe *)(void *)((char *)field - key->field);
    const char *text = json_string_value(value);
    if (!text && !json_is_boolean(value))
        return recipe_refuse(wrong, "true, false, \"scale\" or a title");
    r->scale_bar = text && strcmp(text, "scale") == 0;
    r->legend = !r->scale_bar && !json_is_false(value);
    r->legend_title = r->legend ? text : NULL;
    return true;
}

static json_t *write_legend(const recipe_key *key, const void *field) {
    const snow_recipe *r =
        (const snow_recipe *)(const void *)((const char *)field - key->field);
    return r->legend && r->legend_title ? json_string(r->legend_title)
           : r->legend                  ? json_true()
           : r->scale_bar               ? json_string("scale")
                                        : NULL;
}

/* What follows "time=" is checked where there is a time. */
static bool read_annotate(const recipe_key *key, const json_t *value,
                          void *field, char wrong[WRONG_BYTES]) {
    const char *text = json_string_value(value);
    if (!text ||
        (strcasecmp(text, "step") != 0 && strcasecmp(text, "time") != 0 &&
         strncasecmp(text, "time=", 5) != 0))
        return recipe_refuse(wrong, "one of step, time or time=FORMAT");
    return read_text(key, value, field, wrong);
}

/* What does not depend on a volume is checked. */
static bool read_measure(const recipe_key *key, const json_t *value,
                         void *field, char wrong[WRONG_BYTES]) {
    const char *text = json_string_value(value);
    snow_context *context = NULL;
    snow_measure one = {.size = sizeof one};
    snow_status status = snow_context_new(NULL, &context);
    for (int n = 0; text && status == SNOW_STATUS_OK && (!n || one.kind); n++)
        status = snow_measure_read(context, text, n, NULL, &one);
    const bool good = text && status == SNOW_STATUS_OK;
    char why[WRONG_BYTES];
    snprintf(why, sizeof why, "measures; %.900s",
             text ? snow_context_message(context) : "give a text");
    snow_context_free(context);
    return good ? read_text(key, value, field, wrong)
                : recipe_refuse(wrong, why);
}

const recipe_kind recipe_measure = {read_measure, write_text};
const recipe_kind recipe_kernel = {read_kernel, write_kernel};
const recipe_kind recipe_legend = {read_legend, write_legend};
const recipe_kind recipe_annotate = {read_annotate, write_text};
const recipe_kind recipe_text = {read_text, write_text};
const recipe_kind recipe_input = {read_input, write_text};
const recipe_kind recipe_labels = {read_labels, write_text};
const recipe_kind recipe_known = {read_known, write_text};
const recipe_kind recipe_name = {read_name, write_name};
const recipe_kind recipe_given_name = {read_name, write_given_name};
