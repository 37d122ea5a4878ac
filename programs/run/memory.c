/* memory.c - computes the memory that is needed from sizes alone, before voxels
 * are read.
 *
 *   limit    0 ........ smallest slab ........ voxels and picture ........
 *                refused      |     in slabs           |    in memory
 *
 * Bytes of an interesting voxel are those of the encodings: its value of 8 or
 * 16 bits, or four floats for the footprint methods.  Its position takes little
 * more than one bit. */
#include "run/memory.h"
#include "commands/commands.h"
#include "run/free_memory.h"
#include "run/log.h"
#include "run/start.h"

#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define PIXEL_BYTES 16 /* four floats */
#define PLACE_SHARE 7  /* EA: one byte for this many voxels */
#define MASK_BYTES 1   /* of shear-warp: masks and bounds of cells */

/* Bytes of an interesting voxel, without the arrays that all voxels share. */
static double encoded_bytes(const options *opts, const snow_volume_info *info) {
    if (strcmp(opts->method, "original") == 0 ||
        strcmp(opts->method, "raycast") == 0)
        return 0;
    if (strcmp(opts->method, "footprint") == 0)
        return PIXEL_BYTES + 1.0 / PLACE_SHARE;
    /* Rows of integers of 8 and 16 bits are as they are, and other types
     * numbers of 16 bits; where they are not read in place, they are packed
     * too. */
    return 2 * (snow_type_size(info->type) > 1 ? 2 : 1) + MASK_BYTES;
}

/* Bytes of the largest intermediate image: the two sides of a slice, each
 * extended by the largest shift of the slices. */
static double image_bytes(const options *opts, const snow_volume_info *info) {
    const int64_t *dims = info->dims;
    double scale = strcmp(opts->quality, "draft") ? 2 : 1, most = 0;
    for (int axis = 0; axis < 3; axis++) {
        double deep = (double)dims[axis];
        double wide = (double)dims[(axis + 1) % 3] + deep;
        double high = (double)dims[(axis + 2) % 3] + deep;
        if (wide * high > most)
            most = wide * high;
    }
    return most * scale * scale * PIXEL_BYTES;
}

static uint64_t picture_bytes(const options *opts) {
    return (uint64_t)(opts->size[0] * opts->size[1]) * PIXEL_BYTES;
}

memory_need memory_needed(const options *opts, const snow_volume_info *info) {
    double voxels =
        (double)info->dims[0] * (double)info->dims[1] * (double)info->dims[2];
    double least = voxels * (double)snow_type_size(info->type) +
                   (double)picture_bytes(opts);
    double most =
        least + voxels * encoded_bytes(opts, info) + image_bytes(opts, info);
    return (memory_need){(uint64_t)least, (uint64_t)most};
}

/* The sizes that are known before a volume is opened. */
typedef struct sizes {
    snow_volume_info info;
    uint64_t voxels, picture; /* bytes */
    uint64_t looks;           /* each with tables of its own */
    uint64_t masking; /* bytes needed beside the voxels while they are read */
    bool packed;      /* the file is shorter than the voxels: it is compressed,
                         or has fewer bits for each, or not all of them */
    memory_need need;
} sizes;

/* Bytes of the voxels in their native type; 0 for a file that cannot be
 * inspected, which reading will report. */
static uint64_t native_bytes(snow_context *context, const char *path,
                             const snow_volume_options *data) {
    snow_volume_info info = {.size = sizeof info};
    if (snow_volume_inspect(context, path, data, &info) != SNOW_STATUS_OK)
        return 0;
    return (uint64_t)(info.dims[0] * info.dims[1] * info.dims[2]) *
           snow_type_size(info.type);
}

/* The mask, and the volume before masking or clipping (*stored), are in memory
 * together with the result. */
static uint64_t masking_bytes(snow_context *context, const char *path,
                              const snow_volume_options *data,
                              uint64_t *stored) {
    snow_volume_options plain = *data, mask = {.size = sizeof mask};
    const double *plane = data->clip[0];
    bool clips = plane[0] != 0 || plane[1] != 0 || plane[2] != 0;
    if (!data->mask && !clips)
        return 0;
    plain.mask = plain.labels = NULL;
    memset(plain.clip, 0, sizeof plain.clip);
    memcpy(mask.crop, data->crop, sizeof mask.crop);
    *stored = native_bytes(context, path, &plain);
    return *stored +
           (data->mask ? native_bytes(context, data->mask, &mask) : 0);
}

