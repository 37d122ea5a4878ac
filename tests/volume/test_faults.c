/* tests/volume/test_faults.c - each call by which a file is looked up, opened,
 * read or listed is made to fail, once and from there on, for a file of each
 * format: the conversion then fails with one line, or gives the same bytes.
 *
 * The linker's --wrap puts the functions below before those of the system, so
 * that only the library's own calls fail. */
#include "support/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- calls that fail ------------------------------------------------------ */

typedef enum fault_kind {
    NO_FAULT,
    INTERRUPTED, /* EINTR, and a read of one byte: neither does any harm */
    SHORT,
    BROKEN, /* EIO */
    CLOSED  /* EACCES; of names alone */
} fault_kind;

#define MOST_CALLS 20000

static struct {
    fault_kind fault; /* of call number `failing` */
    bool for_good;    /* and of all after it */
    long failing;
    atomic_long calls, held; /* so far; descriptors and listings */
    char kinds[MOST_CALLS];  /* of calls: r(ead), n(ame), o(ther) */
} faults;

/* Counts a call; returns the fault that it shall have, with errno. */
static fault_kind next_fault(char kind) {
    const long number = faults.calls++;
    if (number < MOST_CALLS)
        faults.kinds[number] = kind;
    if (!faults.fault || number < faults.failing ||
        (number > faults.failing && !faults.for_good) ||
        (faults.fault == CLOSED && kind != 'n') ||
        (faults.fault < BROKEN && kind != 'r'))
        return NO_FAULT;
    if (faults.fault != SHORT)
        errno = faults.fault == INTERRUPTED ? EINTR
                : faults.fault == CLOSED    ? EACCES
                                            : EIO;
    return faults.fault;
}

/* A function of the system, and the one before it. */
#define CALL(type, name, parameters) \
    type __real_##name parameters;   \
    type __wrap_##name parameters;   \
    type __wrap_##name parameters

#define LOOK_UP(name, parameters, arguments)                   \
    CALL(int, name, parameters) {                              \
        return next_fault('n') ? -1 : __real_##name arguments; \
    }

#define READ(name, parameters, arguments, count)                       \
    CALL(ssize_t, name, parameters) {                                  \
        const fault_kind found = next_fault('r');                      \
        if (found == SHORT && (count) > 1)                             \
            (count) = 1;                                               \
        return found && found != SHORT ? -1 : __real_##name arguments; \
    }

#define LIST(name)                                             \
    CALL(struct dirent *, name, (DIR * stream)) {              \
        return next_fault('o') ? NULL : __real_##name(stream); \
    }

#define OPEN(name)                                                   \
    CALL(int, name, (const char *path, int flags, ...)) {            \
        va_list rest;                                                \
        va_start(rest, flags);                                       \
        const int mode = flags & O_CREAT ? va_arg(rest, int) : 0600; \
        va_end(rest);                                                \
        const int opened =                                           \
            next_fault('n') ? -1 : __real_##name(path, flags, mode); \
        faults.held += opened >= 0;                                  \
        return opened;                                               \
    }

/* As compilers call them, where offsets of 64 bits are asked for or usual. */
OPEN(open)
OPEN(open64)
#ifdef __GLIBC__ /* in hardened builds */
#define OPEN_CHECKED(name)                                                    \
    CALL(int, name, (const char *path, int flags)) {                          \
        const int opened = next_fault('n') ? -1 : __real_##name(path, flags); \
        faults.held += opened >= 0;                                           \
        return opened;                                                        \
    }
OPEN_CHECKED(__open_2)
OPEN_CHECKED(__open64_2)
#endif
LOOK_UP(stat, (const char *path, struct stat *out), (path, out))
LOOK_UP(stat64, (const char *path, struct stat *out), (path, out))
LOOK_UP(lstat, (const char *path, struct stat *out), (path, out))
LOOK_UP(lstat64, (const char *path, struct stat *out), (path, out))
LOOK_UP(fstat, (int file, struct stat *out), (file, out))
LOOK_UP(fstat64, (int file, struct stat *out), (file, out))
READ(read, (int file, void *bytes, size_t size), (file, bytes, size), size)
READ(pread, (int file, void *bytes, size_t size, off_t at),
     (file, bytes, size, at), size)
READ(pread64, (int file, void *bytes, size_t size, off_t at),
     (file, bytes, size, at), size)
LIST(readdir)
LIST(readdir64)

