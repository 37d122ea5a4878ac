/* json.c - figures and lists for scripts. */
#include "run/log.h"

#include <math.h>
#include <stdio.h>

/* JSON has no NaN and no infinity; jansson would drop the key silently. */
json_t *json_number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *json_vector(const double *values, size_t count) {
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(array, json_number(values[i]));
    return array;
}

json_t *json_names(const char *(*at)(size_t)) {
    json_t *array = json_array();
    for (size_t i = 0; at(i); i++)
        json_array_append_new(array, json_string(at(i)));
    return array;
}

json_t *json_sizes(const int64_t *values, size_t count) {
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(array, json_integer(values[i]));
    return array;
}

int print_json(json_t *object) {
    if (json_dumpf(object, stdout, JSON_FORM) == 0)
        putchar('\n');
    json_decref(object);
    return finish_stdout();
}