/* A file of a few kilobytes is only a header. */
static bool is_packed(const char *path, uint64_t voxels) {
    struct stat about;
    if (stat(path, &about) != 0 || !S_ISREG(about.st_mode))
        return false;
    uint64_t bytes = (uint64_t)about.st_size;
    return bytes > 65536 && bytes < voxels / 10 * 9;
}

/* Others of the same size, which are read beside the first. */
static void add_channels(const options *opts, int more, sizes *s) {
    const memory_need one = memory_needed(opts, &s->info);
    const uint64_t picture = s->picture,
                   several = more > 0 ? (uint64_t)more : 0;
    s->need.least += several * (one.least - picture);
    s->need.most += several * (one.most - picture);
    s->masking += several * (one.least - picture);
    s->looks = 1 + several;
}

/* Inspects the headers in a context of its own, without warnings: opening the
 * file repeats them and reports its errors.  Returns false on error. */
static bool measure(const options *opts, const char *path,
                    const snow_volume_options *data, int count, sizes *out) {
    sizes s = {.info = {.size = sizeof s.info}, .picture = picture_bytes(opts)};
    snow_context *context;
    struct stat about;
    const bool piped = strcmp(path, "-") == 0 ||
                       (stat(path, &about) == 0 && !S_ISREG(about.st_mode) &&
                        !S_ISDIR(about.st_mode));
    if (piped /* and can be read only once */ ||
        snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return false;
    bool fine =
        snow_volume_inspect(context, path, data, &s.info) == SNOW_STATUS_OK;
    if (fine) {
        uint64_t stored = 0;
        const uint64_t overlay =
            opts->overlay ? native_bytes(context, opts->overlay, NULL) : 0;
        s.masking = masking_bytes(context, path, data, &stored);
        s.need = memory_needed(opts, &s.info);
        s.voxels = s.need.least - s.picture;
        /* For the magnitude, a component beside the result. */
        s.masking += s.info.magnitude ? s.voxels : 0;
        if (s.voxels + s.masking > s.need.least)
            s.need.least = s.voxels + s.masking;
        s.need.least += overlay;
        s.need.most += overlay;
        if (s.need.least > s.need.most)
            s.need.most = s.need.least;
        s.masking += overlay;
        add_channels(opts, count - 1, &s);
        s.packed = is_packed(path, stored ? stored : s.voxels);
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

/* Why a picture cannot be made from slabs; NULL if it can. */
static const char *why_whole(const char *path) {
    if (process_ranks() > 1 || strcmp(path, "-") == 0)
        return "this input";
    if (strncmp(path, "phantom:", 8) == 0)
        return "a phantom";
    return NULL;
}

/* Slices of the smallest slab: one and its neighbours. */
#define SLICES_LEAST 3

/* Bytes of the tables of colours and counts, for 256 codes and for 65,536. */
#define TABLES_SMALL ((uint64_t)1 << 20)
#define TABLES_LARGE ((uint64_t)4 << 20)

/* Slices that a thread encodes if slices lie along x and y: a band. */
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

/* Chooses the bytes of a slab's voxels.  Slabs are small, since most of the
 * memory is for interesting voxels.  But there is a band for each thread if it
 * fits into an eighth of the limit.  A packed file is unpacked again for each
 * slab, and a mask applied, so these may take a third. */
static uint64_t choose_slab(const sizes *s, uint64_t limit, int threads) {
    uint64_t capacity = limit > s->picture ? limit - s->picture : 0;
    uint64_t eighth = capacity / 8;
    uint64_t most = eighth < SLAB_USUAL ? eighth : SLAB_USUAL;
    for (int n = threads; n > 0; n--) {
        uint64_t bands = slab_bytes(s, n * BAND_SLICES + 2);
        if (bands > most && bands <= eighth)
            most = bands;
    }
    if (s->packed || s->masking)
        most = capacity / 3;
    double share = (double)s->voxels / (double)(s->voxels + s->masking);
    return (uint64_t)((double)most * share) + 1;
}

/* Bytes of the smallest slab, the tables of the look and the picture. */
static uint64_t slabs_least(const sizes *s) {
    bool small = snow_type_size(s->info.type) == 1;
    return slab_bytes(s, SLICES_LEAST) + s->picture +
           s->looks * (small ? TABLES_SMALL : TABLES_LARGE);
}

/* --- plans ---------------------------------------------------------------- */

/* The limit: what this machine has free, less a reserve for other programs, or
 * what --memory allows. */
static uint64_t limit_of(const options *opts, bool *own) {
    uint64_t there = free_memory();
    *own = there == UINT64_MAX || (opts->memory && opts->memory <= there);
    if (*own)
        return opts->memory;
    return there / 10 * 9;
}

bool memory_holds(const options *opts, const snow_volume_info *info, int count,
                  char *why, size_t size) {
    char need[32], scratch[32];
    bool own;
    const uint64_t limit = limit_of(opts, &own);
    sizes s = {.info = *info,
               .picture = picture_bytes(opts),
               .need = memory_needed(opts, info)};
    s.voxels = s.need.least - s.picture;
    add_channels(opts, count - 1, &s);
    const uint64_t least =
        slabs_least(&s) < s.need.least ? slabs_least(&s) : s.need.least;
    if (!limit || least <= limit)
        return true;
    snprintf(why, size, "several need %s of memory, over the %s of %s",
             print_bytes(least, need), print_bytes(limit, scratch),
             own ? "--memory" : "free memory");
    return false;
}

/* Slices are compressed to a quarter at best. */
bool memory_is_small_folder(const char *path) {
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

/* Refuses the volume.  `why` says why all voxels must be in memory at once;
 * NULL if slabs would do but do not fit either. */
static int refuse_volume(const sizes *s, const char *path, uint64_t limit,
                         bool own, const char *why) {
    char need[32], scratch[32];
    const char *of = own ? "--memory" : "free memory";
    const char *advice = own ? "raise it, " : "";
    bool slabs = !why && slabs_least(s) < s->need.least;
    print_bytes(slabs ? slabs_least(s) : s->need.least, need);
    print_bytes(limit, scratch);
    if (slabs)
        say("%s: one slab, tables and the picture need %s, over the %s of %s; "
            "%suse --crop or a smaller --size",
            path, need, of, scratch, advice);
    else
        say("%s: voxels and picture need %s, over the %s of %s%s%s%s; %suse "
            "--crop, or share the volume among several machines "
            "(snowglass-mpi)",
            path, need, of, scratch, why ? ", and " : "", why ? why : "",
            why ? " needs all voxels at once" : "", advice);
    return SNOW_STATUS_NO_MEMORY;
}

int memory_plan_for(const options *opts, const char *path,
                    const snow_volume_options *data, int count, bool report,
                    memory_plan *out) {
    const char *why = why_whole(path);
    bool own = true;
    uint64_t limit = opts->memory;
    sizes s;
    *out = (memory_plan){.may_stream = !why, .limit = opts->memory};
    if (!opts->memory && !report && count < 2 && memory_is_small_folder(path))
        return CONTINUE;
    if (!measure(opts, path, data, count, &s)) {
        out->may_stream = false;
        return CONTINUE;
    }
    if (report) {
        char least[32], most[32];
        say("memory: at least %s, about %s if all voxels are interesting",
            print_bytes(s.need.least, least), print_bytes(s.need.most, most));
    }
    limit = limit_of(opts, &own);
    if (limit)
        out->slab_bytes = choose_slab(&s, limit,
                                      opts->threads ? (int)opts->threads
                                                    : process_processors());
    out->packed = s.packed;
    if (!limit || s.need.least <= limit)
        return CONTINUE;
    if (why && (!opts->memory || s.need.least <= opts->memory))
        return CONTINUE; /* the system may know better what is free */
    out->limit = limit;
    if (why || slabs_least(&s) > limit || slabs_least(&s) >= s.need.least)
        return refuse_volume(&s, path, limit, own, why);
    out->streams = true;
    return CONTINUE;
}

int memory_check(const options *opts, const char *path,
                 const snow_volume_options *data) {
    sizes s;
    if (!opts->memory || !measure(opts, path, data, 1, &s) ||
        s.need.least <= opts->memory)
        return CONTINUE;
    return refuse_volume(&s, path, opts->memory, true,
                         "the range of all steps");
}
