/* formats/tiff/planes.c - which planes of an image are there, on which pages,
 * and the voxels of those that are wanted. */
#include "formats/array.h"
#include "formats/tiff/tiff.h"

#include <string.h>

#if SNOW_HAVE_TIFF && !SNOW_LOADS

/* Of the planes that OME-XML claims, so many need no bytes of a file. */
#define FREE_PLANES ((uint64_t)1 << 19)

/* The page of a plane. */
struct place {
    uint32_t file;
    int32_t page; /* -1: no page is named */
};

static struct place place_of(const tiff_plan *plan, int64_t plane) {
    if (plan->places)
        return plan->places[plane];
    return (struct place){
        0, plane < plan->present && plane < INT32_MAX ? (int32_t)plane : -1};
}

/* --- OME ------------------------------------------------------------------ */

/* Pages of a file that is there follow one another in the image's order. */
static snow_status place_run(tiff_set *set, tiff_plan *plan,
                             const tiff_run *run, int64_t *named) {
    const int64_t sizes[3] = {plan->channels, plan->slices, plan->times};
    const int64_t steps[3] = {plan->channel_step, plan->slice_step,
                              plan->time_step};
    int64_t plane = 0, count = run->count;
    tiff_reader *reader;
    for (int i = 0; i < 3; i++) {
        int64_t at = run->first[i];
        if (!i && at >= sizes[0] && plan->page.samples > 1)
            at /= plan->page.samples; /* it counts samples */
        if (at >= sizes[i])
            return SNOW_STATUS_OK; /* as ImageJ writes of cropped images */
        plane += at * steps[i];
    }
    if (!count) {
        SNOW_TRY(snow_tiff_open_member(set, run->file, &reader));
        count =
            reader && reader->count > run->page ? reader->count - run->page : 0;
    }
    if (count > plan->planes - plane)
        count = plan->planes - plane;
    *named += count;
    if (run->page > INT32_MAX - count || *named > 8 * plan->planes)
        return snow_fail(set->context, SNOW_STATUS_BAD_INPUT,
                         "its OME-XML names a page beyond any file's end, or "
                         "planes many times; it is damaged");
    for (int64_t k = 0; k < count; k++)
        plan->places[plane + k] =
            (struct place){(uint32_t)run->file, (int32_t)(run->page + k)};
    return SNOW_STATUS_OK;
}

snow_status snow_tiff_place(tiff_set *set, tiff_plan *plan) {
    const tiff_ome *ome = &set->ome;
    const uint64_t bytes =
        set->own.open ? snow_seekable_size(set->own.file.bytes) : ome->used;
    int64_t named = 0;
    if ((uint64_t)plan->planes > FREE_PLANES + bytes)
        return snow_fail(set->context, SNOW_STATUS_BAD_INPUT,
                         "claims %lld planes, more than it can describe; its "
                         "OME-XML is damaged",
                         (long long)plan->planes);
    plan->places = snow_allocate_array(set->context, (uint64_t)plan->planes,
                                       sizeof *plan->places);
    if (!plan->places)
        return SNOW_STATUS_NO_MEMORY;
    memset(plan->places, 0xff, (size_t)plan->planes * sizeof *plan->places);
    for (size_t n = 0; n < ome->run_count; n++)
        SNOW_TRY(place_run(set, plan, &ome->runs[n], &named));
    return SNOW_STATUS_OK;
}

/* --- what is missing ------------------------------------------------------ */

/* Whether a plane is there, as far as that is known without opening files, or
 * with that. */
static snow_status look(tiff_set *set, const tiff_plan *plan, int64_t plane,
                        bool opens, bool *is_there) {
    const struct place at = place_of(plan, plane);
    tiff_reader *reader;
    *is_there = at.page >= 0;
    if (at.page < 0 || !plan->places)
        return SNOW_STATUS_OK;
    tiff_member *member = &set->ome.members[at.file];
    if (opens && !member->pages)
        SNOW_TRY(snow_tiff_open_member(set, at.file, &reader));
    SNOW_TRY(snow_tiff_find_member(set, at.file));
    *is_there = member->state != TIFF_ABSENT &&
                (!member->pages || at.page < member->pages);
    member->used += opens && *is_there;
    return SNOW_STATUS_OK;
}

/* A text of what is missing, cut where it has no room. */
typedef struct gaps {
    char text[300];
    int64_t count, all;
} gaps;

static void add_gap(gaps *g, const tiff_plan *plan, int64_t c, int64_t t,
                    int64_t first, int64_t last) {
    const size_t used = strlen(g->text), size = sizeof g->text;
    if (size - used < 120) {
        if (g->text[used - 1] != '.')
            snow_append(g->text, size, "; ...");
        return;
    }
    if (used)
        snow_append(g->text, size, "; ");
    if (plan->times > 1)
        snow_append(g->text, size, "time step %lld, ", (long long)t);
    if (plan->channels > 1)
        snow_append(g->text, size, "channel %lld, ", (long long)c);
    snow_append(g->text, size, "slice %lld", (long long)first);
    if (last > first)
        snow_append(g->text, size, " to %lld", (long long)last);
}

/* Looks for slices of one channel and step. */
static snow_status find_gaps(tiff_set *set, const tiff_plan *plan, int64_t c,
                             int64_t t, bool opens, gaps *g) {
    int64_t begun = -1;
    for (int64_t z = 0; z <= plan->slices; z++) {
        bool is_there = true;
        if (z < plan->slices) {
            SNOW_TRY(look(set, plan,
                          c * plan->channel_step + z * plan->slice_step +
                              t * plan->time_step,
                          opens, &is_there));
            g->all++;
            g->count += !is_there;
        }
        if (!is_there && begun < 0)
            begun = z;
        if (is_there && begun >= 0)
            add_gap(g, plan, c, t, begun, z - 1);
        if (is_there)
            begun = -1;
    }
    return SNOW_STATUS_OK;
}

