/* annotations.h - overlays that are drawn when pictures are written:
 * orientation letters unless --no-labels, the bars of --legend, the step of
 * --annotate. */
#ifndef ANNOTATIONS_H
#define ANNOTATIONS_H

#include "measure/measures.h"
#include "picture/channels.h"

/* All that the overlays depend on, except the frame.  Several threads may read
 * it at once; the transfer function must outlive it. */
typedef struct picture_annotations {
    const options *opts;
    snow_volume_info info;
    snow_view view;
    const snow_transfer *transfer;
    double range[2]; /* the range that mean and sum are painted over; both 0:
                        none */
    const channel_set *channels;  /* instead of that look; NULL: none */
    const snow_transfer *overlay; /* of layers_legend, or NULL */
    const measures *measures;     /* or NULL */
    int axis;                     /* of the grid, that a slice lies across, */
    const int64_t *index;         /* and its number; NULL: it is no slice */
    snow_status (*more)(const void *user, snow_overlay *overlay);
    const void *user; /* of `more`, which draws what is of several slices, or is
                         NULL; the title keeps off that */
} picture_annotations;

/* Refuses annotations for files of floats, which cannot show them.  Returns
 * CONTINUE or an exit code. */
int annotations_check(const options *opts);

/* The share of the width that the view is to leave to the legend. */
double annotations_strip(const picture_annotations *annotations);

/* Makes the overlay for a picture from an azimuth; NULL if nothing is drawn.
 * `step` is a time step, or -1; the image, which may be NULL and must outlive
 * the overlay, hides edges of the box.  Error messages go to the context. */
snow_status annotations_make(const picture_annotations *annotations,
                             double azimuth, int64_t step,
                             const snow_image *image, snow_context *context,
                             snow_overlay **out);

/* Notes in `whole` that values are Hounsfield units where they say so and the
 * file says nothing, if a legend wants to know.  Collective, if the volume is
 * one of the `parts` of several ranks. */
void annotations_find_unit(const options *opts, const snow_volume *volume,
                           bool parts, snow_volume_info *whole);

/* Reports the parts that a legend lacks. */
void annotations_report(const options *opts);

#endif
