/* formats/hdf5/filters.h - the filters of a data set; for chunks.c. */
#ifndef SNOW_FORMATS_HDF5_FILTERS_H
#define SNOW_FORMATS_HDF5_FILTERS_H

#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

/* The filters of a data set, in the order of writing. */
#define HDF5_MOST_FILTERS 32
#define HDF5_MOST_SETTINGS 16
typedef struct hdf5_filters {
    int count;
    bool foreign; /* there is one that only libhdf5 undoes */
    struct {
        int id;
        unsigned settings[HDF5_MOST_SETTINGS];
        size_t settings_count;
    } all[HDF5_MOST_FILTERS];
} hdf5_filters;

/* Whether a filter is undone without libhdf5. */
bool snow_hdf5_undoes(int id);

/* Returns false if libhdf5 does not describe them, or there are too many. */
bool snow_hdf5_read_filters(hid_t plan, hdf5_filters *out);

/* A chunk: stored at first, unpacked in the end.  Blocks grow as needed, and
 * belong to the caller. */
typedef struct hdf5_packed {
    bool given;           /* the chunk is stored */
    uint32_t mask;        /* bit i: filter i was not used */
    unsigned char *bytes; /* `size` of them */
    uint64_t size;
    unsigned char *scratch;
    const char *fault; /* what is wrong with it; NULL if nothing is */
    snow_status status;
} hdf5_packed;

/* Undoes the filters of a stored chunk that unpacks to at least `bytes`, which
 * sets bytes, size (at least `bytes`), fault and status.  At a foreign filter
 * it ends, if the chunk is as long as that filter's header says.  May be called
 * by several threads, with chunks of their own. */
void snow_hdf5_unpack(snow_context *context, const hdf5_filters *filters,
                      uint64_t bytes, hdf5_packed *packed);

#endif
#endif
