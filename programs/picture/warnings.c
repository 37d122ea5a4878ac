/* warnings.c - the notes of warnings.h. */
#include "picture/warnings.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <string.h>

static bool is_shown(const options *opts) {
    return opts->verbosity >= 0 && process_talks();
}

/* An option of a configuration may be meant for another mode, so only options
 * on the command line are reported. */
static void warn_option(const options *opts, const char *name) {
    if (options_typed(opts, name))
        say("note: --%s has no effect in mode %s", name, opts->mode);
}

void warn_unused(const options *opts) {
    static const char *const of_opacity[] = {"opacity", "gradient-opacity"};
    static const char *const of_light[] = {"light", "shade", "material",
                                           "depth-darkening", "occlusion"};
    bool lit = strcmp(opts->mode, "iso") == 0;
    if (strcmp(opts->mode, "over") == 0 || !is_shown(opts))
        return;
    for (size_t i = 0; i < sizeof of_opacity / sizeof *of_opacity; i++)
        warn_option(opts, of_opacity[i]);
    for (size_t i = 0; i < sizeof of_light / sizeof *of_light && !lit; i++)
        warn_option(opts, of_light[i]);
}

/* Reports a method that was requested by name, or a kernel's, but not used. */
static void warn_method(const render_state *s) {
    bool opts =
        strcmp(s->opts->method, "shear-warp") == 0 ||
        (strcmp(s->opts->method, "auto") == 0 &&
         (strcmp(s->opts->kernel, "auto") != 0 || s->opts->footprint != 0));
    if (!opts || s->stats.method == SNOW_METHOD_SHEAR_WARP)
        return;
    say("note: method %s is used in place of shear-warp, which takes kernels "
        "tent of 2 voxels and bspline of 4, slices at most 384 times as far "
        "apart as voxels, and no eye beside the slices or near to them",
        snow_method_name(s->stats.method));
}

bool picture_is_empty(snow_image *image) {
    if (!image)
        return false;
    int64_t count = (int64_t)snow_image_width(image) * snow_image_height(image);
    const float *pixels = snow_image_pixels(image);
    int channels = snow_image_channels(image);
    for (int64_t i = 0; i < count; i++)
        if (channels == 1 ? !isnan(pixels[i])
                          : pixels[i * channels + channels - 1] != 0)
            return false;
    return true;
}

static void warn_empty(const render_state *s, snow_image *image) {
    snow_mode mode = s->settings.mode;
    if (!picture_is_empty(image))
        return;
    if (mode == SNOW_MODE_ISO)
        say("note: the picture is empty: no surface of value %g is in view; "
            "snowglass info prints the range of values",
            s->settings.iso);
    else if (mode == SNOW_MODE_OVER && s->stats.interesting == 0)
        say("note: the picture is empty: no voxel has an opacity above the "
            "threshold; snowglass info prints the range of values, --opacity "
            "sets which are visible");
    else if (mode != SNOW_MODE_OVER && !s->opts->background.automatic)
        say("note: the picture is empty: nothing but the lowest value is in "
            "view, which --background none leaves out; give --range LO,HI");
    else
        say("note: the picture is empty: no visible voxel is in view; check "
            "--target, --position, --zoom and --clip");
}

/* Values reach a level from below: of a field whose ground is 0 and that is
 * below it elsewhere, such as the charge of electrons, all around is inside. */
static void warn_iso(const render_state *s) {
    const double iso = s->settings.iso;
    snow_volume_statistics of;
    snow_volume_statistics_init(&of);
    if (s->settings.mode != SNOW_MODE_ISO || !(iso < 0) || !s->volume ||
        snow_volume_get_statistics(s->volume, &of) != SNOW_STATUS_OK ||
        of.max > 0 || of.min >= iso)
        return;
    say("note: no value is above 0, so that nearly all reaches %g: mode iso "
        "shows the box; --opacity %g:1,%g:1,%g:0 --shade phong shows what is "
        "below %g",
        iso, of.min, iso, 0.97 * iso, iso);
}

void warn_picture(const render_state *s, snow_image *image) {
    if (!is_shown(s->opts))
        return;
    warn_iso(s);
    warn_method(s);
    warn_empty(s, image);
}