CALL(DIR *, opendir, (const char *path)) {
    DIR *opened = next_fault('n') ? NULL : __real_opendir(path);
    faults.held += opened != NULL;
    return opened;
}

/* A file is closed even where that fails. */
CALL(int, close, (int file)) {
    faults.held--;
    const int done = __real_close(file);
    return next_fault('o') ? -1 : done;
}

CALL(int, closedir, (DIR * stream)) {
    faults.held--;
    const int done = __real_closedir(stream);
    return next_fault('o') ? -1 : done;
}

/* What survives a power failure is not looked at here. */
CALL(int, fsync, (int file)) {
    return file < 0 ? __real_fsync(file) : 0;
}

/* --- files ---------------------------------------------------------------- */

/* Writes a file, and the folders that it is in. */
static void write_below(const char *folder, const char *name, const void *bytes,
                        size_t size) {
    char path[512];
    for (const char *slash = name; (slash = strchr(slash, '/')); slash++) {
        snprintf(path, sizeof path, "%s/%.*s", folder, (int)(slash - name),
                 name);
        assert_true(mkdir(path, 0700) == 0 || errno == EEXIST);
    }
    snprintf(path, sizeof path, "%s/%s", folder, name);
    support_write_file(path, bytes, size);
}

static size_t read_corpus(const char *name, unsigned char bytes[1 << 16]) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", SNOW_CORPUS, name);
    FILE *file = fopen(path, "rb");
    if (!file)
        fail_msg("%s: is not there", path);
    size_t size = fread(bytes, 1, 1 << 16, file);
    fclose(file);
    return size;
}

/* Another slice of a DICOM series: the last letters of its name and place rise.
 */
static void raise(unsigned char *bytes, size_t size, char by) {
    static const char *const ends[] = {"1.2.9.2", "\\2.0\\3"};
    for (int n = 0; n < 2; n++)
        for (size_t at = strlen(ends[n]); at < size; at++)
            if (!memcmp(bytes + at - strlen(ends[n]), ends[n], strlen(ends[n])))
                bytes[at - 1] += (unsigned char)by;
}

/* Writes a text; a file of the corpus, where it begins with ":", perhaps raised
 * by a number before that; the corpus has folders as records (zarr.h). */
static void write_file(const char *folder, const char *name, const char *text) {
    static unsigned char bytes[1 << 16];
    if (!strchr(text, ':') || strchr(text, ':') > text + 1) {
        write_below(folder, name, text, strlen(text));
        return;
    }
    const size_t size = read_corpus(strchr(text, ':') + 1, bytes);
    if (*text != ':')
        raise(bytes, size, (char)(*text - '0'));
    if (strstr(text, ":zarr/") != text && strstr(text, ":amrex/") != text) {
        write_below(folder, name, bytes, size);
        return;
    }
    for (size_t at = 0; at < size && at + bytes[at] + 5 <= size;) {
        char record[600];
        const unsigned char *count = bytes + at + 1 + bytes[at];
        size_t length = (size_t)count[0] | (size_t)count[1] << 8 |
                        (size_t)count[2] << 16 | (size_t)count[3] << 24;
        if (length > size - at - 5 - bytes[at])
            return;
        snprintf(record, sizeof record, "%s/%.*s", name, (int)bytes[at],
                 bytes + at + 1);
        if (record[strlen(record) - 1] != '/')
            write_below(folder, record, count + 4, length);
        at += 5 + bytes[at] + length;
    }
}

#define VTI                                                                  \
    "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 1 0 1 0 1\">"    \
    "<Piece Extent=\"0 1 0 1 0 1\"><PointData Scalars=\"s\"><DataArray "     \
    "type=\"UInt8\" Name=\"s\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray>" \
    "</PointData></Piece></ImageData></VTKFile>"
#define NRRD "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\n"
#define MHD                                            \
    "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\n" \
    "ElementType = MET_UCHAR\nElementDataFile = "

/* Volumes that are in several files; `open` is what is opened, m.nrrd a mask,
 * and l.txt a table of labels. */
typedef struct sample {
    const char *open; /* "": the folder */
    const char *files[5][2];
} sample;

