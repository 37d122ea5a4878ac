/* volume/zarr.h - the parts of the reader of Zarr; for zarr*.c, the folder's
 * reader and tests.
 *
 *   zarr_store.c   names -> bytes, of a folder or of memory
 *   zarr_meta.c    .zarray, zarr.json -> what an array is
 *   zarr_codec.c   the coders that they name, as steps; values to fill with
 *   zarr_find.c    a path -> the array that is read, a level of an image or not
 *   zarr_place.c   axes and transformations -> where voxels lie
 *   zarr_unpack.c  the bytes of a chunk -> its values
 *   zarr_blosc.c   the same by a library that is loaded when needed
 *   zarr_chunks.c  the chunks that a box touches -> the volume
 *   zarr.c         all of that in turn
 *
 * Sources: the Zarr storage specification, version 2, the Zarr core
 * specification, version 3, and OME-NGFF 0.1 to 0.5 (ngff.openmicroscopy.org).
 * Axes are in the order of the file throughout, the last one fastest in "C"
 * order; only zarr_place.c and what comes after it know x, y and z. */
#ifndef SNOW_ZARR_H
#define SNOW_ZARR_H

#include "volume/array.h"
#include "volume/window.h"

#include <jansson.h>

#define ZARR_MOST_AXES 8
#define ZARR_MOST_LEVELS 64
#define ZARR_MOST_FILTERS 4
#define ZARR_PATH_BYTES 1024
#define ZARR_NAME_BYTES 32

/* --- zarr_store.c ----------------------------------------------------------
 */

/* Where names lead to bytes: a folder, or records in memory, one behind the
 * other: a byte that counts the letters of the name, the name, four bytes, the
 * low one first, that count the bytes, and these. */
typedef struct zarr_store {
    snow_context *context;
    char
        folder[ZARR_PATH_BYTES]; /* "" for memory; without a slash at its end */
    const unsigned char *records;
    size_t size;
} zarr_store;

/* One file of it, open. */
typedef struct zarr_file {
    const zarr_store *store;
    char name[2 * ZARR_PATH_BYTES]; /* for messages: with the folder */
    bool is_there;                  /* the others mean nothing where not */
    uint64_t size;
    int descriptor; /* -1 in memory */
    const unsigned char *bytes;
} zarr_file;

/* Opens what is at a name; that nothing is there is no failure.
 * Errors: SNOW_BAD_INPUT (a folder, a device, no permission, a loop of links).
 */
snow_status snow_zarr_open(const zarr_store *store, const char *name,
                           zarr_file *out);
void snow_zarr_close(zarr_file *file);

/* Copies bytes first .. first + count - 1, which lie in the file. */
snow_status snow_zarr_read(const zarr_file *file, uint64_t first,
                           unsigned char *bytes, size_t count);

/* Told the names in a folder of the store, in the order of people; those that
 * begin with a dot are left out.  A status other than SNOW_OK ends the visit.
 */
typedef snow_status zarr_visit_fn(void *user, const char *name);
snow_status snow_zarr_visit(const zarr_store *store, const char *path,
                            zarr_visit_fn *visit, void *user);

/* "path/name" into `out` of ZARR_PATH_BYTES, or the one of them that is not
 * empty; false where it has no room. */
bool snow_zarr_join(const char *path, const char *name, char *out);

/* --- zarr_meta.c, zarr_codec.c ----------------------------------------------
 */

typedef enum zarr_packer {
    ZARR_PLAIN,
    ZARR_INFLATE, /* gzip and zlib */
    ZARR_ZSTD,
    ZARR_LZ4,
    ZARR_BLOSC
} zarr_packer;

/* What is undone after unpacking; `width` bytes of a value. */
typedef struct zarr_filter {
    enum { ZARR_SHUFFLE, ZARR_DELTA } kind;
    size_t width;
} zarr_filter;

/* How the values of a chunk become the bytes of a file, in the order of
 * writing: filters, check sums, packer, check sums. */
