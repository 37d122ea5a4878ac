/* splat/shear_warp/labels.c - slabs of labels, sample by sample: each
 * label has a membership, 1 in its voxels, which is interpolated; the largest
 * wins. */
#include "splat/shear_warp/scratch.h"

#include <math.h>
#include <string.h>

/* Voxels around the samples of both ends of a slab. */
#define AROUND 16

/* A slab of a sample: its labels, and what they have at both ends. */
typedef struct label_slab {
    const snow_value_splat *splat;
    value_sample at;
    double longer; /* than the table's way */
    value_spot ends[2];
    int labels[AROUND], count;
    int member[AROUND][2];
} label_slab;

/* --- membership ----------------------------------------------------------- */

static int code_of(const snow_value_store *s, int64_t i, int64_t j, int64_t k) {
    return s->values[snow_value_at(s, k)[j] + i];
}

static int64_t clamp(int64_t i, int64_t count) {
    return i < 0 ? 0 : i < count ? i : count - 1;
}

/* Of a voxel of a slice, beyond the box by the odd reflection. */
static int slice_member(const snow_value_store *s, int label, int64_t i,
                        int64_t j, int64_t k) {
    int64_t u = clamp(i, s->columns), v = clamp(j, s->rows);
    int here = code_of(s, u, v, k) == label ? SNOW_VALUE_MOST : 0;
    if (u == i && v == j)
        return here;
    /* The voxel inside of the one at a side. */
    if (u != i)
        u = s->columns == 1 ? 0 : i < 0 ? 1 : s->columns - 2;
    else
        v = s->rows == 1 ? 0 : j < 0 ? 1 : s->rows - 2;
    return 2 * here - (code_of(s, u, v, k) == label ? SNOW_VALUE_MOST : 0);
}

static int member_at(const snow_value_store *s, int label,
                     const value_spot *at) {
    int row[2];
    const int64_t k = at->resampled->slice;
    for (int y = 0; y < 2; y++) {
        int ends[2];
        for (int x = 0; x < 2; x++) {
            const int64_t i = at->i + x, j = at->j + y;
            ends[x] = slice_member(s, label, i, j, k);
            if (at->resampled->between)
                ends[x] =
                    value_toward(ends[x], slice_member(s, label, i, j, k + 1),
                                 at->resampled->toward);
        }
        row[y] = value_between(ends[0], ends[1], at->wu);
    }
    return value_between(row[0], row[1], at->wv);
}

/* --- gradients ------------------------------------------------------------ */

/* What voxels of a row that have a label weigh, and how that grows.  None is
 * beyond the grid; one that is not stored has none that is seen. */
static void add_row(const snow_value_store *s, int label, const value_bell *u,
                    int64_t row, int64_t slice, double out[2]) {
    out[0] = out[1] = 0;
    if (row < 0 || row >= s->rows || slice < 0 || slice >= s->slices)
        return;
    const int64_t *at = snow_value_at(s, slice) + row;
    const int32_t *ends =
        s->ends[slice * (s->rows + 2 * s->margin) + s->margin + row];
    for (int n = 0; n < u->taps; n++)
        if (u->at[n] >= ends[0] && u->at[n] < ends[1] && u->at[n] >= 0 &&
            u->at[n] < s->columns && s->values[*at + u->at[n]] == label) {
            out[0] += u->weight[n];
            out[1] += u->slope[n];
        }
}

