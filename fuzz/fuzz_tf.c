/* fuzz/fuzz_tf.c - an input is a transfer function's file.  What is taken makes
 * a transfer function, and reads as the same points from our JSON. */
#include "support/capped.h"

#include <snowglass/look_file.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

static void check_same(const snow_look *a, const snow_look *b) {
    if (a->color_count != b->color_count ||
        a->opacity_count != b->opacity_count ||
        a->gradient_opacity_count != b->gradient_opacity_count ||
        a->log != b->log || a->domain != b->domain || a->per_mm != b->per_mm ||
        (a->color_count && memcmp(a->colors, b->colors,
                                  a->color_count * sizeof *a->colors) != 0) ||
        (a->opacity_count &&
         memcmp(a->opacities, b->opacities,
                a->opacity_count * sizeof *a->opacities) != 0) ||
        (a->gradient_opacity_count &&
         memcmp(a->gradient_opacities, b->gradient_opacities,
                a->gradient_opacity_count * sizeof *a->gradient_opacities) !=
             0))
        abort();
}

static void round_trip(snow_context *context, const snow_look_file *tf) {
    const snow_look *points = snow_look_file_look(tf);
    snow_look_file *again = NULL;
    size_t length = 0;
    if (snow_look_write_json(context, points, NULL, 0, &length) !=
        SNOW_STATUS_OK)
        abort();
    char *text = malloc(length + 1);
    if (!text || snow_look_write_json(context, points, text, length + 1,
                                      &length) != SNOW_STATUS_OK)
        abort();
    if (snow_look_parse(context, "again", text, length, NULL, &again) ==
        SNOW_STATUS_OK)
        check_same(points, snow_look_file_look(again));
    else if (length < SNOW_LOOK_BYTES_MAX &&
             !strstr(snow_context_message(context), "memory"))
        abort();
    snow_look_file_free(again);
    free(text);
}

static void use(snow_context *context, const snow_look *p) {
    snow_transfer *transfer = NULL;
    size_t length;
    if (p->color_count && p->opacity_count) {
        snow_status status =
            snow_transfer_new(context, p->colors, p->color_count, p->opacities,
                              p->opacity_count, &transfer);
        if (status != SNOW_STATUS_OK && status != SNOW_STATUS_NO_MEMORY)
            abort();
        snow_transfer_free(transfer);
    }
    snow_look_write_csv(context, p, NULL, 0, &length);
}

/* The suffix decides some formats; a byte more than the input says which. */
int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    static const char *const names[] = {"a.json", "a.vp", "a.pal", "a.csv"};
    for (int i = 0; i < 4; i++) {
        size_t held;
        snow_context *context = capped_context(&held);
        snow_look_file *tf = NULL;
        snow_status status = snow_look_parse(context, names[i], bytes, size,
                                             i == 3 ? "CT-Bone" : NULL, &tf);
        if (status == SNOW_STATUS_OK) {
            round_trip(context, tf);
            use(context, snow_look_file_look(tf));
        } else if (tf || !*snow_context_message(context))
            abort();
        for (const char *at = snow_context_message(context); *at; at++)
            if (*at == '\n')
                abort();
        snow_look_file_free(tf);
        capped_end(context, &held);
    }
    return 0;
}
