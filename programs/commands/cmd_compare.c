/* cmd_compare.c - the verb compare: measures how far two pictures differ and
 * checks the difference against the tolerance. */
#include "commands/commands.h"
#include "run/log.h"

#include <stdio.h>

/* psnr is null for equal pictures, whose PSNR is infinite. */
static int report_json(const snow_image_difference *d, double tolerance,
                       bool within) {
    json_t *object = json_object();
    json_object_set_new(object, "within", json_boolean(within));
    json_object_set_new(object, "tolerance", json_number(tolerance));
    json_object_set_new(object, "largest", json_number(d->largest));
    json_object_set_new(object, "x", json_integer(d->x));
    json_object_set_new(object, "y", json_integer(d->y));
    json_object_set_new(object, "mean", json_number(d->mean));
    json_object_set_new(object, "psnr", json_number(d->psnr));
    json_object_set_new(object, "ssim", json_number(d->ssim));
    return print_json(object);
}

static json_t *size_json(const snow_image *image) {
    const int64_t size[2] = {snow_image_width(image), snow_image_height(image)};
    return json_sizes(size, 2);
}

/* Pictures of two sizes have no difference to measure, but this is a result
 * (exit code 6), not an error. */
static int judge_sizes(const options *opts, snow_image *const images[2]) {
    int done = SNOW_STATUS_OK;
    const snow_image *a = images[0], *b = images[1];
    if (snow_image_width(a) == snow_image_width(b) &&
        snow_image_height(a) == snow_image_height(b))
        return CONTINUE;
    say("%s and %s: %d x %d and %d x %d pixels; only pictures of one size can "
        "be compared",
        name_of_input(opts->operands[0]), name_of_input(opts->operands[1]),
        snow_image_width(a), snow_image_height(a), snow_image_width(b),
        snow_image_height(b));
    if (opts->json) {
        json_t *object = json_object();
        json_object_set_new(object, "within", json_false());
        json_object_set_new(object, "tolerance", json_number(opts->tolerance));
        json_object_set_new(object, "sizes",
                            json_pack("[oo]", size_json(a), size_json(b)));
        done = print_json(object);
    }
    return done == SNOW_STATUS_OK ? SNOW_STATUS_DIFFERENT : done;
}

/* Nine digits distinguish any two floats. */
static int report_text(const snow_image_difference *d, double tolerance,
                       bool within) {
    printf("largest  %.9g at pixel %d,%d\n", d->largest, d->x, d->y);
    printf("mean     %.9g\n", d->mean);
    printf("psnr     %.4g dB\n", d->psnr);
    printf("ssim     %.6f\n", d->ssim);
    printf("%s the tolerance of %.9g\n", within ? "within" : "beyond",
           tolerance);
    return finish_stdout();
}

/* The differences are printed even if they are too large: whoever sees exit
 * code 6 wants to know by how much.  A largest difference of NaN exceeds every
 * tolerance. */
static int judge_difference(const options *opts,
                            const snow_image_difference *d) {
    bool within = d->largest <= opts->tolerance;
    int done = opts->json ? report_json(d, opts->tolerance, within)
                          : report_text(d, opts->tolerance, within);
    if (done == SNOW_STATUS_OK && !within)
        return SNOW_STATUS_DIFFERENT;
    return done;
}

/* Both pictures share one context, which holds the message of a failed
 * comparison. */
int cmd_compare(const options *opts) {
    snow_context *context = NULL;
    snow_image *images[2] = {NULL, NULL};
    snow_image_difference difference = {.size = sizeof difference};
    int done = open_context(opts, &context);
    /* "-" reads standard input, so that a picture can come from a pipe:
     * render -o - | compare - b.png. */
    for (int i = 0; i < 2 && done == CONTINUE; i++)
        done = check_status(
            context, snow_image_load(context, opts->operands[i], &images[i]));
    if (done == CONTINUE)
        done = judge_sizes(opts, images);
    if (done == CONTINUE) {
        snow_status status =
            snow_image_compare(images[0], images[1], &difference);
        done = status == SNOW_STATUS_OK ? judge_difference(opts, &difference)
                                        : fail_status(context, status);
    }
    snow_image_free(images[0]);
    snow_image_free(images[1]);
    snow_context_free(context);
    return done;
}
