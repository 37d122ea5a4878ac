/* splat/footprint/perspective.c - footprints in perspective, pixel by pixel. */
#include "splat/footprint/perspective.h"

#include <math.h>

/* Pixels from (x0, y0) up to, but not including, (x1, y1). */
typedef struct frame_of_pixels {
    int x0, y0, x1, y1;
} frame_of_pixels;

static void follow_rays(const snow_placement *p, snow_pixel_ray *rays) {
    for (int y = 0; y < p->height; y++)
        for (int x = 0; x < p->width; x++, rays++) {
            double ray[3];
            snow_perspective_ray(&p->eye, x + 0.5, y + 0.5, ray);
            rays->slope[0] = ray[0] / ray[2];
            rays->slope[1] = ray[1] / ray[2];
            rays->side = ray[2] > 0 ? 1 : -1;
            if (!isfinite(rays->slope[0]) || !isfinite(rays->slope[1]))
                *rays = (snow_pixel_ray){{0, 0}, 0};
        }
}

snow_status snow_perspective_splatter_init(snow_context *context,
                                           const snow_placement *p,
                                           snow_kernel kernel, int support,
                                           int channels,
                                           snow_perspective_splatter *out) {
    uint64_t pixels = (uint64_t)p->width * (uint64_t)p->height;
    snow_perspective_splatter s = {.placement = p,
                                   .kernel = kernel,
                                   .support = support,
                                   .channels = channels};
    SNOW_TRY(SNOW_RESERVE(context, s.rays, 0, pixels));
    follow_rays(p, s.rays);
    *out = s;
    return SNOW_STATUS_OK;
}

void snow_perspective_splatter_fini(snow_context *context,
                                    snow_perspective_splatter *s) {
    snow_release(context, s->rays);
    snow_release(context, s->table[0].cells);
    snow_release(context, s->table[1].cells);
    *s = (snow_perspective_splatter){0};
}

/* The kernel along one axis, and its table. */
static snow_status widen_kernel(snow_context *context,
                                snow_perspective_splatter *s, int axis,
                                double width) {
    snow_scaled_kernel scaled_kernel =
        snow_scaled_kernel_make(s->kernel, s->support, width);
    s->scaled_kernel[axis] = scaled_kernel;
    if (s->kernel == SNOW_KERNEL_BOX)
        return SNOW_STATUS_OK;
    return snow_scaled_kernel_table_make(context, &scaled_kernel,
                                         &s->table[axis]);
}

snow_status snow_perspective_splatter_begin_slice(snow_context *context,
                                                  snow_perspective_splatter *s,
                                                  int64_t slice, bool *seen) {
    double width[2];
    s->height = (double)slice - s->placement->eye.at[2];
    *seen = fabs(s->height) > SNOW_EDGE_ON;
    if (!*seen)
        return SNOW_STATUS_OK;
    snow_perspective_pixel_width(s->placement, (double)slice, width);
    SNOW_TRY(widen_kernel(context, s, 0, width[0]));
    return widen_kernel(context, s, 1, width[1]);
}

/* The pixels that a footprint can reach: those of the quadrangle of its
 * corners, or all if one of these is not in front of the camera. */
static frame_of_pixels reach_of(const snow_perspective_splatter *s,
                                const snow_sheet *sheet, double u, double v) {
    const snow_perspective *eye = &s->placement->eye;
    double reach_u = snow_scaled_kernel_reach(&s->scaled_kernel[0]);
    double reach_v = snow_scaled_kernel_reach(&s->scaled_kernel[1]);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int corner = 0; corner < 4; corner++) {
        double step[3] = {u + (corner & 1 ? reach_u : -reach_u) - eye->at[0],
                          v + (corner & 2 ? reach_v : -reach_v) - eye->at[1],
                          s->height};
        double pixel[2];
        if (!snow_perspective_sees(eye, step, pixel))
            return (frame_of_pixels){0, 0, sheet->width, sheet->height};
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], pixel[i]);
            high[i] = fmax(high[i], pixel[i]);
        }
    }
    return (frame_of_pixels){snow_first_pixel(low[0], sheet->width),
                             snow_first_pixel(low[1], sheet->height),
                             snow_last_pixel(high[0], sheet->width) + 1,
                             snow_last_pixel(high[1], sheet->height) + 1};
}

/* The weight at distance t along an axis; 0 outside the kernel. */
static inline float weight_at(const snow_perspective_splatter *s, int axis,
                              double t) {
    const snow_scaled_kernel *scaled_kernel = &s->scaled_kernel[axis];
    if (!snow_scaled_kernel_covers(scaled_kernel, t))
        return 0;
    return scaled_kernel->kernel == SNOW_KERNEL_BOX
               ? snow_scaled_kernel_box(scaled_kernel, t)
               : snow_scaled_kernel_look_up(&s->table[axis], (float)t);
}

/* Adds one voxel's footprint to the sheet. */
static void scatter_voxel(const snow_perspective_splatter *s, snow_sheet *sheet,
                          double u, double v, const float *sample) {
    frame_of_pixels f = reach_of(s, sheet, u, v);
    const double *eye = s->placement->eye.at;
    double from_u = eye[0] - u, from_v = eye[1] - v;
    if (f.x0 >= f.x1 || f.y0 >= f.y1)
        return;
    sheet->x0 = f.x0 < sheet->x0 ? f.x0 : sheet->x0;
    sheet->y0 = f.y0 < sheet->y0 ? f.y0 : sheet->y0;
    sheet->x1 = f.x1 > sheet->x1 ? f.x1 : sheet->x1;
    sheet->y1 = f.y1 > sheet->y1 ? f.y1 : sheet->y1;
    for (int y = f.y0; y < f.y1; y++) {
        size_t at = (size_t)y * (size_t)sheet->width + (size_t)f.x0;
        float *pixel = sheet->pixels + at * (size_t)s->channels;
        const snow_pixel_ray *ray = s->rays + at;
        for (int x = f.x0; x < f.x1; x++, ray++, pixel += s->channels) {
            if (!(ray->side * s->height > 0))
                continue;
            float weight = weight_at(s, 0, from_u + s->height * ray->slope[0]);
            if (!(weight > 0))
                continue;
            weight *= weight_at(s, 1, from_v + s->height * ray->slope[1]);
            for (int c = 0; c < s->channels; c++)
                pixel[c] += weight * sample[c];
        }
    }
}

void snow_perspective_splat_row(const snow_perspective_splatter *s,
                                snow_sheet *sheet, int64_t row,
                                const snow_span *spans, size_t count,
                                const float *samples) {
    for (size_t n = 0; n < count; n++) {
        int64_t end = (int64_t)spans[n].column + spans[n].length;
        for (int64_t column = spans[n].column; column < end; column++) {
            scatter_voxel(s, sheet, (double)column, (double)row, samples);
            samples += s->channels;
        }
    }
}
