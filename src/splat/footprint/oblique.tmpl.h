/* splat/footprint/oblique.tmpl.h - the inner loops of splatting where a voxel's
 * footprint is a parallelogram.  Define before including:
 *
 *   SPLAT_CHANNELS       floats of a sample and of a pixel: 2 or 4
 *   SPLAT_WEIGHT(s,u,v)  weight at (u, v) voxels from the centre, splatter s
 *   SPLAT_ROW            name of the function
 *   SPLAT_SCATTER        name of its helper
 *
 * All are undefined at the end.  As in splat/footprint/aligned.tmpl.h, every
 * method and encoding uses these loops, in the order of the voxels. */

/* Adds one voxel whose centre is at pixel position (x, y). Positions are
 * doubles up to the computation of the distance from the centre, which is
 * small. */
static inline void SPLAT_SCATTER(const snow_splatter *splatter,
                                 snow_sheet *sheet, double x, double y,
                                 const float *sample) {
    const snow_oblique_axis *u = &splatter->oblique_u;
    const snow_oblique_axis *v = &splatter->oblique_v;
    const float step_u = (float)u->step, step_v = (float)v->step;
    int line = snow_first_pixel(y - splatter->reach[1], sheet->height);
    int bottom = snow_last_pixel(y + splatter->reach[1], sheet->height);
    line = line > sheet->top ? line : sheet->top;
    bottom = bottom < sheet->bottom ? bottom : sheet->bottom - 1;
    for (; line <= bottom; line++) {
        double dy = line + 0.5 - y;
        double middle_u = u->lean * dy, middle_v = v->lean * dy;
        double from = SNOW_MAX(middle_u - u->extent, middle_v - v->extent);
        double to = SNOW_MIN(middle_u + u->extent, middle_v + v->extent);
        int first = snow_first_pixel(x + from, sheet->width);
        int last = snow_last_pixel(x + to, sheet->width);
        double dx = first + 0.5 - x;
        const float at_u = (float)(u->step * dx + u->rise * dy);
        const float at_v = (float)(v->step * dx + v->rise * dy);
        float *pixel = sheet->pixels +
                       ((size_t)(line - sheet->top) * (size_t)sheet->width +
                        (size_t)first) *
                           SPLAT_CHANNELS;
        for (int i = 0; i <= last - first; i++, pixel += SPLAT_CHANNELS) {
            float weight = SPLAT_WEIGHT(splatter, at_u + (float)i * step_u,
                                        at_v + (float)i * step_v);
            for (int c = 0; c < SPLAT_CHANNELS; c++)
                pixel[c] += weight * sample[c];
        }
    }
}

static void SPLAT_ROW(const snow_splatter *splatter, snow_sheet *sheet,
                      int64_t row, const snow_span *spans, size_t count,
                      const float *samples) {
    const snow_placement *p = splatter->placement;
    double x = splatter->origin[0] + (double)row * p->step_v[0];
    double y = splatter->origin[1] + (double)row * p->step_v[1];
    for (size_t s = 0; s < count; s++) {
        int64_t end = (int64_t)spans[s].column + spans[s].length;
        for (int64_t column = spans[s].column; column < end; column++) {
            SPLAT_SCATTER(splatter, sheet, x + (double)column * p->step_u[0],
                          y + (double)column * p->step_u[1], samples);
            samples += SPLAT_CHANNELS;
        }
    }
}

#undef SPLAT_CHANNELS
#undef SPLAT_WEIGHT
#undef SPLAT_ROW
#undef SPLAT_SCATTER
