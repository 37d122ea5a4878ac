/* formats/hdf5/chunks.c - reads a box of a data set, and unpacks its chunks.
 *
 * libhdf5 takes for granted that a chunk has as many bytes as its sizes say,
 * and copies what lies behind a shorter one in its memory.  So chunks of the
 * usual filters are read as they are stored, and unpacked and measured here, by
 * several threads.  A chunk that unpacks to more bytes is cut: some NetCDF
 * files have such.  What other filters make is libhdf5's, if the stored bytes
 * are as many as the filter's own header asks for.
 *
 * Filters after "HDF5 File Format Specification Version 3.0", IV.A.2.l; LZF
 * after the format of liblzf, as h5py uses it. */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include "base/minmax.h"
#include "base/thread_pool.h"
#include "formats/hdf5/filters.h"

#include <snowglass/snowglass.h>

#include <stdio.h>
#include <string.h>

/* Memory for chunks that are unpacked at a time, if one is not larger. */
#define BATCH_BYTES ((uint64_t)32 << 20)
#define MOST_SLOTS 64

/* Fewer are unpacked before other threads are awake. */
#define THREADED_BYTES ((uint64_t)1 << 18)

/* A chunk on its way: its first element, and its bytes. */
typedef struct chunk_slot {
    hsize_t first[HDF5_MOST_AXES];
    hdf5_packed packed;
} chunk_slot;

typedef struct box_job {
    snow_context *context;
    const hdf5_file *file;
    hid_t set, stored, type; /* the types in the file and in memory */
    const hsize_t *first, *count;
    int axes;
    hsize_t sizes[HDF5_MOST_AXES], chunk[HDF5_MOST_AXES];
    size_t width, stored_width; /* bytes of an element in memory, in the file */
    bool converted;             /* the two types differ */
    bool whole_only;            /* chunks beyond the edge are not filtered */
    hdf5_filters filters;
    uint64_t elements, bytes; /* of a chunk, unpacked, as stored */
    unsigned char fill[16];
    unsigned char *out;
    chunk_slot *slots;
    uint64_t done;
} box_job;

/* --- where chunks lie ----------------------------------------------------- */

/* Copies rows of the last axis from the chunk to the box; from NULL, the fill
 * value. */
static void put_chunk(const box_job *job, const hsize_t *chunk,
                      const unsigned char *values) {
    hsize_t low[HDF5_MOST_AXES], high[HDF5_MOST_AXES], at[HDF5_MOST_AXES];
    const int last = job->axes - 1;
    for (int i = 0; i < job->axes; i++) { /* what is in chunk and box */
        at[i] = low[i] = SNOW_MAX(chunk[i], job->first[i]);
        high[i] =
            SNOW_MIN(chunk[i] + job->chunk[i], job->first[i] + job->count[i]);
    }
    const size_t row = (size_t)(high[last] - low[last]);
    for (;;) {
        uint64_t from = 0, to = 0;
        for (int i = 0; i < job->axes; i++) {
            from = from * job->chunk[i] + (at[i] - chunk[i]);
            to = to * job->count[i] + (at[i] - job->first[i]);
        }
        unsigned char *place = job->out + to * job->width;
        if (values)
            memcpy(place, values + from * job->width, row * job->width);
        for (size_t i = 0; i < row && !values; i++)
            memcpy(place + i * job->width, job->fill, job->width);
        int axis = last - 1;
        while (axis >= 0 && ++at[axis] == high[axis]) {
            at[axis] = low[axis];
            axis--;
        }
        if (axis < 0)
            return;
    }
}

/* Goes on to the next chunk of the box; false behind the last one. */
static bool next_chunk(const box_job *job, hsize_t *chunk) {
    for (int i = job->axes - 1; i >= 0; i--) {
        chunk[i] += job->chunk[i];
        if (chunk[i] < job->first[i] + job->count[i])
            return true;
        chunk[i] = job->first[i] / job->chunk[i] * job->chunk[i];
    }
    return false;
}