/* Of a smooth membership, at a place of a slab. */
static void find_slopes(const label_slab *slab, int label, int place,
                        value_queue *q, int count) {
    const snow_value_store *s = slab->splat->store;
    double at[3], back[3], sums[3] = {0, 0, 0};
    value_place_of(&slab->ends[0], at);
    value_place_of(&slab->ends[1], back);
    for (int axis = 0; axis < 3; axis++)
        at[axis] += place / 32768.0 * (back[axis] - at[axis]);
    const value_bell u = value_bell_at(at[0], s->columns, VALUE_BELL_MOST);
    const value_bell v = value_bell_at(at[1], s->rows, VALUE_BELL_MOST);
    const value_bell w = value_bell_at(at[2], s->slices, VALUE_BELL_MOST);
    for (int n = 0; n < w.taps * v.taps; n++) {
        const int y = n % v.taps, z = n / v.taps;
        double row[2];
        add_row(s, label, &u, v.at[y], w.at[z], row);
        sums[0] += w.weight[z] * v.weight[y] * row[1];
        sums[1] += w.weight[z] * v.slope[y] * row[0];
        sums[2] += w.slope[z] * v.weight[y] * row[0];
    }
    for (int axis = 0; axis < 3; axis++)
        q->slopes[axis][count] =
            (int16_t)floor(2 * SNOW_VALUE_MOST * sums[axis] + 0.5);
}

/* --- labels of a slab ----------------------------------------------------- */

static void add_label(label_slab *slab, int label) {
    for (int n = 0; n < slab->count; n++)
        if (slab->labels[n] == label)
            return;
    slab->labels[slab->count++] = label;
}

/* In draft a resampled slice has the label of the nearest voxel. */
static int nearest(const snow_value_store *s, const value_spot *at) {
    return code_of(s, clamp(at->i + (at->wu >= 16384), s->columns),
                   clamp(at->j + (at->wv >= 16384), s->rows),
                   at->resampled->slice);
}

static void find_labels(label_slab *slab) {
    const snow_value_store *s = slab->splat->store;
    bool draft = slab->splat->labels_nearest;
    slab->count = 0;
    for (int end = 0; end < 2; end++) {
        const value_spot *at = &slab->ends[end];
        for (int n = 0; n < (at->resampled->between ? 8 : 4) && !draft; n++)
            add_label(slab, code_of(s, clamp(at->i + n % 2, s->columns),
                                    clamp(at->j + n / 2 % 2, s->rows),
                                    at->resampled->slice + n / 4));
        if (draft)
            add_label(slab, nearest(s, at));
    }
    for (int n = 0; n < slab->count; n++)
        for (int end = 0; end < 2; end++)
            slab->member[n][end] =
                draft ? (nearest(s, &slab->ends[end]) == slab->labels[n]) *
                            SNOW_VALUE_MOST
                : slab->count == 1
                    ? SNOW_VALUE_MOST
                    : member_at(s, slab->labels[n], &slab->ends[end]);
}

/* The label whose membership is the largest at t, of equals the larger one; -1:
 * none, where holes have more than half. */
static int winner(const label_slab *slab, double t) {
    int best = -1;
    double most = 0;
    for (int n = 0; n < slab->count; n++) {
        const int *ends = slab->member[n];
        double here = ends[0] + t * (ends[1] - ends[0]);
        if (slab->labels[n] == SNOW_VALUE_HOLE) {
            if (2 * here > SNOW_VALUE_MOST)
                return -1;
        } else if (here > most || (here == most && here > 0 && best >= 0 &&
                                   slab->labels[n] > best)) {
            best = slab->labels[n];
            most = here;
        }
    }
    return best;
}

/* --- colours -------------------------------------------------------------- */

/* The part of a slab that is inside. */
typedef struct label_part {
    double from, share;
} label_part;

/* What a sample collects; *t: where its opacity lies. */
static void collect(const label_slab *slab, label_part part, double rgba[4],
                    double *t) {
    const snow_value_labels *labels = slab->splat->labels;
    double places = 0;
    memset(rgba, 0, 4 * sizeof *rgba);
    for (int n = 0; n < labels->steps; n++) {
        double at = part.from + part.share * (n + 0.5) / labels->steps;
        int label = winner(slab, at);
        if (label < 0 || !(labels->looks[label].step > 0))
            continue;
        const snow_label_look *look = &labels->looks[label];
        double share = part.share * slab->longer;
        double alpha =
            share == 1
                ? look->step
                : -expm1(share * labels->exponent * log1p(-look->opacity));
        alpha *= 1 - rgba[3];
        for (int c = 0; c < 3; c++)
            rgba[c] += alpha * look->rgb[c];
        rgba[3] += alpha;
        places += alpha * at;
    }
    *t = rgba[3] > 0 ? places / rgba[3] : 0;
}