static const sample samples[] = {
    {"a.nhdr",
     {{"a.nhdr", NRRD "encoding: raw\ndata file: a.raw\n"},
      {"a.raw", "abcdefgh"}}},
    {"a.nhdr",
     {{"a.nhdr", NRRD "encoding: raw\ndata file: LIST\na.raw\nb.raw\n"},
      {"a.raw", "abcd"},
      {"b.raw", "efgh"}}},
    {"a.mhd", {{"a.mhd", MHD "a.raw\n"}, {"a.raw", "abcdefgh"}}},
    {"a.mhd",
     {{"a.mhd", MHD "s%d.raw 1 2 1\n"},
      {"s1.raw", "abcd"},
      {"s2.raw", "ef!h"}}},
    {"a.bov",
     {{"a.bov", "DATA_FILE: a.raw\nDATA_SIZE: 2 2 2\nDATA_FORMAT: BYTE\n"},
      {"a.raw", "abcdefgh"}}},
    {"a.hdr", {{"a.hdr", ":nifti/pair"}, {"a.img", ":dicom/big"}}},
    {"a.img", {{"a.hdr", ":nifti/pair"}, {"a.img", ":dicom/big"}}},
    {"a.pvd",
     {{"a.pvd", "<VTKFile type=\"Collection\"><Collection><DataSet "
                "timestep=\"0\" file=\"a.vti\"/></Collection></VTKFile>"},
      {"a.vti", VTI}}},
    {"a.pvti",
     {{"a.pvti",
       "<VTKFile type=\"PImageData\"><PImageData WholeExtent=\"0 1 0 1 0 1\">"
       "<PPointData Scalars=\"s\"><PDataArray type=\"UInt8\" Name=\"s\"/>"
       "</PPointData><Piece Extent=\"0 1 0 1 0 1\" Source=\"a.vti\"/>"
       "</PImageData></VTKFile>"},
      {"a.vti", VTI}}},
    {"a.vtm",
     {{"a.vtm", "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet>"
                "<DataSet index=\"0\" file=\"a.vti\"/></vtkMultiBlockDataSet>"
                "</VTKFile>"},
      {"a.vti", VTI}}},
    {"a.visit", {{"a.visit", "a.vti\n"}, {"a.vti", VTI}}},
    {"a.xmf",
     {{"a.xmf",
       "<Xdmf><Domain><Grid GridType=\"Uniform\"><Topology TopologyType="
       "\"3DCoRectMesh\" Dimensions=\"2 2 2\"/><Geometry GeometryType="
       "\"ORIGIN_DXDYDZ\"><DataItem Format=\"XML\">0 0 0</DataItem><DataItem "
       "Format=\"XML\">1 1 1</DataItem></Geometry><Attribute Name=\"s\" "
       "Center=\"Node\"><DataItem Format=\"Binary\" NumberType=\"UChar\" "
       "Dimensions=\"2 2 2\">a.raw</DataItem></Attribute></Grid></Domain>"
       "</Xdmf>"},
      {"a.raw", "abcdefgh"}}},
    {"",
     {{"1.png", ":png_slice/grey8.png"},
      {"2.png", ":png_slice/grey8.png"},
      {"3.png", ":png_slice/grey8.png"}}},
    {"%d.jpg", {{"1.jpg", ":jpeg/grey.jpg"}, {"2.jpg", ":jpeg/grey.jpg"}}},
    {"*.dcm",
     {{"1.dcm", ":dicom/big"},
      {"2.dcm", "1:dicom/big"},
      {"3.dcm", "2:dicom/big"}}},
    {"2", {{"1", ":dicom/big"}, {"2", "1:dicom/big"}, {"3", "2:dicom/big"}}},
    {"plt", {{"plt", ":amrex/two_levels"}}},
    {"a.zarr", {{"a.zarr", ":zarr/image"}}},
    {"a.zarr", {{"a.zarr", ":zarr/group"}}},
    {"a.zarr", {{"a.zarr", ":zarr/missing"}}},
    {"a.zarr", {{"a.zarr", ":zarr/shards"}}},
    {"a.nhdr",
     {{"a.nhdr", NRRD "encoding: raw\ndata file: a.raw\n"},
      {"a.raw", "abcdefgh"},
      {"m.nrrd", NRRD "encoding: ascii\n\n1 0 1 0 1 0 1 0\n"},
      {"l.txt", "97 Left-Hippocampus 220 216 20 0\n"}}},
};

/* --- conversions ---------------------------------------------------------- */

/* Where a conversion comes from and goes to. */
typedef struct conversion {
    char folder[SUPPORT_FOLDER_BYTES], path[128], out[128];
    char mask[128], labels[128];
    snow_volume_options options;
    char message[SNOW_MESSAGE_BYTES];
} conversion;

