/* io/png.c - what readers and writers of PNG share: memory, errors, bytes. */
#include "io/png.h"

bool snow_png_probe(const unsigned char *bytes, size_t size) {
    return size >= 8 && png_sig_cmp(bytes, 0, 8) == 0;
}

void snow_png_sides(const unsigned char *header, int64_t sides[2]) {
    for (int i = 0; i < 2; i++)
        sides[i] = png_get_uint_32(header + 16 + 4 * i);
}

/* Replaces malloc, also for zlib's state.  libpng may continue without the
 * block, or report an error; the status is kept for that case. */
static void *allocate_block(png_structp png, png_alloc_size_t bytes) {
    snow_png *job = png_get_mem_ptr(png);
    void *block = snow_allocate(job->context, bytes);
    if (!block)
        job->status = SNOW_STATUS_NO_MEMORY;
    return block;
}

static void release_block(png_structp png, void *block) {
    snow_png *job = png_get_mem_ptr(png);
    snow_release(job->context, block);
}

void snow_png_leave(snow_png *job, snow_status status) {
    if (job->status == SNOW_STATUS_OK)
        job->status = status;
    longjmp(job->jump, 1);
}

/* A failure below libpng (memory, the file) has a more specific message. */
static void note_error(png_structp png, png_const_charp text) {
    snow_png *job = png_get_error_ptr(png);
    if (job->status == SNOW_STATUS_OK)
        snow_fail(job->context, job->refusal, "%s (libpng: %s); %s",
                  job->prefix, text, job->remedy);
    snow_png_leave(job, job->refusal);
}

/* Warnings change nothing in the pixels. */
static void note_warning(png_structp png, png_const_charp text) {
    (void)png;
    (void)text;
}

/* Sources transfer all bytes, or fail with a message. */
static void read_bytes(png_structp png, png_bytep bytes, size_t size) {
    snow_png *job = png_get_io_ptr(png);
    snow_status status =
        snow_source_read_all(job->source, bytes, size, "the pixels");
    if (status != SNOW_STATUS_OK)
        snow_png_leave(job, status);
}

snow_status snow_png_make(snow_png *job, bool writes) {
    job->png = (writes ? png_create_write_struct_2 : png_create_read_struct_2)(
        PNG_LIBPNG_VER_STRING, job, note_error, note_warning, job,
        allocate_block, release_block);
    if (job->png)
        job->info = png_create_info_struct(job->png);
    if (job->info || job->status != SNOW_STATUS_OK)
        return job->status;
    return snow_fail(job->context, SNOW_STATUS_FAILED,
                     "libpng %s is not compatible with %s, for which this was "
                     "built; install the latter",
                     png_get_libpng_ver(NULL), PNG_LIBPNG_VER_STRING);
}

snow_status snow_png_begin(snow_png *job, uint32_t side) {
    SNOW_TRY(snow_png_make(job, false));
    png_set_read_fn(job->png, job, read_bytes);
    png_set_user_limits(job->png, side, side);
    png_set_crc_action(job->png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    /* -1: all chunks but IHDR, PLTE, tRNS, IDAT and IEND */
    png_set_keep_unknown_chunks(job->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    /* An error that libpng would forgive, such as a wrong Adler-32, is an
     * error. */
    png_set_benign_errors(job->png, 0);
    png_read_info(job->png, job->info);
    return SNOW_STATUS_OK;
}