/* Whether there is anything to see. */
static bool is_seen(const label_slab *slab) {
    for (int n = 0; n < slab->count; n++)
        if (slab->labels[n] != SNOW_VALUE_HOLE &&
            slab->splat->labels->looks[slab->labels[n]].step > 0)
            return true;
    return false;
}

/* Packs a sample as number `count`, if it is seen. */
static bool pack(label_slab *slab, label_part part, value_queue *q, int count,
                 bool sloped) {
    double rgba[4], t;
    find_labels(slab);
    if (!is_seen(slab))
        return false;
    collect(slab, part, rgba, &t);
    for (int c = 0; c < 4; c++)
        q->color[c][count] =
            (int16_t)(rgba[c] * slab->splat->table->full + 0.5);
    if (!q->color[3][count])
        return false;
    int place = (int)floor(32768 * t + 0.5);
    q->place[count] = (int16_t)(place < INT16_MAX ? place : INT16_MAX);
    if (sloped)
        find_slopes(slab, winner(slab, t), place, q, count);
    return true;
}

/* --- a phase of a slab ---------------------------------------------------- */

static label_part part_of(const value_slab *slab, int row, int lane) {
    const value_cut *cut = slab->cut;
    const value_clip *clip = &slab->clip;
    int from = 0, to = INT16_MAX;
    if (cut[0].cuts) {
        from = cut[0].from[lane];
        to = cut[0].to[lane];
    }
    if (cut[1].cuts) {
        from = from > cut[1].from[row] ? from : cut[1].from[row];
        to = to < cut[1].to[row] ? to : cut[1].to[row];
    }
    if (clip->cuts) {
        from = from > clip->from[row][lane] ? from : clip->from[row][lane];
        to = to < clip->to[row][lane] ? to : clip->to[row][lane];
    }
    to = to == INT16_MAX ? 32768 : to;
    return (label_part){from / 32768.0, (to - from) / 32768.0};
}

/* Its length, in that of the table. */
static double way_of(const snow_value_rays *rays, float slope[2][2],
                     const int16_t ray[2]) {
    const float *m = rays->metric;
    double u = slope[0][0] + (double)slope[0][1] * ray[0];
    double v = slope[1][0] + (double)slope[1][1] * ray[1];
    return rays->usual * sqrt(m[0] * u * u + m[1] * v * v + m[2] +
                              m[3] * u * v + m[4] * u + m[5] * v);
}

int snow_value_collect_labels(const snow_value_splat *p, int n, int phase,
                              const int tile[2], float slope[2][2],
                              value_slab *slab, value_queue *q, int count,
                              bool sloped) {
    label_slab sample = {
        .splat = p, .at = {p, n, phase, 0, 0, tile}, .longer = 1};
    for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
        int row = __builtin_ctz(rows);
        uint32_t seen = 0;
        for (uint32_t left = slab->active[row]; left; left &= left - 1) {
            int lane = __builtin_ctz(left);
            label_part part = part_of(slab, row, lane);
            sample.at.row = row;
            sample.at.lane = lane;
            for (int end = 0; end < 2; end++)
                sample.ends[end] = value_spot_of(&sample.at, end);
            if (p->rays) {
                int16_t ray[2];
                /* The ray of a sample, in phases from the tile's first cell. */
                const snow_value_rays *rays = sample.at.splat->rays;
                const uint8_t *own = rays->spot[sample.at.phase];
                ray[0] = (int16_t)(sample.at.lane * rays->phases[0] + own[0]);
                ray[1] = (int16_t)(sample.at.row * rays->phases[1] + own[1]);
                q->ray[0][count] = ray[0];
                q->ray[1][count] = ray[1];
                sample.longer = way_of(p->rays, slope, ray);
            }
            if (part.share > 0 && pack(&sample, part, q, count, sloped)) {
                seen |= UINT32_C(1) << lane;
                count++;
            }
        }
        slab->active[row] = seen;
    }
    return count;
}
