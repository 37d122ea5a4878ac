/* tests/render/test_world_to_pixel.c - points of the world and pixels: against
 * the formulas of cameras, and against the depths of a sphere. */
#include "support/support.h"

#include <snowglass/snowglass.h>

#include <math.h>
#include <string.h>

/* An oblique grid, whose directions are neither unit vectors nor at right
 * angles. */
static const snow_volume_info oblique = {.size = sizeof oblique,
                                         .dims = {31, 27, 23},
                                         .type = SNOW_TYPE_FLOAT32,
                                         .matrix = {{0.9, 0.3, -0.2, 12},
                                                    {-0.2, 1.1, 0.4, -70},
                                                    {0.1, -0.3, 1.3, 5},
                                                    {0, 0, 0, 1}}};

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

static void normalize(double a[3]) {
    const double length = sqrt(dot(a, a));
    for (int i = 0; i < 3; i++)
        a[i] /= length;
}

/* The middle of the voxel boxes, and its distance from their farthest corner.
 */
static double find_middle(double middle[3]) {
    double most = 0;
    for (int corner = 0; corner < 8; corner++) {
        double from[3] = {0};
        for (int axis = 0; axis < 3; axis++)
            for (int i = 0; i < 3; i++)
                from[i] += oblique.matrix[i][axis] *
                           (double)oblique.dims[axis] *
                           (corner >> axis & 1 ? 0.5 : -0.5);
        most = fmax(most, dot(from, from));
    }
    for (int i = 0; i < 3; i++) {
        middle[i] = oblique.matrix[i][3];
        for (int axis = 0; axis < 3; axis++)
            middle[i] +=
                oblique.matrix[i][axis] * (double)(oblique.dims[axis] - 1) / 2;
    }
    return sqrt(most);
}

static double between(uint64_t *random, double low, double high) {
    return low + (high - low) * support_uniform(random);
}

/* A camera at 3 to 5 radii, which looks somewhere into the volume. */
static snow_view placed_view(uint64_t *random, int n) {
    snow_view view = {.size = sizeof view};
    double middle[3], away[3], radius = find_middle(middle);
    snow_view_init(&view);
    view.width = 40 + n % 90;
    view.height = 40 + n * 7 % 90;
    view.zoom = between(random, 0.4, 3);
    view.strip = n % 3 ? 0 : between(random, 0, 0.5);
    view.fov = n % 2 ? between(random, 5, 70) : 0;
    view.has_position = view.has_target = view.has_view_up = true;
    for (int i = 0; i < 3; i++)
        away[i] = between(random, -1, 1);
    normalize(away);
    for (int i = 0; i < 3; i++) {
        view.position[i] = middle[i] + between(random, 3, 5) * radius * away[i];
        view.target[i] = middle[i] + between(random, -0.4, 0.4) * radius;
        view.view_up[i] = between(random, -1, 1);
    }
    return view;
}

/* As in every book: the axes of the camera, a scale, and a division. */
static void expect_pixel(const snow_view *view, const double point[3],
                         double pixel[3]) {
    double forward[3], right[3], up[3], from[3], middle[3];
    const double radius = find_middle(middle);
    const double width = view->width - floor(view->strip * view->width + 0.5);
    const double side = fmin(width, view->height) * view->zoom;
    for (int i = 0; i < 3; i++) {
        forward[i] = view->target[i] - view->position[i];
        from[i] = point[i] - view->target[i];
    }
    const double distance = sqrt(dot(forward, forward));
    normalize(forward);
    cross(forward, view->view_up, right);
    normalize(right);
    cross(right, forward, up);
    const double depth = dot(from, forward);
    const double half = tan(view->fov / 2 * acos(-1) / 180);
    const double seen =
        view->fov > 0 ? half * (distance + depth) : radius; /* of the side */
    pixel[0] = width / 2 + dot(from, right) / seen * side / 2;
    pixel[1] = view->height / 2.0 - dot(from, up) / seen * side / 2;
    pixel[2] = depth;
}

static void points_are_seen_where_the_formula_has_them(void **state) {
    snow_context *context = support_context();
    uint64_t random = 5;
    (void)state;
    for (int n = 0; n < 200; n++) {
        snow_view view = placed_view(&random, n);
        double points[5][3], pixels[5][3], back[5][3], middle[3], expected[3];
        const double radius = find_middle(middle);
        for (int p = 0; p < 5; p++)
            for (int i = 0; i < 3; i++)
                points[p][i] = middle[i] + between(&random, -1, 1) * radius;
        assert_int_equal(snow_view_world_to_pixel(context, &oblique, &view,
                                                  points[0], 5, pixels[0]),
                         SNOW_STATUS_OK);
        assert_int_equal(snow_view_pixel_to_world(context, &oblique, &view,
                                                  pixels[0], 5, back[0]),
                         SNOW_STATUS_OK);
        for (int p = 0; p < 5; p++) {
            expect_pixel(&view, points[p], expected);
            for (int i = 0; i < 3; i++) {
                assert_true(fabs(pixels[p][i] - expected[i]) < 1e-9 * 1000);
                assert_true(fabs(back[p][i] - points[p][i]) < 1e-9 * 100);
            }
        }
    }
    snow_context_free(context);
}