static void begin(conversion *c, const char *open) {
    *c = (conversion){.options = {.size = sizeof c->options}};
    snprintf(c->folder, sizeof c->folder, "/dev/shm/snowglass-test-XXXXXX");
    if (!mkdtemp(c->folder)) /* where thousands of files take no time */
        support_folder_make(c->folder);
    snprintf(c->path, sizeof c->path, "%s/in%s%s", c->folder, *open ? "/" : "",
             open);
    snprintf(c->out, sizeof c->out, "%s/out.nrrd", c->folder);
    write_below(c->folder, "in/.made", "", 0);
}

static void write_sample(conversion *c, const sample *s) {
    for (int n = 0; n < 5 && s->files[n][0]; n++) {
        const char *own = s->files[n][0];
        char name[64];
        snprintf(name, sizeof name, "in/%s", own);
        write_file(c->folder, name, s->files[n][1]);
        if (!strcmp(own, "m.nrrd")) {
            snprintf(c->mask, sizeof c->mask, "%s/%s", c->folder, name);
            c->options.mask = c->mask;
        }
        if (!strcmp(own, "l.txt")) {
            snprintf(c->labels, sizeof c->labels, "%s/%s", c->folder, name);
            c->options.label_table = c->labels;
        }
    }
}

/* Opens under a fault; what was opened is saved without.  The size of what was
 * saved, into `bytes`; 0: it was refused, with the message. */
static size_t convert(conversion *c, fault_kind fault, long failing,
                      bool for_good, unsigned char *bytes, size_t room) {
    snow_context *context = support_context();
    snow_volume *volume = NULL;
    size_t size = 0;
    snow_context_set_memory_limit(context, (uint64_t)8 << 20);
    faults.calls = faults.held = 0;
    faults.failing = failing;
    faults.for_good = for_good;
    faults.fault = fault;
    snow_status status =
        snow_volume_open(context, c->path, &c->options, &volume);
    faults.fault = NO_FAULT;
    const long calls = faults.calls;
    if (faults.held)
        fail_msg("%s: %ld files stay open", c->path, faults.held);
    snprintf(c->message, sizeof c->message, "%s",
             snow_context_message(context));
    if (status == SNOW_STATUS_OK &&
        snow_volume_save(volume, c->out, true) == SNOW_STATUS_OK) {
        FILE *file = fopen(c->out, "rb");
        assert_non_null(file);
        size = fread(bytes, 1, room, file);
        fclose(file);
    }
    assert_true((status == SNOW_STATUS_OK) == (volume != NULL));
    snow_volume_close(volume);
    assert_int_equal(snow_context_bytes(context), 0);
    snow_context_free(context);
    faults.calls = calls;
    return size;
}

#define ROOM ((size_t)1 << 20)
static unsigned char wanted[ROOM], found[ROOM];

/* One line that names a file of the folder and says what to do. */
static bool is_told(const conversion *c) {
    return strstr(c->message, c->folder) && strchr(c->message, ';') &&
           !strchr(c->message, '\n');
}

static void fail_call(conversion *c, const char *name, size_t size, long call,
                      fault_kind fault, bool for_good) {
    const char kind = faults.kinds[call];
    const size_t got = convert(c, fault, call, for_good, found, ROOM);
    if (got ? got == size && !memcmp(found, wanted, size)
            : fault >= BROKEN && is_told(c))
        return;
    fail_msg("%s, call %ld (%c), fault %d%s: %s", name, call, kind, (int)fault,
             for_good ? " for good" : "", got ? "other voxels" : c->message);
}

/* Every call fails in turn.  What cannot be opened anyway is left out. */
static bool fail_each(conversion *c, const char *name) {
    static char kinds[MOST_CALLS];
    const size_t size = convert(c, NO_FAULT, 0, false, wanted, ROOM);
    const long calls = faults.calls;
    if (!size || size == ROOM)
        return false;
    assert_true(calls > 3 && calls < MOST_CALLS);
    memcpy(kinds, faults.kinds, sizeof kinds);
    const long step = (long)support_stride(5);
    for (long call = (long)support_start((size_t)calls, 5); call < calls;
         call += step)
        for (fault_kind fault = INTERRUPTED; fault <= CLOSED; fault++)
            for (int for_good = 0; for_good < 2; for_good++)
                if (fault == BROKEN ||
                    (fault == CLOSED && kinds[call] == 'n') ||
                    (fault == SHORT && kinds[call] == 'r') ||
                    (fault == INTERRUPTED && kinds[call] == 'r' && !for_good))
                    fail_call(c, name, size, call, fault, for_good);
    return true;
}

