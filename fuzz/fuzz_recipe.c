/* fuzz/fuzz_recipe.c - an input is a recipe.  What is taken is written, and
 * must read as it was. */
#include <snowglass/recipe.h>

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* A recipe's text; ends the run where it cannot be made. */
static char *write_text(snow_context *context, const snow_recipe *recipe) {
    size_t length = 0;
    if (snow_recipe_write(context, recipe, NULL, 0, &length) != SNOW_STATUS_OK)
        abort();
    char *text = malloc(length + 1);
    if (!text || snow_recipe_write(context, recipe, text, length + 1,
                                   &length) != SNOW_STATUS_OK)
        abort();
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    snow_context *context = NULL;
    snow_recipe recipe = {.size = sizeof recipe},
                again = {.size = sizeof again};
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return 0;
    if (snow_recipe_parse(context, "text", (const char *)bytes, size,
                          &recipe) == SNOW_STATUS_OK) {
        char *text = write_text(context, &recipe);
        if (snow_recipe_parse(context, "again", text, strlen(text), &again) !=
            SNOW_STATUS_OK)
            abort();
        char *second = write_text(context, &again);
        if (strcmp(text, second) != 0)
            abort();
        free(second);
        free(text);
        snow_recipe_clear(&again);
        snow_recipe_clear(&recipe);
    }
    snow_context_free(context);
    return 0;
}
