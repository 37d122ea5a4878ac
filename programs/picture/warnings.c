/* warnings.c - the notes of warnings.h. */
#include "picture/warnings.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <string.h>

static bool is_heard(const options *asked) {
    return asked->verbosity >= 0 && launch_talks();
}

/* An option of a configuration may be meant for another mode, so only options
 * on the command line are reported. */
static void warn_option(const options *asked, const char *name) {
    if (options_typed(asked, name))
        say("note: --%s has no effect in mode %s", name, asked->mode);
}

void warn_unused(const options *asked) {
    static const char *const of_opacity[] = {"opacity", "gradient-opacity"};
    static const char *const of_light[] = {
        "light",    "shade",     "ambient",        "diffuse",
        "specular", "shininess", "depth-darkening"};
    bool lit = strcmp(asked->mode, "iso") == 0;
    if (strcmp(asked->mode, "over") == 0 || !is_heard(asked))
        return;
    for (size_t i = 0; i < sizeof of_opacity / sizeof *of_opacity; i++)
        warn_option(asked, of_opacity[i]);
    for (size_t i = 0; i < sizeof of_light / sizeof *of_light && !lit; i++)
        warn_option(asked, of_light[i]);
}

/* Reports a method that was requested by name, or a kernel's, but not used. */
static void warn_method(const scene *s) {
    bool asked =
        strcmp(s->asked->method, "shear-warp") == 0 ||
        (strcmp(s->asked->method, "auto") == 0 &&
         (strcmp(s->asked->kernel, "auto") != 0 || s->asked->footprint != 0));
    if (!asked || s->stats.method == SNOW_METHOD_SHEAR_WARP)
        return;
    say("note: method %s is used in place of shear-warp, which takes kernels "
        "tent of 2 voxels and bspline of 4, slices at most 24 times as far "
        "apart as voxels, and no eye beside the slices or near to them",
        snow_method_name(s->stats.method));
}

/* The only axis with a single voxel; -1 if there is none, or several. */
static int axis_of_slice(const snow_volume_info *info) {
    int axis = -1, count = 0;
    for (int i = 0; i < 3; i++)
        if (info->dims[i] == 1) {
            axis = i;
            count++;
        }
    return count == 1 ? axis : -1;
}

/* The components of the normal of a slice along the world's axes, 0 to 1: the
 * cross product of the other two axes of the grid. */
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

/* Sine of the angle below which a slice appears as hardly more than a line. */
#define EDGE_ON 0.1

/* Only for a view that was chosen automatically. */
static void warn_edge(const scene *s) {
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
        say("note: the volume is a single slice, seen from its edge; use "
            "--view %s to see its face",
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
static void warn_empty(const scene *s, snow_image *image) {
    snow_mode mode = s->settings.mode;
    if (!image || snow_image_channels(image) == 1 || !is_empty(image))
        return;
    if (mode == SNOW_MODE_ISO)
        say("note: the picture is empty: no surface of value %g is in view; "
            "snowglass info prints the range of values",
            s->settings.iso);
    else if (mode == SNOW_MODE_OVER && s->stats.interesting == 0)
        say("note: the picture is empty: no voxel has an opacity above the "
            "threshold; snowglass info prints the range of values, --opacity "
            "sets which are visible");
    else
        say("note: the picture is empty: no visible voxel is in view; check "
            "--target, --position, --zoom and --clip");
}

void warn_picture(const scene *s, snow_image *image) {
    if (!is_heard(s->asked))
        return;
    warn_method(s);
    warn_edge(s);
    warn_empty(s, image);
}
