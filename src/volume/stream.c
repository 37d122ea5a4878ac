/* volume/stream.c - see stream.h.
 *
 * A slab is a box of what the user's options ask for, opened as any other: so
 * all formats, masks and planes are served.  The invariant is that every slab
 * has the type and the scale of values that the volume was inspected with; a
 * file that was replaced in between is noticed by its sizes at the latest. */
#include "volume/stream_internal.h"

#include "base/fingerprint.h"
#include "io/source.h"
#include "volume/mask.h"

#include <string.h>

/* --- opening -------------------------------------------------------------- */

static void warn_once(void *user, const char *text) {
    snow_stream *stream = user;
    uint64_t sum = 1469598103934665603U; /* FNV-1a */
    for (const char *at = text; *at; at++)
        sum = (sum ^ (unsigned char)*at) * 1099511628211U;
    for (int n = 0; n < stream->given_count; n++)
        if (stream->given[n] == sum)
            return;
    if (stream->given_count == WARNINGS_MOST)
        return;
    stream->given[stream->given_count++] = sum;
    if (stream->warning)
        stream->warning(stream->warning_user, text);
}

void snow_stream_begin_warnings(snow_context *context, snow_stream *stream) {
    stream->warning = context->warning;
    stream->warning_user = context->warning_user;
    snow_context_set_warning(context, warn_once, stream);
}

void snow_stream_end_warnings(snow_context *context,
                              const snow_stream *stream) {
    snow_context_set_warning(context, stream->warning, stream->warning_user);
}

/* Moves a text behind the record. */
static const char *keep(const char *text, char **at) {
    if (!text)
        return NULL;
    char *own = *at;
    size_t bytes = strlen(text) + 1;
    memcpy(own, text, bytes);
    *at += bytes;
    return own;
}

static size_t text_bytes(const char *text) {
    return text ? strlen(text) + 1 : 0;
}

static snow_status new_stream(snow_context *context, const char *path,
                              const snow_volume_options *options,
                              uint64_t slab_bytes, snow_stream **out) {
    size_t bytes = sizeof **out + text_bytes(path) +
                   text_bytes(options->dataset) + text_bytes(options->series) +
                   text_bytes(options->component) + text_bytes(options->mask) +
                   text_bytes(options->labels) +
                   text_bytes(options->label_table) + text_bytes(options->suv) +
                   text_bytes(options->vertical);
    snow_stream *stream = snow_allocate_clear(context, bytes);
    if (!stream)
        return SNOW_STATUS_NO_MEMORY;
    char *at = (char *)(stream + 1);
    stream->options = *options;
    stream->options.dataset = keep(options->dataset, &at);
    stream->options.series = keep(options->series, &at);
    stream->options.component = keep(options->component, &at);
    stream->options.mask = keep(options->mask, &at);
    stream->options.labels = keep(options->labels, &at);
    stream->options.label_table = keep(options->label_table, &at);
    stream->options.suv = keep(options->suv, &at);
    stream->options.vertical = keep(options->vertical, &at);
    stream->path = at;
    keep(path, &at);
    stream->slab_bytes = slab_bytes ? slab_bytes : SNOW_SLAB_BYTES;
    *out = stream;
    return SNOW_STATUS_OK;
}

snow_status snow_stream_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             uint64_t slab_bytes, snow_open_fn *open,
                             snow_volume **out) {
    snow_volume_options known;
    snow_volume_info info;
    snow_stream *stream;
    SNOW_TRY(snow_need_path(context, path));
    SNOW_TRY(SNOW_RECORD_READ(context, snow_volume_options, options, &known));
    if (snow_source_is_stream(path))
        return snow_fail(context, SNOW_STATUS_BAD_USAGE,
                         "%s: can be read only once, but streaming reads it "
                         "several times; copy it to a file",
                         strcmp(path, "-") ? path : "standard input");
    SNOW_TRY(new_stream(context, path, &known, slab_bytes, &stream));
    snow_stream_begin_warnings(context, stream);
    snow_status status = open(context, path, &known, &info, NULL);
    snow_stream_end_warnings(context, stream);
    snow_volume *volume = NULL;
    if (status == SNOW_STATUS_OK) {
        volume = snow_allocate_clear(context, sizeof *volume);
        status = volume ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    }
    if (status != SNOW_STATUS_OK) {
        snow_release(context, stream);
        return status;
    }
    volume->context = context;
    volume->info = info;
    volume->masked = known.mask != NULL;
    stream->open = open;
    stream->print = snow_fingerprint_of(path).hash;
    volume->stream = stream;
    volume->path = stream->path;
    snow_volume_freeze(volume);
    *out = volume;
    return SNOW_STATUS_OK;
}

snow_status snow_stream_open_part(const snow_volume *volume,
                                  const snow_extent *part,
                                  const int64_t stored[3], snow_volume **out) {
    const snow_stream *stream = volume->stream;
    snow_volume_options options = stream->options;
    snow_volume_info whole;
    snow_volume *opened;
    snow_extent from;
    snow_volume_find_extent(volume, &from);
    snow_volume_whole(volume, &whole);
    for (int i = 0; i < 3; i++) {
        options.crop[i][0] += part->stored[i] - from.stored[i];
        options.crop[i][1] = options.crop[i][0] + stored[i];
    }
    SNOW_TRY(snow_stream_open(volume->context, stream->path, &options,
                              stream->slab_bytes, stream->open, &opened));
    opened->part = *part;
    opened->is_part = true;
    *out = opened;
    return snow_volume_set_whole(opened, &whole);
}

double snow_volume_read_seconds(const snow_volume *volume) {
    return volume && volume->stream ? volume->stream->seconds : 0;
}

/* --- slabs ---------------------------------------------------------------- */

snow_status snow_stream_open_slab(snow_context *context, snow_stream *stream,
                                  const snow_volume_options *options,
                                  bool clipped, snow_volume **out) {
    snow_volume_info info;
    double begin = snow_seconds();
    snow_stream_begin_warnings(context, stream);
    /* A warning on what a mask or plane leaves does not hold for the volume. */
    if (snow_mask_asked(options))
        snow_context_set_warning(context, NULL, NULL);
    context->leaves_clipped = !clipped;
    snow_status status =
        stream->open(context, stream->path, options, &info, out);
    context->leaves_clipped = false;
    snow_stream_end_warnings(context, stream);
    stream->seconds += snow_seconds() - begin;
    return status;
}
