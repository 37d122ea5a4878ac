/* formats/zarr/zarr.h - the parts of the Zarr reader, for this folder, the
 * folder's reader and tests.
 *
 *   store.c   names -> bytes, from a folder or from memory
 *   node.c    .zarray, .zgroup, .zattrs, zarr.json -> what a folder is
 *   meta.c    these -> the description of an array
 *   codec.c   the codecs, as steps; fill values
 *   find.c    a path -> the array to read, perhaps a resolution level
 *   place.c   axes and transformations -> positions of voxels
 *   cf.c      attributes and coordinates as xarray writes them -> the same, and
 *             the conversion of values
 *   unpack.c  the bytes of a chunk -> its values
 *   blosc.c   the same by a library that is loaded when needed
 *   chunks.c  the chunks that a box touches -> the volume
 *   zarr.c    all of that in turn
 *
 * Sources: the Zarr storage specification, version 2, the Zarr core
 * specification, version 3, and OME-NGFF 0.1 to 0.5 (ngff.openmicroscopy.org).
 * Axes are in the order of the file throughout, the last one fastest in "C"
 * order; only place.c and later parts know x, y and z. */
#ifndef SNOW_FORMATS_ZARR_ZARR_H
#define SNOW_FORMATS_ZARR_ZARR_H

#include "formats/array.h"
#include "formats/cf.h"
#include "volume/region.h"

#include <jansson.h>

#define ZARR_MOST_AXES 8
#define ZARR_MOST_LEVELS 64
#define ZARR_MOST_FILTERS 4
#define ZARR_PATH_BYTES 1024
#define ZARR_NAME_BYTES 32

/* --- store.c -------------------------------------------------------------- */

/* A map from names to bytes: a folder. */
typedef struct zarr_store {
    snow_context *context;
    char folder[ZARR_PATH_BYTES]; /* without a slash at its end */
} zarr_store;

/* One file of it, open. */
typedef struct zarr_file {
    const zarr_store *store;
    char name[2 * ZARR_PATH_BYTES]; /* for messages: with the folder */
    bool is_there; /* if false, the other fields are undefined */
    uint64_t size;
    int descriptor; /* -1 while none is open */
} zarr_file;

/* Opens the file of a name; a missing file is not a failure.  Errors:
 * SNOW_STATUS_BAD_INPUT (a folder, a device, no permission, a loop of links).
 */
snow_status snow_zarr_open(const zarr_store *store, const char *name,
                           zarr_file *out);
void snow_zarr_close(zarr_file *file);

/* Copies bytes first .. first + count - 1, which must be in the file. */
snow_status snow_zarr_read(const zarr_file *file, uint64_t first,
                           unsigned char *bytes, size_t count);

/* Called for the names in a folder of the store, in natural order, without
 * those that begin with a dot.  A status other than SNOW_STATUS_OK ends the
 * visit. */
typedef snow_status zarr_visit_fn(void *user, const char *name);
snow_status snow_zarr_visit(const zarr_store *store, const char *path,
                            zarr_visit_fn *visit, void *user);

/* Writes "path/name" to `out` of ZARR_PATH_BYTES, or only the part that is not
 * empty.  Errors: SNOW_STATUS_BAD_INPUT if it does not fit. */
snow_status snow_zarr_join(const zarr_store *store, const char *path,
                           const char *name, char *out);

/* --- node.c, meta.c, codec.c ---------------------------------------------- */

typedef enum zarr_packer {
    ZARR_PLAIN,
    ZARR_INFLATE, /* gzip and zlib */
    ZARR_ZSTD,
    ZARR_LZ4,
    ZARR_BLOSC
} zarr_packer;

/* What is undone after decompression; `width` is the size of a value. */
typedef struct zarr_filter {
    enum { ZARR_SHUFFLE, ZARR_DELTA } kind;
    size_t width;
} zarr_filter;

/* How the values of a chunk become the bytes of a file, in the order of
 * writing: filters, checksums, compressor, checksums. */
typedef struct zarr_coding {
    zarr_filter filters[ZARR_MOST_FILTERS];
    int filter_count;
    int inner_sums, outer_sums; /* CRC-32C, four bytes each */
    zarr_packer packer;
    char text[48]; /* for messages: "blosc lz4" */
} zarr_coding;

