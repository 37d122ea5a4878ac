/* splat/shear_warp/cut.c - slabs at the volume's sides, of which a ray
 * crosses a part only. */
#include "base/minmax.h"
#include "base/vec3.h"
#include "splat/shear_warp/scratch.h"
#include "transform/clip.h"

#include <math.h>
#include <string.h>

/* Narrows [t[0], t[1]] to where from + t (to - from) <= most. */
static void keep_below(double from, double to, double most, double t[2]) {
    double rest = most - from, way = to - from;
    if (rest >= 0 && to <= most)
        return;
    double at = rest / way;
    if (way == 0)
        t[1] = -1;
    else if (way > 0)
        t[1] = at < t[1] ? at : t[1];
    else
        t[0] = at > t[0] ? at : t[0];
}

static int16_t part_of(double t) {
    int part = t <= 0 ? 0 : t >= 1 ? 32767 : (int)(32768 * t + 0.5);
    return (int16_t)(part < 32767 ? part : 32767);
}

/* Of lanes at line[0] + n line[1], which rise, the first of 32 that is not
 * below `least`; 32: all are. */
static int first_lane(const double line[2], double least) {
    if (line[0] >= least)
        return 0;
    if (!(line[0] + 31 * line[1] >= least))
        return 32;
    int n = (int)((least - line[0]) / line[1]);
    while (n > 0 && line[0] + (n - 1) * line[1] >= least)
        n--;
    while (!(line[0] + n * line[1] >= least))
        n++;
    return n;
}

/* How many of them, from the first on, are not above `most`. */
static int end_lane(const double line[2], double most) {
    if (line[0] + 31 * line[1] <= most)
        return 32;
    if (!(line[0] <= most))
        return 0;
    int n = (int)((most - line[0]) / line[1]) + 1;
    while (n > 0 && !(line[0] + (n - 1) * line[1] <= most))
        n--;
    while (line[0] + n * line[1] <= most)
        n++;
    return n;
}

static uint32_t lanes_between(int first, int end) {
    uint64_t bits = first < end ? (UINT64_C(1) << end) - 1 : 0;
    return (uint32_t)(bits >> first << first);
}

void snow_value_cut(const double front[2], const double back[2], double low,
                    double high, value_cut *out) {
    out->cuts =
        !(front[0] >= low && back[0] >= low &&
          front[0] + 31 * front[1] <= high && back[0] + 31 * back[1] <= high);
    out->some = ~UINT32_C(0);
    out->parts = 0;
    if (!out->cuts)
        return;
    int first[2] = {first_lane(front, low), first_lane(back, low)};
    int end[2] = {end_lane(front, high), end_lane(back, high)};
    uint32_t whole =
        lanes_between(SNOW_MAX(first[0], first[1]), SNOW_MIN(end[0], end[1]));
    uint32_t parts =
        lanes_between(SNOW_MIN(first[0], first[1]), SNOW_MAX(end[0], end[1])) &
        ~whole;
    for (int n = 0; n < 32; n++) {
        out->from[n] = 0;
        out->to[n] = whole >> n & 1 ? INT16_MAX : 0;
    }
    out->some = whole;
    for (out->parts = parts; parts; parts &= parts - 1) {
        int n = __builtin_ctz(parts);
        double t[2] = {0, 1};
        double from = front[0] + n * front[1], to = back[0] + n * back[1];
        keep_below(from, to, high, t);
        keep_below(-from, -to, -low, t);
        out->from[n] = part_of(t[0]);
        out->to[n] = t[1] > t[0] ? part_of(t[1]) : 0;
        out->some |= (uint32_t)(out->to[n] > out->from[n]) << n;
    }
}

/* Whether all lanes of all rows of a tile are so far within a plane (1), beyond
 * that (-1) or neither. */
static int side_of(const double plane[4], double within, const double at[4]) {
    double height = plane[0] * at[0] + plane[1] * at[1] + plane[2] * at[2];
    double u = 31 * at[3] * plane[0], v = 31 * at[3] * plane[1];
    double most = height + fmax(0, u) + fmax(0, v);
    double least = height + fmin(0, u) + fmin(0, v);
    double end = plane[3] - within;
    return most <= end ? 1 : least > end ? -1 : 0;
}

/* Narrows the parts of all samples to those within a plane. */
static void clip_by(const double plane[4], const double front[4],
                    const double back[4], double (*parts)[32][2]) {
    double from = 0, to = 0;
    for (int axis = 0; axis < 3; axis++) {
        from += plane[axis] * front[axis];
        to += plane[axis] * back[axis];
    }
    for (int row = 0; row < SNOW_VALUE_ROWS; row++)
        for (int n = 0; n < 32; n++) {
            double aside = plane[0] * n + plane[1] * row;
            keep_below(from + aside * front[3], to + aside * back[3], plane[3],
                       parts[row][n]);
        }
}

static void store_parts(double (*parts)[32][2], value_clip *out) {
    for (int row = 0; row < SNOW_VALUE_ROWS; row++) {
        out->some[row] = 0;
        for (int n = 0; n < 32; n++) {
            const double *t = parts[row][n];
            int16_t from = part_of(t[0]), to = t[1] > t[0] ? part_of(t[1]) : 0;
            out->from[row][n] = from;
            out->to[row][n] = to;
            out->some[row] |= (uint32_t)(to > from) << n;
        }
    }
}

