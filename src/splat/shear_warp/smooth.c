/* splat/shear_warp/smooth.c - see smooth.h. */
#include "splat/shear_warp/smooth.h"

#include "splat/shear_warp/scratch.h"

value_spot value_spot_of(const value_sample *at, int end) {
    const snow_value_splat *p = at->splat;
    const int n = at->slab + end, phase = at->phase;
    if (!p->rays) {
        const snow_value_place *place = p->places + n * p->phases + phase;
        return (value_spot){
            p->resampled_slices + n,
            value_tile_column(p, at->tile[0]) + at->lane + place->whole[0],
            value_tile_row(p, at->tile[1]) + at->row + place->whole[1],
            place->weight[0], place->weight[1]};
    }
    const snow_value_lanes *u =
        value_lanes_of(p->rays, n, phase, 0, at->tile[0]);
    const snow_value_lanes *v =
        value_lanes_of(p->rays, n, phase, 1, at->tile[1]);
    return (value_spot){p->resampled_slices + n, u->first + u->at[at->lane],
                        v->first + v->at[at->row + 1], u->weight[at->lane],
                        v->weight[at->row + 1]};
}

void value_place_of(const value_spot *spot, double out[3]) {
    const snow_resampled_slice *resampled = spot->resampled;
    out[0] = (double)spot->i + spot->wu / 32768.0;
    out[1] = (double)spot->j + spot->wv / 32768.0;
    out[2] = (double)resampled->slice + resampled->at - floor(resampled->at);
}

value_bell value_bell_at(double place, int64_t count, int reach) {
    value_bell bell = {.taps = 2 * reach};
    place = count == 1 ? 0 : place; /* along which nothing changes */
    double first = floor(place) - reach + 1;
    for (int n = 0; n < bell.taps; n++) {
        double way = place - (first + n), x = fabs(way) / reach;
        bell.at[n] = (int64_t)first + n;
        bell.weight[n] = (1 - x * x * (3 - 2 * x)) / reach;
        bell.slope[n] = (way < 0 ? 6 : -6) * x * (1 - x) / (reach * reach);
    }
    return bell;
}
