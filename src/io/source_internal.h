/* io/source_internal.h - the record of a source; for source*.c, filters.c and
 * seekable.c only. */
#ifndef SNOW_IO_SOURCE_INTERNAL_H
#define SNOW_IO_SOURCE_INTERNAL_H

#include "io/filters/filter.h"
#include "io/source.h"

struct snow_source {
    snow_context *context;
    char *name;             /* in the same block */
    snow_filter_stage *top; /* top filter stage, which is read from */
    int depth;              /* of files that led here by name */
    snow_open_named_fn *opener;
    bool siblings; /* other files can be opened by name */
    bool moved;    /* one of them was not where the name says, as a note says */
};

#endif
