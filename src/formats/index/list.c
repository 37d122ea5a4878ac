/* formats/index/list.c - the files of a series, and the choice of a step. */
#include "formats/index/index.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

snow_status snow_index_add(index_list *list, const char *name, int64_t step,
                           double time) {
    const size_t bytes = strlen(name) + 1;
    SNOW_TRY(SNOW_RESERVE(list->context, list->names, list->used,
                          list->used + bytes));
    SNOW_TRY(SNOW_RESERVE(list->context, list->entries, list->count,
                          list->count + 1));
    memcpy(list->names + list->used, name, bytes);
    list->entries[list->count++] = (index_entry){list->used, step, time};
    list->used += bytes;
    return SNOW_STATUS_OK;
}

void snow_index_free(index_list *list) {
    snow_release(list->context, list->names);
    snow_release(list->context, list->entries);
}

/* Those without a time come first. */
static double order_of(const index_entry *entry) {
    return isnan(entry->time) ? -INFINITY : entry->time;
}

/* Files of one time stay in their order. */
static int by_time(const void *a, const void *b) {
    const index_entry *x = a, *y = b;
    double first = order_of(x), second = order_of(y);
    if (first < second || first > second)
        return first < second ? -1 : 1;
    return (x->name > y->name) - (x->name < y->name);
}

void snow_index_sort(index_list *list) {
    int64_t step = 0;
    if (!list->count)
        return;
    qsort(list->entries, list->count, sizeof *list->entries, by_time);
    for (size_t i = 0; i < list->count; i++) {
        if (i && order_of(&list->entries[i]) > order_of(&list->entries[i - 1]))
            step++;
        list->entries[i].step = step;
    }
}

snow_status snow_index_read(snow_source *source, const index_list *list,
                            const char *format,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out) {
    size_t first = 0, end;
    snow_volume_options own = *options;
    snow_volume_info series = snow_volume_info_default(format);
    if (!list->count)
        return snow_fail(list->context, SNOW_STATUS_BAD_INPUT,
                         "names no files; write it again");
    series.times = list->entries[list->count - 1].step + 1;
    SNOW_TRY(
        snow_volume_pick_time(list->context, "time step", options, &series));
    while (list->entries[first].step < series.time)
        first++;
    for (end = first; end < list->count &&
                      list->entries[end].step == list->entries[first].step;)
        end++;
    own.time = 0;
    const snow_status read_files =
        end - first == 1
            ? snow_volume_open_named(source, snow_index_name(list, first), &own,
                                     info, out)
            : snow_mosaic_read_named(source, list, first, end, &own, info, out);
    SNOW_TRY(read_files);
    info->format = format;
    info->times = series.times;
    info->time = series.time;
    if (!isnan(list->entries[first].time))
        info->time_value = list->entries[first].time;
    return SNOW_STATUS_OK;
}
