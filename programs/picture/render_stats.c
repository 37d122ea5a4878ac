/* render_stats.c - reports seconds, bytes and the checksum of one picture. */
#include "picture/render_stats.h"
#include "commands/world.h"
#include "run/log.h"
#include "run/start.h"

#include <inttypes.h>
#include <stdio.h>

/* The size in memory, in the native type: the encodings are compared with
 * it. */
static uint64_t volume_bytes(const snow_volume_info *info) {
    return (uint64_t)(info->dims[0] * info->dims[1] * info->dims[2]) *
           snow_type_size(info->type);
}

static json_t *volume_json(const snow_volume_info *info) {
    json_t *object = json_object();
    json_object_set_new(object, "dims", json_sizes(info->dims, 3));
    json_object_set_new(object, "type",
                        json_string(snow_type_name(info->type)));
    json_object_set_new(object, "spacing",
                        json_vector(world_in_units(info).spacing, 3));
    return object;
}

static void set_bytes(json_t *object, const char *key, uint64_t bytes) {
    json_object_set_new(object, key, json_integer((json_int_t)bytes));
}

/* EA, IA and PA are the paper's three arrays (section 3.1); 0 for methods
 * without them. */
static json_t *bytes_json(const render_report *report) {
    const snow_stats *stats = report->stats;
    json_t *object = json_object();
    set_bytes(object, "volume", volume_bytes(report->volume));
    set_bytes(object, "ea", stats->ea_bytes);
    set_bytes(object, "ia", stats->ia_bytes);
    set_bytes(object, "pa", stats->pa_bytes);
    set_bytes(object, "peak", report->peak);
    return object;
}

/* Making the transfer function is the first half of classification (paper,
 * section 2), but happens before the frame.  It is counted in `classify`, so
 * that the stages add up to the total, while `frame` is the time of one more
 * picture of the same look. */
static double classify_seconds(const render_report *report) {
    return report->times->look + report->stats->seconds_classify;
}

/* combine and gather are stages of several ranks; their time is 0 for one. */
static json_t *seconds_json(const render_report *report) {
    const snow_stats *stats = report->stats;
    const struct {
        const char *key;
        double seconds;
    } rows[] = {{"read", report->times->read},
                {"classify", classify_seconds(report)},
                {"shade", stats->seconds_shade},
                {"encode", stats->seconds_encode},
                {"splat", stats->seconds_splat},
                {"composite", stats->seconds_composite},
                {"warp", stats->seconds_warp},
                {"combine", report->combine},
                {"gather", report->gather},
                {"write", report->times->write},
                {"frame", stats->seconds_frame},
                {"total", report->times->total}};
    json_t *object = json_object();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        json_object_set_new(object, rows[i].key, json_number(rows[i].seconds));
    return object;
}

/* The checksum is text, since JSON readers may keep numbers as doubles, which
 * cannot hold 64 bits. */
static json_t *image_json(const snow_image *image) {
    char checksum[17];
    snprintf(checksum, sizeof checksum, "%016" PRIx64,
             snow_image_checksum(image));
    json_t *object = json_object();
    json_object_set_new(object, "width", json_integer(snow_image_width(image)));
    json_object_set_new(object, "height",
                        json_integer(snow_image_height(image)));
    json_object_set_new(object, "checksum", json_string(checksum));
    return object;
}

json_t *stats_json(const render_report *report) {
    const snow_stats *stats = report->stats;
    const snow_settings *settings = report->settings;
    json_t *o = json_object();
    json_object_set_new(o, "version", json_string(snow_version()));
    json_object_set_new(o, "volume", volume_json(report->volume));
    json_object_set_new(o, "threshold", json_number(settings->threshold));
    json_object_set_new(o, "sparse_ratio", json_number(stats->sparse_ratio));
    const bool encoded = stats->encoding != SNOW_ENCODING_AUTO;
    json_object_set_new(
        o, "encoding",
        json_string(encoded ? snow_encoding_name(stats->encoding) : "none"));
    json_object_set_new(o, "method",
                        json_string(snow_method_name(stats->method)));
    json_object_set_new(o, "kernel",
                        json_string(snow_kernel_name(stats->kernel)));
    json_object_set_new(o, "footprint", json_integer(stats->footprint));
    json_object_set_new(o, "threads", json_integer(stats->threads));
    json_object_set_new(o, "ranks", json_integer(process_ranks()));
    json_object_set_new(o, "load", json_number(report->load));
    json_object_set_new(o, "isa", json_string(snow_isa_name(stats->isa)));
    json_object_set_new(o, "quality",
                        json_string(snow_quality_name(stats->quality)));
    json_object_set_new(o, "bytes", bytes_json(report));
    json_object_set_new(o, "seconds", seconds_json(report));
    json_object_set_new(o, "image", image_json(report->image));
    return o;
}

void log_stats(const render_report *report) {
    const snow_stats *stats = report->stats;
    const render_times *times = report->times;
    say("seconds: read %.3f, classify %.3f (look %.3f), shade %.3f, encode "
        "%.3f, splat %.3f, composite %.3f, frame %.3f, write %.3f, total %.3f",
        times->read, classify_seconds(report), times->look,
        stats->seconds_shade, stats->seconds_encode, stats->seconds_splat,
        stats->seconds_composite, stats->seconds_frame, times->write,
        times->total);
    say("bytes: volume %" PRIu64 ", EA %" PRIu64 ", IA %" PRIu64 ", PA %" PRIu64
        ", peak %" PRIu64,
        volume_bytes(report->volume), stats->ea_bytes, stats->ia_bytes,
        stats->pa_bytes, report->peak);
    if (stats->kept_bytes > 0)
        say("encodings along other axes: %" PRIu64 " bytes, at most %" PRIu64
            ", are kept for the next pictures",
            stats->kept_bytes, stats->kept_most);
    say("interesting voxels: %" PRId64 " of %" PRId64 ", sparse ratio %.1f %%",
        stats->interesting, stats->voxels, 100 * stats->sparse_ratio);
    if (process_ranks() > 1)
        say("ranks: %d, load of the largest part %.2f; combine %.3f s, gather "
            "%.3f s",
            process_ranks(), report->load, report->combine, report->gather);
}
