/* formats/zarr/chunks.c - reads the chunks that a box touches, one after the
 * other.
 *
 *   files    | 0 .............. | 1 .............. |   a shard of chunks each,
 *   chunks   | 0  | 1  | 2 | 3  | 4  | ...             or one chunk
 *   box             =========================
 *
 * The index of a shard gives the position and the size of each chunk, eight
 * bytes each, all ones for a chunk that is not stored.  Memory is needed for
 * the volume, one compressed chunk and one decompressed chunk. */
#include "base/minmax.h"
#include "formats/bytes/number.h"
#include "formats/zarr/zarr.h"

#include <stdio.h>

/* The most files, and chunks of a file, that are read for one volume. */
#define MOST_PIECES ((int64_t)1 << 20)

/* Voxels that files may lack: chunks that were never written. */
#define UNWRITTEN_BYTES ((uint64_t)256 << 20)

/* The highest compression ratio of any compressor. */
#define MOST_RATIO 32768

/* A box of cells, and one of them. */
typedef struct cells {
    int axes;
    int64_t first[ZARR_MOST_AXES], end[ZARR_MOST_AXES];
    int64_t at[ZARR_MOST_AXES];
} cells;

typedef struct filler {
    zarr_box *box;
    snow_context *context;
    unsigned char *voxels;
    uint64_t step[ZARR_MOST_AXES];  /* strides of values in a chunk */
    uint64_t place[ZARR_MOST_AXES]; /* strides of voxels in the volume */
    uint64_t bytes;                 /* bytes of a chunk */
    unsigned char *packed, *values, *index;
    int64_t chunks, missing;
    double all; /* bytes of the box */
} filler;

/* The cells of `size` entries that contain entries low .. high - 1. */
static void set_cells(cells *c, int axis, int64_t size, int64_t low,
                      int64_t high) {
    c->first[axis] = c->at[axis] = low / size;
    c->end[axis] = (high - 1) / size + 1;
}

static bool next_cell(cells *c) {
    for (int i = c->axes - 1; i >= 0; i--) {
        if (++c->at[i] < c->end[i])
            return true;
        c->at[i] = c->first[i];
    }
    return false;
}

/* The number of cells, but at most one above the limit. */
static int64_t count_cells(const cells *c) {
    int64_t count = 1;
    for (int i = 0; i < c->axes; i++) {
        int64_t size = c->end[i] - c->first[i];
        if (size > MOST_PIECES / count)
            return MOST_PIECES + 1;
        count *= size;
    }
    return count;
}

static cells cells_of_box(const zarr_box *box, const int64_t *sizes) {
    cells c = {.axes = box->array->axes};
    for (int i = 0; i < c.axes; i++)
        set_cells(&c, i, sizes[i], box->first[i], box->end[i]);
    return c;
}

/* "scale0/image/c/0/1/2" */
static snow_status name_file(const zarr_box *box, const int64_t *at,
                             char separator, char out[ZARR_PATH_BYTES]) {
    const zarr_array *array = box->array;
    char numbers[24 * ZARR_MOST_AXES] = "";
    size_t used = 0;
    if (array->prefixed)
        used = (size_t)snprintf(numbers, sizeof numbers, "c%c", separator);
    for (int i = 0; i < array->axes; i++)
        used +=
            (size_t)snprintf(numbers + used, sizeof numbers - used, "%.*s%lld",
                             i ? 1 : 0, &separator, (long long)at[i]);
    return snow_zarr_join(box->store, array->path, numbers, out);
}

/* Opens the file of a chunk or shard.  Some programs nest the files and do not
 * say so, or the reverse: where none was found yet, that is tried too. */
static snow_status open_file(zarr_box *box, const int64_t *at, zarr_file *out) {
    const char own = box->array->separator, other = own == '/' ? '.' : '/';
    char name[ZARR_PATH_BYTES];
    SNOW_TRY(name_file(box, at, box->separator ? box->separator : own, name));
    SNOW_TRY(snow_zarr_open(box->store, name, out));
    if (box->separator || out->is_there) {
        box->separator = box->separator ? box->separator : own;
        return SNOW_STATUS_OK;
    }
    zarr_file nested;
    SNOW_TRY(name_file(box, at, other, name));
    SNOW_TRY(snow_zarr_open(box->store, name, &nested));
    if (!nested.is_there)
        return SNOW_STATUS_OK;
    *out = nested;
    box->separator = other;
    if (box->array->axes > 1)
        snow_notify(box->store->context,
                    "the names of its chunks have \"%c\" between their "
                    "numbers, not \"%c\" as its metadata say",
                    other, own);
    return SNOW_STATUS_OK;
}

/* --- before anything is read ---------------------------------------------- */

/* Missing chunks are valid, but not so many that a few bytes fill the
 * memory. */