static snow_status fail_chunk(const box_job *job, const hsize_t *chunk,
                              const char *what) {
    char place[24 * HDF5_MOST_AXES] = "";
    for (int i = job->axes - 1; i >= 0; i--)
        snprintf(place + strlen(place), sizeof place - strlen(place), "%s%llu",
                 i == job->axes - 1 ? "" : ",", (unsigned long long)chunk[i]);
    return snow_fail(job->context, SNOW_STATUS_BAD_INPUT,
                     "its chunk at %s %s; the file is damaged, get or write it "
                     "again",
                     place, what);
}

/* --- a chunk as it is stored ---------------------------------------------- */

/* libhdf5 fails for a chunk that was never written, and no function below it:
 * one that cannot be looked up has an error of its own. */
static herr_t find_absence(unsigned depth, const H5E_error2_t *error,
                           void *absent) {
    if (depth == 0)
        *(bool *)absent =
            !strcmp(error->func_name, "H5D__get_chunk_storage_size");
    return 0;
}

/* Returns whether a chunk of no bytes has a place in the file, which is damaged
 * then. */
static bool has_place(const box_job *job, const hsize_t *first) {
#if H5_VERSION_GE(1, 10, 5)
    unsigned mask;
    haddr_t place = HADDR_UNDEF;
    hsize_t size;
    return H5Dget_chunk_info_by_coord(job->set, first, &mask, &place, &size) >=
               0 &&
           place != HADDR_UNDEF;
#else
    (void)job, (void)first;
    return true;
#endif
}

/* Reads the stored bytes of a chunk, if it was ever written. */
static snow_status load_chunk(const box_job *job, chunk_slot *slot) {
    hdf5_packed *packed = &slot->packed;
    hsize_t size = 0;
    packed->given = false;
    if (H5Dget_chunk_storage_size(job->set, slot->first, &size) < 0) {
        bool absent = false;
        H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, find_absence, &absent);
        if (!absent)
            return snow_hdf5_fail(job->context, "its chunks cannot be found");
        return SNOW_STATUS_OK;
    }
    packed->given = size || has_place(job, slot->first);
    if (!packed->given)
        return SNOW_STATUS_OK;
    if (!size)
        return fail_chunk(job, slot->first, "has no bytes");
    if (size > snow_hdf5_size(job->file))
        return fail_chunk(job, slot->first,
                          "claims more bytes than the file has");
    SNOW_TRY(SNOW_RESERVE(job->context, packed->bytes, 0, size));
    packed->mask = 0;
    if (H5Dread_chunk(job->set, H5P_DEFAULT, slot->first, &packed->mask,
                      packed->bytes) < 0)
        return snow_hdf5_fail(job->context, "its voxels cannot be read");
    packed->size = size;
    for (int i = 0; job->whole_only && i < job->axes; i++)
        if (slot->first[i] + job->chunk[i] > job->sizes[i])
            packed->mask = UINT32_MAX;
    return SNOW_STATUS_OK;
}

/* Undoes the filters of a chunk, as one item of a batch. */
static void unpack_one(void *user, int64_t item, int worker) {
    const box_job *job = user;
    (void)worker;
    snow_hdf5_unpack(job->context, &job->filters, job->bytes,
                     &job->slots[item].packed);
}

/* Makes an unpacked chunk values of memory, and copies them to the box. */
static snow_status take_chunk(const box_job *job, chunk_slot *slot) {
    hdf5_packed *packed = &slot->packed;
    if (!packed->given) {
        put_chunk(job, slot->first, NULL);
        return SNOW_STATUS_OK;
    }
    SNOW_TRY(packed->status);
    if (packed->fault)
        return fail_chunk(job, slot->first, packed->fault);
    if (job->converted) {
        const size_t widest = SNOW_MAX(job->width, job->stored_width);
        SNOW_TRY(snow_reserve(job->context, &packed->bytes, packed->size,
                              job->elements * widest, 1));
        if (H5Tconvert(job->stored, job->type, (size_t)job->elements,
                       packed->bytes, NULL, H5P_DEFAULT) < 0)
            return snow_hdf5_fail(job->context, "its values are not readable");
    }
    put_chunk(job, slot->first, packed->bytes);
    return SNOW_STATUS_OK;
}

