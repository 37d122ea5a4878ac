/* formats/index/xdmf.h - the parts of the XDMF reader, private to xdmf*.c:
 * xdmf_text.c makes the wanted step of the XML, xdmf.c the volume of that. */
#ifndef SNOW_FORMATS_INDEX_XDMF_H
#define SNOW_FORMATS_INDEX_XDMF_H

#include "formats/index/index.h"

#define XDMF_TEXT_BYTES 512
#define XDMF_MOST_ITEMS 3
#define XDMF_MOST_AXES 5
#define XDMF_MOST_PARTS 65536 /* of a step */

/* Where numbers are. */
typedef struct xdmf_item {
    char text[XDMF_TEXT_BYTES]; /* a file or, in XML, the numbers */
    bool hdf, binary, xml, big_endian;
    snow_type type;
    int64_t seek;
    size_t numbers; /* in XML: their place among all texts */
    size_t length;
    int axes;                        /* of a HyperSlab of it; 0: the whole */
    int64_t slab[3][XDMF_MOST_AXES]; /* first, step, count; slowest first */
} xdmf_item;

/* A grid, from its topology and geometry. */
typedef struct xdmf_grid {
    bool known, rectilinear; /* known: a kind that can be read */
    char kind[64];
    int64_t points[3]; /* x first */
    char geometry[32];
    xdmf_item items[XDMF_MOST_ITEMS];
    int item_count;
} xdmf_grid;

/* An array of a step, or of a part of one. */
typedef struct xdmf_step {
    xdmf_grid grid;
    int64_t step;
    double time;
    char name[64];
    bool cells, vector, found;
    xdmf_item item; /* the first one of those that are joined */
    xdmf_item parts[XDMF_MOST_ITEMS]; /* components */
    int joined;
} xdmf_step;

typedef struct xdmf_file {
    snow_source *source;
    snow_context *context;
    const snow_volume_options *options;
    xdmf_step now;    /* the grid that is read */
    xdmf_step kept;   /* the step that is wanted */
    xdmf_step *parts; /* the grids of it, side by side */
    size_t part_count;
    int64_t steps;
    uint64_t collections; /* a bit of each Grid that is open: it is one */
    uint64_t spaces;      /* and one in space */
    double space_time;    /* of the one in space */
    bool loose, timed;    /* some collection does not say of what; any times */
    bool in_geometry, in_attribute, in_times, in_item, in_slab, joins;
    int slab_axes; /* of the HyperSlab that is read; 0: not yet known */
    int64_t slab[3][XDMF_MOST_AXES];
    bool even_times; /* of a collection: first, step, count; else one each */
    xdmf_item times; /* length 0: none */
    char attribute[64];
    int64_t attributes; /* in all grids */
    bool cells, vector;
    xdmf_item item;
    char seen[512];
    char *numbers; /* texts of numbers in XML */
    size_t used;
} xdmf_file;

/* Compares with a word in small letters, whatever the case of the text; a text
 * may be NULL. */
bool snow_xdmf_is(const char *text, const char *word);

/* Reads the XML to its end.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_xdmf_parse(xdmf_file *f);

#endif
