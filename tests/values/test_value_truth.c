/* tests/values/test_value_truth.c - how near the value model is to a fine ray
 * caster, on the cases of values that pictures are judged by.
 *
 * The short tier looks at few pixels of small smooth volumes, the long one at
 * few pixels of all cases.  SNOW_STRIDE=1 looks at every pixel, for many
 * minutes, SNOW_CASE=ball at the cases of that name, and SNOW_PLAN changes
 * choices of the model, to see what they are worth.  With SNOW_PICTURES set to
 * a folder the pictures are written there, the truth first. */
#include "values/cases.h"

#include <math.h>

static const snow_quality qualities[] = {
    SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL, SNOW_QUALITY_HIGH};

/* Pixels are compared in every stride-th column and row. */

static bool is_small(const value_case *what) {
    return what->volume == VALUE_CASE_SPHERE || what->volume == VALUE_CASE_BALL;
}

/* Few pixels are like all of them where there are no edges. */
static bool is_smooth(const value_case *what) {
    return is_small(what) && what->reached[1] > 50;
}

/* Pixels from one that is looked at to the next.  Of a small object with hard
 * edges most of the error is in few pixels, and more of them have to be seen.
 */
static int stride_of_tier(const value_case *what) {
    const char *stride = getenv("SNOW_STRIDE");
    bool edges = is_small(what) && !is_smooth(what);
    int hard = support_is_release() ? 5 : 8;
    return stride ? atoi(stride) : (int)support_sweep(edges ? hard : 17, 41);
}

static double *truth_of(const value_case_scene *open, int fine, int stride) {
    int side = 512 / stride;
    double *pixels = calloc((size_t)(side * side) * 4, sizeof *pixels);
    value_truth *truth = value_truth_new(&open->scene, fine);
    assert_non_null(pixels);
    for (int n = 0; n < side * side; n++)
        value_truth_pixel(truth, n % side * stride + stride / 2 + 0.5,
                          n / side * stride + stride / 2 + 0.5, pixels + 4 * n);
    value_truth_free(truth);
    return pixels;
}

static void choose(value_plan *plan, const char *name, int value) {
    if (strcmp(name, "cells") == 0)
        plan->cells[0] = plan->cells[1] = value;
    else if (strcmp(name, "quincunx") == 0)
        plan->quincunx = value != 0;
    else if (strcmp(name, "sheets") == 0)
        value_plan_sheets(plan, value); /* a slice */
    else if (strcmp(name, "nodes") == 0)
        plan->nodes = value;
    else if (strcmp(name, "steps") == 0)
        plan->steps = value;
    else if (strcmp(name, "measured") == 0)
        plan->measured = value != 0;
    else if (strcmp(name, "warp") == 0)
        plan->warp = (value_warp)value;
    else if (strcmp(name, "mean") == 0)
        plan->mean = value;
    else
        fail_msg("SNOW_PLAN: there is no choice '%s'", name);
}

/* Other choices than the model's: SNOW_PLAN="quincunx=0 cells=2". */
static void choose_all(value_plan *plan) {
    const char *words = getenv("SNOW_PLAN");
    char name[16];
    int value, length;
    while (words &&
           sscanf(words, " %15[a-z]=%d%n", name, &value, &length) == 2) {
        choose(plan, name, value);
        words += length;
    }
}

static double *model_of(const value_case_scene *open, int stride) {
    int side = 512 / stride;
    value_plan plan;
    double *pixels = calloc((size_t)(side * side) * 4, sizeof *pixels);
    assert_non_null(pixels);
    assert_true(value_plan_of(&open->scene, &plan));
    choose_all(&plan);
    value_model *model = value_model_new(&plan);
    for (int n = 0; n < side * side; n++)
        value_model_pixel(model, n % side * stride + stride / 2,
                          n / side * stride + stride / 2, pixels + 4 * n);
    value_model_free(model);
    return pixels;
}

static void keep(snow_context *context, const value_case *what,
                 const char *suffix, const double *pixels, int side) {
    const char *folder = getenv("SNOW_PICTURES");
    snow_image *image = NULL;
    char path[1024];
    if (!folder)
        return;
    assert_int_equal(snow_image_new(context, side, side, 4, &image),
                     SNOW_STATUS_OK);
    for (int n = 0; n < side * side * 4; n++)
        snow_image_pixels(image)[n] = (float)pixels[n];
    snprintf(path, sizeof path, "%s/%s, %s.png", folder, what->name, suffix);
    snow_image_options options = {
        .size = sizeof options, .flatten = true, .overwrite = true};
    assert_int_equal(snow_image_save(image, path, &options), SNOW_STATUS_OK);
    snow_image_free(image);
}

static double decibels(const double *pixels, const double *truth, int side) {
    value_distance distance = {0};
    for (int n = 0; n < side * side; n++)
        value_distance_add(&distance, pixels + 4 * n, truth + 4 * n);
    return value_distance_decibels(&distance);
}