snow_status snow_zarr_check_box(zarr_box *box, uint64_t bytes) {
    const zarr_array *array = box->array;
    cells files = cells_of_box(box, array->file);
    cells chunks = cells_of_box(box, array->chunk);
    uint64_t held = 0, most = UNWRITTEN_BYTES;
    if (count_cells(&files) > MOST_PIECES || count_cells(&chunks) > MOST_PIECES)
        return snow_zarr_fail(box->store, array->path,
                              "lies in more than %lld chunks; copy it with "
                              "larger ones, or use --crop",
                              (long long)MOST_PIECES);
    do {
        zarr_file file;
        if (most >= bytes)
            return SNOW_STATUS_OK;
        SNOW_TRY(open_file(box, files.at, &file));
        held += file.size;
        snow_zarr_close(&file);
        if (!snow_mul_u64(held, MOST_RATIO, &most) ||
            !snow_add_u64(most, UNWRITTEN_BYTES, &most))
            return SNOW_STATUS_OK;
    } while (next_cell(&files));
    if (most >= bytes)
        return SNOW_STATUS_OK;
    return snow_zarr_fail(
        box->store, array->path,
        "claims %llu bytes of voxels, but its files hold only %llu compressed "
        "ones; most of it is missing, use --crop",
        (unsigned long long)bytes, (unsigned long long)held);
}

/* --- voxels --------------------------------------------------------------- */

/* A part of a chunk and its destination; values are in the machine's order.
 * Along x, y and z: the count, and the strides in the chunk and in the
 * volume. */
typedef struct patch {
    uint64_t from; /* offset in the chunk */
    unsigned char *to;
    int64_t count[3];
    uint64_t step[3], place[3];
} patch;

/* Axes that the volume lacks have one entry: selected, or of size 1. */
static void find_patch(const filler *f, const int64_t *chunk, patch *out) {
    const zarr_array *array = f->box->array;
    *out = (patch){0, f->voxels, {1, 1, 1}, {0, 0, 0}, {0, 0, 0}};
    for (int i = 0; i < array->axes; i++) {
        const int64_t size = array->chunk[i], begin = chunk[i] * size;
        const int64_t low = SNOW_MAX(begin, f->box->first[i]);
        const int64_t high = SNOW_MIN(begin + size, f->box->end[i]);
        out->from += (uint64_t)(low - begin) * f->step[i];
        out->to += (uint64_t)(low - f->box->first[i]) * f->place[i];
        for (int role = 0; role < 3; role++)
            if (f->box->roles.space[role] == i) {
                out->count[role] = high - low;
                out->step[role] = f->step[i];
                out->place[role] = f->place[i];
            }
    }
}

/* Of a chunk that is not stored all values are the fill value. */
static void put_chunk(const filler *f, const int64_t *chunk, bool stored) {
    const zarr_array *array = f->box->array;
    const size_t wide = snow_type_size(array->type);
    patch p;
    find_patch(f, chunk, &p);
    for (int64_t z = 0; z < p.count[2]; z++)
        for (int64_t y = 0; y < p.count[1]; y++) {
            unsigned char *to =
                p.to + (uint64_t)z * p.place[2] + (uint64_t)y * p.place[1];
            if (stored)
                snow_coding_put(array->values, snow_machine_big_endian(),
                                array->width,
                                f->values + p.from + (uint64_t)z * p.step[2] +
                                    (uint64_t)y * p.step[1],
                                p.step[0], to, wide, (uint64_t)p.count[0]);
            else
                snow_coding_put(SNOW_CODING_PLAIN, false, wide, array->fill, 0,
                                to, wide, (uint64_t)p.count[0]);
        }
}

/* --- chunks --------------------------------------------------------------- */

/* Reads a chunk, bytes first .. first + size - 1 of a file. */
static snow_status read_chunk(filler *f, const zarr_file *file, uint64_t first,
                              uint64_t size, const int64_t *chunk) {
    const zarr_array *array = f->box->array;
    SNOW_TRY(SNOW_RESERVE(f->context, f->packed, 0, size));
    SNOW_TRY(snow_zarr_read(file, first, f->packed, (size_t)size));
    SNOW_TRY(snow_zarr_expect(f->context, file->name, &array->coding, f->packed,
                              (size_t)size, f->bytes));
    SNOW_TRY(SNOW_RESERVE(f->context, f->values, 0,
                          snow_zarr_capacity(&array->coding, f->bytes)));
    SNOW_TRY(snow_zarr_unpack(f->context, file->name, array, f->packed,
                              (size_t)size, f->values, f->bytes));
    if (array->big_endian != snow_machine_big_endian())
        snow_swap_bytes(f->values, f->bytes / array->width, array->width);
    put_chunk(f, chunk, true);
    return SNOW_STATUS_OK;
}

/* The index entry of a chunk, in "C" order. */
static uint64_t entry_of(const zarr_array *array, const int64_t *chunk) {
    uint64_t entry = 0;
    for (int i = 0; i < array->axes; i++) {
        int64_t count = array->file[i] / array->chunk[i];
        entry = entry * (uint64_t)count + (uint64_t)(chunk[i] % count);
    }
    return entry;
}