/* Whether files can hold the pages that are wanted of them, compressed or
 * not. */
static snow_status check_size(const tiff_set *set, const tiff_plan *plan,
                              int64_t images, uint64_t size) {
    const tiff_page *page = &plan->page;
    const int64_t sizes[] = {page->width, page->height, page->samples, images};
    uint64_t steps[4], bits;
    if (snow_array_steps(sizes, 4, page->bits, steps, &bits) &&
        snow_tiff_least(page, bits / 8) <= size)
        return SNOW_STATUS_OK;
    return snow_fail(set->context, SNOW_STATUS_BAD_INPUT,
                     "claims %lld images of %lldx%lld pixels, which its %llu "
                     "bytes cannot hold; it is truncated or damaged",
                     (long long)images, (long long)page->width,
                     (long long)page->height, (unsigned long long)size);
}

static snow_status check_sizes(const tiff_set *set, const tiff_plan *plan) {
    if (!plan->places)
        return check_size(set, plan, plan->present,
                          snow_seekable_size(set->own.file.bytes));
    for (size_t i = 0; i < set->ome.member_count; i++)
        if (set->ome.members[i].used)
            SNOW_TRY(check_size(set, plan, set->ome.members[i].used,
                                set->ome.members[i].bytes));
    return SNOW_STATUS_OK;
}

/* A small file must not cost gigabytes of nothing. */
snow_status snow_tiff_check_count(const tiff_set *set, int64_t present,
                                  int64_t all) {
    if (all / 64 <= present && present)
        return SNOW_STATUS_OK;
    return snow_fail(set->context, SNOW_STATUS_BAD_INPUT,
                     "has %lld of the %lld planes that it describes; find the "
                     "others",
                     (long long)present, (long long)all);
}

snow_status snow_tiff_check_planes(tiff_set *set, const tiff_plan *plan,
                                   const snow_volume_options *options,
                                   int64_t channel, int64_t time,
                                   bool *has_gaps) {
    gaps g = {.count = 0};
    SNOW_TRY(find_gaps(set, plan, channel, time, true, &g));
    SNOW_TRY(check_sizes(set, plan));
    *has_gaps = g.count > 0;
    if (g.count)
        SNOW_TRY(snow_tiff_check_count(set, g.all - g.count, g.all));
    if (g.count && !options->allow_gaps)
        return snow_fail(set->context, SNOW_STATUS_BAD_INPUT,
                         "%lld of %lld slices are missing (%s); get the whole "
                         "image, or open it with --allow-gaps",
                         (long long)g.count, (long long)g.all, g.text);
    if (g.count)
        snow_notify(set->context,
                    "%lld of %lld slices are missing, and have no values: %s",
                    (long long)g.count, (long long)g.all, g.text);
    gaps others = {.count = 0};
    for (int64_t t = 0; t < plan->times && !options->each_time; t++)
        for (int64_t c = 0; c < plan->channels; c++)
            if (c != channel || t != time)
                SNOW_TRY(find_gaps(set, plan, c, t, false, &others));
    if (others.count)
        snow_notify(set->context,
                    "%lld of %lld slices of other steps and channels are "
                    "missing: %s",
                    (long long)others.count, (long long)others.all,
                    others.text);
    return SNOW_STATUS_OK;
}

/* --- voxels --------------------------------------------------------------- */

static snow_status read_plane(tiff_set *set, const tiff_plan *plan,
                              struct place at, int64_t sample,
                              const snow_region *region, unsigned char *slice) {
    tiff_reader *reader = &set->own;
    tiff_page page;
    if (plan->raw)
        return snow_tiff_read_raw(&reader->file, &plan->page, at.page, sample,
                                  region, slice);
    if (plan->places)
        SNOW_TRY(snow_tiff_open_member(set, at.file, &reader));
    *reader->file.complaint = 0;
    if (at.page >= reader->count ||
        !TIFFSetSubDirectory(reader->file.tiff, reader->pages[at.page]))
        return snow_tiff_fail(&reader->file);
    /* Samples may be interleaved in one page and in planes in the next, with
     * another compression. */
    SNOW_TRY(snow_tiff_compare(&reader->file, &plan->page, at.page));
    SNOW_TRY(snow_tiff_describe(&reader->file, &page));
    page.flip = plan->page.flip;
    return snow_tiff_read_page(&reader->file, &page, sample, region, slice);
}

snow_status snow_tiff_read_planes(tiff_set *set, const tiff_plan *plan,
                                  int64_t first, int64_t sample,
                                  const snow_region *region,
                                  snow_volume *volume, bool *missing) {
    const size_t slice_bytes = (size_t)(region->count[0] * region->count[1]) *
                               snow_type_size(volume->info.type);
    for (int64_t z = 0; z < region->count[2]; z++) {
        const int64_t plane = first + (region->first[2] + z) * plan->slice_step;
        bool is_there;
        SNOW_TRY(look(set, plan, plane, true, &is_there));
        missing[z] = !is_there;
        if (is_there)
            SNOW_TRY(read_plane(
                set, plan, place_of(plan, plane), sample, region,
                (unsigned char *)volume->owned + (size_t)z * slice_bytes));
    }
    return SNOW_STATUS_OK;
}

#endif
