/* render/settings_resolve.c - settings made definite for a volume (job.h). */
#include "render/job.h"
#include "render/tested.h"

#include <math.h>
#include <snowglass/snowglass.h>

static snow_status check_choice(snow_context *context, const char *name,
                                int value, int count) {
    if (value >= 0 && value < count)
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                     "invalid %s %d: not one of its values", name, value);
}

/* A footprint of 0 stands for the kernel's own, which is in range. */
static snow_status check_numbers(snow_context *context,
                                 const snow_settings *s) {
    const struct {
        const char *name;
        double value, low, high;
    } numbers[] = {
        {"threshold", s->threshold, 0, 255},
        {"footprint", s->footprint ? s->footprint : 2, 2, SNOW_FOOTPRINT_MOST},
        {"ambient", s->ambient, 0, 1},
        {"diffuse", s->diffuse, 0, 1},
        {"specular", s->specular, 0, 1},
        {"shininess", s->shininess, 0, 1e6},
        {"light azimuth", s->light_azimuth, -1e6, 1e6},
        {"light elevation", s->light_elevation, -1e6, 1e6},
        {"depth darkening", s->depth_darkening, 0, 1},
        {"occlusion", s->occlusion, 0, 1},
        {"opacity length", s->opacity_length, 0, 1e300},
        {"threads", s->threads, 0, SNOW_THREADS_MOST},
    };
    for (int i = 0; i < (int)(sizeof numbers / sizeof *numbers); i++)
        if (!(numbers[i].value >= numbers[i].low &&
              numbers[i].value <= numbers[i].high))
            return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                             "invalid %s %g: must be %g to %g", numbers[i].name,
                             numbers[i].value, numbers[i].low, numbers[i].high);
    return SNOW_STATUS_OK;
}

/* Threads and instruction set, as this machine has them. */
static snow_status resolve_machine(snow_context *context, snow_settings *s) {
    if (s->threads == 0)
        s->threads = snow_processors();
    if (s->deterministic)
        s->isa = snow_isa_same();
    if (!snow_isa_runs(s->isa))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "this machine cannot run %s: it supports %s",
                         snow_isa_name(s->isa), snow_isa_found());
    s->isa = snow_isa_resolve(s->isa);
    return SNOW_STATUS_OK;
}

/* Kernels that interpolate values; the others are those of footprints. */
static bool is_of_values(const snow_settings *s) {
    return (s->kernel == SNOW_KERNEL_TENT && s->footprint == 2) ||
           (s->kernel == SNOW_KERNEL_BSPLINE && s->footprint == 4);
}

static snow_status check_kernel(snow_context *context, const snow_settings *s) {
    const bool iso = s->mode == SNOW_MODE_ISO;
    if ((s->method != SNOW_METHOD_RAYCAST && !iso) || is_of_values(s))
        return SNOW_STATUS_OK;
    return snow_fail(
        context, SNOW_STATUS_BAD_USAGE,
        "invalid kernel %s of footprint %d for %s: it must be tent of 2 or "
        "bspline of 4; use another kernel%s",
        snow_kernel_name(s->kernel), s->footprint,
        iso ? "mode iso" : "method raycast",
        iso ? "" : ", or method footprint");
}

snow_status snow_settings_resolve(snow_context *context,
                                  const snow_volume_info *info,
                                  snow_settings *s) {
    SNOW_TRY(check_choice(context, "method", (int)s->method,
                          (int)SNOW_METHOD_TESTED + 1));
    SNOW_TRY(check_choice(context, "encoding", (int)s->encoding,
                          SNOW_ENCODING_RLE + 1));
    SNOW_TRY(
        check_choice(context, "kernel", (int)s->kernel, SNOW_KERNEL_BOX + 1));
    SNOW_TRY(
        check_choice(context, "shade", (int)s->shade, SNOW_SHADE_NONE + 1));
    SNOW_TRY(check_choice(context, "light", (int)s->light,
                          SNOW_LIGHT_DIRECTION + 1));
    SNOW_TRY(check_choice(context, "quality", (int)s->quality,
                          SNOW_QUALITY_HIGH + 1));
    SNOW_TRY(check_choice(context, "isa", (int)s->isa, SNOW_ISA_WASM + 1));
    SNOW_TRY(check_choice(context, "mode", (int)s->mode, SNOW_MODE_ISO + 1));
    if (!isfinite(s->iso))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "invalid iso %g: must be a finite data value", s->iso);
    SNOW_TRY(check_numbers(context, s));
    SNOW_TRY(resolve_machine(context, s));
    if (s->mode != SNOW_MODE_OVER && s->mode != SNOW_MODE_ISO)
        s->depth_darkening = s->occlusion = 0;
    s->depth = s->depth || s->depth_darkening > 0 || s->occlusion > 0;
    if (s->light == SNOW_LIGHT_AUTO)
        s->light = s->light_azimuth != 0 || s->light_elevation != 0
                       ? SNOW_LIGHT_DIRECTION
                       : SNOW_LIGHT_KEY;
    /* Footprints have no isosurfaces. */
    if (s->method == SNOW_METHOD_AUTO ||
        (s->mode == SNOW_MODE_ISO && s->method != SNOW_METHOD_RAYCAST))
        s->method = SNOW_METHOD_SHEAR_WARP;
    /* Methods that interpolate values go through those of voxels. */
    const bool tent =
        s->method == SNOW_METHOD_RAYCAST || s->method == SNOW_METHOD_SHEAR_WARP;
    if (s->kernel == SNOW_KERNEL_AUTO)
        s->kernel =
            s->footprint == 0 && tent ? SNOW_KERNEL_TENT : SNOW_KERNEL_BSPLINE;
    if (s->footprint == 0)
        s->footprint = snow_kernel_default_support(s->kernel);
    SNOW_TRY(check_kernel(context, s));
    if (s->method == SNOW_METHOD_SHEAR_WARP && !is_of_values(s))
        s->method = SNOW_METHOD_FOOTPRINT;
    const double *spacing = info->spacing;
    if (s->opacity_length == 0)
        s->opacity_length = fmin(spacing[0], fmin(spacing[1], spacing[2]));
    return SNOW_STATUS_OK;
}
