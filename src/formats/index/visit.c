/* formats/index/visit.c - VisIt's lists of files, .visit:
 *
 *     !NBLOCKS 2            files of a step; else each file is one
 *     !TIME 0.5             of the next step, or of the steps in turn
 *     a_000.vti             a file a line; # begins a comment
 */
#include "formats/index/index.h"

#include <math.h>
#include <string.h>

typedef struct visit_list {
    index_list files, times; /* times: one entry each */
    int64_t blocks;
} visit_list;

static snow_status take_order(visit_list *v, const char *line) {
    snow_context *context = v->files.context;
    double time;
    if (!strncmp(line, "!NBLOCKS", 8)) {
        const char *number = line + 8 + strspn(line + 8, " \t");
        if (!snow_parse_int64(number, &v->blocks) || v->blocks < 1 ||
            v->files.count)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "\"%.60s\" is not a number of blocks before the "
                             "first file; correct it",
                             line);
        return SNOW_STATUS_OK;
    }
    if (!strncmp(line, "!TIME", 5) &&
        snow_parse_double(line + 5 + strspn(line + 5, " \t"), &time))
        return snow_index_add(&v->times, "", 0, time);
    return SNOW_STATUS_OK; /* others do not concern the files */
}

static snow_status take_lines(snow_source *source, visit_list *v) {
    for (;;) {
        char line[4096];
        bool got;
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        if (!got)
            return SNOW_STATUS_OK;
        char *name = line + strspn(line, " \t");
        for (size_t end = strlen(name); end && strchr(" \t", name[end - 1]);
             end--)
            name[end - 1] = 0;
        if (*name == '!')
            SNOW_TRY(take_order(v, name));
        else if (*name && *name != '#')
            SNOW_TRY(snow_index_add(&v->files, name,
                                    (int64_t)v->files.count / v->blocks, NAN));
    }
}

static snow_status read_list(snow_source *source, visit_list *v,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    SNOW_TRY(take_lines(source, v));
    if (v->files.count % (size_t)v->blocks)
        return snow_fail(v->files.context, SNOW_STATUS_BAD_INPUT,
                         "its %zu files are no multiple of its %lld blocks; "
                         "add the missing ones",
                         v->files.count, (long long)v->blocks);
    for (size_t i = 0; i < v->files.count; i++) {
        index_entry *entry = &v->files.entries[i];
        if ((size_t)entry->step < v->times.count)
            entry->time = v->times.entries[entry->step].time;
    }
    return snow_index_read(source, &v->files, "visit", options, info, out);
}

static snow_status read_visit(snow_source *source,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    visit_list v = {.files = {.context = context},
                    .times = {.context = context},
                    .blocks = 1};
    snow_status status = read_list(source, &v, options, info, out);
    snow_index_free(&v.files);
    snow_index_free(&v.times);
    return status;
}

const snow_format snow_format_visit = {
    .name = "visit",
    .text = "list of files of VisIt (.visit)",
    .suffixes = {".visit"},
    .crops = true,
    .sets = true,
    .channels = true,
    .levels = true,
    .read = read_visit,
};
