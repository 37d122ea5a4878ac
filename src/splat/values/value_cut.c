/* splat/values/value_cut.c - slabs at the volume's sides, of which a ray
 * crosses a part only. */
#include "splat/values/value_room.h"

#include <math.h>

/* Narrows [t[0], t[1]] to where from + t (to - from) <= most. */
static void keep_below(double from, double to, double most, double t[2]) {
    double rest = most - from, way = to - from;
    if (way > 0)
        t[1] = fmin(t[1], rest / way);
    else if (way < 0)
        t[0] = fmax(t[0], rest / way);
    else if (rest < 0)
        t[1] = -1;
}

static int16_t part_of(double t) {
    int part = (int)floor(32768 * fmin(fmax(t, 0), 1) + 0.5);
    return (int16_t)(part < 32767 ? part : 32767);
}

void snow_value_cut(double front, double back, double low, double high,
                    value_cut *out) {
    out->cuts = !(front >= low && back >= low && front + 31 <= high &&
                  back + 31 <= high);
    out->some = ~UINT32_C(0);
    if (!out->cuts)
        return;
    out->some = 0;
    for (int n = 0; n < 32; n++) {
        double t[2] = {0, 1};
        keep_below(front + n, back + n, high, t);
        keep_below(-front - n, -back - n, -low, t);
        out->from[n] = part_of(t[0]);
        out->to[n] = t[1] > t[0] ? part_of(t[1]) : 0;
        out->some |= (uint32_t)(out->to[n] > out->from[n]) << n;
    }
}

void snow_value_shorten(value_queue *q, int count, int channels) {
    for (int n = 0; n < count; n++) {
        float alpha = (float)q->color[3][n] * (1.0F / 32767);
        if (q->part[n] == INT16_MAX || !(alpha > 0))
            continue;
        float part = (float)q->part[n] * 0x1p-15F;
        float share = (1 - powf(1 - alpha, part)) / alpha;
        for (int c = channels == 2 ? 3 : 0; c < 4; c++)
            q->color[c][n] = (int16_t)((float)q->color[c][n] * share + 0.5F);
        if (channels == 2)
            q->color[0][n] = (int16_t)((float)q->color[0][n] * share + 0.5F);
    }
}
