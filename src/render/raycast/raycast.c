/* render/raycast/raycast.c - see raycast.h: the rays of a picture, and the
 * method as figure 8 knows it. */
#include "render/raycast/raycast.h"

#include "base/vec3.h"
#include "classify/count_interesting.h"
#include "classify/shear_warp/range.h"
#include "render/modes/depth.h"
#include "volume/clip_planes.h"

#include <math.h>
#include <string.h>

/* --- rays ----------------------------------------------------------------- */

/* Cuts a ray to where `at` + t `slope` is at most `most`. */
static void cut_ray(snow_ray *ray, double at, double slope, double most) {
    double t = (most - at) / slope;
    if (slope > 0)
        ray->leave = fmin(ray->leave, t);
    else if (slope < 0)
        ray->enter = fmax(ray->enter, t);
    else if (at > most)
        ray->leave = -INFINITY;
}

/* The stretch within the field and on the inner side of all planes. */
static void cut_to_field(const snow_raycast_pass *pass, snow_ray *ray) {
    const snow_field *field = &pass->field;
    const snow_clip_planes *clip = field->volume->clip;
    const double stored[3] = {(double)field->stored[0],
                              (double)field->stored[1],
                              (double)field->stored[2]};
    for (int axis = 0; axis < 3; axis++) {
        double at = ray->start[axis], slope = ray->along[axis];
        cut_ray(ray, at, slope, field->high[axis]);
        cut_ray(ray, -at, -slope, -field->low[axis]);
    }
    for (size_t n = 0; clip && n < clip->plane_count; n++)
        cut_ray(ray, snow_dot(clip->planes[n], ray->start),
                snow_dot(clip->planes[n], ray->along),
                clip->planes[n][3] + snow_dot(clip->planes[n], stored));
}

/* From (u, v, slice) of a placement to (x, y, z). */
static void to_axes(const snow_placement *p, const double from[3],
                    double to[3]) {
    to[p->u_axis] = from[0];
    to[p->v_axis] = from[1];
    to[p->slice_axis] = from[2];
}

/* The world vector of a step in index space. */
static void to_world(const snow_volume_info *info, const double step[3],
                     double world[3]) {
    for (int row = 0; row < 3; row++) {
        world[row] = 0;
        for (int axis = 0; axis < 3; axis++)
            world[row] += info->matrix[row][axis] * step[axis];
    }
}

/* The ray through pixel position (x, y), and the direction to its viewer. */
static void aim(const snow_raycast_pass *pass, double x, double y,
                snow_ray *ray, double viewer[3]) {
    const snow_placement *p = &pass->job->placement;
    double start[3], along[3], world[3];
    ray->enter = p->perspective ? 0 : -INFINITY;
    ray->leave = INFINITY;
    if (p->perspective) {
        memcpy(start, p->eye.at, sizeof start);
        snow_perspective_ray(&p->eye, x, y, along);
        to_axes(p, along, ray->along);
        to_world(&pass->field.volume->info, ray->along, world);
        double length = snow_length(world);
        for (int n = 0; n < 3; n++) {
            ray->along[n] /= length;
            viewer[n] = -world[n] / length;
        }
    } else {
        for (int axis = 0; axis < 2; axis++)
            start[axis] = p->inverse[axis][0] * (x - p->origin[0]) +
                          p->inverse[axis][1] * (y - p->origin[1]);
        start[2] = 0;
        memcpy(viewer, p->back, 3 * sizeof *viewer);
        for (int n = 0; n < 3; n++)
            ray->along[n] = -snow_dot(pass->shader.inverse[n], viewer);
    }
    to_axes(p, start, ray->start);
}

/* The steps that end next to a part's voxels, and perhaps some more. */
static void cut_to_part(const snow_raycast_pass *pass, snow_ray *ray) {
    snow_ray own = *ray;
    for (int axis = 0; pass->cut && axis < 3; axis++) {
        double at = ray->start[axis], slope = ray->along[axis];
        cut_ray(&own, at, slope, (double)pass->own[axis][1] + 0.5);
        cut_ray(&own, -at, -slope, 0.5 - (double)pass->own[axis][0]);
    }
    ray->first = 0;
    ray->last = ray->steps;
    if (!(own.enter <= own.leave + ray->step))
        ray->last = -1;
    else if (pass->cut) {
        double first = (own.enter - ray->enter) / ray->step;
        double last = (own.leave - ray->enter) / ray->step;
        ray->first = (int64_t)fmax(0, floor(first) - 1);
        ray->last = (int64_t)fmin(ceil(last) + 1, (double)ray->steps);
    }
}

