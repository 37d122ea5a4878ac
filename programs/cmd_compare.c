/* cmd_compare.c - how far two pictures differ, and whether that is too far. */
#include "commands.h"
#include "report.h"

#include <stdio.h>

/* "-" is standard input, so that a picture can come from a pipe:
 * render -o - | compare - b.png. */
static int load(snow_context *context, const char *path, snow_image **out) {
    snow_status status = snow_image_load(context, path, out);
    return status == SNOW_OK ? GO_ON : fail_status(context, status);
}

/* psnr is null for equal pictures, where it is infinite. */
static int tell_json(const snow_image_difference *d, double tolerance,
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

/* Of two sizes there is no difference to measure, yet an answer. */
static int judge_sizes(const options *asked, snow_image *const images[2]) {
    int done = SNOW_OK;
    const snow_image *a = images[0], *b = images[1];
    if (snow_image_width(a) == snow_image_width(b) &&
        snow_image_height(a) == snow_image_height(b))
        return GO_ON;
    say("%s and %s: %d x %d and %d x %d pixels; only pictures of one size can "
        "be compared",
        name_of_input(asked->operands[0]), name_of_input(asked->operands[1]),
        snow_image_width(a), snow_image_height(a), snow_image_width(b),
        snow_image_height(b));
    if (asked->json) {
        json_t *object = json_object();
        json_object_set_new(object, "within", json_false());
        json_object_set_new(object, "tolerance", json_number(asked->tolerance));
        json_object_set_new(object, "sizes",
                            json_pack("[oo]", size_json(a), size_json(b)));
        done = print_json(object);
    }
    return done == SNOW_OK ? SNOW_DIFFERENT : done;
}

/* Nine digits tell any two floats apart. */
static int tell_text(const snow_image_difference *d, double tolerance,
                     bool within) {
    printf("largest  %.9g at pixel %d,%d\n", d->largest, d->x, d->y);
    printf("mean     %.9g\n", d->mean);
    printf("psnr     %.4g dB\n", d->psnr);
    printf("ssim     %.6f\n", d->ssim);
    printf("%s the tolerance of %.9g\n", within ? "within" : "beyond",
           tolerance);
    return finish_stdout();
}

/* Differences are told also when they are too large: whoever sees exit code 6
 * wants to know by how much.  A largest difference of NaN is beyond every
 * tolerance. */
static int judge(const options *asked, const snow_image_difference *d) {
    bool within = d->largest <= asked->tolerance;
    int done = asked->json ? tell_json(d, asked->tolerance, within)
                           : tell_text(d, asked->tolerance, within);
    if (done == SNOW_OK && !within)
        return SNOW_DIFFERENT;
    return done;
}

/* One context for both pictures: the message of a failed comparison is left
 * there. */
int cmd_compare(const options *asked) {
    snow_context *context = NULL;
    snow_image *images[2] = {NULL, NULL};
    snow_image_difference difference;
    int done = open_context(asked, &context);
    if (done == GO_ON)
        done = load(context, asked->operands[0], &images[0]);
    if (done == GO_ON)
        done = load(context, asked->operands[1], &images[1]);
    if (done == GO_ON)
        done = judge_sizes(asked, images);
    if (done == GO_ON) {
        snow_status status =
            snow_image_compare(images[0], images[1], &difference);
        done = status == SNOW_OK ? judge(asked, &difference)
                                 : fail_status(context, status);
    }
    snow_image_free(images[0]);
    snow_image_free(images[1]);
    snow_context_free(context);
    return done;
}
