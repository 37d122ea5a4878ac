/* light.h - what pictures of several channels, and slices with an overlay, are
 * made of, here and in the Python package. */
#ifndef PICTURE_LIGHT_H
#define PICTURE_LIGHT_H

#include <snowglass/ranks.h>

/* Adds the light of a picture, of which a share counts, to that of another,
 * which is made if it is not there.  After the last one light is at most what
 * is covered.  Errors: no memory. */
snow_status light_add(snow_context *context, const snow_image *one,
                      double share, snow_image **sum);
void light_limit(snow_image *sum);

/* Red, green and blue of a map from black to one colour; false: of another. */
bool light_of_colormap(size_t index, double rgb[3]);

/* What opacities of an overlay are multiplied by in a slice: those of sheets
 * say little of a single one.  `asked`: some are; a factor (below 0: none) is
 * the most that it covers. */
double light_cover(const snow_transfer *transfer, bool asked, double factor,
                   bool outline);

/* Lays slice `index` of an overlay over the picture of a slice, which is
 * replaced; with `outline` the borders of its parts alone. */
snow_status light_lay_slice(snow_context *context, const snow_volume *volume,
                            const snow_transfer *transfer, double cover,
                            bool outline, int64_t index, const snow_view *view,
                            const snow_settings *settings, snow_image **image);

/* Other opacities than those of a look: `points` unless it is NULL, times a
 * factor; of the volume, or of what ranks (comm unless NULL) have parts of.
 * Points beyond LIGHT_POINTS are left out. */
#define LIGHT_POINTS 256
snow_status light_fade(snow_comm *comm, const snow_transfer *look,
                       const snow_volume *volume, double factor,
                       const snow_opacity_point *points, size_t count,
                       snow_transfer **out);

#endif
