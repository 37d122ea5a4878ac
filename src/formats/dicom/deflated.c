/* formats/dicom/deflated.c - inflates the elements of a deflated file (PS3.5,
 * A.5) as far as the walk through them asks.
 *
 * A megabyte can inflate to a gigabyte.  So the pixels are not inflated for the
 * header, and of the pixels no more than the image has. */
#include "formats/dicom/dicom.h"
#include "io/zlib_memory.h"

/* More than the elements before the pixels of any file: enhanced images with
 * thousands of frames have some 30 MB. */
#define MOST_BEFORE_PIXELS ((uint64_t)64 << 20)

/* What is inflated at once, and read from the file. */
#define PIECE_BYTES ((size_t)64 << 10)
#define READ_BYTES 4096

struct dicom_inflater {
    snow_context *context;
    snow_seekable *packed;
    uint64_t at; /* in the packed bytes */
    z_stream stream;
    uint64_t most; /* bytes that may be inflated */
    bool ended;
    unsigned char in[READ_BYTES];
};

snow_status snow_dicom_inflate_begin(snow_context *context,
                                     snow_seekable *packed, uint64_t at,
                                     uint64_t pixels, dicom_inflater **out) {
    dicom_inflater *d = snow_allocate_clear(context, sizeof *d);
    if (!d)
        return SNOW_STATUS_NO_MEMORY;
    d->context = context;
    d->packed = packed;
    d->at = at;
    d->most = UINT64_MAX - pixels < MOST_BEFORE_PIXELS
                  ? UINT64_MAX
                  : pixels + MOST_BEFORE_PIXELS;
    snow_zlib_use(&d->stream, context);
    if (inflateInit2(&d->stream, -MAX_WBITS) != Z_OK) {
        snow_release(context, d);
        return SNOW_STATUS_NO_MEMORY;
    }
    *out = d;
    return SNOW_STATUS_OK;
}

void snow_dicom_inflate_end(dicom_inflater *d) {
    if (!d)
        return;
    inflateEnd(&d->stream);
    snow_release(d->context, d);
}

/* Makes up to a piece more. */
static snow_status inflate_piece(dicom_inflater *d, unsigned char **bytes,
                                 size_t *used) {
    z_stream *stream = &d->stream;
    SNOW_TRY(SNOW_RESERVE(d->context, *bytes, *used, *used + PIECE_BYTES));
    stream->next_out = *bytes + *used;
    stream->avail_out = (uInt)PIECE_BYTES;
    int answer = Z_OK;
    while (answer == Z_OK && stream->avail_out) {
        if (!stream->avail_in) {
            stream->next_in = d->in;
            stream->avail_in =
                (uInt)snow_seekable_read(d->packed, d->at, d->in, READ_BYTES);
            d->at += stream->avail_in;
        }
        answer = inflate(stream, Z_NO_FLUSH);
    }
    *used += PIECE_BYTES - stream->avail_out;
    d->ended = answer == Z_STREAM_END;
    if (answer == Z_OK || d->ended)
        return SNOW_STATUS_OK;
    return answer == Z_MEM_ERROR
               ? SNOW_STATUS_NO_MEMORY /* with a message */
               : snow_fail(d->context, SNOW_STATUS_BAD_INPUT,
                           "is truncated or damaged: its deflated elements "
                           "cannot be decompressed; get the file again");
}

snow_status snow_dicom_inflate_to(dicom_inflater *d, uint64_t wanted,
                                  unsigned char **bytes, size_t *used) {
    if (wanted > d->most)
        return snow_fail(d->context, SNOW_STATUS_BAD_INPUT,
                         "inflates to more than %llu MiB beside its pixels; it "
                         "is damaged, or no image",
                         (unsigned long long)(MOST_BEFORE_PIXELS >> 20));
    while (*used < wanted && !d->ended)
        SNOW_TRY(inflate_piece(d, bytes, used));
    return SNOW_STATUS_OK;
}

bool snow_dicom_inflate_ended(const dicom_inflater *d) {
    return d->ended;
}
