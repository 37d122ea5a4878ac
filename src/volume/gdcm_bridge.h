/* volume/gdcm_bridge.h - what the C side sees of GDCM: a frame's packed bytes
 * go in, its words come out.
 *
 * No exception leaves it.  GDCM prints nothing, but for a line on standard
 * error that its libjpeg has for some damaged pixels. */
#ifndef SNOW_GDCM_BRIDGE_H
#define SNOW_GDCM_BRIDGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One frame as its header tells it. */
typedef struct gdcm_frame {
    const char *syntax;      /* UID of the transfer syntax */
    const char *photometric; /* "MONOCHROME2", say */
    unsigned columns, rows;
    int samples;                 /* words of a pixel */
    bool planes;                 /* one for each of them, not side by side */
    int allocated, stored, high; /* bits; the highest one stored, from 0 */
    bool is_signed;
} gdcm_frame;

/* Unpacks a frame into `out`, which has room for columns * rows * samples words
 * of the bits allocated; in the machine's byte order.  The four numbers of
 * words that may be other than the header says are changed in *frame.  False
 * when the codec fails, or its words are not as many and as long. */
bool snow_gdcm_unpack(gdcm_frame *frame, const void *packed, size_t size,
                      void *out, size_t room);

/* The same function, which may lie in a module. */
typedef bool gdcm_codec(gdcm_frame *frame, const void *packed, size_t size,
                        void *out, size_t room);

#ifdef __cplusplus
}
#endif
#endif
