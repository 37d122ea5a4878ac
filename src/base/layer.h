/* base/layer.h - the layers that a source is made of; for base/ alone.
 *
 * A source is a pile of layers, each with a buffer of its own.  The bottom one
 * takes bytes from a file or from memory, and every layer above it unpacks the
 * bytes of the one below, straight out of that one's buffer:
 *
 *   top      inflated bytes  [....begin=====end....]  <- source.c reads here
 *   bottom   packed bytes    [..begin==end.........]  <- file or memory */
#ifndef SNOW_LAYER_H
#define SNOW_LAYER_H

#include "base/base.h"

#define SNOW_LAYER_BYTES 65536

typedef struct snow_layer snow_layer;

struct snow_layer {
    snow_context *context;
    const char *name;  /* of the source, for messages; owned by it */
    snow_layer *below; /* owned; NULL for the bottom */
    /* Brings at least one byte and up to `size`; *got is 0 at the end only. */
    snow_status (*pull)(snow_layer *layer, void *bytes, size_t size,
                        size_t *got);
    /* Passes by `count` bytes that are there and not buffered; may be NULL. */
    bool (*jump)(snow_layer *layer, uint64_t count);
    /* The most bytes that can still come where `size` is not known; NULL: as
     * deflate packs those below. */
    uint64_t (*limit)(const snow_layer *layer);
    /* Copies bytes from any place without taking them, as many as are there;
     * NULL where that cannot be done. */
    size_t (*look)(snow_layer *layer, uint64_t from, void *bytes, size_t size);
    void (*fini)(snow_layer *layer);
    int64_t size;      /* of all its bytes; -1 when that is not known */
    uint64_t taken;    /* bytes handed out so far */
    uint64_t horizon;  /* reading ahead ends at this byte, if it lies ahead */
    size_t begin, end; /* of the buffered bytes */
    unsigned char *buffer;
};

/* Makes the bottom layer; the descriptor is closed with it.  `size` is -1 for
 * a pipe.  On failure the descriptor stays open. */
snow_status snow_layer_open_file(snow_context *context, const char *name,
                                 int descriptor, int64_t size,
                                 snow_layer **out);
snow_status snow_layer_open_memory(snow_context *context, const char *name,
                                   const void *bytes, size_t size,
                                   snow_layer **out);

/* Puts a layer that unpacks gzip or zlib on top; owns `below` on success. */
snow_status snow_layer_open_inflate(snow_layer *below, snow_layer **out);

/* Puts a layer that reads base64 (RFC 4648) on top, up to the first letter that
 * is none of its; blanks are passed by, and what follows padding is read on. */
snow_status snow_layer_open_base64(snow_layer *below, snow_layer **out);

/* Zlib streams one behind the other, each unpacking to `whole` bytes but for
 * the last, which makes `last`; `packed` are their packed sizes. */
typedef struct snow_blocks {
    uint64_t count; /* at least 1 */
    uint64_t whole, last;
    uint64_t *packed; /* from snow_allocate */
} snow_blocks;

/* Puts a layer that unpacks them on top, which owns the sizes on success.
 * Refuses sizes that the bytes below or deflate cannot make true. */
snow_status snow_layer_open_blocks(snow_layer *below, const snow_blocks *blocks,
                                   snow_layer **out);

/* Closes a layer and those below; NULL is accepted. */
void snow_layer_close(snow_layer *layer);

/* Room for a layer's record of `bytes` bytes, which begins with a snow_layer,
 * and its buffer; the record is cleared.  For those who open layers. */
void *snow_layer_allocate(snow_context *context, size_t bytes);

/* Buffers at least `size` (at most SNOW_LAYER_BYTES) bytes unless the data end
 * before, and more up to the horizon where one is set. */
snow_status snow_layer_fill(snow_layer *layer, size_t size);

/* The byte at which a pull would begin. */
static inline uint64_t snow_layer_reach(const snow_layer *layer) {
    return layer->taken + (layer->end - layer->begin);
}

/* Takes `count` buffered bytes away. */
void snow_layer_drop(snow_layer *layer, size_t count);

/* As snow_source_read. */
snow_status snow_layer_read(snow_layer *layer, void *bytes, size_t size,
                            size_t *got);

/* Bytes still to come when that is known, else -1. */
int64_t snow_layer_remaining(const snow_layer *layer);

/* The largest number of bytes that can still come, UINT64_MAX when nothing is
 * known: for a packed stream deflate's limit times the packed bytes. */
uint64_t snow_layer_limit(const snow_layer *layer);

/* True when the bytes begin a gzip member. */
bool snow_looks_gzip(const unsigned char *bytes, size_t size);

#endif