typedef struct zarr_coding {
    zarr_filter filters[ZARR_MOST_FILTERS];
    int filter_count;
    int inner_sums, outer_sums; /* CRC-32C, four bytes each */
    zarr_packer packer;
    char text[48]; /* for people: "blosc lz4" */
} zarr_coding;

typedef struct zarr_array {
    char path[ZARR_PATH_BYTES]; /* within the store; "": the store itself */
    int version;                /* 2 or 3 */
    int axes;
    int64_t sizes[ZARR_MOST_AXES];
    int64_t chunk[ZARR_MOST_AXES]; /* what is unpacked at once */
    int64_t file[ZARR_MOST_AXES];  /* what a file holds: a chunk, or a shard of
                                      whole chunks */
    int order[ZARR_MOST_AXES];     /* axes of a chunk, the last one fastest */
    snow_type type;                /* of voxels */
    snow_coding values;            /* of stored values */
    size_t width;                  /* bytes of one */
    bool big_endian;
    unsigned char fill[8]; /* of voxels that are not stored, as voxels are */
    char fill_text[32];
    bool prefixed;  /* names of files begin with "c" */
    char separator; /* between their numbers */
    zarr_coding coding;
    bool sharded, index_first, index_summed;
    char names[ZARR_MOST_AXES][ZARR_NAME_BYTES]; /* of axes, "": not told */
} zarr_array;

typedef enum zarr_kind { ZARR_NOTHING, ZARR_GROUP, ZARR_ARRAY } zarr_kind;

/* What describes a folder. */
typedef struct zarr_node {
    zarr_kind kind;
    int version;
    json_t *meta;       /* .zarray or zarr.json */
    json_t *attributes; /* NULL where there are none */
} zarr_node;

/* Looks at a folder of the store.  Errors: SNOW_BAD_INPUT (no JSON). */
snow_status snow_zarr_look(const zarr_store *store, const char *path,
                           zarr_node *out);
void snow_zarr_forget(zarr_node *node);

/* The array that a node of that kind describes.
 * Errors: SNOW_BAD_INPUT (contradictory, not supported). */
snow_status snow_zarr_describe(const zarr_store *store, const char *path,
                               const zarr_node *node, zarr_array *out);

/* A failure in what describes a path: "folder/path: text". */
snow_status snow_zarr_fail(const zarr_store *store, const char *path,
                           const char *format, ...) SNOW_PRINTF(3, 4);

/* Takes one coder in the order of writing: its name and what it is told.
 * `type` is that of the array.  Errors: SNOW_BAD_INPUT. */
snow_status snow_zarr_add_coder(const zarr_store *store, const char *path,
                                const char *name, const json_t *told,
                                zarr_array *array, zarr_coding *coding);

/* The value of voxels that are not stored. */
snow_status snow_zarr_take_fill(const zarr_store *store, const json_t *told,
                                zarr_array *array);

/* --- zarr_find.c, zarr_place.c ----------------------------------------------
 */

/* What an image tells of one of its arrays; borrowed of `node`. */
typedef struct zarr_found {
    zarr_node node;      /* of the image; nothing where there is none */
    const json_t *image; /* an entry of "multiscales", or NULL */
    const json_t *level; /* an entry of its "datasets" */
    int index, levels;   /* of the level; of how many */
    zarr_array array;
} zarr_found;

/* Finds the array of a path within the store, which may be an image, of which
 * the finest level that is there is taken, an array, or a group with one of
 * them in it.  To be forgotten in any case.
 * Errors: SNOW_BAD_INPUT, SNOW_BAD_USAGE (several; none of that name). */
snow_status snow_zarr_find(const zarr_store *store, const char *path,
                           zarr_found *out);
void snow_zarr_found_forget(zarr_found *found);

/* The entry of "multiscales" of attributes by its index, or NULL. */
const json_t *snow_zarr_image(const json_t *attributes, size_t index);

