/* formats/nifti/nifti.c - NIfTI-1 and NIfTI-2 volumes: .nii, and .hdr with
 * .img.
 *
 * The fourth axis is time, of which one step is read; those behind it are
 * components of a voxel, one volume after another.  Colours are three or four
 * bytes in each voxel.  Either file of a
 * pair may be opened.  Analyze 7.5, NIfTI's predecessor with the same header
 * size but without the magic, is refused: it does not distinguish left from
 * right. */
#include "formats/nifti/nifti.h"
#include "formats/array.h"
#include "formats/write.h"
#include "io/folder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Tests size field and magic together: 348 alone begins Analyze files as
 * well. */
static bool probe_nifti(const unsigned char *bytes, size_t size) {
    return nifti_header_size(bytes, size) != 0;
}

/* Fills info from the header; the sizes of the array are samples of a voxel, x,
 * y, z, time and components. */
static void describe_volume(const nifti_header *header, snow_context *context,
                            const snow_volume_options *options,
                            snow_volume_info *info, int64_t sizes[6]) {
    *info = snow_volume_info_default("nifti");
    memcpy(info->dims, header->dim + 1, sizeof info->dims);
    info->type = nifti_type(header->datatype);
    info->slope = header->slope;
    info->intercept = header->intercept;
    info->whole = header->labels;
    info->estimate = header->estimate;
    nifti_geometry(context, header, options, info);
    sizes[0] = nifti_samples(header->datatype);
    if (isfinite(header->cal_min) && isfinite(header->cal_max) &&
        header->cal_max > header->cal_min && !header->labels &&
        !header->vectors && !header->colors && sizes[0] == 1)
        memcpy(info->window, (double[2]){header->cal_min, header->cal_max},
               sizeof info->window);
    memcpy(sizes + 1, header->dim + 1, 4 * sizeof *sizes);
    /* Numbers that any header of 348 bytes can claim. */
    uint64_t last = (uint64_t)header->dim[5];
    if (!snow_mul_u64(last, (uint64_t)header->dim[6], &last) ||
        !snow_mul_u64(last, (uint64_t)header->dim[7], &last) ||
        last > INT64_MAX)
        last = INT64_MAX;
    sizes[5] = (int64_t)last;
    info->times = sizes[4];
}

/* Which of the values of a voxel. */
static snow_status pick(const nifti_header *header, snow_context *context,
                        const snow_volume_options *options,
                        const int64_t sizes[6], snow_volume_info *info,
                        int64_t *channel) {
    const bool colors = sizes[0] > 2, is_complex = sizes[0] == 2;
    const bool vectors = is_complex || (header->vectors && !colors);
    if (!vectors)
        snow_channels_begin(info, colors ? sizes[0] : sizes[5], false);
    if (colors || (header->colors && (sizes[5] == 3 || sizes[5] == 4)))
        snow_channels_are_colors(info);
    if (sizes[0] > 1 && sizes[5] > 1)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "has %lld %s in each voxel (dim); one is supported",
                         (long long)sizes[5],
                         colors ? "colours" : "complex numbers");
    SNOW_TRY(vectors ? snow_volume_pick_component(context, options,
                                                  is_complex ? 2 : sizes[5],
                                                  info, channel)
                     : snow_volume_pick_channel(context, options,
                                                info->channels, info, channel));
    return snow_volume_pick_time(context, "time step", options, info);
}

/* Reads the voxels from a source of which `taken` bytes were read. */
static snow_status read_voxels(snow_source *source, const nifti_header *header,
                               const snow_volume_options *options,
                               uint64_t taken, snow_volume_info *info,
                               snow_volume **out) {
    snow_context *context = snow_source_context(source);
    const uint64_t skip = header->vox_offset - taken;
    int64_t sizes[6], channel = 0;
    uint64_t steps[6], all;
    describe_volume(header, context, options, info, sizes);
    const uint64_t size = snow_type_size(info->type);
    if (!snow_array_steps(sizes, 6, size, steps, &all))
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "its sizes (dim) are too large for any file; correct the header");
    SNOW_TRY(pick(header, context, options, sizes, info, &channel));
    if (info->channels <= 1 && info->components <= 1) {
        SNOW_TRY(snow_volume_read(source, options, header->big_endian, skip,
                                  info, out));
    } else {
        snow_array array = {.big_endian = header->big_endian, .all = all};
        memcpy(array.step, steps + 1, sizeof array.step);
        array.first = (uint64_t)info->time * steps[4] +
                      (uint64_t)channel * steps[sizes[0] > 1 ? 0 : 5];
        SNOW_TRY(snow_source_skip(source, skip, "the voxels"));
        SNOW_TRY(snow_array_read(source, options, &array, info, out));
    }
    return out && header->labels ? snow_volume_set_labels(*out, NULL, 0)
                                 : SNOW_STATUS_OK;
}

