/* formats/dicom/gdcm_bridge.h - the C interface to GDCM: decodes a frame's
 * compressed bytes to words.
 *
 * No exception leaves it.  GDCM prints nothing, except for a line on standard
 * error by its libjpeg for some damaged pixels. */
#ifndef SNOW_FORMATS_DICOM_GDCM_BRIDGE_H
#define SNOW_FORMATS_DICOM_GDCM_BRIDGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A frame as described by its header. */
typedef struct gdcm_frame {
    const char *syntax;      /* UID of the transfer syntax */
    const char *photometric; /* for example "MONOCHROME2" */
    unsigned columns, rows;
    int samples;                 /* words of a pixel */
    bool planes;                 /* one plane per sample, not interleaved */
    int allocated, stored, high; /* bits; the highest one stored, from 0 */
    int packed_bits; /* of the packed values, as they say themselves */
    bool is_signed;
} gdcm_frame;

/* Decodes a frame into `out`, which has room for columns * rows * samples words
 * of the allocated bits, in the machine's byte order.  Changes the four numbers
 * of *frame in which the words may differ from the header.  Returns false if
 * the codec fails, or its words differ in number or size. */
bool snow_gdcm_unpack(gdcm_frame *frame, const void *packed, size_t size,
                      void *out, size_t capacity);

/* The type of this function, which may be in a module. */
typedef bool gdcm_codec(gdcm_frame *frame, const void *packed, size_t size,
                        void *out, size_t capacity);

#ifdef __cplusplus
}
#endif
#endif
