/* schema.c - the JSON schema (draft 7) of recipes: the keys are those long
 * options that the library takes, their texts the help, their types those that
 * each reader of options stands for. */
#include "manual/manual.h"
#include "run/log.h"

#include <jansson.h>
#include <snowglass/recipe.h>
#include <stdio.h>
#include <string.h>

/* What a recipe has for an option's text; numbers get the row's limits. */
static const struct {
    option_read *read;
    const char *schema;
} types[] = {
    {read_flag, "{'type': 'boolean'}"},
    {read_text, "{'type': 'string'}"},
    {read_component, "{'anyOf': [{'enum': ['x', 'y', 'z', 'w', 'magnitude']},"
                     "{'type': 'string', 'pattern': '^[0-9]+$'}]}"},
    {read_channels, "{'anyOf': [{'type': 'integer', 'minimum': 0}, {'type': "
                    "'string'}]}"},
    {read_labels, "{'type': 'string'}"},
    {read_preset, "{'type': 'string'}"},
    {read_colormap, "{'type': 'string'}"},
    {read_view, "{'type': 'string'}"},
    {read_type, "{'type': 'string'}"},
    {read_choice, "{'type': 'string'}"},
    {read_real, "{'type': 'number'}"},
    {read_strength, "{'type': 'number'}"},
    {read_kernel, "{'anyOf': [{'type': 'string', 'pattern':"
                  "'^(auto|tent|gauss|bspline|box)(:[2-9])?$'}]}"},
    {read_legend, "{'anyOf': [{'type': 'boolean'}, {'type': 'string'}]}"},
    {read_annotate, "{'anyOf': [{'enum': ['step', 'time']}, {'type': 'string',"
                    "'pattern': '^time='}]}"},
    {read_material, "{'type': 'array', 'minItems': 4, 'maxItems': 4, 'items':"
                    "[{'type': 'number', 'minimum': 0, 'maximum': 1},"
                    "{'type': 'number', 'minimum': 0, 'maximum': 1},"
                    "{'type': 'number', 'minimum': 0, 'maximum': 1},"
                    "{'type': 'number', 'minimum': 0, 'maximum': 1000}]}"},
    {read_scale, "{'anyOf': [{'enum': ['linear', 'log', 'symlog']}, {'type':"
                 "'string', 'pattern': '^symlog:[0-9.eE+-]+$'}]}"},
    {read_fov, "{'type': 'number'}"},
    {read_integer, "{'type': 'integer'}"},
    {read_time, "{'anyOf': [{'type': 'integer'}, {'type': 'string'}]}"},
    {read_count, "{'type': 'integer', 'minimum': 0}"},
    {read_size,
     "{'anyOf': [{'type': 'integer', 'minimum': 1, 'maximum': 32768},"
     "{'type': 'array', 'minItems': 2, 'maxItems': 2, 'items':"
     "{'type': 'integer', 'minimum': 1, 'maximum': 32768}}]}"},
    {read_window, "{'type': 'array', 'minItems': 2, 'maxItems': 2, 'items':"
                  "{'type': 'number'}}"},
    {read_dims, "{'type': 'array', 'minItems': 3, 'maxItems': 3, 'items':"
                "{'type': 'integer', 'minimum': 1}}"},
    {read_spacing, "{'type': 'array', 'minItems': 3, 'maxItems': 3, 'items':"
                   "{'type': 'number', 'exclusiveMinimum': 0}}"},
    {read_place, "{'type': 'array', 'minItems': 3, 'maxItems': 3, 'items':"
                 "{'type': 'number'}}"},
    {read_crop, "{'type': 'array', 'minItems': 3, 'maxItems': 3, 'items':"
                "{'type': 'array', 'minItems': 2, 'maxItems': 2, 'items':"
                "{'type': 'integer', 'minimum': 0}}}"},
    {read_clip, "{'type': 'array', 'minItems': 1, 'maxItems': 6, 'items':"
                "{'type': 'array', 'minItems': 4, 'maxItems': 4, 'items':"
                "{'type': 'number'}}}"},
    {read_range,
     "{'anyOf': [{'const': 'full'}, {'type': 'array', 'minItems': 2,"
     "'maxItems': 2, 'items': {'type': 'number'}}, {'type': 'array',"
     "'minItems': 2, 'maxItems': 2, 'items': {'type': 'string',"
     "'pattern': '^p[0-9.]+$'}}]}"},
    {read_points,
     "{'type': 'array', 'minItems': 1, 'maxItems': 256, 'items':"
     "{'type': 'array', 'minItems': 2, 'maxItems': 2, 'items':"
     "[{'type': 'number'}, {'type': 'number', 'minimum': 0, 'maximum': 1}]}}"},
    {read_overlay_look, "{'type': 'string'}"},
    {read_light,
     "{'anyOf': [{'enum': ['key', 'head']}, {'type': 'array',"
     "'minItems': 2, 'maxItems': 2, 'items': {'type': 'number'}}]}"},
    {read_color,
     "{'anyOf': [{'const': 'none'}, {'type': 'string', 'pattern':"
     "'^#[0-9a-fA-F]{6}$'}, {'type': 'array', 'minItems': 3, 'maxItems': 3,"
     "'items': {'type': 'number', 'minimum': 0, 'maximum': 1}}]}"},
};