static snow_status read_chunks(box_job *job, int slots) {
    hsize_t chunk[HDF5_MOST_AXES];
    bool more = true;
    uint64_t all = 1;
    for (int i = 0; i < job->axes; i++) {
        chunk[i] = job->first[i] / job->chunk[i] * job->chunk[i];
        all *= (job->first[i] + job->count[i] - 1) / job->chunk[i] -
               job->first[i] / job->chunk[i] + 1;
    }
    while (more) {
        int count = 0;
        for (; more && count < slots; count++) {
            memcpy(job->slots[count].first, chunk, sizeof chunk);
            SNOW_TRY(load_chunk(job, &job->slots[count]));
            more = next_chunk(job, chunk);
        }
        const bool worth = (uint64_t)count * job->bytes >= THREADED_BYTES;
        SNOW_TRY(snow_parallel(job->context, worth ? snow_processors() : 1,
                               count, unpack_one, job));
        for (int i = 0; i < count; i++)
            SNOW_TRY(take_chunk(job, &job->slots[i]));
        job->done += (uint64_t)count;
        snow_monitor_report(job->context->monitor, SNOW_STAGE_READ,
                            (double)job->done, (double)all);
    }
    return SNOW_STATUS_OK;
}

static snow_status read_by_chunks(box_job *job) {
    int slots = 2 * snow_processors();
    if ((uint64_t)slots > BATCH_BYTES / (2 * job->bytes))
        slots = (int)(BATCH_BYTES / (2 * job->bytes));
    slots = slots < 1 ? 1 : slots > MOST_SLOTS ? MOST_SLOTS : slots;
    job->slots =
        snow_allocate_clear(job->context, (size_t)slots * sizeof *job->slots);
    if (!job->slots)
        return SNOW_STATUS_NO_MEMORY;
    const snow_status status = read_chunks(job, slots);
    for (int i = 0; i < slots; i++) {
        snow_release(job->context, job->slots[i].packed.bytes);
        snow_release(job->context, job->slots[i].packed.scratch);
    }
    snow_release(job->context, job->slots);
    return status;
}

/* --- what libhdf5 unpacks ------------------------------------------------- */

/* Whether the chunks of the box are as long as their filters' headers say. */
static snow_status check_chunks(box_job *job) {
    chunk_slot slot = {{0}, {0}};
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < job->axes; i++)
        slot.first[i] = job->first[i] / job->chunk[i] * job->chunk[i];
    do {
        status = load_chunk(job, &slot);
        if (status != SNOW_STATUS_OK || !slot.packed.given)
            continue;
        snow_hdf5_unpack(job->context, &job->filters, job->bytes, &slot.packed);
        status = slot.packed.status;
        if (status == SNOW_STATUS_OK && slot.packed.fault)
            status = fail_chunk(job, slot.first, slot.packed.fault);
    } while (status == SNOW_STATUS_OK && next_chunk(job, slot.first));
    snow_release(job->context, slot.packed.bytes);
    snow_release(job->context, slot.packed.scratch);
    return status;
}

static snow_status read_by_library(const box_job *job) {
    hid_t space = H5Dget_space(job->set);
    hid_t memory = H5Screate_simple(job->axes, job->count, NULL);
    const bool read =
        space >= 0 && memory >= 0 &&
        H5Sselect_hyperslab(space, H5S_SELECT_SET, job->first, NULL, job->count,
                            NULL) >= 0 &&
        H5Dread(job->set, job->type, memory, space, H5P_DEFAULT, job->out) >= 0;
    const snow_status status =
        read ? SNOW_STATUS_OK
             : snow_hdf5_fail(job->context, "its voxels cannot be read");
    snow_hdf5_drop(memory);
    snow_hdf5_drop(space);
    return status;
}