static bool make_ray(const snow_raycast_pass *pass, double x, double y,
                     snow_ray *ray, double viewer[3]) {
    aim(pass, x, y, ray, viewer);
    cut_to_field(pass, ray);
    double length = ray->leave - ray->enter;
    if (!(length > 0) || !isfinite(length))
        return false;
    ray->steps = (int64_t)ceil(length / pass->step - 1e-9);
    ray->steps = ray->steps > 0 ? ray->steps : 1;
    ray->step = length / (double)ray->steps;
    cut_to_part(pass, ray);
    return ray->first <= ray->last;
}

int64_t snow_ray_skip(const snow_ray *ray, const double at[3]) {
    double least = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double slope = ray->along[axis] * ray->step;
        double border = floor(at[axis]) + (slope > 0);
        if (slope != 0)
            least = fmin(least, (border - at[axis]) / slope);
    }
    return least > 1 && least < (double)ray->steps ? (int64_t)least : 1;
}

float snow_raycast_depth(const snow_raycast_pass *pass, const snow_ray *ray,
                         double t) {
    double at[3];
    snow_ray_at(ray, t, at);
    return (float)(snow_dot(pass->depth, at) + pass->depth[3]);
}

float snow_raycast_flatness(const snow_raycast_pass *pass, const double at[3]) {
    double own[3];
    for (int axis = 0; axis < 3; axis++)
        own[axis] = at[axis] - (double)pass->field.stored[axis];
    return snow_clip_flatness(pass->field.volume->clip, &pass->viewer, own);
}

/* --- lines ---------------------------------------------------------------- */

static void cast_line(void *of, int64_t y, int worker) {
    const snow_raycast_pass *pass = of;
    const snow_job *job = pass->job;
    size_t width = (size_t)job->view->width, line = (size_t)y * width;
    size_t channels = (size_t)job->channels;
    snow_raycast_eye eye, layers[SNOW_LAYERS_MAX];
    memset(&eye, 0, sizeof eye);
    for (int n = 0; n < pass->layer_count; n++)
        memset(&layers[n], 0, sizeof *layers);
    eye.shader = pass->shader;
    eye.layers = layers;
    for (size_t x = 0; x < width; x++) {
        float *pixel = job->pixels + (line + x) * channels;
        float *depth = job->depths ? job->depths + line + x : NULL;
        snow_ray ray;
        double viewer[3];
        if (snow_monitor_look(job->context->monitor, worker))
            return;
        if (pass->cut && pixel[channels - 1] > 0) /* met by a part in front */
            continue;
        if (!make_ray(pass, (double)x + 0.5, (double)y + 0.5, &ray, viewer))
            continue;
        if (job->placement.perspective)
            snow_shader_turn(&eye.shader, viewer);
        pass->cast(pass, &ray, &eye, pixel, depth);
    }
}

/* --- a picture ------------------------------------------------------------ */

static double longest_step(const snow_volume_info *info, snow_quality quality) {
    const double *s = info->spacing;
    double least = fmin(fmin(s[0], s[1]), s[2]);
    return least / (quality == SNOW_QUALITY_DRAFT  ? 2
                    : quality == SNOW_QUALITY_HIGH ? 16
                                                   : 4);
}

/* How much values fall off at a border of a mask, by their range; of one value
 * anything does.  Those of logarithms are decimal. */
static void set_border(snow_raycast_pass *pass, double range) {
    if (pass->field.volume->masked)
        pass->field.border =
            range > 0 ? range * (pass->field.log ? 3.3219280948873623 : 1) : 1;
}

static void choose_cast(const snow_picture *p, snow_raycast_pass *pass) {
    const snow_identity_transfer *identity = &p->frame->identity;
    snow_mode mode = p->job.settings.mode;
    double range = identity->high - identity->low;
    pass->visible[0] = -INFINITY;
    pass->visible[1] = INFINITY;
    if (mode == SNOW_MODE_OVER) {
        pass->cast = snow_raycast_over;
        snow_raycast_see_look(pass);
    } else if (mode == SNOW_MODE_ISO) {
        pass->cast = snow_raycast_iso;
        set_border(pass, range);
        pass->visible[0] = pass->isovalue;
    } else {
        pass->cast = mode == SNOW_MODE_MIP || mode == SNOW_MODE_MINIP
                         ? snow_raycast_largest
                         : snow_raycast_sum;
        range = range > 0 ? range : 1;
        pass->from = identity->kind.inverted ? identity->high : identity->low;
        pass->range = identity->kind.inverted ? -range : range;
    }
}

static void set_part(snow_raycast_pass *pass) {
    const snow_volume *volume = pass->job->volume;
    const snow_extent *part = &volume->part;
    pass->cut = volume->is_part;
    for (int axis = 0; pass->cut && axis < 3; axis++) {
        pass->own[axis][0] = part->first[axis];
        pass->own[axis][1] = part->first[axis] + part->count[axis] - 1;
    }
}

