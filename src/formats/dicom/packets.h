/* formats/dicom/packets.h - the parts of a JPEG 2000 code stream, and whether
 * all of it is there. */
#ifndef SNOW_FORMATS_DICOM_PACKETS_H
#define SNOW_FORMATS_DICOM_PACKETS_H

#include "base/base.h"

/* Flags of packets, and of the style of code blocks. */
enum { J2K_PRECINCTS = 1, J2K_SOP = 2, J2K_EPH = 4 };
enum { J2K_BYPASS = 1, J2K_EACH_PASS = 4 };

/* How all tiles are coded (T.800, A.6.1). */
typedef struct j2k_coding {
    int flags, order, levels, style;
    int wide, high; /* code blocks of 1 << wide columns */
    uint32_t layers;
    unsigned char precinct[33]; /* of a level: exponents of height and width */
} j2k_coding;

/* Packets of a tile. */
typedef struct j2k_part {
    uint32_t tile;
    unsigned number, parts; /* of its tile; 0: not known */
    const unsigned char *bytes;
    size_t size;
} j2k_part;

typedef struct j2k_stream {
    uint64_t x0, y0, x1, y1, tile_wide, tile_high, tile_x0, tile_y0;
    uint32_t components, tiles;
    j2k_coding coding;
    bool plain; /* packets can be walked */
    j2k_part *parts;
    size_t count;
} j2k_stream;

/* Finds whether parts first .. first + count - 1, which are those of a tile,
 * consist of its packets. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_walk_tile(snow_context *context, const j2k_stream *s,
                                 size_t first, size_t count, bool *whole);

#endif
