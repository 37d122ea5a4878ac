/* bench/tables/volumes.c - the paper's test volumes (section 5.2): Cube, Head,
 * Engine.
 *
 * Cube is artificial and always the phantom.  Head and Engine are the real
 * ones when their folder is given.  The paper renders 8-bit heads but does not
 * tell how the 16-bit scan was mapped; we take floor((v + 88) 0.0825), clipped
 * to 0..255: among linear mappings it comes near all three of the paper's
 * sparse ratios. */
#include "bench.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A longer --data is cut, not found, and told with the name that was tried. */
#define PATH_BYTES 4096

#define HEAD_OFFSET 88
#define HEAD_SCALE 0.0825

/* Raw files say nothing of themselves, so their form stands here, as the
 * collections that they come from give it. */
static const bench_source sources[] = {
    [BENCH_CUBE] = {"Cube",
                    "phantom:cube",
                    NULL,
                    {.size = sizeof(snow_volume_options)}},
    [BENCH_HEAD] = {"Head",
                    "phantom:head",
                    "classic/CThead_256x256x113_u16be.raw.gz",
                    {.size = sizeof(snow_volume_options),
                     .dims = {256, 256, 113},
                     .type = SNOW_TYPE_UINT16,
                     .endian = SNOW_ENDIAN_BIG}},
    [BENCH_ENGINE] = {"Engine",
                      "phantom:engine",
                      "classic/engine_256x256x110_u8.raw.gz",
                      {.size = sizeof(snow_volume_options),
                       .dims = {256, 256, 110},
                       .type = SNOW_TYPE_UINT8}},
};

const bench_source *bench_source_of(bench_set set) {
    return &sources[set];
}

static void spell_path(const bench_options *options, const char *file,
                       char *path, size_t size) {
    snprintf(path, size, "%s/%s", options->data, file);
}

bool bench_source_found(const bench_source *source,
                        const bench_options *options) {
    char path[PATH_BYTES];
    if (!options->data || !source->file)
        return true;
    spell_path(options, source->file, path, sizeof path);
    FILE *file = fopen(path, "rb");
    bool found = file && fgetc(file) != EOF; /* folders open, too */
    const char *reason = file ? "cannot be read" : strerror(errno);
    if (!found)
        fprintf(stderr,
                "snowglass: bench: %s: %s; --data takes the folder that holds "
                "classic/\n",
                path, reason);
    if (file)
        fclose(file);
    return found;
}

bool bench_data_found(const bench_options *options) {
    for (size_t i = 0; i < sizeof sources / sizeof *sources; i++)
        if (!bench_source_found(&sources[i], options))
            return false;
    return true;
}

/* Puts the 16-bit head's voxels on 8 bits.  The new volume shares them: they
 * live as long as `out`. */
static snow_status map_head(snow_context *context, bench_volume *out) {
    snow_volume_info info = *snow_volume_get_info(out->file);
    size_t voxels = (size_t)(info.dims[0] * info.dims[1] * info.dims[2]);
    const uint16_t *native = snow_volume_voxels(out->file);
    out->mapped = malloc(voxels);
    if (!out->mapped)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < voxels; i++) {
        double value = floor((native[i] + HEAD_OFFSET) * HEAD_SCALE);
        out->mapped[i] = (unsigned char)(value < 255 ? value : 255);
    }
    info.type = SNOW_TYPE_UINT8;
    snprintf(out->source + strlen(out->source),
             sizeof out->source - strlen(out->source),
             ", on 8 bits by floor((v + %d) * %g), our choice: the paper does "
             "not tell its own",
             HEAD_OFFSET, HEAD_SCALE);
    return snow_volume_wrap(context, &info, out->mapped, &out->volume);
}

/* What was opened is kept in words for the table: figures of a phantom are no
 * figures of the real volume. */
static snow_status open_file(snow_context *context, const bench_source *source,
                             const bench_options *options, bench_volume *out) {
    if (!options->data || !source->file) {
        snprintf(out->source, sizeof out->source, "%s", source->phantom);
        /* The rest of the options is the file's. */
        snow_volume_options size = {.size = sizeof size,
                                    .dims = {source->options.dims[0],
                                             source->options.dims[1],
                                             source->options.dims[2]}};
        return snow_volume_open(context, source->phantom, &size, &out->file);
    }
    char path[PATH_BYTES];
    spell_path(options, source->file, path, sizeof path);
    snprintf(out->source, sizeof out->source, "%s", source->file);
    size_t length = strlen(path);
    if (length > 4 && strcmp(path + length - 4, ".vti") == 0)
        return bench_vti_open(context, path, &out->mapped, &out->file);
    return snow_volume_open(context, path, &source->options, &out->file);
}

snow_status bench_source_open(snow_context *context, const bench_source *source,
                              const bench_options *options, bench_volume *out) {
    *out = (bench_volume){.name = source->name};
    snow_status status = open_file(context, source, options, out);
    if (status == SNOW_STATUS_OK) {
        out->volume = out->file;
        if (snow_volume_get_info(out->file)->type != SNOW_TYPE_UINT8)
            status = map_head(context, out);
    }
    if (status == SNOW_STATUS_OK)
        snow_volume_freeze(out->volume); /* nobody changes what we share */
    else
        bench_volume_close(out);
    return status;
}

const snow_look bench_linear_look = {.size = sizeof bench_linear_look,
                                     .preset = "linear",
                                     .range = SNOW_RANGE_VALUES,
                                     .low = 0,
                                     .high = 255};

snow_status bench_volume_open(snow_context *context, bench_set set,
                              const bench_options *options, bench_volume *out) {
    bench_source source = sources[set];
    if (options->quick) {
        /* For tests: an eighth of the phantom along each side. */
        for (int axis = 0; axis < 3; axis++)
            source.options.dims[axis] = axis < 2 ? 32 : 14;
    }
    snow_status status = bench_source_open(context, &source, options, out);
    if (status == SNOW_STATUS_OK) {
        status = snow_transfer_new_for_volume(out->volume, &bench_linear_look,
                                              &out->transfer);
        if (status != SNOW_STATUS_OK)
            bench_volume_close(out);
    }
    return status;
}

void bench_volume_close(bench_volume *volume) {
    snow_transfer_free(volume->transfer);
    if (volume->volume != volume->file)
        snow_volume_close(volume->volume);
    snow_volume_close(volume->file);
    free(volume->mapped);
    *volume = (bench_volume){0};
}
