/* io/npy_header.h - the header of a NumPy array file, for pictures and volumes.
 *
 * Follows the description in numpy/lib/format.py, versions 1 to 3:
 *
 *   \x93NUMPY  major minor  header length (2 bytes; 4 from version 2 on)
 *   {'descr': '<f4', 'fortran_order': False, 'shape': (480, 640, 4), }  \n
 *   values, the last index fastest, or the first in Fortran order
 *
 * The header is a Python literal of this form, with keys in any order. */
#ifndef SNOW_IO_NPY_HEADER_H
#define SNOW_IO_NPY_HEADER_H

#include "io/source.h"

/* The values begin at a multiple of this, so that they can be mapped. */
#define NPY_ALIGNMENT 64

#define NPY_MOST_AXES 5

/* The contents of a header; `keys` has a bit for each key found. */
typedef struct npy_header {
    char type[8]; /* NumPy's, such as "<f4" */
    bool fortran_order;
    int64_t shape[NPY_MOST_AXES];
    int axes; /* may exceed NPY_MOST_AXES: further ones are not stored */
    unsigned keys;
} npy_header;

/* Refuses the file; returns SNOW_STATUS_BAD_INPUT. */
snow_status snow_npy_fail(snow_source *source, const char *reason);

bool snow_npy_probe(const unsigned char *bytes, size_t size);

/* Reads the file up to the first value. Errors: SNOW_STATUS_BAD_INPUT. */
snow_status snow_npy_read_header(snow_source *source, npy_header *header);

#endif
