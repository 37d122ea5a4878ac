/* io/zlib_memory.h - zlib's memory comes from the context too, so that it is
 * counted, limited and made to fail in tests like all other. */
#ifndef SNOW_IO_ZLIB_MEMORY_H
#define SNOW_IO_ZLIB_MEMORY_H

#include "base/base.h"

#include <zlib.h>

static voidpf snow_zlib_allocate(voidpf context, uInt count, uInt size) {
    return snow_allocate_array(context, count, size);
}

static void snow_zlib_release(voidpf context, voidpf block) {
    snow_release(context, block);
}

/* Before the stream is initialised. */
static inline void snow_zlib_use(z_stream *stream, snow_context *context) {
    stream->zalloc = snow_zlib_allocate;
    stream->zfree = snow_zlib_release;
    stream->opaque = context;
}

#endif