/* One array serves both ways; the plane of the eye and what lies behind it is
 * seen nowhere, and no depth is no point. */
static void what_is_not_seen_is_not_a_number(void **state) {
    snow_context *context = support_context();
    uint64_t random = 6;
    snow_view view = placed_view(&random, 1);
    double at[4][3];
    (void)state;
    for (int i = 0; i < 3; i++) {
        const double step = view.position[i] - view.target[i];
        at[0][i] = view.target[i];
        at[1][i] = view.position[i] + 0.01 * step;
        at[2][i] = view.target[i] + 0.5 * step;
        at[3][i] = i ? NAN : 0;
    }
    assert_int_equal(
        snow_view_world_to_pixel(context, &oblique, &view, at[0], 4, at[0]),
        SNOW_STATUS_OK);
    for (int i = 0; i < 3; i++) {
        assert_true(isfinite(at[0][i]) && isfinite(at[2][i]));
        assert_true(isnan(at[1][i]) && isnan(at[3][i]));
    }
    at[2][2] = -1e9; /* far behind the eye */
    assert_int_equal(
        snow_view_pixel_to_world(context, &oblique, &view, at[0], 4, at[0]),
        SNOW_STATUS_OK);
    for (int i = 0; i < 3; i++) {
        assert_true(fabs(at[0][i] - view.target[i]) < 1e-9);
        assert_true(isnan(at[1][i]) && isnan(at[2][i]) && isnan(at[3][i]));
    }
    snow_context_free(context);
}

static void a_view_that_cannot_be_drawn_is_refused(void **state) {
    snow_context *context = support_context();
    snow_view view;
    double at[3] = {1, 2, 3};
    (void)state;
    snow_view_init(&view);
    view.zoom = 0;
    assert_int_equal(
        snow_view_world_to_pixel(context, &oblique, &view, at, 1, at),
        SNOW_STATUS_BAD_USAGE);
    assert_non_null(strstr(snow_context_message(context), "zoom"));
    assert_int_equal(
        snow_view_pixel_to_world(context, &oblique, &view, at, 1, at),
        SNOW_STATUS_BAD_USAGE);
    assert_true(at[0] == 1 && at[1] == 2 && at[2] == 3);
    assert_int_equal(
        snow_view_world_to_pixel(context, &oblique, NULL, at, 0, at),
        SNOW_STATUS_OK);
    snow_context_free(context);
}

/* --- a sphere ------------------------------------------------------------- */

#define RADIUS 8.5
#define VOXELS (31 * 27 * 23)

/* The distance to the sphere's surface, above 0 inside. */
static snow_volume *sphere_of(snow_context *context, const double middle[3],
                              float *voxels) {
    snow_volume *volume = NULL;
    for (int n = 0; n < VOXELS; n++) {
        const double index[3] = {n % 31, n / 31 % 27, n / 31 / 27};
        double from[3];
        for (int i = 0; i < 3; i++)
            from[i] = dot(oblique.matrix[i], index) + oblique.matrix[i][3] -
                      middle[i];
        voxels[n] = (float)(RADIUS - sqrt(dot(from, from)));
    }
    assert_int_equal(snow_volume_wrap(context, &oblique, voxels, &volume),
                     SNOW_STATUS_OK);
    return volume;
}

/* The depth at which a pixel's line meets the sphere first; NaN: nowhere. */
static double first_hit(snow_context *context, const snow_view *view, int x,
                        int y, const double middle[3], double radius) {
    double ends[2][3] = {{x + 0.5, y + 0.5, -20}, {x + 0.5, y + 0.5, 20}};
    double along[3], from[3];
    assert_int_equal(
        snow_view_pixel_to_world(context, &oblique, view, ends[0], 2, ends[0]),
        SNOW_STATUS_OK);
    for (int i = 0; i < 3; i++) {
        along[i] = ends[1][i] - ends[0][i];
        from[i] = ends[0][i] - middle[i];
    }
    const double a = dot(along, along), b = dot(along, from) / a;
    const double c = (dot(from, from) - radius * radius) / a;
    return -20 + 40 * (-b - sqrt(b * b - c));
}

/* Turned from a side, or placed; some about another point, some beside a
 * legend. */
static snow_view sphere_view(uint64_t *random, int n, const double middle[3]) {
    snow_view view = placed_view(random, n);
    view.width = 80 + 7 * (n % 5);
    view.height = 70 + 3 * (n % 7);
    view.zoom = between(random, 2, 3);
    view.fov = n % 2 ? between(random, 20, 45) : 0;
    view.has_position = n % 4 > 1;
    view.has_target = n % 3 > 0;
    view.azimuth = between(random, 0, 360);
    view.elevation = between(random, -80, 80);
    view.roll = between(random, 0, 360);
    for (int i = 0; i < 3; i++)
        view.target[i] = middle[i] + between(random, -2, 2);
    return view;
}

/* The picture's depths are those of the formula, but at the sphere's edge: in
 * the mean, as those of footprints are of whole slices. */
