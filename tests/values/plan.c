/* tests/values/plan.c - the value model's choices.
 *
 * docs/model.md, the value model, points 1 and 8, and what the table is made
 * for: sheets, lattice, range of values, warp. */
#include "values/value_model.h"

#include <math.h>

double value_sheet_at(const value_plan *plan, int sheet) {
    return plan->first + plan->direction * (double)sheet / plan->per_slice;
}

/* --- the lattice ---------------------------------------------------------- */

void value_lattice_front(const value_plan *plan, double a, double b,
                         double front[2]) {
    double u = a, v = b;
    if (plan->quincunx) {
        u = (a + b) / 2;
        v = (a - b) / 2;
    }
    front[0] = u / plan->cells[0];
    front[1] = v / plan->cells[1];
}

void value_lattice_of(const value_plan *plan, const double front[2],
                      double ab[2]) {
    double u = front[0] * plan->cells[0], v = front[1] * plan->cells[1];
    ab[0] = plan->quincunx ? u + v : u;
    ab[1] = plan->quincunx ? u - v : v;
}

/* How far the world moves where an index position moves. */
static double world_length(const value_plan *plan, const double step[3]) {
    double sum = 0;
    for (int r = 0; r < 3; r++) {
        double part = 0;
        for (int c = 0; c < 3; c++)
            part += plan->scene->base.info.matrix[r][plan->axis[c]] * step[c];
        sum += part * part;
    }
    return sqrt(sum);
}

value_ray value_ray_of(const value_plan *plan, double front_u, double front_v) {
    value_ray ray = {.front = {front_u, front_v}};
    for (int n = 0; n < 2; n++)
        ray.slope[n] = plan->perspective ? (ray.front[n] - plan->eye[n]) /
                                               (plan->first - plan->eye[2])
                                         : plan->slope[n];
    double step[3] = {ray.slope[0], ray.slope[1], 1};
    double length = world_length(plan, step);
    ray.path = length / plan->per_slice;
    for (int n = 0; n < 3; n++)
        ray.eye[n] = -plan->direction * step[n] / length;
    return ray;
}

void value_ray_at(const value_plan *plan, const value_ray *ray, double sheet,
                  double at[3]) {
    double p = plan->direction * sheet / plan->per_slice;
    at[0] = ray->front[0] + p * ray->slope[0];
    at[1] = ray->front[1] + p * ray->slope[1];
    at[2] = plan->first + p;
}

/* Pixels a voxel: along the finer in-plane spacing, in perspective at the
 * volume's middle. */
static double pixels_a_voxel(const value_plan *plan) {
    const reference_scene *scene = &plan->scene->base;
    double pitch = plan->camera.pitch;
    if (plan->perspective) {
        double index[3], world[3], depth = plan->camera.distance;
        for (int n = 0; n < 3; n++)
            index[n] = (double)(scene->info.dims[n] - 1) / 2;
        for (int r = 0; r < 3; r++) {
            world[r] = scene->info.matrix[r][3] - plan->camera.target[r];
            for (int c = 0; c < 3; c++)
                world[r] += scene->info.matrix[r][c] * index[c];
            depth -= world[r] * plan->camera.back[r];
        }
        pitch *= depth / plan->camera.distance;
    }
    return fmin(plan->length[0], plan->length[1]) / pitch;
}

static void choose_lattice(value_plan *plan) {
    double pixels = pixels_a_voxel(plan);
    int each = 1;
    switch (plan->scene->base.settings.quality) {
    case SNOW_QUALITY_DRAFT:
        break;
    case SNOW_QUALITY_HIGH:
        each = pixels < 1 - 1e-6 ? 2 : 4;
        break;
    case SNOW_QUALITY_NORMAL:
        plan->quincunx = pixels >= 1 - 1e-6 && pixels <= sqrt(2) + 1e-6;
        each = pixels > sqrt(2) + 1e-6 ? 2 : 1;
    }
    int fine = plan->length[0] <= plan->length[1] ? 0 : 1;
    double ratio = plan->length[!fine] / plan->length[fine];
    plan->cells[fine] = each;
    plan->cells[!fine] = each << (int)rint(log2(ratio));
}

bool value_lattice_at(const value_plan *plan, double x, double y,
                      double ab[2]) {
    reference_ray ray =
        reference_ray_at(&plan->scene->base, &plan->camera, x, y);
    const int *axis = plan->axis;
    double t = (plan->first - ray.start[axis[2]]) / ray.step[axis[2]];
    double front[2] = {ray.start[axis[0]] + t * ray.step[axis[0]],
                       ray.start[axis[1]] + t * ray.step[axis[1]]};
    value_lattice_of(plan, front, ab);
    return isfinite(t) && (!plan->perspective || t > 0);
}

/* Lattice pixels a pixel where the volume's middle is seen: the longer of the
 * ways that both lattice positions go. */
