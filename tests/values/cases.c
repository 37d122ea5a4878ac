/* tests/values/cases.c - volumes and looks by which pictures are held
 * against the truth. */
#include "values/cases.h"

#include <math.h>

static const snow_color_point white[] = {{0, 1, 1, 1}};
static const snow_opacity_point engine_ramp[] = {
    {80, 0}, {120, 0.9}, {255, 0.9}};
static const snow_color_point mist[] = {
    {0, 0, 0, 0}, {40, 0.2, 0.2, 0.2}, {255, 1, 1, 1}};
static const snow_opacity_point mist_ramp[] = {{0, 0}, {40, 0}, {255, 0.06}};
static const snow_color_point bone[] = {
    {1150, 0.9, 0.85, 0.7}, {1200, 0.9, 0.85, 0.7}, {3272, 1, 1, 0.95}};
static const snow_opacity_point bone_ramp[] = {
    {1150, 0}, {1200, 0.95}, {3272, 0.95}};
static const snow_color_point hot[] = {{30, 0.04, 0, 0}, {45, 0.1, 0, 0},
                                       {90, 0.8, 0, 0},  {120, 1, 0.25, 0},
                                       {200, 1, 1, 0.2}, {255, 1, 1, 1}};
static const snow_opacity_point hot_ramp[] = {
    {30, 0}, {45, 0.02}, {90, 0.06}, {120, 0.5}, {200, 0.9}, {255, 0.9}};
static const snow_opacity_point step[] = {{127.5, 0}, {127.5, 1}};

#define LOOK(colors, opacities)                        \
    colors, sizeof colors / sizeof *colors, opacities, \
        sizeof opacities / sizeof *opacities

const value_case value_cases[] = {
    {"engine, opaque",
     VALUE_CASE_ENGINE,
     LOOK(white, engine_ramp),
     true,
     'z',
     -30,
     20,
     1.0193,
     {31.3, 36.6, 48.6}},
    {"engine, zoom 4",
     VALUE_CASE_ENGINE,
     LOOK(white, engine_ramp),
     true,
     'z',
     -30,
     20,
     4 * 1.0193,
     {31.4, 39.1, 50.3}},
    {"engine, translucent",
     VALUE_CASE_ENGINE,
     LOOK(mist, mist_ramp),
     false,
     'z',
     -30,
     20,
     1.0193,
     {53.2, 57.9, 68.9}},
    {"CT head, bone",
     VALUE_CASE_HEAD,
     LOOK(bone, bone_ramp),
     true,
     'y',
     150,
     15,
     1.4,
     {25.7, 29.4, 36}},
    {"head phantom",
     VALUE_CASE_PHANTOM,
     LOOK(hot, hot_ramp),
     true,
     'y',
     -35,
     15,
     1.6,
     {40.9, 41.3, 50}},
    {"hard sphere, whole",
     VALUE_CASE_SPHERE,
     LOOK(white, step),
     true,
     'z',
     20,
     25,
     1.6,
     {33.9, 37.3, 40.6}},
    {"hard sphere, inside",
     VALUE_CASE_SPHERE,
     LOOK(white, step),
     true,
     'z',
     20,
     25,
     6.4,
     {58.2, 64.4, 73.3}},
    {"soft ball, along y",
     VALUE_CASE_BALL,
     LOOK(hot, hot_ramp),
     true,
     'y',
     20,
     35,
     1.6,
     {57.4, 61, 73.2}},
    {"soft ball, along z",
     VALUE_CASE_BALL,
     LOOK(hot, hot_ramp),
     true,
     'z',
     20,
     20,
     1.6,
     {58.2, 63.3, 69.6}},
    {"soft ball, slices 8 apart",
     VALUE_CASE_THICK,
     LOOK(hot, hot_ramp),
     true,
     'z',
     35,
     20,
     1.6,
     {36.7, 47.7, 47.8}},
};
const size_t value_case_count = sizeof value_cases / sizeof *value_cases;

