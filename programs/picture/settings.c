/* picture/settings.c - the library's records of settings and view, from the
 * options. */
#include "commands/commands.h"
#include "run/log.h"
#include "run/start.h"

#include <math.h>
#include <string.h>

/* The length of a millimetre in the unit of the volume's world. */
static int opacity_length(const options *opts, const snow_volume_info *info,
                          double *out) {
    const double unit = snow_unit_length(*info->unit ? info->unit : "mm", NULL);
    *out = 0;
    /* A file of a transfer function may say so, but a recipe has priority. */
    const bool per_mm =
        opts->loaded && !opts->opacity_unit
            ? snow_look_file_look(opts->loaded)->per_mm
            : opts->opacity_unit && strcmp(opts->opacity_unit, "mm") == 0;
    if (!per_mm)
        return CONTINUE;
    if (unit > 0) {
        *out = snow_unit_length("mm", NULL) / unit;
        return CONTINUE;
    }
    return fail_usage("opacities per mm: the volume's unit '%s' is not a "
                      "length; give --config '{\"opacity-unit\": \"voxel\"}'",
                      info->unit);
}

/* The option table has checked the words, so the library knows every name. */
void fill_settings(const options *opts, snow_settings *out) {
    snow_settings_init(out);
    out->threshold = opts->threshold < 0 ? 0 : opts->threshold;
    out->method = (snow_method)snow_method_from_name(opts->method);
    out->encoding = (snow_encoding)snow_encoding_from_name(opts->encoding);
    out->kernel = (snow_kernel)snow_kernel_from_name(opts->kernel);
    out->footprint = (int)opts->footprint;
    out->shade =
        strcmp(opts->shade, "none") == 0 ? SNOW_SHADE_NONE : SNOW_SHADE_PHONG;
    out->ambient = opts->material[0];
    out->diffuse = opts->material[1];
    out->specular = opts->material[2];
    out->shininess = opts->material[3];
    out->light = opts->light.light;
    out->light_azimuth = opts->light.azimuth;
    out->light_elevation = opts->light.elevation;
    out->depth_darkening = opts->depth_darkening;
    out->occlusion = opts->occlusion;
    out->quality = (snow_quality)snow_quality_from_name(opts->quality);
    out->isa = (snow_isa)snow_isa_from_name(opts->isa);
    out->threads = (int)opts->threads;
    out->deterministic = opts->deterministic;
    out->mode = (snow_mode)snow_mode_from_name(opts->mode);
    out->iso = isnan(opts->iso) ? 0 : opts->iso;
    out->depth = opts->depth != NULL;
}

int make_settings(const options *opts, const snow_volume_info *info,
                  snow_settings *out) {
    fill_settings(opts, out);
    if (!out->threads)
        out->threads = process_threads();
    return opacity_length(opts, info, &out->opacity_length);
}

static void place_camera(const options *opts, snow_view *out) {
    out->has_position = opts->position.given;
    out->has_target = opts->target.given;
    out->has_view_up = opts->up.given;
    memcpy(out->position, opts->position.at, sizeof out->position);
    memcpy(out->target, opts->target.at, sizeof out->target);
    memcpy(out->view_up, opts->up.at, sizeof out->view_up);
}

/* A named view also sets size and angles, so it comes before them. */
int make_view(snow_context *context, const options *opts,
              const snow_volume_info *info, snow_view *out) {
    snow_view_init(out);
    snow_status status =
        snow_view_from_name(context, snow_view_name_for(info, opts->view), out);
    if (status != SNOW_STATUS_OK)
        return fail_status(context, status);
    out->width = (int)opts->size[0];
    out->height = (int)opts->size[1];
    out->azimuth = opts->azimuth;
    out->elevation = opts->elevation;
    out->roll = opts->roll;
    out->zoom = opts->zoom;
    out->fov = opts->fov;
    place_camera(opts, out);
    return CONTINUE;
}