static double density(const value_plan *plan) {
    const double bit = 1e-3;
    double middle[3], pixel[2], ab[4][2] = {{0}};
    for (int n = 0; n < 3; n++)
        middle[n] = (double)(plan->scene->base.info.dims[n] - 1) / 2;
    reference_project(&plan->scene->base, &plan->camera, middle, pixel);
    for (int n = 0; n < 4; n++)
        value_lattice_at(plan,
                         pixel[0] + (n == 0   ? -bit
                                     : n == 1 ? bit
                                              : 0),
                         pixel[1] + (n == 2   ? -bit
                                     : n == 3 ? bit
                                              : 0),
                         ab[n]);
    double most = 0;
    for (int n = 0; n < 2; n++)
        most = fmax(most, hypot(ab[1][n] - ab[0][n], ab[3][n] - ab[2][n]) /
                              (2 * bit));
    return most;
}

static void choose_warp(value_plan *plan) {
    double pixels = density(plan);
    bool wide = 1 / pixels_a_voxel(plan) > 1.5;
    plan->warp = plan->scene->base.settings.quality == SNOW_QUALITY_DRAFT
                     ? VALUE_WARP_BILINEAR
                     : VALUE_WARP_CATMULL_ROM;
    if (!wide || !(pixels > 1.5))
        return;
    plan->warp = VALUE_WARP_MEAN;
    plan->halvings = 0;
    for (; pixels > 16; pixels /= 2)
        plan->halvings++;
    plan->mean = (int)ceil(pixels - 1e-6);
}

/* --- sheets --------------------------------------------------------------- */

double value_plan_path(const value_plan *plan) {
    if (!plan->perspective)
        return value_ray_of(plan, 0, 0).path;
    /* The ray of the picture's middle. */
    double ab[2], front[2];
    const snow_view *view = &plan->scene->base.view;
    value_lattice_at(plan, view->width / 2.0, view->height / 2.0, ab);
    value_lattice_front(plan, ab[0], ab[1], front);
    return value_ray_of(plan, front[0], front[1]).path;
}

void value_plan_sheets(value_plan *plan, int per_slice) {
    bool single = plan->dims[2] == 1;
    plan->per_slice = single ? 1 : per_slice;
    plan->sheets = single ? 2 : (int)(plan->dims[2] - 1) * per_slice + 1;
    plan->first = single                ? -plan->direction / 2.0
                  : plan->direction > 0 ? 0
                                        : (double)plan->dims[2] - 1;
    plan->path = value_plan_path(plan);
}

/* As few sheets a slice as are no farther apart than they may be. */
static int sheets_per_slice(const value_plan *plan) {
    snow_quality quality = plan->scene->base.settings.quality;
    double ratio = plan->length[2] / fmin(plan->length[0], plan->length[1]);
    double most = quality == SNOW_QUALITY_DRAFT ? 12 : 1.5;
    int least = 1;
    if (quality == SNOW_QUALITY_HIGH ||
        (quality == SNOW_QUALITY_NORMAL && pixels_a_voxel(plan) >= 4 - 1e-6))
        least = 2;
    for (int n = least; n < 16; n *= 2)
        if (ratio / n <= most * (1 + 1e-9))
            return n;
    return 16;
}

static bool choose_sheets(value_plan *plan) {
    reference_ray ray = reference_ray_at(&plan->scene->base, &plan->camera,
                                         plan->scene->base.view.width / 2.0,
                                         plan->scene->base.view.height / 2.0);
    plan->direction = ray.step[plan->axis[2]] > 0 ? 1 : -1;
    plan->perspective = plan->camera.distance > 0;
    for (int n = 0; n < 2; n++)
        plan->slope[n] = ray.step[plan->axis[n]] / ray.step[plan->axis[2]];
    for (int n = 0; n < 3; n++)
        plan->eye[n] = ray.start[plan->axis[n]];
    double reach = plan->dims[2] == 1 ? 0.5 : 0;
    if (plan->perspective)
        plan->direction = plan->eye[2] < 0 ? 1 : -1;
    if (plan->perspective && plan->eye[2] >= -reach - 1e-6 &&
        plan->eye[2] <= (double)plan->dims[2] - 1 + reach + 1e-6)
        return false;
    value_plan_sheets(plan, sheets_per_slice(plan));
    return true;
}

/* --- values --------------------------------------------------------------- */

static void find_range(value_plan *plan) {
    const int64_t *n = plan->scene->base.info.dims;
    plan->low = INFINITY;
    plan->high = -INFINITY;
    for (int64_t k = 0; k < n[2]; k++)
        for (int64_t j = 0; j < n[1]; j++)
            for (int64_t i = 0; i < n[0]; i++) {
                double x = value_data(plan->scene, (int64_t[]){i, j, k});
                if (!isfinite(x))
                    continue;
                plan->low = fmin(plan->low, x);
                plan->high = fmax(plan->high, x);
            }
}