/* Few pixels may be nearer to the truth than all, or less near. */
static void check_reached(const value_case *what, const double reached[3],
                          int stride) {
    double slack = stride < 4 ? 0.2 : 3;
    for (int n = 0; n < 3; n++)
        assert_true(reached[n] >= what->reached[n] - slack);
    slack = stride < 4 ? 0 : 0.5;
    assert_true(reached[1] >= reached[0] - slack);
    assert_true(reached[2] >= reached[1] - slack);
}

static void check_case(snow_context *context, const value_case *what) {
    int stride = stride_of_tier(what), side = 512 / stride;
    static const char *names[] = {"draft", "normal", "high"};
    value_case_scene open;
    double reached[3];
    if (!value_case_open(what, context, &open)) {
        print_message("             skip   %s: no data\n", what->name);
        return;
    }
    double *truth = truth_of(&open, is_small(what) ? 32 : 16, stride);
    keep(context, what, "truth", truth, side);
    for (int n = 0; n < 3; n++) {
        open.scene.base.settings.quality = qualities[n];
        double *pixels = model_of(&open, stride);
        reached[n] = decibels(pixels, truth, side);
        keep(context, what, names[n], pixels, side);
        free(pixels);
    }
    print_message("| %s | %.1f | %.1f | %.1f |\n", what->name, reached[0],
                  reached[1], reached[2]);
    if (!getenv("SNOW_PLAN"))
        check_reached(what, reached, stride);
    free(truth);
    value_case_close(&open);
}

static void each_quality_is_nearer_than_the_one_below(void **state) {
    (void)state;
    snow_context *context = support_context();
    const char *name = getenv("SNOW_CASE");
    bool all = support_sweep(1, 0);
    for (size_t n = 0; n < value_case_count; n++)
        if (name ? strstr(value_cases[n].name, name) != NULL
                 : all || is_smooth(&value_cases[n]))
            check_case(context, &value_cases[n]);
    snow_context_free(context);
}

/* --- rings ---------------------------------------------------------------- */

/* A row or column of `count` values that are `step` apart, blurred by a
 * Gaussian of deviation `sigma`. */
static void blur_line(double *line, int count, int step, double sigma) {
    double *from = calloc((size_t)count, sizeof *from);
    int reach = (int)(4 * sigma);
    assert_non_null(from);
    for (int n = 0; n < count; n++)
        from[n] = line[n * step];
    for (int n = 0; n < count; n++) {
        double sum = 0, weights = 0;
        for (int d = -reach; d <= reach; d++) {
            int at = n + d < 0 ? 0 : n + d >= count ? count - 1 : n + d;
            double weight = exp(-d * d / (2 * sigma * sigma));
            sum += weight * from[at];
            weights += weight;
        }
        line[n * step] = sum / weights;
    }
    free(from);
}

/* Where the truth's alpha is above 0.9 in all pixels within 16. */
static bool is_deep(const double *truth, int x, int y, int side) {
    for (int dy = -16; dy <= 16; dy += 4)
        for (int dx = -16; dx <= 16; dx += 4) {
            int i = x + dx, j = y + dy;
            if (i < 0 || j < 0 || i >= side || j >= side ||
                !(truth[4 * (j * side + i) + 3] > 0.9))
                return false;
        }
    return true;
}

/* The error less its blur, root mean square, of 255. */
static double rings(const double *pixels, const double *truth, int side) {
    double *error = calloc((size_t)(side * side), sizeof *error);
    double *smooth = calloc((size_t)(side * side), sizeof *smooth);
    double squares = 0;
    int count = 0;
    assert_non_null(error);
    assert_non_null(smooth);
    for (int n = 0; n < side * side; n++)
        for (int c = 0; c < 3; c++)
            error[n] = smooth[n] += (pixels[4 * n + c] - truth[4 * n + c]) / 3;
    for (int n = 0; n < side; n++)
        blur_line(smooth + n * side, side, 1, 16);
    for (int n = 0; n < side; n++)
        blur_line(smooth + n, side, side, 16);
    for (int n = 0; n < side * side; n++)
        if (is_deep(truth, n % side, n / side, side)) {
            squares += (error[n] - smooth[n]) * (error[n] - smooth[n]);
            count++;
        }
    free(error);
    free(smooth);
    return 255 * sqrt(squares / count);
}

static void a_soft_ball_has_no_rings(void **state) {
    (void)state;
    snow_context *context = support_context();
    if (!support_sweep(1, 0) || getenv("SNOW_CASE")) {
        snow_context_free(context);
        skip();
    }
    bool more = true;
    for (size_t n = 0; n < value_case_count; n++) {
        value_case_scene open;
        if (value_cases[n].volume != VALUE_CASE_BALL || !more)
            continue;
        more = support_is_release();
        assert_true(value_case_open(&value_cases[n], context, &open));
        double *truth = truth_of(&open, 8, 1), *pixels = model_of(&open, 1);
        double found = rings(pixels, truth, 512);
        print_message("             %s: rings of %.3f\n", value_cases[n].name,
                      found);
        assert_true(found <= 0.27);
        free(truth);
        free(pixels);
        value_case_close(&open);
    }
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_quality_is_nearer_than_the_one_below),
        cmocka_unit_test(a_soft_ball_has_no_rings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
