/* tests/values/scenes.c - small volumes of float64 by a formula. */
#include "values/scenes.h"

#include <math.h>

const snow_quality value_qualities[] = {SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL,
                                        SNOW_QUALITY_HIGH};

static const snow_color_point white[] = {{0, 1, 1, 1}};

value_scene value_scene_of(const int64_t dims[3], value_formula *formula,
                           double opacity) {
    value_scene scene = {
        .base = {.info = {.dims = {dims[0], dims[1], dims[2]},
                          .type = SNOW_TYPE_FLOAT64,
                          .slope = 1},
                 .colors = white,
                 .color_count = 1,
                 .opacity_count = 1,
                 .view = {.width = 48, .height = 40, .zoom = 1}},
    };
    double *voxels =
        calloc((size_t)(dims[0] * dims[1] * dims[2]), sizeof *voxels);
    snow_opacity_point *points = calloc(1, sizeof *points);
    assert_non_null(voxels);
    assert_non_null(points);
    points->opacity = opacity;
    scene.base.voxels = voxels;
    scene.base.opacities = points;
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++)
                *voxels++ =
                    formula((double[]){(double)i, (double)j, (double)k});
    snow_settings_init(&scene.base.settings);
    scene.base.settings.shade = SNOW_SHADE_NONE;
    value_scene_space(&scene, 1, 1, 1);
    value_scene_look(&scene, 2, 0, 0, 0);
    return scene;
}

void value_scene_free(value_scene *scene) {
    free((void *)(uintptr_t)scene->base.voxels);
    if (scene->base.opacity_count == 1)
        free((void *)(uintptr_t)scene->base.opacities);
}

double *value_scene_voxels(const value_scene *scene) {
    return (double *)(uintptr_t)scene->base.voxels;
}

void value_scene_space(value_scene *scene, double x, double y, double z) {
    double spacing[3] = {x, y, z};
    memset(scene->base.info.matrix, 0, sizeof scene->base.info.matrix);
    for (int n = 0; n < 3; n++) {
        scene->base.info.spacing[n] = spacing[n];
        scene->base.info.matrix[n][n] = spacing[n];
    }
    scene->base.info.matrix[3][3] = 1;
}

void value_scene_look(value_scene *scene, int side, double azimuth,
                      double elevation, double fov) {
    snow_view *view = &scene->base.view;
    for (int n = 0; n < 3; n++) {
        view->back[n] = n == side;
        view->up[n] = n == (side == 2 ? 1 : 2);
    }
    view->azimuth = azimuth;
    view->elevation = elevation;
    view->fov = fov;
}

value_plan value_scene_plan(const value_scene *scene) {
    value_plan plan;
    assert_true(value_plan_of(scene, &plan));
    return plan;
}

double value_scene_chord(const value_plan *plan, const value_ray *ray) {
    double from[3], low = -INFINITY, high = INFINITY;
    value_ray_at(plan, ray, 0, from);
    for (int n = 0; n < 3; n++) {
        bool single = plan->dims[n] == 1;
        double ends[2] = {single ? -0.5 : 0,
                          single ? 0.5 : (double)plan->dims[n] - 1};
        if (fabs(ray->eye[n]) < 1e-12) {
            if (from[n] < ends[0] || from[n] > ends[1])
                return 0;
            continue;
        }
        double a = (ends[0] - from[n]) / -ray->eye[n];
        double b = (ends[1] - from[n]) / -ray->eye[n];
        low = fmax(low, fmin(a, b));
        high = fmin(high, fmax(a, b));
    }
    return fmax(0, high - low);
}
