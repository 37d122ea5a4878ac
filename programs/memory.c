/* memory.c - the need is computed from sizes alone, before voxels are read.
 *
 *   limit    0 ........ smallest slab ........ voxels and picture ........
 *                refused      |     in slabs           |    in memory
 *
 * Bytes of an interesting voxel are those of the encodings: its value as a code
 * of 8 or 16 bits and a normal of 16 bits where it is shaded, or four floats
 * for the exact methods; its place takes a bit and a little more. */
#include "memory.h"
#include "commands.h"
#include "free_memory.h"
#include "launch.h"
#include "report.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define PIXEL_BYTES 16  /* four floats */
#define PLACE_SHARE 7   /* EA: one byte for so many voxels */
#define BOUND_BYTES 0.5 /* 16 bits for four voxels */

static double sheared_bytes(const options *asked, double value_bytes) {
    double code = value_bytes > 1 ? 2 : 1;
    double normal = strcmp(asked->shade, "none") ? 2 : 0;
    /* Bounds of largest values, which have no normals. */
    if (strcmp(asked->mode, "mip") == 0 || strcmp(asked->mode, "minip") == 0)
        normal = normal > BOUND_BYTES ? normal : BOUND_BYTES;
    /* Slices between slices are encoded as well. */
    double times = strcmp(asked->quality, "high") ? 1 : 2;
    return times * (code + normal + 1.0 / PLACE_SHARE);
}

/* Of an interesting voxel, when all else is there. */
static double encoded_bytes(const options *asked,
                            const snow_volume_info *info) {
    if (strcmp(asked->method, "original") == 0)
        return 0;
    if (strcmp(asked->method, "footprint") == 0)
        return PIXEL_BYTES + 1.0 / PLACE_SHARE;
    double value = (double)snow_type_size(info->type);
    double bytes = sheared_bytes(asked, value);
    /* A draft of few pixels: a level of half the voxels or fewer, which are
     * encoded in place of the volume's. */
    double level = (value + bytes) / 2;
    bool draft = strcmp(asked->quality, "draft") == 0;
    return draft && level > bytes ? level : bytes;
}

/* Of the largest intermediate image: two slice sides, each longer by what the
 * slices are moved. */
static double image_bytes(const options *asked, const snow_volume_info *info) {
    const int64_t *dims = info->dims;
    double scale = strcmp(asked->quality, "draft") ? 2 : 1, most = 0;
    for (int axis = 0; axis < 3; axis++) {
        double deep = (double)dims[axis];
        double wide = (double)dims[(axis + 1) % 3] + deep;
        double high = (double)dims[(axis + 2) % 3] + deep;
        if (wide * high > most)
            most = wide * high;
    }
    return most * scale * scale * PIXEL_BYTES;
}

static uint64_t picture_bytes(const options *asked) {
    return (uint64_t)(asked->size[0] * asked->size[1]) * PIXEL_BYTES;
}

memory_need memory_needed(const options *asked, const snow_volume_info *info) {
    double voxels =
        (double)info->dims[0] * (double)info->dims[1] * (double)info->dims[2];
    double least = voxels * (double)snow_type_size(info->type) +
                   (double)picture_bytes(asked);
    double most =
        least + voxels * encoded_bytes(asked, info) + image_bytes(asked, info);
    return (memory_need){(uint64_t)least, (uint64_t)most};
}

/* What is known of a volume before it is opened. */
typedef struct sizes {
    snow_volume_info info;
    uint64_t voxels, picture; /* bytes */
    uint64_t masking;         /* bytes beside the voxels while they are read */
    bool packed;              /* perhaps: the file is shorter than they */
    memory_need need;
} sizes;

/* Bytes of voxels as they are read; 0 of what cannot be looked at, which the
 * reading tells. */
static uint64_t native_bytes(snow_context *context, const char *path,
                             const snow_volume_options *data) {
    snow_volume_info info;
    if (snow_volume_inspect(context, path, data, &info) != SNOW_OK)
        return 0;
    return (uint64_t)(info.dims[0] * info.dims[1] * info.dims[2]) *
           snow_type_size(info.type);
}

/* The mask, and the volume before it was masked or clipped, are there together
 * with what comes of both. */
