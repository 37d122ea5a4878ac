/* base/record.h - the initialisers of records that grow at their end
 * (snowglass/extend.h). */
#ifndef SNOW_BASE_RECORD_H
#define SNOW_BASE_RECORD_H

#include <snowglass/extend.h>

/* Defines the initialiser of a record whose defaults are zeros. */
#define SNOW_RECORD_OF_ZEROS(record)                      \
    void record##_init_sized(record *made, size_t size) { \
        snow_record_init(made, size, NULL, sizeof *made); \
    }                                                     \
    struct record

#endif