/* Reads the header from the front of a source. */
static snow_status read_header(snow_source *source, nifti_header *header,
                               uint64_t *taken) {
    unsigned char bytes[NIFTI2_BYTES];
    size_t size;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    SNOW_TRY(
        nifti_header_parse(snow_source_context(source), bytes, size, header));
    *taken = header->version == 1 ? NIFTI1_BYTES : NIFTI2_BYTES;
    return snow_source_skip(source, *taken, "the header");
}

/* Finds "hdr" or "img" in a name, or NULL: "a.hdr", "a.IMG.gz". */
static char *pair_letters(char *name) {
    size_t length = strlen(name);
    if (snow_has_suffix(name, ".gz"))
        length -= 3;
    if (length < 4)
        return NULL;
    char saved = name[length];
    name[length] = 0;
    bool is_pair =
        snow_has_suffix(name, ".hdr") || snow_has_suffix(name, ".img");
    name[length] = saved;
    return is_pair ? name + length - 3 : NULL;
}

/* Opens the other file of a pair: same name and case, `wanted` ("hdr" or "img")
 * in place of the other, with .gz or without. */
static snow_status open_other(snow_source *source, const char *wanted,
                              snow_source **out) {
    snow_context *context = snow_source_context(source);
    const char *own = snow_path_name(snow_source_name(source));
    size_t capacity = strlen(own) + 4;
    char *name = snow_allocate_clear(context, capacity);
    if (!name)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(name, own, strlen(own));
    char *letters = pair_letters(name);
    snow_status status = snow_fail(context, SNOW_STATUS_BAD_INPUT,
                                   "is one of a pair of files, but its name "
                                   "does not end in .hdr or .img; rename both");
    if (letters) {
        /* The likelier first: if one file is compressed, so is the other. */
        bool packed = letters[3] != 0;
        for (int i = 0; i < 3; i++) {
            bool upper = letters[i] >= 'A' && letters[i] <= 'Z';
            letters[i] = (char)(upper ? wanted[i] - 'a' + 'A' : wanted[i]);
        }
        bool is_there = false;
        status = SNOW_STATUS_OK;
        for (int attempt = 0;
             attempt < 2 && !is_there && status == SNOW_STATUS_OK;
             attempt++, packed = !packed) {
            memcpy(letters + 3, packed ? ".gz" : "", packed ? 4 : 1);
            status = snow_source_look_for_sibling(source, name, &is_there);
        }
        if (status == SNOW_STATUS_OK)
            status = snow_source_open_sibling(source, name, out);
    }
    snow_release(context, name);
    return status;
}

/* The .img file was opened: its header is beside it. */
static snow_status read_image(snow_source *image,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    snow_source *source;
    nifti_header header;
    uint64_t taken;
    SNOW_TRY(open_other(image, "hdr", &source));
    snow_status status = read_header(source, &header, &taken);
    snow_source_close(source);
    SNOW_TRY(status);
    if (!header.pair)
        return snow_fail(
            snow_source_context(image), SNOW_STATUS_BAD_INPUT,
            "its header places the voxels in the .hdr file; open that file");
    return read_voxels(image, &header, options, 0, info, out);
}

/* Bytes have priority over names: an .img file that begins with a header is
 * read as such. */
static snow_status read_nifti(snow_source *source,
                              const snow_volume_options *options,
                              snow_volume_info *info, snow_volume **out) {
    unsigned char bytes[NIFTI1_BYTES];
    size_t size;
    nifti_header header;
    uint64_t taken;
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &size));
    /* The voxels of a pair have no magic, so only the name identifies them. */
    const char *name = snow_source_name(source);
    if ((snow_has_suffix(name, ".img") || snow_has_suffix(name, ".img.gz")) &&
        !nifti_header_size(bytes, size))
        return read_image(source, options, info, out);
    SNOW_TRY(read_header(source, &header, &taken));
    if (header.pair) {
        snow_source *image;
        SNOW_TRY(open_other(source, "img", &image));
        snow_status status = read_voxels(image, &header, options, 0, info, out);
        snow_source_close(image);
        return status;
    }
    return read_voxels(source, &header, options, taken, info, out);
}

const snow_format snow_format_nifti = {
    .name = "nifti",
    .text = "NIfTI-1 and NIfTI-2 (.nii, .nii.gz, .hdr with .img)",
    .suffixes = {".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"},
    .probe = probe_nifti,
    .crops = true,
    .channels = true,
    .read = read_nifti,
    .write = snow_nifti_write,
};