static uint64_t masking_bytes(snow_context *context, const char *path,
                              const snow_volume_options *data) {
    snow_volume_options plain = *data, mask = {.type = SNOW_TYPE_NONE};
    const double *plane = data->clip[0];
    bool clips = plane[0] != 0 || plane[1] != 0 || plane[2] != 0;
    if (!data->mask && !clips)
        return 0;
    plain.mask = plain.labels = NULL;
    memset(plain.clip, 0, sizeof plain.clip);
    memcpy(mask.crop, data->crop, sizeof mask.crop);
    return native_bytes(context, path, &plain) +
           (data->mask ? native_bytes(context, data->mask, &mask) : 0);
}

/* A file of a few kilobytes is a header. */
static bool is_packed(const char *path, uint64_t voxels) {
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode))
        return false;
    uint64_t bytes = (uint64_t)about.st_size;
    return bytes > 65536 && bytes < voxels / 10 * 9;
}

/* A pipe, which only the reading may read. */
static bool is_read_once(const char *path) {
    struct stat about;
    return strcmp(path, "-") == 0 ||
           (stat(path, &about) == 0 && !S_ISREG(about.st_mode) &&
            !S_ISDIR(about.st_mode));
}

/* Looks at the headers in a context of its own, whose remarks nobody hears: the
 * opening makes them too, and tells what is wrong with the file.  False where
 * something is. */
static bool measure(const options *asked, const char *path,
                    const snow_volume_options *data, sizes *out) {
    sizes s = {.picture = picture_bytes(asked)};
    snow_context *context;
    if (is_read_once(path) || snow_context_new(NULL, &context) != SNOW_OK)
        return false;
    bool fine = snow_volume_inspect(context, path, data, &s.info) == SNOW_OK;
    if (fine) {
        s.masking = masking_bytes(context, path, data);
        s.need = memory_needed(asked, &s.info);
        s.voxels = s.need.least - s.picture;
        if (s.voxels + s.masking > s.need.least)
            s.need.least = s.voxels + s.masking;
        if (s.need.least > s.need.most)
            s.need.most = s.need.least;
        s.packed = is_packed(path, s.voxels);
        *out = s;
    }
    snow_context_free(context);
    return fine;
}

/* "12.3 MiB". */
static const char *print_bytes(uint64_t bytes, char text[32]) {
    static const char *const units[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    double value = (double)bytes;
    int unit = 0;
    for (; value >= 1024 && unit < 4; unit++)
        value /= 1024;
    snprintf(text, 32, "%.*f %s", unit ? 1 : 0, value, units[unit]);
    return text;
}

/* --- in slabs ------------------------------------------------------------- */

/* Why a picture cannot be made of slabs; NULL: it can. */
static const char *why_whole(const char *path) {
    if (launch_ranks() > 1 || strcmp(path, "-") == 0)
        return "it";
    if (strncmp(path, "phantom:", 8) == 0)
        return "a phantom";
    return NULL;
}

/* Slices of the smallest slab: one, and those beside it. */
#define SLICES_LEAST 3

/* Tables of colours and counts, for 256 codes and for 65,536. */
#define TABLES_SMALL ((uint64_t)1 << 20)
#define TABLES_LARGE ((uint64_t)4 << 20)

/* Slices that a thread encodes where slices lie along x and y: a band. */
#define BAND_SLICES 32

/* Longer slabs are not read faster. */
#define SLAB_USUAL ((uint64_t)24 << 20)

/* Bytes of a slab while it is read. */
static uint64_t slab_bytes(const sizes *s, int64_t slices) {
    int64_t all = s->info.dims[2];
    if (slices > all)
        slices = all;
    return (s->voxels + s->masking) / (uint64_t)all * (uint64_t)slices;
}

/* Small, for most of the room is the interesting voxels'; but a band for each
 * thread where an eighth of it makes room for them, and of a packed file, all
 * of which is unpacked for each slab, a third.  In bytes of voxels alone. */
static uint64_t choose_slab(const sizes *s, uint64_t limit, int threads) {
    uint64_t room = limit > s->picture ? limit - s->picture : 0;
    uint64_t eighth = room / 8;
    uint64_t most = eighth < SLAB_USUAL ? eighth : SLAB_USUAL;
    for (int n = threads; n > 0; n--) {
        uint64_t bands = slab_bytes(s, n * BAND_SLICES + 2);
        if (bands > most && bands <= eighth)
            most = bands;
    }
    if (s->packed)
        most = room / 3;
    double share = (double)s->voxels / (double)(s->voxels + s->masking);
    return (uint64_t)((double)most * share) + 1;
}

/* --- plans ---------------------------------------------------------------- */

/* What this machine has, but for what others may want while it works; and what
 * --memory allows. */
static uint64_t limit_of(const options *asked, bool *own) {
    uint64_t there = free_memory();
    *own = there == UINT64_MAX || (asked->memory && asked->memory <= there);
    if (*own)
        return asked->memory;
    return there / 10 * 9;
}

/* Whether the files of a folder are so small that their voxels fit for certain:
 * looking into all of them twice would take time.  Slices are packed to a
 * quarter at best. */
static bool is_small_folder(const char *path) {
    char name[PATH_MAX];
    struct stat about;
    uint64_t bytes = 0;
    DIR *folder = opendir(path);
    if (!folder)
        return false;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (entry->d_name[0] == '.')
            continue;
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        if (stat(name, &about) == 0)
            bytes +=
                S_ISDIR(about.st_mode) ? UINT32_MAX : (uint64_t)about.st_size;
    }
    closedir(folder);
    return bytes < free_memory() / 8;
}