static snow_volume *open_raw(snow_context *context, const char *name,
                             int64_t slices, snow_type type, double spacing) {
    const char *path = support_data(name);
    snow_volume *volume = NULL;
    snow_volume_options options = {.size = sizeof options,
                                   .dims = {256, 256, slices},
                                   .type = type,
                                   .endian = SNOW_ENDIAN_BIG,
                                   .spacing = {1, 1, spacing}};
    if (path &&
        snow_volume_open(context, path, &options, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return volume;
}

static snow_volume *open_phantom(snow_context *context) {
    snow_volume *volume = NULL;
    snow_volume_options options = {.size = sizeof options,
                                   .spacing = {1, 1, 2}};
    if (snow_volume_open(context, "phantom:head", &options, &volume) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return volume;
}

/* A sphere of 8 bits about the same middle: hard where slices are 1 apart. */
static uint8_t *fill_sphere(snow_volume_info *info, int64_t apart) {
    int64_t slices = 96 / apart;
    double spacing = (double)apart;
    *info = (snow_volume_info){
        .dims = {96, 96, slices},
        .type = SNOW_TYPE_UINT8,
        .slope = 1,
        .matrix = {
            {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, spacing, 0}, {0, 0, 0, 1}}};
    uint8_t *voxels = calloc((size_t)(96 * 96 * slices), 1), *to = voxels;
    assert_non_null(voxels);
    for (int64_t k = 0; k < slices; k++)
        for (int64_t j = 0; j < 96; j++)
            for (int64_t i = 0; i < 96; i++) {
                double x = (double)i - 47.5, y = (double)j - 47.8;
                double r = hypot(hypot(x, y), (double)k * spacing - 47.3);
                double radius = apart > 2 ? 28 : 36; /* away from the ends */
                double value = apart > 1
                                   ? 20 + 200 / (1 + exp(-(radius - r) / 2.5))
                                   : 128 + 32 * (radius - r);
                *to++ = (uint8_t)rint(fmin(fmax(value, 0), 255));
            }
    return voxels;
}

static void aim(const value_case *what, snow_view *view) {
    bool along_z = what->side == 'z';
    *view = (snow_view){.width = 512,
                        .height = 512,
                        .back = {0, !along_z, along_z},
                        .up = {0, along_z, !along_z},
                        .azimuth = what->azimuth,
                        .elevation = what->elevation,
                        .zoom = what->zoom};
}

bool value_case_open(const value_case *what, snow_context *context,
                     value_case_scene *out) {
    *out = (value_case_scene){0};
    reference_scene *scene = &out->scene.base;
    int64_t apart = what->volume == VALUE_CASE_THICK  ? 8
                    : what->volume == VALUE_CASE_BALL ? 2
                                                      : 1;
    if (apart > 1 || what->volume == VALUE_CASE_SPHERE)
        out->voxels = fill_sphere(&scene->info, apart);
    else if (what->volume == VALUE_CASE_PHANTOM)
        out->volume = open_phantom(context);
    else if (what->volume == VALUE_CASE_ENGINE)
        out->volume = open_raw(context, "classic/engine_256x256x110_u8.raw.gz",
                               110, SNOW_TYPE_UINT8, 1);
    else
        out->volume =
            open_raw(context, "classic/CThead_256x256x113_u16be.raw.gz", 113,
                     SNOW_TYPE_UINT16, 2);
    if (!out->volume && !out->voxels)
        return false;
    if (out->volume)
        scene->info = *snow_volume_get_info(out->volume);
    scene->voxels = out->volume ? snow_volume_voxels(out->volume) : out->voxels;
    scene->colors = what->colors;
    scene->color_count = what->color_count;
    scene->opacities = what->opacities;
    scene->opacity_count = what->opacity_count;
    snow_settings_init(&scene->settings);
    scene->settings.shade = what->shaded ? SNOW_SHADE_PHONG : SNOW_SHADE_NONE;
    scene->settings.light = SNOW_LIGHT_HEAD;
    aim(what, &scene->view);
    return true;
}

void value_case_close(value_case_scene *open) {
    snow_volume_close(open->volume);
    free(open->voxels);
}

void value_distance_add(value_distance *distance, const double picture[4],
                        const double truth[4]) {
    if (!(picture[3] > 0) && !(truth[3] > 0))
        return;
    for (int c = 0; c < 3; c++) {
        double difference = picture[c] - truth[c];
        distance->squares += difference * difference;
        distance->largest = fmax(distance->largest, fabs(difference));
    }
    distance->pixels++;
}

double value_distance_decibels(const value_distance *distance) {
    return 10 * log10(3 * (double)distance->pixels / distance->squares);
}
