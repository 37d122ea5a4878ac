/* remarks.c - the notes of remarks.h. */
#include "remarks.h"
#include "launch.h"
#include "report.h"

#include <math.h>
#include <string.h>

static bool is_heard(const options *asked) {
    return asked->verbosity >= 0 && launch_talks();
}

/* What a configuration says may be meant for another mode. */
static void remark_option(const options *asked, const char *name) {
    if (options_typed(asked, name))
        say("note: --%s has no part in mode %s", name, asked->mode);
}

void remark_unused(const options *asked) {
    static const char *const of_opacity[] = {"opacity", "gradient-opacity"};
    static const char *const of_light[] = {"light",   "shade",    "ambient",
                                           "diffuse", "specular", "shininess"};
    bool lit = strcmp(asked->mode, "iso") == 0;
    if (strcmp(asked->mode, "over") == 0 || !is_heard(asked))
        return;
    for (size_t i = 0; i < sizeof of_opacity / sizeof *of_opacity; i++)
        remark_option(asked, of_opacity[i]);
    for (size_t i = 0; i < sizeof of_light / sizeof *of_light && !lit; i++)
        remark_option(asked, of_light[i]);
    if (lit && strcmp(asked->method, "sheared") == 0)
        say("note: --method sheared has no part in mode iso: rays find the "
            "surface among the encoded voxels");
}

/* Of what is asked for by its name. */
static void remark_method(const scene *s) {
    snow_mode mode = s->settings.mode;
    if (strcmp(s->asked->method, "sheared") != 0 || mode == SNOW_MODE_ISO ||
        s->stats.method == SNOW_METHOD_SHEARED)
        return;
    say("note: method footprint in place of sheared: pixels are too many "
        "voxels wide, the eye is too near%s",
        mode == SNOW_MODE_OVER ? "" : ", or a voxel is no finite number");
}

/* The one axis of a single voxel; -1 where there is none, or more. */
static int axis_of_slice(const snow_volume_info *info) {
    int axis = -1, count = 0;
    for (int i = 0; i < 3; i++)
        if (info->dims[i] == 1) {
            axis = i;
            count++;
        }
    return count == 1 ? axis : -1;
}

/* Shares of the world's axes in the normal of a slice, 0 to 1: the product of
 * the other two axes of the grid. */
static void find_normal(const snow_volume_info *info, int axis,
                        double normal[3]) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    double length = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = info->matrix[j][u] * info->matrix[k][v] -
                    info->matrix[k][u] * info->matrix[j][v];
        length += normal[i] * normal[i];
    }
    for (int i = 0; i < 3; i++)
        normal[i] = fabs(normal[i]) / sqrt(length);
}

/* Sine of the angle from which a slice is hardly more than a line. */
#define EDGE_ON 0.1

/* Only of the view that nobody chose. */
static void remark_edge(const scene *s) {
    static const char *const views[2][3] = {{"+x", "+y", "+z"},
                                            {"left", "anterior", "inferior"}};
    const options *asked = s->asked;
    const snow_volume_info *info = &s->drawn.whole;
    int axis = axis_of_slice(info), along = info->medical ? 1 : 2, most = 0;
    double normal[3];
    if (axis < 0 || asked->view || asked->position.given ||
        asked->azimuth != 0 || asked->elevation != 0)
        return;
    find_normal(info, axis, normal);
    for (int i = 1; i < 3; i++)
        if (normal[i] > normal[most])
            most = i;
    if (normal[along] < EDGE_ON)
        say("note: the volume is a single slice, seen from its edge; --view "
            "%s shows its face",
            views[info->medical][most]);
}

static bool is_empty(snow_image *image) {
    int64_t count = (int64_t)snow_image_width(image) * snow_image_height(image);
    const float *pixels = snow_image_pixels(image);
    int channels = snow_image_channels(image);
    for (int64_t i = 0; i < count; i++)
        if (pixels[i * channels + channels - 1] != 0)
            return false;
    return true;
}

/* A picture of values has no opacity. */
static void remark_empty(const scene *s, snow_image *image) {
    snow_mode mode = s->settings.mode;
    if (!image || snow_image_channels(image) == 1 || !is_empty(image))
        return;
    if (mode == SNOW_MODE_ISO)
        say("note: nothing is to be seen: no surface of value %g is in view; "
            "snowglass info tells the range of values",
            s->settings.iso);
    else if (mode == SNOW_MODE_OVER && s->stats.interesting == 0)
        say("note: nothing is to be seen: no voxel has an opacity, or one "
            "above "
            "the threshold; snowglass info tells the range of values, "
            "--opacity says what is shown of it");
    else
        say("note: nothing is to be seen: no visible voxel is in view; look at "
            "--target, --position, --zoom and --clip");
}

void remark_picture(const scene *s, snow_image *image) {
    if (!is_heard(s->asked))
        return;
    remark_method(s);
    remark_edge(s);
    remark_empty(s, image);
}