void snow_value_clip(const snow_value_splat *p, const double front[4],
                     const double back[4], value_clip *out) {
    double parts[SNOW_VALUE_ROWS][32][2];
    out->cuts = out->flat = false;
    memcpy(out->front, front, sizeof out->front);
    memcpy(out->back, back, sizeof out->back);
    for (size_t plane = 0; plane < p->clip_count; plane++) {
        const double *clip = p->clips[plane];
        int sides[2] = {side_of(clip, 0, front), side_of(clip, 0, back)};
        double reach = 2 * SNOW_FLAT_DEPTH * snow_length(clip);
        out->flat |= side_of(clip, reach, front) <= 0;
        if (sides[0] > 0 && sides[1] > 0)
            continue;
        for (int row = 0; !out->cuts && row < SNOW_VALUE_ROWS; row++)
            for (int n = 0; n < 32; n++) {
                parts[row][n][0] = 0;
                parts[row][n][1] = 1;
            }
        out->cuts = true;
        if (sides[0] < 0 && sides[1] < 0) {
            memset(out->some, 0, sizeof out->some);
            return;
        }
        clip_by(clip, front, back, parts);
    }
    if (out->cuts)
        store_parts(parts, out);
}

/* --- cut faces ------------------------------------------------------------ */

/* How much of the light at a place of a slab is theirs. */
static double flatness(const snow_value_splat *p, const value_clip *at, int row,
                       int lane, double place) {
    const double aside[2] = {lane, row};
    double front[3], way[3], flat = 0;
    for (int axis = 0; axis < 3; axis++) {
        front[axis] = at->front[axis];
        way[axis] = at->back[axis] - front[axis];
        if (axis < 2) {
            front[axis] += aside[axis] * at->front[3];
            way[axis] += aside[axis] * (at->back[3] - at->front[3]);
        }
    }
    for (size_t n = 0; n < p->clip_count; n++) {
        const double *clip = p->clips[n];
        double deeper = -snow_dot(clip, way);
        double slabs = place + (clip[3] - snow_dot(clip, front)) / deeper;
        if (deeper > 0)
            flat = fmax(flat, 2 - slabs * snow_length(way) / SNOW_FLAT_DEPTH);
    }
    return fmin(flat, 1);
}

void snow_value_flatten(const snow_value_splat *p, const value_slab *slabs,
                        int phases, value_queue *q) {
    const double one = p->light->bright ? 16384 : INT16_MAX;
    int n = 0;
    for (const value_slab *slab = slabs; slab < slabs + phases; slab++)
        for (uint32_t rows = slab->rows; rows; rows &= rows - 1) {
            const int row = __builtin_ctz(rows);
            uint32_t left = slab->active[row];
            for (; left; left &= left - 1, n++) {
                if (!slab->clip.flat)
                    continue;
                double flat = flatness(p, &slab->clip, row, __builtin_ctz(left),
                                       q->place[n] / 32768.0);
                q->light[n] += (int16_t)(flat * (one - q->light[n]));
                q->white[n] -= (int16_t)(flat * q->white[n]);
            }
        }
}

/* --- parts ---------------------------------------------------------------- */

/* As a bit of 32, or beyond all. */
static int lane_of(double place) {
    return place > 0 ? place < 32 ? (int)place : 32 : 0;
}

/* The same in perspective, from lane `skip` on. */
static uint32_t spread_within(const double own[2], int64_t stored,
                              const snow_value_lanes *lanes, int skip) {
    uint32_t within = 0;
    for (int n = 0; n < 32; n++) {
        double place = (double)(stored + lanes->first + lanes->at[n + skip]) +
                       lanes->weight[n + skip] * 0x1p-15;
        within |= (uint32_t)(place >= own[0] && place < own[1]) << n;
    }
    return within;
}

/* Borders are found from the lane alone, so that two who share one agree. */
uint32_t snow_value_own_lanes(const snow_value_splat *p, int n, int phase,
                              const int tile[2], int axis) {
    int64_t first =
        axis ? value_tile_row(p, tile[1]) : value_tile_column(p, tile[0]);
    if (!p->rays) { /* lanes whose places are within the part */
        const double at = p->places[n * p->phases + phase].at[axis];
        const uint64_t one = 1;
        int from = lane_of(ceil(p->own[axis][0] - at) - (double)first);
        int to = lane_of(ceil(p->own[axis][1] - at) - (double)first);
        return to > from ? (uint32_t)((one << to) - (one << from)) : 0;
    }
    return spread_within(p->own[axis], p->rays->stored[axis],
                         value_lanes_of(p->rays, n, phase, axis, tile[axis]),
                         axis);
}

void snow_value_shorten(const snow_value_table *table, value_queue *q,
                        int count, int channels) {
    for (int n = 0; n < count; n++) {
        float alpha = (float)q->color[3][n] * table->unit;
        if (q->part[n] == INT16_MAX || !(alpha > 0))
            continue;
        float part = (float)q->part[n] * 0x1p-15F;
        float share = value_lengthen(table, alpha, part) / alpha;
        for (int c = channels == 2 ? 3 : 0; c < 4; c++)
            q->color[c][n] = (int16_t)((float)q->color[c][n] * share + 0.5F);
        if (channels == 2)
            q->color[0][n] = (int16_t)((float)q->color[0][n] * share + 0.5F);
    }
}

/* Beyond the queue there are zeros. */
void snow_value_meet(const snow_value_surface *surface, const value_queue *q,
                     int n, bool cuts, int16_t places[32]) {
    for (int i = 0; i < 32; i++) {
        float front = q->front[n + i], back = q->back[n + i];
        float from = 0, part = 32768, t = 0;
        if (cuts) {
            from = q->from[n + i];
            part = q->part[n + i] == INT16_MAX ? 32768 : q->part[n + i];
        }
        if (front < surface->at && back > front)
            t = (surface->at - front) / (back - front);
        places[i] = (int16_t)fminf(floorf(from + t * part + 0.5F), INT16_MAX);
    }
}
