/* tests/values/modes.c - the value model's other modes, and labels.
 *
 * docs/model.md, the value model, points 10 and 11. */
#include "values/value_model.h"

#include <math.h>
#include <string.h>

/* --- labels --------------------------------------------------------------- */

/* What each label has at both ends of a slab: its membership, or in draft 1
 * where it is the nearest.  False beside a hole. */
static bool memberships(value_field *field, const value_ray *ray, int slab,
                        int label, double ends[2]) {
    bool nearest =
        field->plan->scene->base.settings.quality == SNOW_QUALITY_DRAFT;
    for (int end = 0; end < 2; end++) {
        double at[3];
        value_ray_at(field->plan, ray, slab + end, at);
        field->member = label;
        int value = nearest ? value_sheet_label(field, slab + end, at[0], at[1])
                            : value_sheet(field, slab + end, at[0], at[1]);
        if (value == VALUE_HOLE)
            return false;
        ends[end] = nearest ? value == label : value;
    }
    return true;
}

/* The label whose membership is the largest at t, of equals the larger one. */
static int winner(const value_field *field, double (*ends)[2], double t) {
    int best = -1;
    double most = 0;
    for (int n = 0; n < field->name_count; n++) {
        double here = ends[n][0] + t * (ends[n][1] - ends[n][0]);
        bool wins = here > most || (here == most && here > 0 && best >= 0 &&
                                    field->names[n] > field->names[best]);
        if (wins) {
            best = n;
            most = here;
        }
    }
    return best;
}

/* Nothing where it is below the threshold. */
static void look_of_label(const value_plan *plan, double name, double rgba[4]) {
    double threshold = plan->scene->base.settings.threshold;
    reference_classify(&plan->scene->base, name, rgba);
    if (threshold > 0 && 255 * rgba[3] <= threshold + 0.0001)
        rgba[3] = 0;
}

bool value_label_slab(value_field *field, const value_ray *ray, int slab,
                      const int part[2], double rgba[4], int *place) {
    const value_plan *plan = field->plan;
    double ends[256][2], share = (part[1] - part[0]) / 32768.0;
    double exponent =
        ray->path * share /
        (plan->steps * reference_opacity_length(&plan->scene->base));
    double places = 0;
    memset(rgba, 0, 4 * sizeof *rgba);
    for (int n = 0; n < field->name_count; n++)
        if (!memberships(field, ray, slab, n, ends[n]))
            return false;
    for (int n = 0; n < plan->steps; n++) {
        double t = part[0] / 32768.0 + share * (n + 0.5) / plan->steps, look[4];
        int label = winner(field, ends, t);
        look_of_label(plan, field->names[label], look);
        double alpha = (1 - rgba[3]) * (1 - pow(1 - look[3], exponent));
        for (int c = 0; c < 3; c++)
            rgba[c] += alpha * look[c];
        rgba[3] += alpha;
        places += alpha * t;
    }
    if (!(rgba[3] > 0))
        return false;
    *place = (int)floor(32768 * places / rgba[3] + 0.5);
    field->member = winner(field, ends, places / rgba[3]);
    return true;
}

/* --- projections and the isosurface --------------------------------------- */

typedef struct ray_summary {
    double most, least, sum, length;
    bool any;
} ray_summary;

/* A kept part of a slab from f to b. */
static void count_slab(ray_summary *sums, double f, double b, double length) {
    sums->most = sums->any ? fmax(sums->most, fmax(f, b)) : fmax(f, b);
    sums->least = sums->any ? fmin(sums->least, fmin(f, b)) : fmin(f, b);
    sums->sum += (f + b) / 2 * length;
    sums->length += length;
    sums->any = true;
}

/* V at both ends of the kept part of a slab; false where there is none. */
static bool slab_ends(const value_field *field, const value_ray *ray, int slab,
                      const int part[2], double ends[2]) {
    int value[2];
    for (int end = 0; end < 2; end++) {
        double at[3];
        value_ray_at(field->plan, ray, slab + end, at);
        value[end] = value_sheet(field, slab + end, at[0], at[1]);
        if (value[end] == VALUE_HOLE)
            return false;
    }
    for (int end = 0; end < 2; end++)
        ends[end] = fmin(fmax(value_between(value[0], value[1], part[end]), 0),
                         VALUE_MOST);
    return true;
}

/* The data value of any V. */
static double data_of(const value_plan *plan, double v) {
    return plan->low + v * (plan->high - plan->low) / VALUE_MOST;
}

static void show_surface(const value_field *field, const value_ray *ray,
                         int slab, int place, double rgba[4]) {
    const value_plan *plan = field->plan;
    double gradient[3];
    reference_classify(&plan->scene->base, plan->scene->base.settings.iso,
                       rgba);
    rgba[3] = 1;
    value_gradient(field, ray, slab, place, gradient);
    value_add_border(field, ray, slab, place, gradient);
    if (plan->scene->base.settings.shade == SNOW_SHADE_PHONG)
        value_shade(plan, ray, gradient, rgba);
}

/* The first place that is not below the surface's value. */
static bool meet_surface(const value_field *field, const value_ray *ray,
                         int slab, const int part[2], const double ends[2],
                         double rgba[4]) {
    const value_plan *plan = field->plan;
    double iso = plan->scene->base.settings.iso, t = 0;
    iso = iso > plan->low
              ? (iso - plan->low) * VALUE_MOST / (plan->high - plan->low) - 1e-4
              : 0;
    if (ends[0] < iso && ends[1] < iso)
        return false;
    if (ends[0] < iso)
        t = (iso - ends[0]) / (ends[1] - ends[0]);
    int place = (int)floor(part[0] + t * (part[1] - part[0]) + 0.5);
    show_surface(field, ray, slab, place, rgba);
    return true;
}

void value_mode_sample(const value_field *field, const value_ray *ray,
                       double out[4]) {
    const value_plan *plan = field->plan;
    snow_mode mode = plan->scene->base.settings.mode;
    ray_summary sums = {0};
    memset(out, 0, 4 * sizeof *out);
    for (int slab = 0; slab + 1 < plan->sheets; slab++) {
        int part[2];
        double ends[2];
        if (!value_cut(plan, ray, slab, part) ||
            !slab_ends(field, ray, slab, part, ends))
            continue;
        if (mode == SNOW_MODE_ISO &&
            meet_surface(field, ray, slab, part, ends, out))
            return;
        count_slab(&sums, ends[0], ends[1],
                   ray->path * (part[1] - part[0]) / 32768);
    }
    if (mode == SNOW_MODE_ISO || !sums.any)
        return;
    double length = reference_opacity_length(&plan->scene->base);
    out[0] = mode == SNOW_MODE_MIP     ? data_of(plan, sums.most)
             : mode == SNOW_MODE_MINIP ? data_of(plan, sums.least)
             : mode == SNOW_MODE_MEAN
                 ? data_of(plan, sums.sum / sums.length)
                 : (plan->low * sums.length +
                    (plan->high - plan->low) * sums.sum / VALUE_MOST) /
                       length;
    out[1] = 1;
}