/* The path of one of its levels within its group; NULL where it is none. */
const char *snow_zarr_level_path(const json_t *image, size_t index);

/* Which axis of the array is x, y, z, channel and time; -1: none. */
enum { ZARR_X, ZARR_Y, ZARR_Z, ZARR_CHANNEL, ZARR_TIME, ZARR_ROLES };
typedef struct zarr_roles {
    int axis[ZARR_ROLES];
} zarr_roles;

/* The roles of the array's axes, whose names are completed. */
snow_status snow_zarr_assign(const zarr_store *store, zarr_found *found,
                             zarr_roles *out);

/* Matrix and unit into the info. */
snow_status snow_zarr_place(const zarr_store *store, const zarr_found *found,
                            const zarr_roles *roles, snow_volume_info *info);

/* --- zarr_unpack.c ----------------------------------------------------------
 */

/* Bytes of memory that unpacking needs for a chunk of so many. */
uint64_t snow_zarr_room(const zarr_coding *coding, uint64_t bytes);

/* Whether so many packed bytes can be a chunk; before memory is taken for it.
 * `name` is that of the file. */
snow_status snow_zarr_expect(snow_context *context, const char *name,
                             const zarr_coding *coding,
                             const unsigned char *packed, size_t size,
                             uint64_t bytes);

/* Unpacks it to `out`, which has room, and undoes filters. */
snow_status snow_zarr_unpack(snow_context *context, const char *name,
                             const zarr_array *array,
                             const unsigned char *packed, size_t size,
                             unsigned char *out, uint64_t bytes);

/* The same of Blosc, without what is around it. */
snow_status snow_zarr_blosc_expect(snow_context *context, const char *name,
                                   const unsigned char *packed, size_t size,
                                   uint64_t bytes);
snow_status snow_zarr_blosc_unpack(snow_context *context, const char *name,
                                   const unsigned char *packed,
                                   unsigned char *out, uint64_t bytes);

/* "name: what; it is cut or damaged, copy it again". */
static inline snow_status snow_zarr_fail_damaged(snow_context *context,
                                                 const char *name,
                                                 const char *what) {
    return snow_fail(context, SNOW_BAD_INPUT,
                     "%s: %s; it is cut or damaged, copy it again", name, what);
}

static inline snow_status snow_zarr_fail_size(snow_context *context,
                                              const char *name, uint64_t told,
                                              uint64_t bytes) {
    return snow_fail(context, SNOW_BAD_INPUT,
                     "%s: holds %llu bytes of values where a chunk has %llu; "
                     "it is damaged, or belongs to another array",
                     name, (unsigned long long)told, (unsigned long long)bytes);
}

/* CRC-32C (RFC 3720, section 12.1). */
uint32_t snow_zarr_sum(const unsigned char *bytes, size_t count);

/* --- zarr_chunks.c ----------------------------------------------------------
 */

/* The part of the array that is wanted. */
typedef struct zarr_box {
    const zarr_store *store;
    const zarr_array *array;
    zarr_roles roles;
    int64_t first[ZARR_MOST_AXES], end[ZARR_MOST_AXES];
} zarr_box;

/* Refuses a box of more voxels than its files can fill, and of more files and
 * chunks than are ever read. */
snow_status snow_zarr_check_box(const zarr_box *box, uint64_t bytes);

/* Reads it into the voxels of its volume. */
snow_status snow_zarr_fill(const zarr_box *box, unsigned char *voxels);

/* --- zarr.c -----------------------------------------------------------------
 */

/* True for a folder with a Zarr array or group, and for what looks like one
 * by its name. */
bool snow_zarr_is(const char *path);

/* As a format's `read`, of a folder. */
snow_status snow_zarr_read_folder(snow_context *context, const char *path,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out);

/* The same of records in memory, from a path in them. */
snow_status snow_zarr_read_store(const zarr_store *store, const char *path,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out);

#endif
