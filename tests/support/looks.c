/* tests/support/looks.c - what support_looks.h promises. */
#include "support/looks.h"

snow_volume *support_row(snow_context *context, snow_type type,
                         const void *values, int64_t n) {
    snow_volume_info info = {
        .size = sizeof info, .dims = {n, 1, 1}, .type = type};
    snow_volume *volume = NULL;
    if (snow_volume_wrap(context, &info, values, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return volume;
}

snow_transfer *support_look(const snow_volume *volume, snow_look look) {
    snow_transfer *transfer = NULL;
    if (snow_transfer_new_for_volume(volume, &look, &transfer) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(volume->context));
    return transfer;
}

/* --- a test's own context ------------------------------------------------- */

static void hear(void *user, const char *text) {
    looks_fixture *f = user;
    snprintf(f->warning, sizeof f->warning, "%s", text);
    f->warnings++;
}

int looks_begin(void **state) {
    looks_fixture *f = calloc(1, sizeof *f);
    assert_non_null(f);
    f->context = support_context();
    snow_context_set_warning(f->context, hear, f);
    *state = f;
    return 0;
}

int looks_end(void **state) {
    looks_fixture *f = *state;
    for (size_t n = 0; n < f->transfer_count; n++)
        snow_transfer_free(f->transfers[n]);
    for (size_t n = 0; n < f->volume_count; n++)
        snow_volume_close(f->volumes[n]);
    assert_int_equal(snow_context_bytes(f->context), 0);
    snow_context_free(f->context);
    free(f->transfers);
    free(f->volumes);
    free(f);
    return 0;
}

static snow_volume *keep_volume(looks_fixture *f, snow_volume *volume) {
    size_t bytes = (f->volume_count + 1) * sizeof(void *);
    f->volumes = realloc(f->volumes, bytes);
    assert_non_null(f->volumes);
    f->volumes[f->volume_count++] = volume;
    return volume;
}

static snow_transfer *keep_transfer(looks_fixture *f, snow_transfer *transfer) {
    size_t bytes = (f->transfer_count + 1) * sizeof(void *);
    f->transfers = realloc(f->transfers, bytes);
    assert_non_null(f->transfers);
    f->transfers[f->transfer_count++] = transfer;
    return transfer;
}

snow_volume *looks_volume(looks_fixture *f, snow_volume_info info,
                          const void *voxels) {
    snow_volume *volume = NULL;
    info.size = sizeof info;
    if (snow_volume_wrap(f->context, &info, voxels, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(f->context));
    return keep_volume(f, volume);
}

snow_volume *looks_row(looks_fixture *f, snow_type type, const void *values,
                       int64_t n) {
    return keep_volume(f, support_row(f->context, type, values, n));
}

snow_transfer *looks_of(looks_fixture *f, const snow_volume *volume,
                        snow_look look) {
    look.size = sizeof look;
    return keep_transfer(f, support_look(volume, look));
}

snow_transfer *looks_of_points(looks_fixture *f, const snow_color_point *colors,
                               size_t color_count,
                               const snow_opacity_point *opacities,
                               size_t opacity_count) {
    snow_transfer *transfer = NULL;
    if (snow_transfer_new(f->context, colors, color_count, opacities,
                          opacity_count, &transfer) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(f->context));
    return keep_transfer(f, transfer);
}

void looks_refused(looks_fixture *f, const snow_volume *volume, snow_look look,
                   const char *words) {
    snow_transfer *transfer = NULL;
    look.size = sizeof look;
    assert_int_equal(snow_transfer_new_for_volume(volume, &look, &transfer),
                     SNOW_STATUS_BAD_USAGE);
    assert_null(transfer);
    if (!strstr(snow_context_message(f->context), words))
        fail_msg("\"%s\" lacks \"%s\"", snow_context_message(f->context),
                 words);
}

double looks_opacity(const snow_transfer *transfer, double value) {
    double rgba[4];
    snow_transfer_evaluate(transfer, value, rgba);
    assert_true(rgba[3] == snow_transfer_opacity(transfer, value));
    return rgba[3];
}

double looks_red(const snow_transfer *transfer, double value) {
    double rgba[4];
    snow_transfer_evaluate(transfer, value, rgba);
    return rgba[0];
}

bool looks_say(const snow_transfer *transfer, const char *words) {
    return strstr(snow_transfer_description(transfer), words) != NULL;
}