static int threads_of(const options *asked) {
    return asked->threads ? (int)asked->threads : launch_processors();
}

static void tell_need(const sizes *s) {
    char least[32], most[32];
    say("memory: at least %s, about %s if all voxels are interesting",
        print_bytes(s->need.least, least), print_bytes(s->need.most, most));
}

/* The smallest slab, the tables of a look and the picture. */
static uint64_t slabs_least(const sizes *s) {
    bool small = snow_type_size(s->info.type) == 1;
    return slab_bytes(s, SLICES_LEAST) + s->picture +
           (small ? TABLES_SMALL : TABLES_LARGE);
}

/* `why` the voxels have to be there at once: NULL where they need not, and
 * nothing would fit even so. */
static int refuse(const sizes *s, const char *path, uint64_t limit, bool own,
                  const char *why) {
    char need[32], room[32];
    const char *of = own ? "--memory" : "free memory";
    bool slabs = !why && slabs_least(s) < s->need.least;
    print_bytes(slabs ? slabs_least(s) : s->need.least, need);
    print_bytes(limit, room);
    if (slabs)
        say("%s: a slab of slices, tables and the picture alone need %s, over "
            "the %s of %s; raise it, give --crop or a smaller --size",
            path, need, of, room);
    else
        say("%s: voxels and picture need %s, over the %s of %s%s%s%s; raise "
            "it, give --crop, or let several machines share the volume "
            "(snowglass-mpi)",
            path, need, of, room, why ? ", and " : "", why ? why : "",
            why ? " needs all of them at once" : "");
    return SNOW_NO_MEMORY;
}

int memory_plan_for(const options *asked, const char *path,
                    const snow_volume_options *data, bool tell,
                    memory_plan *out) {
    const char *why = why_whole(path);
    bool own = true;
    uint64_t limit = asked->memory;
    sizes s;
    *out = (memory_plan){.may_stream = !why, .limit = asked->memory};
    if (!asked->memory && !tell && is_small_folder(path))
        return GO_ON;
    if (!measure(asked, path, data, &s)) {
        out->may_stream = false;
        return GO_ON;
    }
    if (tell)
        tell_need(&s);
    limit = limit_of(asked, &own);
    if (limit)
        out->slab_bytes = choose_slab(&s, limit, threads_of(asked));
    out->packed = s.packed;
    if (!limit || s.need.least <= limit)
        return GO_ON;
    if (why && (!asked->memory || s.need.least <= asked->memory))
        return GO_ON; /* the system may know better what it has */
    out->limit = limit;
    if (why || slabs_least(&s) > limit || slabs_least(&s) >= s.need.least)
        return refuse(&s, path, limit, own, why);
    out->streams = true;
    return GO_ON;
}

int memory_check(const options *asked, const char *path,
                 const snow_volume_options *data) {
    sizes s;
    if (!asked->memory || !measure(asked, path, data, &s) ||
        s.need.least <= asked->memory)
        return GO_ON;
    return refuse(&s, path, asked->memory, true, "the range of all steps");
}
