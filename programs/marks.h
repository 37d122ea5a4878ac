/* marks.h - what is drawn over pictures as they are written: letters of
 * orientation unless --no-labels, the bars of --legend, the step of
 * --time-label. */
#ifndef MARKS_H
#define MARKS_H

#include "options.h"

/* All that they depend on, but for the frame.  May be read by several threads
 * at once; the transfer function must stay. */
typedef struct picture_marks {
    const options *asked;
    snow_volume_info info;
    snow_view view;
    const snow_transfer *transfer;
    double range[2]; /* that mean and sum are painted over, both 0: none */
} picture_marks;

/* Refuses marks for files of floats, which show none.  Answers GO_ON or an exit
 * code. */
int marks_check(const options *asked);

/* The overlay for a picture from an azimuth, NULL where nothing is drawn; of a
 * time step, or -1.  Messages go to the context. */
snow_status marks_make(const picture_marks *marks, double azimuth, int64_t step,
                       snow_context *context, snow_overlay **out);

/* Says what a legend lacks. */
void marks_tell(const options *asked);

#endif
