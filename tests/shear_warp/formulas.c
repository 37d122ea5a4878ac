/* tests/shear_warp/formulas.c - small volumes by a formula. */
#include "shear_warp/formulas.h"

const snow_quality qualities[] = {SNOW_QUALITY_DRAFT, SNOW_QUALITY_NORMAL,
                                  SNOW_QUALITY_HIGH};

warp_scene formula_scene(const int64_t dims[3], formula_fn *formula,
                         double opacity) {
    warp_scene scene = {.base = model_blank(dims, opacity)};
    float *voxels = model_voxels(&scene.base);
    for (int64_t k = 0; k < dims[2]; k++)
        for (int64_t j = 0; j < dims[1]; j++)
            for (int64_t i = 0; i < dims[0]; i++)
                *voxels++ =
                    (float)formula((double[]){(double)i, (double)j, (double)k});
    /* All values have the opacity, not those above 1/2 only. */
    ((snow_opacity_point *)(uintptr_t)scene.base.opacities)[0].opacity =
        opacity;
    scene.base.settings.method = SNOW_METHOD_SHEAR_WARP;
    scene.base.view.width = 49;
    scene.base.view.height = 41;
    return scene;
}

void formula_scene_space(warp_scene *scene, const double spacing[3]) {
    for (int c = 0; c < 3; c++) {
        scene->base.info.matrix[c][c] = spacing[c];
        scene->base.info.spacing[c] = spacing[c];
    }
}

void formula_scene_look(warp_scene *scene, int side, double azimuth,
                        double elevation, double fov) {
    double back[3] = {0}, up[3] = {0};
    back[side] = 1;
    up[side == 2 ? 1 : 2] = 1;
    model_look(&scene->base, back, up);
    model_turn(&scene->base, azimuth, elevation, 0, 1);
    scene->base.view.fov = fov;
}

void formula_scene_pose(warp_scene *scene, int number) {
    static const double angles[][2] = {
        {0, 0}, {17, 23}, {-38, 12}, {31, -35}, {-8, -41}};
    static const double spacings[][3] = {
        {1, 1, 1}, {0.7, 1.1, 1.3}, {1, 1, 2}, {2.6, 1, 0.9}};
    formula_scene_space(scene, spacings[number % 4]);
    formula_scene_look(scene, number % 3, angles[number % 5][0],
                       angles[number % 5][1], number / 3 % 2 ? 25 : 0);
    scene->base.settings.quality = qualities[number / 6 % QUALITIES];
}

void formula_scene_middle(const warp_scene *scene, double rgba[4]) {
    model_stage stage = model_open();
    warp_scene one = *scene;
    one.base.view.width = one.base.view.height = 1;
    one.base.view.zoom = 60;
    float *picture = warp_scene_render(&stage, &one);
    for (int c = 0; c < 4; c++)
        rgba[c] = (double)picture[c];
    free(picture);
    model_close(&stage);
}