static snow_status read_index(filler *f, const zarr_file *file) {
    const zarr_array *array = f->box->array;
    uint64_t count = 1;
    for (int i = 0; i < array->axes; i++)
        count *= (uint64_t)(array->file[i] / array->chunk[i]);
    uint64_t bytes = 16 * count, all = bytes + (array->index_summed ? 4 : 0);
    if (count > file->size || all > file->size)
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "%s: is shorter than the index of its shard; it is "
                         "truncated or damaged, copy it again",
                         file->name);
    SNOW_TRY(SNOW_RESERVE(f->context, f->index, 0, all));
    SNOW_TRY(snow_zarr_read(file, array->index_first ? 0 : file->size - all,
                            f->index, (size_t)all));
    if (array->index_summed && snow_number_at(f->index + bytes, 4, false) !=
                                   snow_zarr_sum(f->index, (size_t)bytes))
        return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                         "%s: the index of its shard does not match its "
                         "checksum; it is damaged, copy it again",
                         file->name);
    return SNOW_STATUS_OK;
}

/* Reads a chunk of an open file; a chunk that is not stored is filled. */
static snow_status take_chunk(filler *f, const zarr_file *file,
                              const int64_t *chunk) {
    const zarr_array *array = f->box->array;
    uint64_t first = 0, size = file->size;
    bool is_there = file->is_there;
    f->chunks++;
    if (is_there && array->sharded) {
        const unsigned char *entry = f->index + 16 * entry_of(array, chunk);
        first = snow_number_at(entry, 8, false);
        size = snow_number_at(entry + 8, 8, false);
        is_there = first != UINT64_MAX || size != UINT64_MAX;
        if (is_there && (first > file->size || size > file->size - first))
            return snow_fail(f->context, SNOW_STATUS_BAD_INPUT,
                             "%s: its index names bytes beyond its end; it is "
                             "truncated or damaged, copy it again",
                             file->name);
    }
    if (is_there)
        return read_chunk(f, file, first, size, chunk);
    f->missing++;
    put_chunk(f, chunk, false);
    return SNOW_STATUS_OK;
}

/* Reads the chunks of one file that the box touches. */
static snow_status take_file(filler *f, const int64_t *at,
                             const zarr_file *file) {
    const zarr_array *array = f->box->array;
    cells chunks = {.axes = array->axes};
    if (file->is_there && array->sharded)
        SNOW_TRY(read_index(f, file));
    for (int i = 0; i < array->axes; i++) {
        const int64_t begin = at[i] * array->file[i];
        set_cells(&chunks, i, array->chunk[i],
                  SNOW_MAX(begin, f->box->first[i]),
                  SNOW_MIN(begin + array->file[i], f->box->end[i]));
    }
    do {
        SNOW_TRY(take_chunk(f, file, chunks.at));
        snow_monitor_report(f->context->monitor, SNOW_STAGE_READ,
                            (double)f->chunks * (double)f->bytes, f->all);
    } while (next_cell(&chunks));
    return SNOW_STATUS_OK;
}

static snow_status take_files(filler *f) {
    cells files = cells_of_box(f->box, f->box->array->file);
    do {
        zarr_file file;
        SNOW_TRY(open_file(f->box, files.at, &file));
        snow_status status = take_file(f, files.at, &file);
        snow_zarr_close(&file);
        SNOW_TRY(status);
    } while (next_cell(&files));
    return SNOW_STATUS_OK;
}

/* Strides in a chunk follow its order; those in the volume are x, y, z. */
static void lay_steps(filler *f) {
    const zarr_array *array = f->box->array;
    uint64_t step = snow_type_size(array->type);
    f->bytes = array->width;
    for (int i = array->axes - 1; i >= 0; i--) {
        f->step[array->order[i]] = f->bytes;
        f->bytes *= (uint64_t)array->chunk[array->order[i]];
    }
    for (int role = 0; role < 3; role++) {
        int axis = f->box->roles.space[role];
        if (axis >= 0) {
            f->place[axis] = step;
            step *= (uint64_t)(f->box->end[axis] - f->box->first[axis]);
        }
    }
    f->all = (double)step;
}

snow_status snow_zarr_fill(zarr_box *box, unsigned char *voxels) {
    filler f = {.box = box, .context = box->store->context, .voxels = voxels};
    lay_steps(&f);
    snow_status status = take_files(&f);
    snow_release(f.context, f.packed);
    snow_release(f.context, f.values);
    snow_release(f.context, f.index);
    if (status == SNOW_STATUS_OK && f.missing)
        snow_notify(f.context,
                    "%lld of %lld chunks are not stored; their voxels are the "
                    "fill value, %s",
                    (long long)f.missing, (long long)f.chunks,
                    box->array->fill_text);
    return status;
}
