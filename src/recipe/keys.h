/* recipe/keys.h - the keys of a recipe: one table, by which it is read and
 * written.  A row tells where its value lies in the record and how it is taken
 * from JSON and put there. */
#ifndef SNOW_RECIPE_KEYS_H
#define SNOW_RECIPE_KEYS_H

#include <jansson.h>
#include <snowglass/recipe.h>

/* Room for the end of a message: "must be ...". */
#define WRONG_BYTES 1024

typedef struct recipe_key recipe_key;

/* Takes a value into its field (of `recipe`, at the key's offset).  False where
 * it does not fit: `wrong` then says what it must be. */
typedef bool key_read(const recipe_key *key, const json_t *value, void *field,
                      char wrong[WRONG_BYTES]);

/* The value of a field, a new reference; NULL where nothing is to be said. */
typedef json_t *key_write(const recipe_key *key, const void *field);

struct recipe_key {
    const char *name;
    key_read *read;
    key_write *write;
    size_t field;     /* offset in snow_recipe */
    double low, high; /* of numbers; both 0: any finite one */
    int count;        /* of arrays */
    /* Of names: name of a value (NULL past the last), and back (-1). */
    const char *(*name_of)(int value);
    int (*named)(const char *name);
};

/* Ends with a row without a name. */
extern const recipe_key recipe_keys[];

#endif