static void volumes_in_several_files_are_whole_or_refused(void **state) {
    (void)state;
    for (size_t n = 0; n < sizeof samples / sizeof *samples; n++) {
        conversion c;
        char name[64];
        begin(&c, samples[n].open);
        write_sample(&c, &samples[n]);
        snprintf(name, sizeof name, "sample %zu, %s", n, samples[n].open);
        if (!fail_each(&c, name))
            fail_msg("%s: %s", name, c.message);
        support_folder_remove(c.folder);
    }
}

static void try_corpus(const char *subject, const char *suffix) {
    char folder[512];
    int opened = 0;
    snprintf(folder, sizeof folder, "%s/%s", SNOW_CORPUS, subject);
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    for (const struct dirent *entry; (entry = readdir(stream));) {
        char name[300], text[310], inside[64];
        conversion c;
        if (*entry->d_name == '.')
            continue;
        snprintf(name, sizeof name, "%s/%s", subject, entry->d_name);
        snprintf(text, sizeof text, ":%s", name);
        snprintf(inside, sizeof inside, "in/a%s", suffix);
        begin(&c, inside + 3);
        write_file(c.folder, inside, text);
        opened += fail_each(&c, name);
        support_folder_remove(c.folder);
    }
    closedir(stream);
    assert_true(opened > 0);
}

static void files_of_each_format_are_whole_or_refused(void **state) {
    (void)state;
    static const char *const subjects[][2] = {
        {"amrex", ".plt"}, {"den", ".den"},        {"dicom", ".dcm"},
        {"hdf5", ".h5"},   {"jpeg", ".jpg"},       {"metaimage", ".mha"},
        {"mrc", ".mrc"},   {"netcdf", ".nc"},      {"nifti", ".nii"},
        {"nrrd", ".nrrd"}, {"npy_volume", ".npy"}, {"png_slice", ".png"},
        {"tiff", ".tif"},  {"vti", ".vti"},        {"vtk", ".vtk"},
        {"vtr", ".vtr"},   {"zarr", ".zarr"},
    };
    for (size_t n = 0; n < sizeof subjects / sizeof *subjects; n++)
        try_corpus(subjects[n][0], subjects[n][1]);
}

/* --- links that lead nowhere ---------------------------------------------- */

/* Of a volume, each file in turn is a link to a file that has not been fetched,
 * as of git-annex. */
static void unlink_each(conversion *c, const char *folder, size_t size) {
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    for (const struct dirent *entry; (entry = readdir(stream));) {
        char path[512], aside[512];
        struct stat about;
        if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, ".."))
            continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        assert_int_equal(lstat(path, &about), 0);
        if (S_ISDIR(about.st_mode)) {
            unlink_each(c, path, size);
            continue;
        }
        snprintf(aside, sizeof aside, "%s/aside", c->folder);
        assert_int_equal(rename(path, aside), 0);
        assert_int_equal(symlink("nowhere", path), 0);
        const size_t got = convert(c, NO_FAULT, 0, false, found, ROOM);
        if (got ? got != size || memcmp(found, wanted, size) != 0
                : !strstr(c->message, path))
            fail_msg("%s leads nowhere: %s", path,
                     got ? "other voxels" : c->message);
        assert_int_equal(rename(aside, path), 0);
    }
    closedir(stream);
}

static void a_link_that_leads_nowhere_is_no_missing_file(void **state) {
    (void)state;
    for (size_t n = 0; n < sizeof samples / sizeof *samples; n++) {
        conversion c;
        char folder[128];
        begin(&c, samples[n].open);
        write_sample(&c, &samples[n]);
        size_t size = convert(&c, NO_FAULT, 0, false, wanted, ROOM);
        snprintf(folder, sizeof folder, "%s/in", c.folder);
        unlink_each(&c, folder, size);
        support_folder_remove(c.folder);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_in_several_files_are_whole_or_refused),
        cmocka_unit_test(files_of_each_format_are_whole_or_refused),
        cmocka_unit_test(a_link_that_leads_nowhere_is_no_missing_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
