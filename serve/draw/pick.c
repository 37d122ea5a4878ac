/* pick.c - implements pick.h by a small picture with depths. */
#include "draw/pick.h"
#include "draw/ranks.h"
#include "draw/small.h"
#include "run/log.h"

#include <math.h>

/* The longer side of the small picture, and how far from the place the object
 * may be, in its pixels. */
#define SIDE 320
#define REACH 2

/* The depth that is nearest to a pixel. */
static double near(const snow_image *depths, int x, int y) {
    int width = snow_image_width(depths), height = snow_image_height(depths);
    const float *at = snow_image_data(depths);
    double best = NAN;
    int least = REACH * REACH + 1;
    for (int v = y - REACH; v <= y + REACH; v++)
        for (int u = x - REACH; u <= x + REACH; u++) {
            int far = (u - x) * (u - x) + (v - y) * (v - y);
            if (u < 0 || v < 0 || u >= width || v >= height || far >= least ||
                isnan(at[v * width + u]))
                continue;
            least = far;
            best = at[v * width + u];
        }
    return best;
}

int pick_depth(drawing *d, double x, double y, const double size[2],
               double *depth) {
    render_state *s = &d->state;
    snow_settings settings = s->settings;
    snow_view view = s->view;
    snow_frame *frame = NULL;
    snow_image *image = NULL;
    double scale = fmin(1, SIDE / fmax(size[0], size[1]));
    *depth = NAN;
    ranks_tell(d, RANKS_DEPTH, json_pack("[f,f,f,f]", x, y, size[0], size[1]));
    if (settings.mode != SNOW_MODE_OVER &&
        (settings.mode != SNOW_MODE_ISO || process_ranks() > 1))
        return CONTINUE;
    settings.depth = true;
    settings.stop = NULL;
    settings.quality = SNOW_QUALITY_DRAFT;
    view.width = (int)fmax(1, rint(scale * size[0]));
    view.height = (int)fmax(1, rint(scale * size[1]));
    snow_status status =
        small_render(d, s->transfer, &view, &settings, &frame, &image);
    if (status == SNOW_STATUS_OK && image)
        *depth = near(snow_frame_depth(frame), (int)(x * view.width),
                      (int)(y * view.height));
    snow_image_free(image);
    snow_frame_free(frame);
    return check_status(s->context, status);
}