typedef struct zarr_array {
    const zarr_store *store;
    char path[ZARR_PATH_BYTES]; /* within the store; "": the store itself */
    int version;                /* 2 or 3 */
    int axes;
    int64_t sizes[ZARR_MOST_AXES];
    int64_t chunk[ZARR_MOST_AXES]; /* decompressed at once */
    int64_t file[ZARR_MOST_AXES]; /* the contents of a file: a chunk, or a shard
                                     of whole chunks */
    int order[ZARR_MOST_AXES];    /* axes of a chunk, the last one fastest */
    snow_type type;               /* of voxels */
    snow_coding values;           /* of stored values */
    size_t width;                 /* size of a stored value */
    bool big_endian;
    unsigned char fill[8]; /* fill value, as voxels are stored in memory */
    char fill_text[32];
    cf_number fill_number; /* if it is given */
    bool has_fill;
    bool prefixed;  /* names of files begin with "c" */
    char separator; /* between their numbers */
    zarr_coding coding;
    bool sharded, index_first, index_summed;
    char names[ZARR_MOST_AXES][ZARR_NAME_BYTES]; /* of axes, "": not given */
} zarr_array;

typedef enum zarr_kind { ZARR_NOTHING, ZARR_GROUP, ZARR_ARRAY } zarr_kind;

/* The metadata of a folder. */
typedef struct zarr_node {
    zarr_kind kind;
    int version;
    json_t *meta;       /* .zarray or zarr.json */
    json_t *attributes; /* NULL if there are none */
} zarr_node;

/* Reads the metadata of a folder of the store.  Errors: SNOW_STATUS_BAD_INPUT
 * (invalid JSON). */
snow_status snow_zarr_look(const zarr_store *store, const char *path,
                           zarr_node *out);
void snow_zarr_forget(zarr_node *node);

/* Describes the array of a node of that kind.  Errors: SNOW_STATUS_BAD_INPUT
 * (contradictory, not supported). */
snow_status snow_zarr_describe(const zarr_store *store, const char *path,
                               const zarr_node *node, zarr_array *out);

/* Fails because of the metadata of a path: "folder/path: text". */
snow_status snow_zarr_fail(const zarr_store *store, const char *path,
                           const char *format, ...) SNOW_PRINTF(3, 4);

/* The same because of an array's metadata. */
#define ZARR_FAIL(array, ...) \
    snow_zarr_fail((array)->store, (array)->path, __VA_ARGS__)

/* Adds one codec in the order of writing: its name and its configuration.
 * Errors: SNOW_STATUS_BAD_INPUT. */
snow_status snow_zarr_add_coder(const char *name, const json_t *given,
                                zarr_array *array);

/* A number, or one of those that JSON lacks: "NaN", "Infinity", "-Infinity";
 * false for others. null is 0. */
bool snow_zarr_number(const json_t *given, double *out);

/* The value of voxels that are not stored. */
snow_status snow_zarr_take_fill(const json_t *given, zarr_array *array);

/* --- find.c, place.c ------------------------------------------------------ */

/* What an image says about one of its arrays; owned by `node`. */
typedef struct zarr_found {
    zarr_node node;      /* of the image; empty if there is none */
    const json_t *image; /* an entry of "multiscales", or NULL */
    const json_t *level; /* an entry of its "datasets": a resolution level */
    int index, levels;   /* its index; how many there are */
    json_t *attributes;  /* of the array; NULL if there are none */
    zarr_array array;
} zarr_found;

/* Finds the array of a path within the store: an array, an image, of which the
 * finest existing resolution level is used, or a group that contains one of
 * them.  `out` must be freed in any case.  Errors: SNOW_STATUS_BAD_INPUT,
 * SNOW_STATUS_BAD_USAGE (several; none of that name). */
snow_status snow_zarr_find(const zarr_store *store, const char *path,
                           zarr_found *out);
void snow_zarr_found_forget(zarr_found *found);

/* The path of a resolution level of an entry of "multiscales" within its group;
 * NULL if it is invalid. */
const char *snow_zarr_level_path(const json_t *image, size_t index);

