/* classify/shear_warp/labels.h - volumes of labels for shear-warp:
 * quantized values that name things and are never interpolated. */
#ifndef SNOW_CLASSIFY_SHEAR_WARP_LABELS_H
#define SNOW_CLASSIFY_SHEAR_WARP_LABELS_H

#include "classify/shear_warp/table.h"

/* The most labels of a volume. */
#define SNOW_VALUE_LABELS_MOST (SNOW_VALUE_MOST + 1)

/* What a label looks like. */
typedef struct snow_label_look {
    double rgb[3], opacity; /* straight; of the reference length */
    double step;            /* alpha of a step of a whole slab */
} snow_label_look;

typedef struct snow_value_labels {
    double *names; /* data values, rising; label n is names[n] */
    int count;
    snow_label_look *looks; /* of each */
    int steps;              /* of a slab */
    double exponent;        /* length of a step, in reference lengths */
} snow_value_labels;

/* The first name that is not below a value. */
int snow_value_label_of(const double *names, int count, double value);

/* Adds a label, or those of a volume, to a set that may be empty.  Errors:
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_BAD_USAGE (too many). */
snow_status snow_value_labels_name(snow_context *context,
                                   snow_value_labels *labels, double value);
snow_status snow_value_labels_add(const snow_volume *volume,
                                  snow_value_labels *labels);

/* Their looks; the table is one of labels then, which has transparent intervals
 * and no entries.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_labels_look(snow_context *context,
                                   const snow_value_look *look,
                                   snow_value_labels *labels,
                                   snow_value_table *table);

void snow_value_labels_fini(snow_context *context, snow_value_labels *labels);

#endif
