/* io/filter.h - the filter stages of a source; for io/ only.
 *
 * A source is a stack of stages, each with its own buffer. The bottom one reads
 * bytes from a file or from memory, and every stage above it unpacks the bytes
 * of the one below, directly from that one's buffer:
 *
 *   top      inflated bytes  [....begin=====end....]  <- source.c reads here
 *   bottom   packed bytes    [..begin==end.........]  <- file or memory */
#ifndef SNOW_IO_FILTER_H
#define SNOW_IO_FILTER_H

#include "base/base.h"
#include "io/source.h"

#define SNOW_FILTER_BYTES 65536

typedef struct snow_filter_stage snow_filter_stage;

struct snow_filter_stage {
    snow_context *context;
    const char *name;         /* of the source, for messages; owned by it */
    snow_filter_stage *below; /* owned; NULL for the bottom */
    /* Reads at least one byte and up to `size`; *got is 0 at the end only. */
    snow_status (*pull)(snow_filter_stage *filter, void *bytes, size_t size,
                        size_t *got);
    /* Skips `count` bytes that exist and are not buffered; may be NULL. */
    bool (*jump)(snow_filter_stage *filter, uint64_t count);
    /* The most bytes that can still follow if `size` is not known; NULL: by
     * deflate's limit for the bytes below. */
    uint64_t (*limit)(const snow_filter_stage *filter);
    /* Copies bytes from any position without consuming them, as many as there
     * are; NULL if not supported. */
    size_t (*look)(snow_filter_stage *filter, uint64_t from, void *bytes,
                   size_t size);
    void (*fini)(snow_filter_stage *filter);
    int64_t size;      /* of all its bytes; -1 if not known */
    uint64_t taken;    /* bytes returned so far */
    uint64_t horizon;  /* reading ahead ends at this byte, if it is ahead */
    size_t begin, end; /* of the buffered bytes */
    unsigned char *buffer;
};

/* Makes the bottom stage; closing it closes the descriptor. `size` is -1 for a
 * pipe. On failure the descriptor stays open. */
snow_status snow_filter_stage_open_file(snow_context *context, const char *name,
                                        int descriptor, int64_t size,
                                        snow_filter_stage **out);
snow_status snow_filter_stage_open_memory(snow_context *context,
                                          const char *name, const void *bytes,
                                          size_t size, snow_filter_stage **out);

snow_status snow_filter_stage_open_with(snow_context *context, const char *name,
                                        const snow_bytes_behind *bytes,
                                        snow_filter_stage **out);

/* How a decoder went on: *packed and *room are what it left. */
typedef enum snow_decoded {
    SNOW_DECODED_SOME,
    SNOW_DECODED_END, /* of a stream */
    SNOW_DECODED_DAMAGED,
    SNOW_DECODED_NO_MEMORY /* snow_allocate set the message */
} snow_decoded;

/* A decoder of streams, several of which may follow one another. */
typedef struct snow_decoder {
    size_t bytes; /* of its state, which is cleared before each stream */
    bool (*begin)(void *state, snow_context *context); /* false: no memory */
    snow_decoded (*decode)(void *state, unsigned char *from, unsigned *packed,
                           void *to, unsigned *room);
    void (*end)(void *state);
    /* Whether bytes begin another stream. */
    bool (*begins)(const unsigned char *bytes, size_t size);
    uint64_t ratio; /* at most so many bytes come of one */
} snow_decoder;

/* Adds a stage on top that decodes them; owns `below` on success. */
snow_status snow_filter_stage_open_decoder(snow_filter_stage *below,
                                           const snow_decoder *decoder,
                                           snow_filter_stage **out);

/* The same for gzip or zlib. */
snow_status snow_filter_stage_open_inflate(snow_filter_stage *below,
                                           snow_filter_stage **out);

/* Adds a stage on top that decodes base64 (RFC 4648), up to the first character
 * that is not base64; blanks are skipped, and decoding continues after padding.
 */
snow_status snow_filter_stage_open_base64(snow_filter_stage *below,
                                          snow_filter_stage **out);

/* Unpacks a block to exactly `bytes` bytes; false if it has not these. */
typedef bool snow_unpack_block_fn(const void *packed, size_t size, void *out,
                                  size_t bytes);

/* Consecutive zlib streams, or blocks that `unpack` unpacks to at most 255
 * times their size, each unpacking to `whole` bytes except the last, which
 * unpacks to `last`; `packed` are their packed sizes. */
typedef struct snow_blocks {
    uint64_t count; /* at least 1 */
    uint64_t whole, last;
    uint64_t *packed;             /* from snow_allocate */
    snow_unpack_block_fn *unpack; /* NULL: zlib */
} snow_blocks;

/* Adds a stage on top that unpacks them, and owns the sizes on success. Rejects
 * sizes that are impossible for the bytes below or for deflate. */
snow_status snow_filter_stage_open_blocks(snow_filter_stage *below,
                                          const snow_blocks *blocks,
                                          snow_filter_stage **out);

/* Closes a stage and those below; NULL is accepted. */
void snow_filter_stage_close(snow_filter_stage *filter);

/* Memory for a stage's record of `bytes` bytes, which begins with a
 * snow_filter_stage, and its buffer; the record is cleared. For functions that
 * open stages. */
void *snow_filter_stage_allocate(snow_context *context, size_t bytes);

/* The same for a stage that is laid over one, with bytes of unknown number. */
void *snow_filter_stage_over(snow_filter_stage *below, size_t bytes);

/* Buffers at least `size` (at most SNOW_FILTER_BYTES) bytes unless the data end
 * before, and more up to the horizon if one is set. */
snow_status snow_filter_stage_fill(snow_filter_stage *filter, size_t size);

/* Removes `count` buffered bytes. */
void snow_filter_stage_drop(snow_filter_stage *filter, size_t count);

/* As snow_source_read. */
snow_status snow_filter_stage_read(snow_filter_stage *filter, void *bytes,
                                   size_t size, size_t *got);

/* Bytes that remain if known, else -1. */
int64_t snow_filter_stage_remaining(const snow_filter_stage *filter);

/* The largest number of bytes that can still follow, UINT64_MAX if unknown: for
 * a packed stream deflate's limit times the packed bytes. */
uint64_t snow_filter_stage_limit(const snow_filter_stage *filter);

/* True if the bytes begin a gzip member. */
bool snow_looks_gzip(const unsigned char *bytes, size_t size);

#endif
