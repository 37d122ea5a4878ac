/* formats/hdf5/driver.c - lets libhdf5 read the bytes of a source.
 *
 * A driver of our own serves libhdf5's requests.  So a file, a fuzzer's bytes
 * and a decompressed gzip stream are all the same, and links in a file lead to
 * no other files.
 *
 * libhdf5 has global state; if it was built thread-safe, as Debian's is, it
 * protects that itself.  The only state changed here, the error handler,
 * belongs to the calling thread and is restored. */
#include "formats/hdf5/hdf5.h"

#if SNOW_HAVE_HDF5

#include "io/seekable.h"

#include <stdio.h>
#include <string.h>

/* The only name that the driver opens. */
#define NAME "source"

/* Bytes that may be missing, except of voxels. */
#define BEHIND_MOST ((size_t)1 << 20)

/* What libhdf5 takes for its tables and a small file, with room to spare. */
#define ROOM_BYTES ((size_t)2 << 20)
#define ROOM_PARTS 8

struct hdf5_file {
    snow_context *context;
    snow_seekable *bytes;
    hid_t driver, access, id;
    H5E_auto2_t handler; /* the error handler to restore */
    void *handler_data;
};

/* Passed to the driver in the access properties, which copy it. */
typedef struct hdf5_pass {
    snow_context *context;
    snow_seekable *bytes;
} hdf5_pass;

/* The record of an open file; it begins with libhdf5's own. */
typedef struct hdf5_handle {
    H5FD_t base;
    hdf5_pass from;
    haddr_t end; /* of the address space that libhdf5 uses */
} hdf5_handle;

static H5FD_t *open_handle(const char *name, unsigned flags, hid_t access,
                           haddr_t most) {
    const hdf5_pass *pass = H5Pget_driver_info(access);
    (void)most;
    if (!pass || strcmp(name, NAME) != 0 || (flags & H5F_ACC_RDWR))
        return NULL;
    hdf5_handle *handle = snow_allocate_clear(pass->context, sizeof *handle);
    if (!handle)
        return NULL;
    handle->from = *pass;
    return &handle->base;
}

static herr_t close_handle(H5FD_t *base) {
    hdf5_handle *handle = (hdf5_handle *)base;
    snow_release(handle->from.context, handle);
    return 0;
}

/* A file is one source. */
static int compare_handles(const H5FD_t *a, const H5FD_t *b) {
    const hdf5_handle *x = (const hdf5_handle *)a;
    const hdf5_handle *y = (const hdf5_handle *)b;
    return (x->from.bytes > y->from.bytes) - (x->from.bytes < y->from.bytes);
}

static herr_t query(const H5FD_t *base, unsigned long *flags) {
    (void)base;
    *flags = H5FD_FEAT_DATA_SIEVE;
    return 0;
}

static haddr_t get_end(const H5FD_t *base, H5FD_mem_t type) {
    (void)type;
    return ((const hdf5_handle *)base)->end;
}

static herr_t set_end(H5FD_t *base, H5FD_mem_t type, haddr_t end) {
    (void)type;
    ((hdf5_handle *)base)->end = end;
    return 0;
}

static haddr_t get_size(const H5FD_t *base, H5FD_mem_t type) {
    (void)type;
    return snow_seekable_size(((const hdf5_handle *)base)->from.bytes);
}

/* Addresses beyond the end of the file read as zeros, as with libhdf5's own
 * drivers, except for voxels, which are missing.  So do structures that cannot
 * be read, where libhdf5 would lose memory if it knew; the failure is kept
 * (io/lookup.h).  The size is limited to what a
 * structure of the format needs: a damaged length may be 4 GB. */
static herr_t read_bytes(H5FD_t *base, H5FD_mem_t type, hid_t transfer,
                         haddr_t from, size_t size, void *bytes) {
    const hdf5_handle *handle = (const hdf5_handle *)base;
    (void)transfer;
    size_t got = snow_seekable_read(handle->from.bytes, from, bytes, size);
    if (got < size && (type == H5FD_MEM_DRAW || size - got > BEHIND_MOST))
        return -1;
    memset((unsigned char *)bytes + got, 0, size - got);
    return 0;
}

static herr_t write_nothing(H5FD_t *base, H5FD_mem_t type, hid_t transfer,
                            haddr_t at, size_t size, const void *bytes) {
    (void)base, (void)type, (void)transfer, (void)at, (void)size, (void)bytes;
    return -1;
}

