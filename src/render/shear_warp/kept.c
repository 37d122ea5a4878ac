/* render/shear_warp/kept.c - encodings of the slabs of a file, which are kept
 * from picture to picture while memory lasts.
 *
 *   first picture   read 0, encode, draw | read 1, encode, draw | ...
 *   the next ones   draw 0 | draw 1 | ...   and read those that had no room
 *
 * Slabs are cut as they were before, so that they are the same ones. */
#include "render/shear_warp/internal.h"

static void drop(snow_value_path *path, snow_value_kept_slab *kept) {
    snow_value_store_fini(&kept->kept.store);
    snow_volume_close(kept->slab);
    *kept = path->kept.slabs[--path->kept.count];
}

void snow_value_forget_slabs(snow_value_path *path) {
    while (path->kept.count)
        drop(path, path->kept.slabs);
    path->kept.of = 0;
}

bool snow_value_lacks_memory(snow_value_path *path, snow_status status) {
    if (status != SNOW_STATUS_NO_MEMORY)
        return false;
    bool kept = path->kept.count > 0;
    snow_value_forget_slabs(path);
    return snow_value_forget_axes(path) || kept;
}

/* What the exchange of a picture takes at most, of the bytes of its image. */
#define EXCHANGE_IMAGES 4

uint64_t snow_value_exchange_bytes(const snow_value_path *path) {
    return EXCHANGE_IMAGES * snow_block_bytes(path->image->plane);
}

static uint64_t room_left(const snow_context *context) {
    return context->bytes < context->limit ? context->limit - context->bytes
                                           : 0;
}

void snow_value_leave_memory(snow_value_path *path, uint64_t bytes) {
    snow_value_kept_slabs *kept = &path->kept;
    if (!path->context->limit || room_left(path->context) >= bytes)
        return;
    snow_value_forget(path);
    while (kept->count && room_left(path->context) < bytes)
        drop(path, &kept->slabs[kept->count - 1]);
}

/* Bytes that another slab needs: its encoding may take all that slabs were cut
 * for. */
static bool has_room(const snow_value_path *path, const snow_volume *volume,
                     const snow_slab_cut *cut) {
    uint64_t bytes = snow_slab_bytes(volume, cut) * (uint64_t)(1 + cut->made) +
                     (volume->is_part ? snow_value_exchange_bytes(path) : 0);
    return !path->context->limit || room_left(path->context) >= bytes;
}

void snow_value_cut_slabs(snow_value_path *path,
                          const snow_value_params *params, snow_slab_cut *cut) {
    snow_value_kept_slabs *kept = &path->kept;
    if (kept->of != params->volume->generation ||
        kept->slice_axis != params->placement->slice_axis)
        snow_value_forget_slabs(path);
    if (!kept->count)
        return;
    cut->slices = kept->slices;
    cut->ghosts = kept->ghosts > cut->ghosts ? kept->ghosts : cut->ghosts;
    while (kept->count && !has_room(path, params->volume, cut))
        drop(path, &kept->slabs[kept->count - 1]);
}

static snow_value_kept_slab *find(const snow_value_path *path,
                                  const snow_volume *slab) {
    for (int n = 0; n < path->kept.count; n++)
        if (path->kept.slabs[n].slab == slab)
            return &path->kept.slabs[n];
    return NULL;
}

const snow_volume *snow_value_kept(snow_value_path *path,
                                   const snow_value_params *params,
                                   const snow_extent *part, int64_t slices) {
    for (int n = 0; n < path->kept.count; n++) {
        snow_value_kept_slab *kept = &path->kept.slabs[n];
        if (kept->slab->part.first[2] != part->first[2])
            continue;
        if (kept->slab->part.count[2] == part->count[2] &&
            kept->slab->part.stored[2] == part->stored[2] &&
            kept->slab->info.dims[2] == slices &&
            snow_value_serves(path, &kept->kept, params,
                              kept->slab->generation))
            return kept->slab;
        drop(path, kept);
        break;
    }
    return NULL;
}

void snow_value_move(snow_value_encoding *to, snow_value_encoding *from) {
    snow_value_store_fini(&to->store);
    *to = *from;
    from->store = (snow_value_store){.context = to->store.context};
    from->key.generation = 0;
}

void snow_value_take_kept(snow_value_path *path, const snow_volume *slab) {
    snow_value_kept_slab *kept = find(path, slab);
    if (kept)
        snow_value_move(&path->made, &kept->kept);
}

static snow_value_kept_slab *add(snow_value_path *path, snow_slabs *slabs) {
    snow_value_kept_slabs *kept = &path->kept;
    if (!has_room(path, slabs->volume, &slabs->cut) ||
        SNOW_RESERVE(path->context, kept->slabs, kept->count,
                     kept->count + 1) != SNOW_STATUS_OK)
        return NULL;
    kept->of = slabs->volume->generation;
    kept->slice_axis = path->made.key.slice_axis;
    kept->slices = slabs->count;
    kept->ghosts = slabs->cut.ghosts;
    kept->slabs[kept->count] =
        (snow_value_kept_slab){.slab = snow_slabs_keep(slabs),
                               .kept.store = {.context = path->context}};
    return &kept->slabs[kept->count++];
}

void snow_value_keep(snow_value_path *path, const snow_value_params *params,
                     snow_slabs *slabs) {
    snow_value_kept_slab *kept = find(path, params->volume);
    if (!path->made.key.generation)
        return;
    if (!kept)
        kept = add(path, slabs);
    if (kept) /* else the next one is encoded in its place */
        snow_value_move(&kept->kept, &path->made);
}
