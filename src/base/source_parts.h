/* base/source_parts.h - what a source consists of; for source*.c alone. */
#ifndef SNOW_SOURCE_PARTS_H
#define SNOW_SOURCE_PARTS_H

#include "base/layer.h"
#include "base/source.h"

struct snow_source {
    snow_context *context;
    char *name;      /* in the same block */
    snow_layer *top; /* the layer that is read from */
    bool siblings;   /* other files can be reached by name */
};

#endif
