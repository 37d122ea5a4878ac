/* parallel/fit_object.h - which voxels a frame is to hold: those that can be
 * seen in the picture, but for specks beside the object (docs/model.md, section
 * 2). */
#ifndef SNOW_PARALLEL_FIT_OBJECT_H
#define SNOW_PARALLEL_FIT_OBJECT_H

#include "classify/count_interesting.h"
#include "transform/transform.h"

#include <stdatomic.h>

/* Opacities by blocks of voxels, whose sides are about alike in the world. */
typedef struct snow_fit_object {
    snow_context *context;
    const snow_volume_info *whole;
    int64_t block[3], blocks[3]; /* voxels of one; blocks */
    double unit;                 /* of sums, of an opacity of 1 */
    atomic_uint_least32_t *sums; /* of the opacities of blocks */
    unsigned char *kept;         /* blocks that are in the frame */
    double length;               /* of the world, of an opacity */
} snow_fit_object;

/* For the voxels of the whole, which must stay.  Free in any case.  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_fit_object_make(snow_context *context,
                                 const snow_volume_info *whole, double length,
                                 snow_fit_object *out);
void snow_fit_object_free(snow_fit_object *object);

/* Adds the opacities of a row; several threads may do so at once. */
void snow_fit_object_add(snow_fit_object *object,
                         const snow_interesting_row *row);

/* Collective, unless `comm` is NULL.  Keeps what can be seen before a camera,
 * besides what is kept already.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_fit_object_see(snow_fit_object *object, snow_comm *comm,
                                const snow_camera *camera);

/* Leaves out entries at both ends of a row; returns whether any is kept. */
bool snow_fit_object_trim(const snow_fit_object *object,
                          const snow_interesting_row *row, size_t *first,
                          size_t *last);

#endif
