/* tests/support/ball.h - a ball in air with noise, for parts that lack what a
 * look shows nothing of, and what such parts must hold. */
#ifndef SNOW_TEST_SUPPORT_BALL_H
#define SNOW_TEST_SUPPORT_BALL_H

#include "support/files.h"
#include "volume/volume.h"

/* Of the volume; air is 20 to 40, the ball 90 to 230. */
extern const int64_t support_ball_dims[3];

/* Writes it into a file of bytes, of words with a negative slope, or of floats
 * with a shell of NaN in the ball; the path lasts as support_path's. */
const char *support_ball_put(support_files *place, snow_type type);

/* What a rank must store: of its box (volume->left_out) the bounding box of the
 * ball's voxels within the ring around it, widened by the ring within the box,
 * and so many layers more, within the volume.  Nothing: one voxel. */
snow_box support_ball_stored(const snow_volume *volume,
                             const int64_t layers[3]);

#endif
