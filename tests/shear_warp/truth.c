/* tests/shear_warp/truth.c - see truth.h. */
#include "shear_warp/truth.h"

#include <math.h>

/* 1; of data values the largest, and of a picture that shows little its
 * strongest opacity: nothing may hide in faintness. */
static double peak_of(const warp_scene *scene, const float *truth) {
    const bool values = warp_scene_has_values(scene);
    double most = 1e-9;
    for (int n = 0; n < scene->base.view.width * scene->base.view.height; n++)
        most = fmax(most, fabs((double)truth[4 * n + (values ? 0 : 3)]));
    return values || most < 0.25 ? most : 1;
}

static closeness compare(const warp_scene *scene, const float *picture,
                         const float *truth) {
    const int channels = warp_scene_has_values(scene) ? 1 : 3;
    const double peak = peak_of(scene, truth);
    double squares = 0, worst = 0;
    int count = 0;
    for (int n = 0; n < scene->base.view.width * scene->base.view.height; n++) {
        const float *a = picture + 4 * n, *b = truth + 4 * n;
        if (!(a[3] > 0) && !(b[3] > 0))
            continue;
        for (int c = 0; c < 4; c++) {
            double off = fabs((double)a[c] - (double)b[c]);
            off /= c == 3 && channels == 1 ? 1 : peak;
            squares += c < channels ? off * off : 0;
            worst = fmax(worst, off);
        }
        count++;
    }
    return (closeness){-10 * log10(squares / fmax(1, count * channels)), worst,
                       count};
}

/* A picture by rays; where pixels are wider than voxels the mean of several. */
static float *cast_rays(const model_stage *stage, const warp_scene *scene) {
    const int rays = scene->base.view.zoom < 1 ? 4 : 1;
    const int width = scene->base.view.width, height = scene->base.view.height;
    warp_scene cast = *scene;
    cast.base.settings.method = SNOW_METHOD_RAYCAST;
    cast.base.settings.quality = SNOW_QUALITY_HIGH;
    cast.base.view.width *= rays;
    cast.base.view.height *= rays;
    float *fine = warp_scene_render(stage, &cast);
    float *picture = calloc((size_t)(4 * width * height), sizeof *picture);
    assert_non_null(picture);
    for (int y = 0; y < rays * height; y++)
        for (int x = 0; x < rays * width; x++)
            for (int c = 0; c < 4; c++)
                picture[4 * (y / rays * width + x / rays) + c] +=
                    fine[4 * (y * rays * width + x) + c] / (float)(rays * rays);
    free(fine);
    return picture;
}

closeness closeness_of(const model_stage *stage, const warp_scene *scene) {
    float *picture = warp_scene_render(stage, scene);
    float *truth = cast_rays(stage, scene);
    closeness found = compare(scene, picture, truth);
    free(picture);
    free(truth);
    return found;
}
