/* base/relay.h - packed data that several unpack in turn: each goes on
 * where the one before has ended, so that no byte is unpacked twice.
 *
 *   unpacked   |-- rank 0 --|-- rank 1 --|-- rank 2 --|
 *   points       .    .   A    .    .  B                A, B: handed on
 *
 * Deflate can be entered between two of its blocks by those who know the 32 KiB
 * before.  What is skipped behind a reader's last byte is left to the others,
 * and the check sum goes along: the last one verifies all. */
#ifndef SNOW_BASE_RELAY_H
#define SNOW_BASE_RELAY_H

#include "base/base.h"

#define SNOW_RELAY_WINDOW 32768

/* Where deflate can be entered; all 0: at the beginning. */
typedef struct snow_relay_point {
    uint64_t unpacked, packed; /* the position */
    uint64_t member;           /* where its member begins, unpacked */
    uint32_t check;            /* sum of the member so far */
    uint16_t bits;             /* of the byte before that are not used yet */
    uint16_t window_bytes;     /* less than SNOW_RELAY_WINDOW: all there was */
    unsigned char window[SNOW_RELAY_WINDOW];
} snow_relay_point;

/* Of the first packed source that is opened with it.  What is handed on comes
 * before `seen`. */
typedef struct snow_relay {
    uint64_t source;          /* which one; 0: none yet */
    uint64_t skips;           /* its readers skip what they do not need */
    snow_relay_point from;    /* where its reader may begin; then, to hand on */
    snow_relay_point seen[2]; /* by the present reader, the later one first */
    bool last;                /* nobody reads on: the rest is verified */
    bool foreign;             /* other bytes follow the packed ones, */
    uint64_t left;            /* and so many unpacked ones the data */
} snow_relay;

/* Warns of what the last reader has found, as that did not. */
void snow_relay_warn(snow_context *context, const char *name, bool foreign,
                     uint64_t left);

#endif