static const H5FD_class_t driver = {
#if H5_VERSION_GE(1, 13, 2)
    .version = H5FD_CLASS_VERSION,
    .value = (H5FD_class_value_t)(H5FD_RESERVED_ENTRIES_MAX + 77),
#endif
    .name = "snowglass",
    .maxaddr = INT64_MAX,
    .fc_degree = H5F_CLOSE_STRONG,
    .fapl_size = sizeof(hdf5_pass),
    .open = open_handle,
    .close = close_handle,
    .cmp = compare_handles,
    .query = query,
    .get_eoa = get_end,
    .set_eoa = set_end,
    .get_eof = get_size,
    .read = read_bytes,
    .write = write_nothing,
    .fl_map = H5FD_FLMAP_SINGLE,
};

/* The innermost error says what is wrong with the file. */
static herr_t take_complaint(unsigned depth, const H5E_error2_t *error,
                             void *text) {
    if (depth == 0 && error->desc)
        snprintf(text, 200, "%s", error->desc);
    return 0;
}

snow_status snow_hdf5_fail(snow_context *context, const char *what) {
    char why[200] = "no reason given";
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_complaint, why);
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "%s (libhdf5: %s); the file may be truncated or damaged, "
                     "so get or write it again",
                     what, why);
}

static snow_status open_file(hdf5_file *file) {
    const hdf5_pass pass = {file->context, file->bytes};
    file->driver = H5FDregister(&driver);
    file->access = H5Pcreate(H5P_FILE_ACCESS);
    if (file->driver < 0 || file->access < 0 ||
        H5Pset_driver(file->access, file->driver, &pass) < 0 ||
        H5Pset_fclose_degree(file->access, H5F_CLOSE_STRONG) < 0)
        return snow_hdf5_fail(file->context, "libhdf5 accepts no driver");
    file->id = H5Fopen(NAME, H5F_ACC_RDONLY, file->access);
    return file->id >= 0
               ? SNOW_STATUS_OK
               : snow_hdf5_fail(file->context, "cannot be opened as HDF5");
}

/* libhdf5 1.10 crashes where it gets no memory for its tables, and where it
 * gets none for a part of a file it may go on without. */
static snow_status check_memory(snow_context *context) {
    void *parts[ROOM_PARTS];
    int made = 0;
    while (made < ROOM_PARTS &&
           (parts[made] = snow_allocate(context, ROOM_BYTES / ROOM_PARTS)))
        made++;
    const bool enough = made == ROOM_PARTS;
    while (made)
        snow_release(context, parts[--made]);
    return enough ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
}

snow_status snow_hdf5_open(snow_source *source, hdf5_file **out) {
    snow_context *context = snow_source_context(source);
    SNOW_TRY(check_memory(context));
    if (H5open() < 0)
        return snow_fail(context, SNOW_STATUS_NO_MEMORY,
                         "libhdf5 cannot begin; close other programs");
    hdf5_file *file = snow_allocate_clear(context, sizeof *file);
    if (!file)
        return SNOW_STATUS_NO_MEMORY;
    file->context = context;
    file->driver = file->access = file->id = H5I_INVALID_HID;
    H5Eget_auto2(H5E_DEFAULT, &file->handler, &file->handler_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    snow_status status = snow_seekable_open(source, &file->bytes);
    if (status == SNOW_STATUS_OK)
        status = open_file(file);
    if (status != SNOW_STATUS_OK) {
        snow_hdf5_close(file);
        return status;
    }
    *out = file;
    return SNOW_STATUS_OK;
}

void snow_hdf5_close(hdf5_file *file) {
    if (!file)
        return;
    if (file->id >= 0)
        H5Fclose(file->id);
    if (file->access >= 0)
        H5Pclose(file->access);
    if (file->driver >= 0)
        H5FDunregister(file->driver);
    H5Eclear2(H5E_DEFAULT);
    H5Eset_auto2(H5E_DEFAULT, file->handler, file->handler_data);
    snow_seekable_close(file->bytes);
    snow_release(file->context, file);
}

hid_t snow_hdf5_id(const hdf5_file *file) {
    return file->id;
}

uint64_t snow_hdf5_size(const hdf5_file *file) {
    return snow_seekable_size(file->bytes);
}

snow_seekable *snow_hdf5_bytes(const hdf5_file *file, uint64_t *base) {
    hsize_t before = 0;
    hid_t plan = H5Fget_create_plist(file->id);
    if (plan >= 0) {
        H5Pget_userblock(plan, &before);
        H5Pclose(plan);
    }
    *base = before;
    return file->bytes;
}

bool snow_hdf5_is_usual(const hdf5_file *file) {
    size_t address = 0, length = 0;
    hid_t plan = H5Fget_create_plist(file->id);
    if (plan >= 0) {
        H5Pget_sizes(plan, &address, &length);
        H5Pclose(plan);
    }
    return address == 8 && length == 8;
}

#endif