static void set_colors(snow_raycast_pass *pass) {
    double rgb[3];
    pass->isovalue = pass->job->settings.iso;
    snow_transfer_color(pass->transfer, pass->isovalue, rgb);
    for (int n = 0; n < 3; n++)
        pass->rgb[n] = (float)rgb[n];
}

/* In mode over: whether a mask has left holes, and the range. */
static snow_status find_border(snow_raycast_pass *pass) {
    const snow_volume *volume = pass->field.volume;
    const snow_scale scale = {pass->field.log, pass->field.linear};
    snow_data_range range;
    if (!pass->shaded || pass->labels || !volume->masked)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_data_range_measure(volume, scale, pass->job->settings.threads,
                                     &range));
    if (range.holes)
        set_border(pass, range.high - range.low);
    return SNOW_STATUS_OK;
}

/* What is a volume's own. */
static snow_status prepare_field(const snow_picture *p, const snow_job *job,
                                 const snow_volume *volume,
                                 const snow_transfer *transfer,
                                 snow_raycast_pass *pass) {
    const snow_settings *s = &p->job.settings;
    bool over = s->mode == SNOW_MODE_OVER;
    *pass = (snow_raycast_pass){
        .job = job,
        .transfer = transfer,
        .shaded = s->shade == SNOW_SHADE_PHONG,
        .gradient_factors =
            over && snow_transfer_has_gradient_opacity(transfer),
        .labels = over && snow_transfer_has_labels(transfer, &volume->info),
        .nearest = s->quality == SNOW_QUALITY_DRAFT,
        .step = longest_step(&volume->info, s->quality),
    };
    SNOW_TRY(snow_field_make(volume, transfer, s, !over, &pass->field));
    if (over)
        SNOW_TRY(find_border(pass));
    SNOW_TRY(snow_shader_init(job->context, volume, &job->placement, s,
                              &pass->shader));
    snow_clip_viewer(&job->placement, &pass->viewer);
    for (int axis = 0; axis < 3; axis++)
        pass->viewer.eye[axis] -= (double)pass->field.stored[axis];
    set_colors(pass);
    choose_cast(p, pass);
    return SNOW_STATUS_OK;
}

static snow_status prepare(const snow_picture *p, const snow_job *job,
                           snow_raycast_pass *pass, snow_raycast_pass *layers) {
    SNOW_TRY(prepare_field(p, job, job->volume, p->job.transfer, pass));
    for (int n = 0; n < job->layer_count; n++) {
        SNOW_TRY(prepare_field(p, job, job->layers[n].volume,
                               job->layers[n].transfer, &layers[n]));
        layers[n].mixes = job->layers[n].mixes;
    }
    pass->layers = layers;
    pass->layer_count = job->layer_count;
    set_part(pass);
    double of[4];
    snow_depth_place(pass->job, of);
    to_axes(&pass->job->placement, of, pass->depth);
    pass->depth[3] = of[3];
    return SNOW_STATUS_OK;
}

static snow_status cast_rays(snow_picture *p, snow_job *job) {
    snow_raycast_pass pass, layers[SNOW_LAYERS_MAX];
    double mark = snow_seconds();
    SNOW_TRY(prepare(p, job, &pass, layers));
    snow_monitor_next(job->context->monitor, SNOW_STAGE_RENDER, 0, 1);
    SNOW_TRY(snow_parallel(job->context, job->settings.threads,
                           job->view->height, cast_line, &pass));
    job->stats->seconds_splat += snow_seconds() - mark;
    return SNOW_STATUS_OK;
}

/* Nothing is encoded; the voxels that a look shows are counted all the same. */
static snow_status find_figures(snow_picture *p, snow_job *job) {
    const snow_settings *s = &p->job.settings;
    SNOW_TRY(snow_job_finish(p->frame, job));
    job->stats->quality = s->quality;
    if (s->mode == SNOW_MODE_ISO)
        SNOW_TRY(snow_identity_transfer_above(job, &p->frame->identity));
    SNOW_TRY(snow_count_interesting(
        job->volume,
        s->mode == SNOW_MODE_OVER ? job->transfer : p->frame->identity.transfer,
        s->mode == SNOW_MODE_OVER ? s->threshold : 0, s->isa, s->threads,
        &job->stats->interesting));
    job->stats->sparse_ratio =
        1 - (double)job->stats->interesting / (double)job->stats->voxels;
    return SNOW_STATUS_OK;
}

const snow_render_method snow_method_raycast = {
    .splat_and_composite = cast_rays,
    .figures = find_figures,
    .depths = true,
};