/* --- any ------------------------------------------------------------------ */

/* Sizes, chunks, filters and fill value; false where libhdf5 fails. */
static bool describe(box_job *job, hid_t plan, H5D_layout_t *layout) {
    hid_t space = H5Dget_space(job->set);
    const bool sized = space >= 0 && H5Sget_simple_extent_dims(
                                         space, job->sizes, NULL) == job->axes;
    snow_hdf5_drop(space);
    *layout = H5Pget_layout(plan);
    job->width = H5Tget_size(job->type);
    job->stored_width = H5Tget_size(job->stored);
    job->converted = H5Tequal(job->stored, job->type) <= 0;
    if (!sized || !job->stored_width || job->width > sizeof job->fill)
        return false;
    if (*layout != H5D_CHUNKED)
        return true;
    unsigned options = 0;
    H5D_fill_value_t filled = H5D_FILL_VALUE_UNDEFINED;
    job->elements = 1;
    if (H5Pget_chunk(plan, job->axes, job->chunk) != job->axes)
        return false;
    for (int i = 0; i < job->axes; i++)
        if (!job->chunk[i] ||
            !snow_mul_u64(job->elements, job->chunk[i], &job->elements))
            return false;
    if (H5Pget_chunk_opts(plan, &options) >= 0)
        job->whole_only = options & H5D_CHUNK_DONT_FILTER_PARTIAL_CHUNKS;
    if (H5Pfill_value_defined(plan, &filled) >= 0 &&
        filled != H5D_FILL_VALUE_UNDEFINED)
        H5Pget_fill_value(plan, job->type, job->fill);
    return snow_mul_u64(job->elements, job->stored_width, &job->bytes) &&
           job->bytes < UINT32_MAX &&
           snow_hdf5_read_filters(plan, &job->filters);
}

snow_status snow_hdf5_read_box(snow_context *context, const hdf5_file *file,
                               hid_t set, hid_t type, int axes,
                               const hsize_t *first, const hsize_t *count,
                               void *out) {
    box_job job = {.context = context,
                   .file = file,
                   .set = set,
                   .stored = H5Dget_type(set),
                   .type = type,
                   .axes = axes,
                   .first = first,
                   .count = count,
                   .out = out};
    hid_t plan = H5Dget_create_plist(set);
    H5D_layout_t layout = H5D_LAYOUT_ERROR;
    uint64_t least = 1;
    const bool described = job.stored >= 0 && plan >= 0 && axes >= 1 &&
                           axes <= HDF5_MOST_AXES &&
                           describe(&job, plan, &layout);
    snow_status status =
        described ? SNOW_STATUS_OK
                  : snow_hdf5_fail(context, "its storage is not described");
    for (int i = 0; described && i < axes; i++)
        least *= job.sizes[i];
    if (status == SNOW_STATUS_OK && layout == H5D_COMPACT &&
        H5Dget_storage_size(set) < least * job.stored_width)
        status = snow_fail(context, SNOW_STATUS_BAD_INPUT,
                           "has fewer bytes than its sizes ask for; the file "
                           "is damaged, get or write it again");
    if (status == SNOW_STATUS_OK && layout == H5D_CHUNKED) {
        status =
            job.filters.foreign ? check_chunks(&job) : read_by_chunks(&job);
        layout = job.filters.foreign ? layout : H5D_LAYOUT_ERROR;
    }
    if (status == SNOW_STATUS_OK && layout != H5D_LAYOUT_ERROR)
        status = read_by_library(&job);
    snow_hdf5_drop(plan);
    if (job.stored >= 0)
        H5Tclose(job.stored);
    return status;
}

#endif