/* The library answers which of the options are keys of a recipe: an object is
 * the value of none. */
static bool is_key(snow_context *context, const char *name) {
    char text[128];
    snow_recipe recipe;
    snow_recipe_init(&recipe);
    int bytes = snprintf(text, sizeof text, "{\"%s\": {}}", name);
    return snow_recipe_parse(context, "schema", text, (size_t)bytes, &recipe) &&
           !strstr(snow_context_message(context), "is not a key");
}

/* The texts above have single quotes, for they are easier to read. */
static json_t *parse(const char *schema) {
    char text[512] = "";
    for (size_t i = 0; schema && schema[i] && i + 1 < sizeof text; i++)
        text[i] = schema[i] == '\'' ? '"' : schema[i];
    return json_loads(text, 0, NULL);
}

static json_t *type_of(option_read *read) {
    const char *schema = NULL;
    if (read == read_gradient_points)
        read = read_points;
    for (size_t i = 0; i < sizeof types / sizeof *types && !schema; i++)
        if (types[i].read == read)
            schema = types[i].schema;
    return parse(schema);
}

static bool is_number(const char *word) {
    return strspn(word, "0123456789") == strlen(word);
}

static void add_words(json_t *type, const option_row *row) {
    char room[WORD_BYTES];
    json_t *words = json_array();
    const char *word = NULL;
    for (size_t i = 0; (word = option_word(row, i, room)) != NULL; i++) {
        long long number = 0;
        if (is_number(word) && sscanf(word, "%lld", &number) == 1) {
            json_object_set_new(type, "type", json_string("integer"));
            json_array_append_new(words, json_integer(number));
        } else {
            json_array_append_new(words, json_string(word));
        }
    }
    json_object_set_new(type, "enum", words);
}

/* A field of view of 0 is a parallel projection. */
static void add_limits(json_t *type, const option_row *row) {
    double low = row->read == read_fov ? 0 : row->low;
    if (row->low == 0 && row->high == 0)
        return;
    json_object_set_new(type, "minimum", json_real(low));
    json_object_set_new(type, "maximum", json_real(row->high));
}

static json_t *property(const option_row *row) {
    char room[WORD_BYTES];
    json_t *type = type_of(row->read);
    const char *name = json_string_value(json_object_get(type, "type"));
    if (name && strcmp(name, "string") == 0 && option_word(row, 0, room))
        add_words(type, row);
    else if (name &&
             (strcmp(name, "number") == 0 || strcmp(name, "integer") == 0))
        add_limits(type, row);
    if (type)
        json_object_set_new(type, "description", json_string(row->text));
    return type;
}

/* Keys that are no options, or mean something else there. */
static void add_others(json_t *properties) {
    json_object_set_new(
        properties, "input",
        parse("{'anyOf': [{'type': 'string'}, {'type': 'array', 'items':"
              "{'type': 'string'}}], 'description':"
              "'volume file, or phantom:NAME; of a movie a list'}"));
    json_object_set_new(
        properties, "opacity-unit",
        parse("{'enum': ['voxel', 'mm'], 'description': 'length over which an "
              "opacity applies: the smallest voxel spacing or one "
              "millimetre (default voxel)'}"));
    json_object_set_new(properties, "verb",
                        parse("{'type': 'string', 'description':"
                              "'the verb that wrote the file'}"));
    json_object_set_new(
        properties, "limit-seconds",
        parse("{'type': 'number', 'minimum': 0, 'maximum': 1e9, 'description':"
              "'of simulations: the most that a step takes in the mean'}"));
    json_object_set_new(properties, "limit-bytes",
                        parse("{'type': 'integer', 'minimum': 0, 'description':"
                              "'of simulations: the most that a rank holds'}"));
    json_object_set_new(
        properties, "reread",
        parse("{'type': 'boolean', 'description': 'of simulations: read the "
              "file again when it changes'}"));
    json_object_set_new(properties, "version",
                        parse("{'type': 'string', 'description':"
                              "'the version that wrote the file'}"));
}

static int add_properties(snow_context *context, json_t *properties) {
    add_others(properties);
    for (const option_row *row = option_table; row->name; row++) {
        if (json_object_get(properties, row->name) ||
            !is_key(context, row->name))
            continue;
        json_t *made = property(row);
        if (!made)
            return fail_usage("--%s has a reader that the schema does not "
                              "know; add it to programs/manual/schema.c",
                              row->name);
        json_object_set_new(properties, row->name, made);
    }
    return SNOW_STATUS_OK;
}

int print_schema(void) {
    snow_context *context = NULL;
    snow_status status = snow_context_new(NULL, &context);
    if (status)
        return (int)status;
    json_t *properties = json_object();
    int code = add_properties(context, properties);
    json_t *schema =
        json_pack("{s:s,s:s,s:s,s:o,s:b}", "$schema",
                  "http://json-schema.org/draft-07/schema#", "title",
                  "a recipe of Snowglass", "type", "object", "properties",
                  properties, "additionalProperties", 0);
    if (!code)
        json_dumpf(schema, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(15));
    json_decref(schema);
    snow_context_free(context);
    putchar('\n');
    return code;
}
