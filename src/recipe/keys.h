/* recipe/keys.h - the keys of a recipe: one table for reading and writing.  A
 * row gives the position of the value in the record and its conversion from and
 * to JSON. */
#ifndef SNOW_RECIPE_KEYS_H
#define SNOW_RECIPE_KEYS_H

#include <jansson.h>
#include <snowglass/recipe.h>

/* Size of the end of a message: "must be ...". */
#define WRONG_BYTES 1024

typedef struct recipe_key recipe_key;

/* Stores a value in its field (of `recipe`, at the key's offset).  Returns
 * false if it is invalid: `wrong` then says what it must be. */
typedef bool key_read(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]);

/* The value of a field, a new reference; NULL to omit the key. */
typedef json_t *key_write(const recipe_key *key, const void *field);

typedef struct recipe_kind {
    key_read *read;
    key_write *write;
} recipe_kind;

struct recipe_key {
    const char *name;
    const recipe_kind *kind;
    size_t field;     /* offset in snow_recipe */
    double low, high; /* of numbers; both 0: any finite number */
    int count;        /* of arrays */
    /* For names: the name of a value (NULL past the last), and the value of a
     * name (-1: unknown; NULL: names are found by the former alone). */
    const char *(*name_of)(int value);
    int (*named)(const char *name);
};

/* Ends with a row without a name. */
extern const recipe_key recipe_keys[];

/* The new spelling of a key that had another one before 0.1, or NULL. */
const char *recipe_renamed(const char *name);

/* The bytes of a recipe's file, to be released.  Errors: BAD_INPUT, NO_MEMORY.
 */
snow_status recipe_read_file(snow_context *context, const char *path,
                             char **text, size_t *bytes);

#endif