/* What the Climate and Forecast conventions say of an array. */
typedef struct zarr_cf {
    cf_values values;
    cf_axis axes[ZARR_MOST_AXES]; /* coordinates, in the order of the file */
    snow_axis_hint hints[SNOW_MOST_AXES]; /* from the last axis on */
    bool named;                           /* it is an array of a data set */
    cf_attributes says;
} zarr_cf;

/* Reads attributes and coordinates.  `out` must be released in any case.
 * Errors: SNOW_STATUS_BAD_INPUT (damaged coordinates). */
snow_status snow_zarr_read_cf(const zarr_found *found, zarr_cf *out);
void snow_zarr_release_cf(const zarr_store *store, zarr_cf *cf);

/* Assigns the roles of the array's axes, which here count in the order of the
 * file, and completes their names. */
snow_status snow_zarr_assign(zarr_found *found, const zarr_cf *cf,
                             snow_axes *out);

/* What "omero" says of the channels of an image, of which there are so many. */
void snow_zarr_describe_channels(const zarr_found *found, int64_t count,
                                 snow_volume_info *info);

/* Sets matrix and unit of the info. */
snow_status snow_zarr_place(const zarr_found *found, const snow_axes *roles,
                            snow_volume_info *info);

/* --- unpack.c ------------------------------------------------------------- */

/* Bytes of memory that decompression needs for a chunk of this size. */
uint64_t snow_zarr_capacity(const zarr_coding *coding, uint64_t bytes);

/* Checks whether compressed bytes can be a chunk, before memory is allocated
 * for it.  `name` is that of the file. */
snow_status snow_zarr_expect(snow_context *context, const char *name,
                             const zarr_coding *coding,
                             const unsigned char *packed, size_t size,
                             uint64_t bytes);

/* Decompresses it to `out`, which is large enough, and undoes filters. */
snow_status snow_zarr_unpack(snow_context *context, const char *name,
                             const zarr_array *array,
                             const unsigned char *packed, size_t size,
                             unsigned char *out, uint64_t bytes);

/* The same for Blosc alone, without filters and checksums. */
snow_status snow_zarr_blosc_expect(snow_context *context, const char *name,
                                   const unsigned char *packed, size_t size,
                                   uint64_t bytes);
snow_status snow_zarr_blosc_unpack(snow_context *context, const char *name,
                                   const unsigned char *packed,
                                   unsigned char *out, uint64_t bytes);

/* "name: what; it is truncated or damaged, copy it again". */
static inline snow_status snow_zarr_fail_damaged(snow_context *context,
                                                 const char *name,
                                                 const char *what) {
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "%s: %s; it is truncated or damaged, copy it again", name,
                     what);
}

static inline snow_status snow_zarr_fail_size(snow_context *context,
                                              const char *name, uint64_t given,
                                              uint64_t bytes) {
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "%s: holds %llu bytes of values, but a chunk has %llu; it "
                     "is damaged, or belongs to another array",
                     name, (unsigned long long)given,
                     (unsigned long long)bytes);
}

/* CRC-32C (RFC 3720, section 12.1). */
uint32_t snow_zarr_sum(const unsigned char *bytes, size_t count);

/* --- chunks.c ------------------------------------------------------------- */

/* The requested part of the array. */
typedef struct zarr_box {
    const zarr_store *store;
    const zarr_array *array;
    snow_axes roles;
    int64_t first[ZARR_MOST_AXES], end[ZARR_MOST_AXES];
    char separator; /* of the files that there are; 0: none was found yet */
} zarr_box;

/* Refuses a box with more voxels than its files can fill, or with too many
 * files and chunks. */
snow_status snow_zarr_check_box(zarr_box *box, uint64_t bytes);

/* Reads it into the voxels of its volume. */
snow_status snow_zarr_fill(zarr_box *box, unsigned char *voxels);

/* --- zarr.c --------------------------------------------------------------- */

/* True for a folder with a Zarr array or group, and for a path that looks like
 * one by its name. */
bool snow_zarr_is(snow_context *context, const char *path);

/* Reads as a format does, for a folder. */
snow_status snow_zarr_read_folder(snow_context *context, const char *path,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out);

/* The same from a path within a store. */
snow_status snow_zarr_read_store(const zarr_store *store, const char *path,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out);

#endif
