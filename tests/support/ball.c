/* tests/support/ball.c - see ball.h. */
#include "support/ball.h"

#include "decompose/partition.h"

#include <math.h>

const int64_t support_ball_dims[3] = {72, 60, 80};
static const double middle[3] = {28, 33, 51};
#define RADIUS 13

/* How deep in the ball a voxel lies; below 0: in the air. */
static double depth_of(const int64_t at[3]) {
    double square = 0;
    for (int i = 0; i < 3; i++)
        square += ((double)at[i] - middle[i]) * ((double)at[i] - middle[i]);
    return RADIUS - sqrt(square);
}

static double value_of(const int64_t at[3], uint64_t *seed, bool hole) {
    const double depth = depth_of(at);
    const double noise = support_uniform(seed);
    if (depth < 0)
        return floor(20 + 20 * noise);
    return hole && depth > RADIUS - 2 ? (double)NAN
                                      : floor(90 + 9 * depth + 20 * noise);
}

static void write_voxels(char *to, snow_type type) {
    const int64_t *dims = support_ball_dims;
    const size_t size = snow_type_size(type);
    uint64_t seed = 5;
    int64_t at[3];
    for (at[2] = 0; at[2] < dims[2]; at[2]++)
        for (at[1] = 0; at[1] < dims[1]; at[1]++)
            for (at[0] = 0; at[0] < dims[0]; at[0]++, to += size) {
                const double value =
                    value_of(at, &seed, type == SNOW_TYPE_FLOAT32);
                const uint8_t byte = isnan(value) ? 0 : (uint8_t)value;
                const int16_t word = (int16_t)(-10 * byte);
                const float real = (float)(value / 7);
                memcpy(to,
                       type == SNOW_TYPE_UINT8   ? (const void *)&byte
                       : type == SNOW_TYPE_INT16 ? (const void *)&word
                                                 : (const void *)&real,
                       size);
            }
}

const char *support_ball_put(support_files *place, snow_type type) {
    const int64_t *dims = support_ball_dims;
    char *voxels =
        malloc((size_t)(dims[0] * dims[1] * dims[2]) * snow_type_size(type));
    assert_non_null(voxels);
    write_voxels(voxels, type);
    snow_volume_info info;
    snow_volume_info_init(&info);
    memcpy(info.dims, dims, sizeof info.dims);
    info.type = type;
    info.slope = type == SNOW_TYPE_INT16     ? -0.1
                 : type == SNOW_TYPE_FLOAT32 ? 7
                                             : 1;
    snow_volume *volume;
    assert_int_equal(snow_volume_wrap(place->context, &info, voxels, &volume),
                     SNOW_STATUS_OK);
    const char *path = support_path(place, "ball.nii");
    assert_int_equal(snow_volume_save(volume, path, true), SNOW_STATUS_OK);
    snow_volume_close(volume);
    free(voxels);
    return path;
}

/* --- what a rank must store ----------------------------------------------- */

/* Voxels first .. end - 1 along an axis. */
typedef struct interval {
    int64_t first, end;
} interval;

static interval widen(interval a, int64_t by, interval within) {
    a.first = a.first - by > within.first ? a.first - by : within.first;
    a.end = a.end + by < within.end ? a.end + by : within.end;
    return a;
}

/* The bounding box of the ball's voxels in a box. */
static bool bound_ball(const interval in[3], interval out[3]) {
    bool any = false;
    int64_t at[3];
    for (at[2] = in[2].first; at[2] < in[2].end; at[2]++)
        for (at[1] = in[1].first; at[1] < in[1].end; at[1]++)
            for (at[0] = in[0].first; at[0] < in[0].end; at[0]++) {
                if (depth_of(at) < 0)
                    continue;
                for (int i = 0; i < 3; i++) {
                    if (!any || at[i] < out[i].first)
                        out[i].first = at[i];
                    if (!any || at[i] >= out[i].end)
                        out[i].end = at[i] + 1;
                }
                any = true;
            }
    return any;
}

snow_box support_ball_stored(const snow_volume *volume,
                             const int64_t layers[3]) {
    const snow_left_out *left = &volume->left_out;
    snow_box stored = {{0, 0, 0}, {1, 1, 1}};
    interval all[3], own[3], near[3], ball[3] = {{0, 0}, {0, 0}, {0, 0}};
    for (int i = 0; i < 3; i++) {
        all[i] = (interval){0, support_ball_dims[i]};
        own[i] = (interval){left->box.first[i],
                            left->box.first[i] + left->box.count[i]};
        near[i] = widen(own[i], left->ring[i], all[i]);
    }
    if (!snow_box_voxels(&left->box) || !bound_ball(near, ball))
        return stored;
    for (int i = 0; i < 3; i++) {
        ball[i] = widen(ball[i], left->ring[i], own[i]);
        if (ball[i].first >= ball[i].end)
            return (snow_box){{0, 0, 0}, {1, 1, 1}};
        ball[i] = widen(ball[i], layers[i], all[i]);
        stored.first[i] = ball[i].first;
        stored.count[i] = ball[i].end - ball[i].first;
    }
    return stored;
}