/* The hull of the values of the data's range that have an opacity. */
static void find_visible(const value_plan *plan, double visible[2]) {
    const reference_scene *scene = &plan->scene->base;
    const snow_opacity_point *p = scene->opacities;
    const snow_color_point *c = scene->colors;
    size_t count = scene->opacity_count;
    double low = INFINITY, high = -INFINITY;
    double first = fmin(p[0].value, c[0].value);
    double last = fmax(p[count - 1].value, c[scene->color_count - 1].value);
    for (size_t n = 0; n <= count; n++) {
        double a = n > 0 ? p[n - 1].value : first;
        double b = n < count ? p[n].value : last;
        if (scene->log) {
            a = log10(a);
            b = log10(b);
        }
        bool seen =
            (n > 0 && p[n - 1].opacity > 0) || (n < count && p[n].opacity > 0);
        if (!seen || a > plan->high || b < plan->low)
            continue;
        low = fmin(low, fmax(a, plan->low));
        high = fmax(high, fmin(b, plan->high));
    }
    visible[0] = low;
    visible[1] = high;
}

/* A look that shows a small part of the range gets the integers for itself. */
static void narrow_range(value_plan *plan) {
    double visible[2];
    find_visible(plan, visible);
    double length = visible[1] - visible[0];
    if (!(length > 0) || length * 64 >= plan->high - plan->low)
        return;
    plan->low = fmax(plan->low, visible[0] - 4 * length);
    plan->high = fmin(plan->high, visible[1] + 4 * length);
}

/* Of integers the ends are some, and `high` is where the rule has 16383. */
static void take_integers(value_plan *plan) {
    const snow_volume_info *info = &plan->scene->base.info;
    const double slope = fabs(info->slope), zero = info->intercept;
    bool log = plan->scene->base.log &&
               plan->scene->base.settings.mode == SNOW_MODE_OVER;
    if (snow_type_size(info->type) > 2 || log || plan->scene->labels ||
        plan->scene->clip_count)
        return;
    double low = floor((plan->low - zero) / slope + 1e-6);
    double high = ceil((plan->high - zero) / slope - 1e-6);
    if (!(high > low))
        return;
    plan->stored = (int)(high - low);
    plan->step = slope;
    value_rule rule = value_rule_of(plan->stored);
    plan->low = low * slope + zero;
    plan->high = plan->low + slope * VALUE_MOST * 32768 * (double)rule.divisor /
                                 ((double)rule.factor * (double)rule.weight);
}

/* The nodes, evenly placed, in which the look's steepest ramp would go from 0
 * to the largest opacity, steps left out. */
static double steepest(const value_plan *plan) {
    const reference_scene *scene = &plan->scene->base;
    double least = INFINITY, most = 0;
    for (size_t n = 0; n < scene->opacity_count; n++)
        most = fmax(most, scene->opacities[n].opacity);
    for (size_t n = 0; n + 1 < scene->opacity_count; n++) {
        const snow_opacity_point *p = &scene->opacities[n];
        double length = scene->log ? log10(p[1].value) - log10(p[0].value)
                                   : p[1].value - p[0].value;
        double rise = fabs(p[1].opacity - p[0].opacity);
        if (rise > 0 && length > 0)
            least = fmin(least, length * most / rise);
    }
    return least / (plan->high - plan->low) * (plan->nodes - 1);
}

static void choose_table(value_plan *plan) {
    bool high = plan->scene->base.settings.quality == SNOW_QUALITY_HIGH;
    plan->nodes = high ? 256 : 129;
    plan->steps = high ? 64 : 16;
    find_range(plan);
    bool over = plan->scene->base.settings.mode == SNOW_MODE_OVER;
    if (over)
        narrow_range(plan);
    take_integers(plan);
    plan->measured = over && steepest(plan) < 4;
}

bool value_plan_of(const value_scene *scene, value_plan *plan) {
    *plan = (value_plan){.scene = scene};
    reference_camera_of(&scene->base, &plan->camera);
    int p = reference_slice_axis(&scene->base, &plan->camera);
    plan->axis[0] = p == 0 ? 1 : 0;
    plan->axis[1] = p == 2 ? 1 : 2;
    plan->axis[2] = p;
    for (int n = 0; n < 3; n++) {
        double column[3];
        for (int r = 0; r < 3; r++)
            column[r] = scene->base.info.matrix[r][plan->axis[n]];
        plan->length[n] = hypot(hypot(column[0], column[1]), column[2]);
        plan->dims[n] = scene->base.info.dims[plan->axis[n]];
    }
    plan->cells[0] = plan->cells[1] = 1;
    choose_table(plan);
    if (!choose_sheets(plan) || !isfinite(plan->low))
        return false;
    choose_lattice(plan);
    choose_warp(plan);
    plan->path = value_plan_path(plan);
    return true;
}
