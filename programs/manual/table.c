/* table.c - snowglass-table: the verbs, topics and options of the tool, and the
 * names that their arguments can be, as JSON on standard output.  The scripts
 * in scripts/manual/ make manual pages, completions and the schema of recipes
 * of it.
 *
 * It is a program of the build and is not installed (cmake/manual.cmake). */
#include "options/parse.h"
#include "run/log.h"

#include <jansson.h>
#include <snowglass/recipe.h>
#include <stdio.h>
#include <string.h>

#define READER(name) \
    { read_##name, #name }
static const struct {
    option_read *read;
    const char *name;
} readers[] = {READER(text),
               READER(flag),
               READER(constant),
               READER(choice),
               READER(kernel),
               READER(combine),
               READER(real),
               READER(fov),
               READER(strength),
               READER(tolerance),
               READER(time),
               READER(integer),
               READER(count),
               READER(bytes),
               READER(window),
               READER(size),
               READER(dims),
               READER(component),
               READER(channels),
               READER(labels),
               READER(clip),
               READER(crop),
               READER(spacing),
               READER(type),
               READER(preset),
               READER(colormap),
               READER(view),
               READER(color),
               READER(range),
               READER(points),
               READER(light),
               READER(legend),
               READER(overlay_look),
               READER(annotate),
               READER(material),
               READER(measure),
               READER(gradient_points),
               READER(scale),
               READER(place),
               READER(listen),
               READER(z_scale)};

/* NULL for a reader that has no name above. */
static const char *reader_name(option_read *read) {
    for (size_t i = 0; i < sizeof readers / sizeof *readers; i++)
        if (readers[i].read == read)
            return readers[i].name;
    return NULL;
}

/* The library answers which of the options are keys of a recipe: an object is
 * the value of none. */
static bool is_key(snow_context *context, const char *name) {
    char text[128];
    snow_recipe recipe;
    snow_recipe_init(&recipe);
    int bytes = snprintf(text, sizeof text, "{\"%s\": {}}", name);
    return snow_recipe_parse(context, "table", text, (size_t)bytes, &recipe) &&
           !strstr(snow_context_message(context), "is not a key");
}

static json_t *named(const char *name, const char *text) {
    return json_pack("{s:s, s:s}", "name", name, "text", text ? text : "");
}

/* A list of the library; `text` may be NULL. */
static json_t *list(const char *(*name)(size_t), const char *(*text)(size_t)) {
    json_t *rows = json_array();
    for (size_t i = 0; name(i); i++)
        json_array_append_new(rows, named(name(i), text ? text(i) : NULL));
    return rows;
}

static json_t *verbs(void) {
    json_t *rows = json_array();
    for (const verb_row *verb = verb_table; verb->name; verb++) {
        json_t *row = named(verb->name, verb->text);
        json_object_set_new(row, "usage", json_string(verb->usage));
        json_array_append_new(rows, row);
    }
    return rows;
}

static json_t *topics(void) {
    json_t *rows = json_array();
    for (const topic_row *row = topic_table; row->name; row++)
        json_array_append_new(rows, named(row->name, row->text));
    return rows;
}

static json_t *types(void) {
    json_t *rows = json_array();
    for (int type = 1; type <= SNOW_TYPE_FLOAT64; type++)
        json_array_append_new(rows, named(snow_type_name((snow_type)type), ""));
    return rows;
}

static json_t *statuses(void) {
    json_t *rows = json_array();
#define STATUS(name, value, text)                                    \
    json_array_append_new(                                           \
        rows, json_pack("{s:i, s:s}", "value", (int)(value), "text", \
                        snow_status_description(SNOW_STATUS_##name)));
    SNOW_STATUS_MAP(STATUS)
#undef STATUS
    return rows;
}

/* What an option is without being given; null: nothing, or no one value. */
static json_t *usual(const option_row *row) {
    static options all;
    const char *field = (const char *)&all + row->field;
    const void *at = field;
    options_init(&all);
    if (row->read == read_choice || row->read == read_kernel)
        return json_string(*(const char *const *)at);
    if (row->read == read_real || row->read == read_strength)
        return json_real(*(const double *)at); /* of NaN: null */
    if (row->read == read_integer)
        return json_integer(*(const int64_t *)at);
    if (row->read == read_flag)
        return json_boolean(*(const bool *)at);
    return row->read == read_size
               ? json_integer(*(const int64_t *)at) /* of a square */
               : NULL;
}

static json_t *option(snow_context *context, const option_row *row) {
    const char letter[2] = {row->letter};
    json_t *made = named(row->name, row->text), *taken = json_array();
    for (const verb_row *verb = verb_table; verb->name; verb++)
        if (row->verbs & verb->bit)
            json_array_append_new(taken, json_string(verb->name));
    json_object_set_new(made, "letter", json_string(letter));
    json_object_set_new(made, "argument",
                        row->argument ? json_string(row->argument)
                                      : json_null());
    json_object_set_new(made, "topic",
                        json_string(topic_table[row->topic].name));
    json_object_set_new(made, "verbs", taken);
    json_object_set_new(made, "reader", json_string(reader_name(row->read)));
    json_t *value = usual(row);
    json_object_set_new(made, "default", value ? value : json_null());
    json_object_set_new(made, "low", json_real(row->low));
    json_object_set_new(made, "high", json_real(row->high));
    json_object_set_new(made, "key", json_boolean(is_key(context, row->name)));
    return made;
}

int main(void) {
    snow_context *context = NULL;
    snow_status status = snow_context_new(NULL, &context);
    if (status)
        return (int)status;
    json_t *rows = json_array();
    for (const option_row *row = option_table; row->name; row++) {
        if (!reader_name(row->read))
            return fail_usage("the reader of --%s has no name in "
                              "programs/manual/table.c",
                              row->name);
        json_array_append_new(rows, option(context, row));
    }
    json_t *table = json_pack(
        "{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "version",
        snow_version(), "verbs", verbs(), "topics", topics(), "options", rows,
        "statuses", statuses(), "presets",
        list(snow_preset_name, snow_preset_description), "colormaps",
        list(snow_colormap_name, NULL), "views", list(snow_view_name, NULL),
        "formats", list(snow_format_name, snow_format_description), "phantoms",
        list(snow_phantom_name, snow_phantom_description), "types", types());
    bool done =
        table && json_dumpf(table, stdout,
                            JSON_INDENT(2) | JSON_REAL_PRECISION(15)) == 0;
    json_decref(table);
    snow_context_free(context);
    putchar('\n');
    return done && fflush(stdout) == 0 ? SNOW_STATUS_OK
                                       : SNOW_STATUS_BAD_OUTPUT;
}