static void check_depths(snow_context *context, const snow_image *depths,
                         const snow_view *view, const double middle[3],
                         double bound) {
    const float *at = snow_image_data(depths);
    int hits = 0;
    double sum = 0;
    for (int y = 1; y < view->height - 1; y++)
        for (int x = 1; x < view->width - 1; x++) {
            const double expected =
                first_hit(context, view, x, y, middle, RADIUS);
            const double depth = (double)at[y * view->width + x];
            double slope = 0;
            int misses = 0;
            for (int n = 0; n < 9; n++) {
                const double beside = first_hit(context, view, x - 1 + n % 3,
                                                y - 1 + n / 3, middle, RADIUS);
                slope = fmax(slope, fabs(expected - beside));
                misses += isnan(beside);
            }
            if (!isnan(depth) &&
                isnan(first_hit(context, view, x, y, middle, RADIUS + 2)))
                fail_msg("%d, %d: depth %g beside the sphere", x, y, depth);
            if (misses || slope > 1)
                continue;
            sum += fabs(depth - expected);
            hits++;
        }
    if (hits < 200 || !(sum < bound * hits))
        fail_msg("%d pixels are %g off in the mean", hits, sum / hits);
}

typedef struct way {
    snow_method method;
    snow_mode mode;
    double bound; /* voxels are 1 to 1.4 wide; footprints know slices alone */
} way;

static void depths_of_a_sphere_lie_on_it(void **state) {
    static const way ways[] = {{SNOW_METHOD_RAYCAST, SNOW_MODE_ISO, 0.08},
                               {SNOW_METHOD_SHEAR_WARP, SNOW_MODE_ISO, 0.08},
                               {SNOW_METHOD_RAYCAST, SNOW_MODE_OVER, 0.12},
                               {SNOW_METHOD_SHEAR_WARP, SNOW_MODE_OVER, 1.5},
                               {SNOW_METHOD_FOOTPRINT, SNOW_MODE_OVER, 1.5}};
    static const snow_color_point white = {0, 1, 1, 1};
    static const snow_opacity_point step[] = {{-0.01, 0}, {0.01, 1}};
    static float voxels[VOXELS];
    snow_context *context = support_context();
    snow_transfer *transfer = NULL;
    snow_frame *frame = NULL;
    double middle[3];
    uint64_t random = 7;
    (void)state;
    find_middle(middle);
    snow_volume *volume = sphere_of(context, middle, voxels);
    assert_int_equal(snow_transfer_new(context, &white, 1, step, 2, &transfer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_frame_new(context, &frame), SNOW_STATUS_OK);
    for (int n = 0; n < 60; n++) {
        const way *w = &ways[n % 5];
        snow_view view = sphere_view(&random, n, middle);
        snow_settings settings;
        snow_image *image = NULL;
        snow_settings_init(&settings);
        settings.method = w->method;
        settings.mode = w->mode;
        settings.depth = true;
        if (!support_takes((size_t)n, 4))
            continue;
        assert_int_equal(snow_frame_render(frame, volume, transfer, &view,
                                           &settings, &image),
                         SNOW_STATUS_OK);
        check_depths(context, snow_frame_depth(frame), &view, middle, w->bound);
        snow_image_free(image);
    }
    snow_frame_free(frame);
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
}

/* Straight on slices of one pixel a voxel: the middles of voxels are the
 * middles of pixels. */
static void voxels_of_a_slice_are_its_pixels(void **state) {
    const snow_volume_info info = {
        .size = sizeof info,
        .dims = {40, 30, 20},
        .type = SNOW_TYPE_UINT8,
        .matrix = {
            {0.5, 0, 0, 100}, {0, 0.5, 0, -7}, {0, 0, 2, 1e5}, {0, 0, 0, 1}}};
    snow_context *context = support_context();
    snow_view view;
    int axis;
    (void)state;
    snow_view_init(&view);
    view.width = view.height = 0;
    assert_int_equal(snow_slice_view(context, &info, "z", &view, &axis),
                     SNOW_STATUS_OK);
    assert_true(view.width == 40 && view.height == 30 && axis == 2);
    double at[2][3] = {{100, -7, 1e5}, {100 + 0.5 * 12, -7 + 0.5 * 21, 1e5}};
    assert_int_equal(
        snow_view_world_to_pixel(context, &info, &view, at[0], 2, at[0]),
        SNOW_STATUS_OK);
    assert_true(fabs(at[0][0] - 0.5) < 1e-9 && fabs(at[0][1] - 29.5) < 1e-9);
    assert_true(fabs(at[1][0] - 12.5) < 1e-9 && fabs(at[1][1] - 8.5) < 1e-9);
    snow_context_free(context);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_are_seen_where_the_formula_has_them),
        cmocka_unit_test(what_is_not_seen_is_not_a_number),
        cmocka_unit_test(a_view_that_cannot_be_drawn_is_refused),
        cmocka_unit_test(depths_of_a_sphere_lie_on_it),
        cmocka_unit_test(voxels_of_a_slice_are_its_pixels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
