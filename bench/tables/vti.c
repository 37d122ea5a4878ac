/* bench/tables/vti.c - 8-bit volumes out of VTK's ImageData files (.vti), as
 * public collections offer the classic test volumes.
 *
 * Read is what those files are, and no more: one DataArray of UInt8 in one
 * piece, appended raw, compressed by zlib, UInt64 headers, little endian:
 *
 *   ... <AppendedData encoding="raw"> _
 *   blocks, bytes of a block, bytes of a last shorter one (0: none),
 *   compressed bytes of each block        (UInt64 each)
 *   block, block, ...                     (zlib streams)
 *
 * The library itself reads no .vti; the bench does, so that its figures can be
 * of real volumes without a converter. */
#include "bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define SIDE_MOST 2048 /* voxels; keeps every product below far from 2^63 */

/* A whole file in memory, with a 0 behind its bytes. */
typedef struct text {
    unsigned char *bytes;
    size_t size;
} text;

static snow_status refuse(const char *path, const char *why) {
    fprintf(stderr,
            "snowglass: bench: %s: %s; the bench reads 8-bit .vti files, "
            "appended raw with zlib and UInt64 headers\n",
            path, why);
    return SNOW_STATUS_BAD_INPUT;
}

static snow_status read_whole(const char *path, text *out) {
    FILE *file = fopen(path, "rb");
    long size = -1;
    if (file && fseek(file, 0, SEEK_END) == 0)
        size = ftell(file);
    snow_status status = SNOW_STATUS_OK;
    if (size < 0 || fseek(file, 0, SEEK_SET) != 0)
        status = refuse(path, "cannot be read");
    else if (!(out->bytes = malloc((size_t)size + 1)))
        status = SNOW_STATUS_NO_MEMORY;
    else if (fread(out->bytes, 1, (size_t)size, file) != (size_t)size)
        status = refuse(path, "cannot be read whole");
    else
        out->bytes[out->size = (size_t)size] = 0;
    if (file)
        fclose(file);
    return status;
}

/* The text behind NAME=" in the XML part, NULL when it is not there. */
static const char *attribute(const char *xml, const char *name) {
    char key[64];
    snprintf(key, sizeof key, " %s=\"", name);
    const char *found = strstr(xml, key);
    return found ? found + strlen(key) : NULL;
}

static bool is(const char *xml, const char *name, const char *value) {
    const char *found = attribute(xml, name);
    size_t length = strlen(value);
    return found && strncmp(found, value, length) == 0 && found[length] == '"';
}

/* Dimensions and spacing out of the XML part, which ends at the first byte 0:
 * `_` and a header's upper bytes come soon after it. */
static const char *read_head(const char *xml, snow_volume_info *info) {
    int first[3], last[3];
    double step[3];
    const char *array = strstr(xml, "<DataArray");
    const char *extent = attribute(xml, "WholeExtent");
    const char *spacing = attribute(xml, "Spacing");
    if (!is(xml, "header_type", "UInt64") ||
        !is(xml, "byte_order", "LittleEndian") ||
        !is(xml, "compressor", "vtkZLibDataCompressor") ||
        !is(xml, "encoding", "raw") || !array || !is(array, "type", "UInt8"))
        return "another kind of VTK file";
    if (!extent || sscanf(extent, "%d %d %d %d %d %d", first, last, first + 1,
                          last + 1, first + 2, last + 2) != 6)
        return "its WholeExtent cannot be read";
    if (!spacing ||
        sscanf(spacing, "%lf %lf %lf", step, step + 1, step + 2) != 3)
        return "its Spacing cannot be read";
    for (int i = 0; i < 3; i++) {
        if (last[i] < first[i] || last[i] - first[i] >= SIDE_MOST ||
            first[i] < 0)
            return "its WholeExtent is out of range";
        info->dims[i] = last[i] - first[i] + 1;
        info->matrix[i][i] = step[i];
    }
    info->matrix[3][3] = 1;
    return NULL;
}

static uint64_t number_at(const unsigned char *bytes) {
    uint64_t value = 0;
    for (int i = 7; i >= 0; i--)
        value = value << 8 | bytes[i];
    return value;
}

/* Inflates all blocks into `voxels`.  Nothing of the header is believed: each
 * block lies within the file and fills exactly its part of the voxels. */
static const char *inflate_blocks(const unsigned char *data, size_t size,
                                  unsigned char *voxels, size_t voxel_bytes) {
    if (size < 24 || number_at(data) == 0 || number_at(data) > size / 8 - 3)
        return "its header is damaged";
    size_t blocks = number_at(data);
    uint64_t full = number_at(data + 8), last = number_at(data + 16);
    size_t at = 24 + 8 * blocks, done = 0;
    for (size_t i = 0; i < blocks; i++) {
        uint64_t packed = number_at(data + 24 + 8 * i);
        uint64_t want = last && i + 1 == blocks ? last : full;
        if (packed > size - at || want > voxel_bytes - done)
            return "its blocks do not fit";
        uLongf got = (uLongf)want;
        if (uncompress(voxels + done, &got, data + at, (uLong)packed) != Z_OK ||
            got != want)
            return "a block is damaged";
        at += packed;
        done += want;
    }
    return done == voxel_bytes ? NULL : "it ends too early";
}

/* Head, blocks, volume, of a file in memory. */
static snow_status open_text(snow_context *context, const char *path,
                             const text *file, unsigned char **voxels,
                             snow_volume **out) {
    snow_volume_info info = {.size = sizeof info, .type = SNOW_TYPE_UINT8};
    const char *why = read_head((const char *)file->bytes, &info);
    const char *mark = strstr((const char *)file->bytes, "<AppendedData");
    mark = mark ? strchr(mark, '_') : NULL;
    if (!why && !mark)
        why = "it has no appended data";
    if (why)
        return refuse(path, why);
    size_t bytes = (size_t)(info.dims[0] * info.dims[1] * info.dims[2]);
    size_t at = (size_t)((const unsigned char *)mark + 1 - file->bytes);
    *voxels = malloc(bytes);
    if (!*voxels)
        return SNOW_STATUS_NO_MEMORY;
    why = inflate_blocks(file->bytes + at, file->size - at, *voxels, bytes);
    return why ? refuse(path, why)
               : snow_volume_wrap(context, &info, *voxels, out);
}

snow_status bench_vti_open(snow_context *context, const char *path,
                           unsigned char **voxels, snow_volume **out) {
    text file = {NULL, 0};
    unsigned char *made = NULL;
    snow_status status = read_whole(path, &file);
    if (status == SNOW_STATUS_OK)
        status = open_text(context, path, &file, &made, out);
    free(file.bytes);
    if (status == SNOW_STATUS_OK)
        *voxels = made;
    else
        free(made);
    return status;
}
