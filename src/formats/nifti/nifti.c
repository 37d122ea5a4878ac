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
#include "io/folder.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Tests size field and magic together: 348 alone begins Analyze files as
 * well. */
static bool probe_nifti(const unsigned char *bytes, size_t size) {
    return nifti_header_size(bytes, size) != 0;
}

/* --- the position in the world --------------------------------------------
 *
 * nifti1.h has three methods: sform, a matrix; qform, a rotation as a
 * quaternion with spacings; or spacings alone.  The first one that is given and
 * valid is used.  World axes are RAS+, as ours. */

/* A singular matrix would draw nothing, and its inverse is needed. */
static bool is_usable(const double m[4][4]) {
    double inverse[3][3];
    for (int i = 0; i < 12; i++)
        if (!isfinite(m[i / 4][i % 4]))
            return false;
    return snow_matrix_invert3(m, inverse);
}

/* Spacings that are not lengths become 1 with a warning: such files are common.
 * The sign has no meaning here; qfac marks mirrored axes. */
static void read_spacing(snow_context *context, const nifti_header *header,
                         const snow_volume_options *options,
                         double spacing[3]) {
    bool replaced = false;
    for (int i = 0; i < 3; i++) {
        spacing[i] = fabs(header->pixdim[i + 1]);
        if (spacing[i] > 0 && isfinite(spacing[i]))
            continue;
        spacing[i] = 1;
        replaced |= header->dim[i + 1] > 1;
    }
    if (replaced && !snow_spacing_given(options))
        snow_notify(context,
                    "spacing %g %g %g (pixdim) is not possible; 1 is used "
                    "where it is wrong",
                    header->pixdim[1], header->pixdim[2], header->pixdim[3]);
}

/* The rotation of the quaternion (a, b, c, d) with implied a >= 0: nifti1.h,
 * section "QUATERNION REPRESENTATION OF ROTATION MATRIX".  Rounding may make b,
 * c, d a little too long; then a is 0 and they are scaled to length 1. */
static void rotate_by_quaternion(const double quatern[3], double r[3][3]) {
    double b = quatern[0], c = quatern[1], d = quatern[2];
    double square = b * b + c * c + d * d, a = 0;
    if (1 - square < 1e-7) {
        double length = sqrt(square);
        b /= length;
        c /= length;
        d /= length;
    } else {
        a = sqrt(1 - square);
    }
    const double rotation[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c - a * d),
         2 * (b * d + a * c)},
        {2 * (b * c + a * d), a * a + c * c - b * b - d * d,
         2 * (c * d - a * b)},
        {2 * (b * d - a * c), 2 * (c * d + a * b),
         a * a + d * d - b * b - c * c},
    };
    memcpy(r, rotation, sizeof rotation);
}

/* nifti1.h, method 3; code 0 means that its fields are not set. */
static bool try_sform(snow_context *context, const nifti_header *header,
                      double m[4][4]) {
    if (header->sform_code <= 0)
        return false;
    memcpy(m, header->srow, sizeof header->srow);
    if (is_usable((const double(*)[4])m))
        return true;
    snow_notify(context, "its matrix (sform) is singular or not finite; %s",
                header->qform_code > 0 ? "its quaternion (qform) is used"
                                       : "only its spacing is used");
    return false;
}

/* nifti1.h, method 2, likewise. */
static bool try_qform(snow_context *context, const nifti_header *header,
                      const double spacing[3], double m[4][4]) {
    if (header->qform_code <= 0)
        return false;
    /* nifti1.h, method 2: the third column takes the sign that mirrors. */
    double r[3][3];
    rotate_by_quaternion(header->quatern, r);
    double qfac = header->pixdim[0] < 0 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        m[i][0] = r[i][0] * spacing[0];
        m[i][1] = r[i][1] * spacing[1];
        m[i][2] = r[i][2] * spacing[2] * qfac;
        m[i][3] = header->qoffset[i];
    }
    if (is_usable((const double(*)[4])m))
        return true;
    snow_notify(context, "its quaternion (qform) is not finite; only its "
                         "spacing is used");
    return false;
}

/* Spacings alone (method 1) give no orientation: left and right are unknown, so
 * the volume is not medical. */
static void read_geometry(snow_context *context, const nifti_header *header,
                          const snow_volume_options *options,
                          snow_volume_info *info) {
    /* Metres and micrometres; an unknown unit counts as millimetres. */
    const double millimetres = header->units == 1   ? 1000
                               : header->units == 3 ? 0.001
                                                    : 1;
    double m[4][4] = {{0}};
    bool placed = try_sform(context, header, m);
    if (!placed) {
        double spacing[3];
        read_spacing(context, header, options, spacing);
        placed = try_qform(context, header, spacing, m);
        if (!placed) {
            memset(m, 0, sizeof m);
            for (int i = 0; i < 3; i++)
                m[i][i] = spacing[i];
        }
    }
    for (int i = 0; i < 12; i++)
        info->matrix[i / 4][i % 4] =
            m[i / 4][i % 4] * millimetres + 0.0; /* no -0 */
    info->medical = placed && !header->no_patient;
    bool unknown = header->no_patient && header->units == 0;
    snprintf(info->unit, sizeof info->unit, "%s", unknown ? "" : "mm");
}

/* --- voxels --------------------------------------------------------------- */

/* Fills info from the header; the sizes of the array are samples of a voxel, x,
 * y, z, time and components. */
static void describe_volume(const nifti_header *header, snow_context *context,
                            const snow_volume_options *options,
                            snow_volume_info *info, int64_t sizes[6]) {
    *info = snow_volume_info_default("nifti");
    memcpy(info->dims, header->dim + 1, sizeof info->dims);
    info->type = header->type->type;
    info->slope = header->slope;
    info->intercept = header->intercept;
    info->whole = header->labels;
    info->estimate = header->estimate;
    read_geometry(context, header, options, info);
    sizes[0] = header->type->samples;
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
    info->directions = vectors && !is_complex;
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
    snow_array array = {.big_endian = header->big_endian};
    int64_t sizes[6], channel = 0;
    uint64_t steps[6];
    describe_volume(header, context, options, info, sizes);
    if (!snow_array_steps(sizes, 6, snow_type_size(info->type), steps,
                          &array.all))
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "its sizes (dim) are too large for any file; correct the header");
    SNOW_TRY(pick(header, context, options, sizes, info, &channel));
    memcpy(array.step, steps + 1, sizeof array.step);
    array.all += skip;
    array.first = skip + (uint64_t)info->time * steps[4] +
                  (uint64_t)channel * steps[sizes[0] > 1 ? 0 : 5];
    SNOW_TRY(snow_array_read(source, options, &array, info, out));
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
    static const char *const ends[] = {".hdr", ".img", ".hdr.gz", ".img.gz"};
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
        if (snow_has_suffix(name, ends[i]))
            return name + strlen(name) - strlen(ends[i]) + 1;
    return NULL;
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
    .write = SNOW_WRITER(snow_nifti_write),
};
