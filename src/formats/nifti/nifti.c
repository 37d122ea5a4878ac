/* formats/nifti/nifti.c - NIfTI-1 and NIfTI-2 volumes: .nii, and .hdr with
 * .img.
 *
 * Axes beyond the third are time steps, of which one is read.  Either file of a
 * pair may be opened.  Analyze 7.5, NIfTI's predecessor with the same header
 * size but without the magic, is refused: it does not distinguish left from
 * right. */
#include "formats/nifti/nifti.h"
#include "formats/write.h"
#include "io/folder.h"

#include <stdio.h>
#include <string.h>

/* Tests size field and magic together: 348 alone begins Analyze files as
 * well. */
static bool probe_nifti(const unsigned char *bytes, size_t size) {
    return nifti_header_size(bytes, size) != 0;
}

/* Fills info from the header. */
static snow_status describe_volume(snow_context *context,
                                   const nifti_header *header,
                                   const snow_volume_options *options,
                                   snow_volume_info *info) {
    int64_t voxels;
    uint64_t step;
    *info = snow_volume_info_default("nifti");
    memcpy(info->dims, header->dim + 1, sizeof info->dims);
    info->type = nifti_type(header->datatype);
    info->slope = header->slope;
    info->intercept = header->intercept;
    nifti_geometry(context, header, options, info);
    uint64_t times = 1, all;
    /* Five products of numbers that any header of 348 bytes can claim. */
    bool fits = snow_volume_count(info->dims, info->type, &voxels, &step);
    for (int i = 4; i < 8; i++)
        fits = fits && snow_mul_u64(times, (uint64_t)header->dim[i], &times);
    fits =
        fits && snow_mul_u64(times, step, &all) && all <= (uint64_t)INT64_MAX;
    if (!fits)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "its sizes (dim) are too large for any file; correct the header");
    info->times = (int64_t)times;
    /* Axes 5 to 7 are directions or components, never time. */
    bool time_alone = header->dim[5] * header->dim[6] * header->dim[7] == 1;
    return snow_volume_pick_time(context, time_alone ? "time step" : "volume",
                                 options, info);
}

/* Reads the voxels from a source of which `taken` bytes were read. */
static snow_status read_voxels(snow_source *source, const nifti_header *header,
                               const snow_volume_options *options,
                               uint64_t taken, snow_volume_info *info,
                               snow_volume **out) {
    SNOW_TRY(
        describe_volume(snow_source_context(source), header, options, info));
    return snow_volume_read(source, options, header->big_endian,
                            header->vox_offset - taken, info, out);
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
static snow_status open_other(const snow_source *source, const char *wanted,
                              snow_source **out) {
    snow_context *context = snow_source_context(source);
    const char *own = snow_path_name(snow_source_name(source));
    size_t room = strlen(own) + 4;
    char *name = snow_allocate_clear(context, room);
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
        for (int attempt = 0; attempt < 2 && status == SNOW_STATUS_BAD_INPUT;
             attempt++, packed = !packed) {
            memcpy(letters + 3, packed ? ".gz" : "", packed ? 4 : 1);
            status = snow_source_open_sibling(source, name, out);
        }
    }
    snow_release(context, name);
    return status;
}

/* The header was opened first: its voxels are in the .img file. */
static snow_status read_beside(snow_source *source, const nifti_header *header,
                               const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    snow_source *image;
    SNOW_TRY(open_other(source, "img", &image));
    snow_status status = read_voxels(image, header, options, 0, info, out);
    snow_source_close(image);
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

/* The voxels of a pair have no magic, so only the name identifies them. */
static bool is_image_name(const char *name) {
    return snow_has_suffix(name, ".img") || snow_has_suffix(name, ".img.gz");
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
    if (is_image_name(snow_source_name(source)) &&
        !nifti_header_size(bytes, size))
        return read_image(source, options, info, out);
    SNOW_TRY(read_header(source, &header, &taken));
    if (header.pair)
        return read_beside(source, &header, options, info, out);
    return read_voxels(source, &header, options, taken, info, out);
}

const snow_format snow_format_nifti = {
    .name = "nifti",
    .text = "NIfTI-1 and NIfTI-2 (.nii, .nii.gz, .hdr with .img)",
    .suffixes = {".nii", ".nii.gz", ".hdr", ".hdr.gz", ".img", ".img.gz"},
    .probe = probe_nifti,
    .crops = true,
    .read = read_nifti,
    .write = snow_nifti_write,
};
