/* io/writer.c - buffers what is written to a file (output_file.h), and packs it
 * with gzip if that is wanted. */
#include "io/writer.h"

#include "io/output_file.h"
#include "io/zlib_memory.h"

#include <limits.h>
#include <string.h>

#define BUFFER_BYTES 65536

struct snow_writer {
    snow_output_file file;
    snow_status status; /* of the first write that failed */
    z_stream *packer;   /* NULL: bytes are not packed */
    size_t fill;        /* bytes waiting in the buffer */
    unsigned char buffer[BUFFER_BYTES];
};

snow_status snow_writer_open(snow_context *context, const char *path,
                             bool overwrite, snow_writer **out) {
    snow_writer *writer = snow_allocate(context, sizeof *writer);
    if (!writer)
        return SNOW_STATUS_NO_MEMORY;
    writer->packer = NULL;
    writer->status = SNOW_STATUS_OK;
    writer->fill = 0;
    snow_status status =
        snow_output_file_open(context, path, overwrite, &writer->file);
    if (status != SNOW_STATUS_OK)
        snow_release(context, writer);
    else
        *out = writer;
    return status;
}

void snow_writer_hurry(snow_writer *writer) {
    writer->file.hurried = true;
}

static snow_status flush_buffer(snow_writer *writer) {
    size_t fill = writer->fill;
    writer->fill = 0;
    writer->status =
        snow_output_file_write(&writer->file, writer->buffer, fill);
    return writer->status;
}

/* Appends bytes as they are. */
static snow_status append_bytes(snow_writer *writer, const void *bytes,
                                size_t size) {
    if (size > BUFFER_BYTES - writer->fill)
        SNOW_TRY(flush_buffer(writer));
    if (size >= BUFFER_BYTES)
        return writer->status =
                   snow_output_file_write(&writer->file, bytes, size);
    if (size)
        memcpy(writer->buffer + writer->fill, bytes, size);
    writer->fill += size;
    return SNOW_STATUS_OK;
}

snow_status snow_writer_pack(snow_writer *writer) {
    snow_context *context = writer->file.context;
    z_stream *packer = snow_allocate_clear(context, sizeof *packer);
    if (!packer)
        return SNOW_STATUS_NO_MEMORY;
    snow_zlib_use(packer, context);
    /* 15: the largest window; + 16: gzip, whose header then has no time and no
     * name, so that the same bytes give the same file. */
    if (deflateInit2(packer, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
        snow_release(context, packer);
        return SNOW_STATUS_NO_MEMORY; /* snow_allocate set the message */
    }
    writer->packer = packer;
    return SNOW_STATUS_OK;
}

/* Packs bytes and appends the result, to the stream's end with `last`. */
static snow_status pack(snow_writer *writer, const unsigned char *bytes,
                        size_t size, bool last) {
    z_stream *packer = writer->packer;
    do {
        uInt some = size < INT_MAX ? (uInt)size : INT_MAX;
        int answer = Z_OK;
        packer->next_in = (unsigned char *)bytes;
        packer->avail_in = some;
        size -= some;
        bytes += some;
        do {
            unsigned char packed[4096];
            packer->next_out = packed;
            packer->avail_out = sizeof packed;
            answer = deflate(packer, last && !size ? Z_FINISH : Z_NO_FLUSH);
            SNOW_TRY(append_bytes(writer, packed,
                                  sizeof packed - packer->avail_out));
        } while (packer->avail_out == 0 && answer != Z_STREAM_END);
    } while (size);
    return SNOW_STATUS_OK;
}

snow_status snow_writer_write(snow_writer *writer, const void *bytes,
                              size_t size) {
    if (writer->status != SNOW_STATUS_OK || !size)
        return writer->status;
    return writer->packer ? pack(writer, bytes, size, false)
                          : append_bytes(writer, bytes, size);
}

snow_status snow_writer_commit(snow_writer *writer) {
    snow_status status = writer->status;
    if (status == SNOW_STATUS_OK && writer->packer)
        status = pack(writer, (const unsigned char *)"", 0, true);
    if (status == SNOW_STATUS_OK)
        status = flush_buffer(writer);
    if (status == SNOW_STATUS_OK)
        status = snow_output_file_finish(&writer->file);
    snow_writer_abandon(writer);
    return status;
}

void snow_writer_abandon(snow_writer *writer) {
    if (!writer)
        return;
    snow_context *context = writer->file.context;
    snow_output_file_abandon(&writer->file);
    if (writer->packer)
        deflateEnd(writer->packer);
    snow_release(context, writer->packer);
    snow_release(context, writer);
}
