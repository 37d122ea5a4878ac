/* splat/separable/coverage.c - see coverage.h. Kernels rise to their middle and
 * fall behind it, so the pixels with enough coverage are one range. */
#include "splat/separable/coverage.h"

/* The first n of 0 .. pixels for which start + n * stride >= at. */
static int first_at(int64_t start, int stride, int64_t at, int pixels) {
    int64_t ahead = at - start;
    int64_t n = ahead > 0 ? (ahead + stride - 1) / stride : 0;
    return n < pixels ? (int)n : pixels;
}

snow_coverage snow_coverage_make(const snow_comb *comb, int phase, int taps,
                                 int64_t first, int stride, int64_t voxels,
                                 int pixels) {
    snow_coverage c = {.start = first + comb->lead[phase],
                       .stride = stride,
                       .taps = taps,
                       .weights = comb->weights[phase],
                       .voxels = voxels};
    c.from = first_at(c.start, stride, 1 - taps, pixels);
    c.in = first_at(c.start, stride, 0, pixels);
    c.out = first_at(c.start, stride, voxels - taps + 1, pixels);
    c.to = first_at(c.start, stride, voxels, pixels);
    return c;
}

float snow_coverage_at(const snow_coverage *c, int n) {
    if (n >= c->in && n < c->out)
        return 1;
    int64_t voxel = c->start + (int64_t)n * c->stride;
    float sum = 0;
    for (int m = 0; m < c->taps; m++, voxel++)
        if (voxel >= 0 && voxel < c->voxels)
            sum += c->weights[m];
    return sum;
}

void snow_coverage_range(const snow_coverage *c, float least, int range[2]) {
    int from = c->from, to = c->to;
    while (from < to && snow_coverage_at(c, from) < least)
        from++;
    while (from < to && snow_coverage_at(c, to - 1) < least)
        to--;
    range[0] = from;
    range[1] = to;
}
