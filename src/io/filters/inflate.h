/* io/filters/inflate.h - the record of a stage that inflates; for
 * filter_inflate.c and relay.c. */
#ifndef SNOW_IO_INFLATE_H
#define SNOW_IO_INFLATE_H

#include "base/relay.h"
#include "io/filters/filter.h"
#include "io/zlib_memory.h"

/* 15: the largest window; + 32: gzip or zlib, according to the header. */
#define SNOW_ANY_HEADER (15 + 32)

/* inflate says so in data_type: it has stopped between two blocks, and the one
 * before was the member's last. */
#define SNOW_BETWEEN_BLOCKS 128
#define SNOW_LAST_BLOCK 64

typedef struct inflate_filter {
    snow_filter_stage filter;
    z_stream stream;
    bool gzip; /* else zlib, which has one member */
    bool ended;
    /* Of a relay: */
    bool entered; /* in the middle of a member, whose sum is kept here */
    uint32_t check;
    uint64_t member;   /* where it begins, unpacked */
    uint64_t unpacked; /* so far */
    uint64_t wanted;   /* the end of what was read */
} inflate_filter;

/* --- filter_inflate.c --- */

/* Says that the packed data are damaged or truncated. */
snow_status snow_inflate_fail(const inflate_filter *inflater, const char *how);

/* Adds bytes to the sum that ends a member. */
uint32_t snow_inflate_sum(const inflate_filter *inflater,
                          const unsigned char *bytes, size_t count);

/* Unpacks at least one byte and up to `size`, from where it is; *got is 0 at
 * the end only. */
snow_status snow_inflate_bytes(inflate_filter *inflater, void *bytes,
                               size_t size, size_t *got);

/* --- relay.c --- */

/* Takes part in a relay, if that is of this source. */
void snow_relay_join(inflate_filter *inflater, snow_relay *relay);

/* Unpacks what was skipped, from the relay's point on where it lies behind
 * that. */
snow_status snow_relay_catch_up(inflate_filter *inflater);

/* Counts and sums unpacked bytes; notes points between deflate's blocks. */
void snow_relay_note(inflate_filter *inflater, const unsigned char *bytes,
                     size_t count);

/* At the end of a member that was entered: verifies it by what lies below; at
 * the beginning of the next one. */
snow_status snow_relay_verify(inflate_filter *inflater);
void snow_relay_begin_member(inflate_filter *inflater);

/* At the end of reading: the relay's point becomes the last one before it. */
void snow_relay_leave(inflate_filter *inflater);

#endif
