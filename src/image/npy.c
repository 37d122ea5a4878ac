/* image/npy.c - pictures as NumPy arrays.
 *
 * io/npy_header.h describes the format.  Writes float32 arrays of shape
 * (height, width, 4), premultiplied, or (height, width) for values in data
 * units. Reads floats of both sizes and byte orders with 1 to 4 channels. */
#include "image/image.h"
#include "io/npy_header.h"

#include <stdio.h>
#include <string.h>

static const unsigned char magic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};

/* The header text fits for all sizes: the file is the same, byte for byte, as
 * from numpy.save. */
static snow_status write_npy(const snow_image *image,
                             const snow_image_options *options,
                             snow_writer *writer) {
    (void)options;
    char header[2 * NPY_ALIGNMENT];
    memset(header, ' ', sizeof header);
    memcpy(header, magic, sizeof magic);
    memcpy(header + 6, "\1\0", 2);
    int channels = image->channels == 1 ? 1 : 4;
    int length =
        10 + snprintf(header + 10, sizeof header - 10,
                      "{'descr': '<f4', 'fortran_order': False, "
                      "'shape': (%d, %d%s), }",
                      image->height, image->width, channels == 1 ? "" : ", 4");
    /* Even the longest text, for sides of 32768, leaves room for the
     * newline. */
    header[length] = ' ';
    header[sizeof header - 1] = '\n';
    header[8] = (char)(sizeof header - 10);
    header[9] = 0;
    SNOW_TRY(snow_writer_write(writer, header, sizeof header));
    return snow_image_write_floats(image, channels, false, writer);
}

/* Each refusal names the NumPy call that makes a readable file. */
static snow_status read_npy(snow_source *source, snow_image **out) {
    npy_header header;
    snow_float_layout layout = {.channels = 1};
    SNOW_TRY(snow_npy_read_header(source, &header));
    /* Parses a type such as <f4.  NumPy writes the machine's byte order as < or
     * >, never as =. */
    bool known = (header.type[0] == '<' || header.type[0] == '>') &&
                 header.type[1] == 'f' &&
                 (header.type[2] == '4' || header.type[2] == '8') &&
                 header.type[3] == '\0';
    layout.big_endian = header.type[0] == '>';
    layout.sample_bytes = known ? header.type[2] - '0' : 0;
    if (!known)
        return snow_npy_fail(source,
                             "the array is not float32 or float64; save it "
                             "with .astype('float32')");
    if (header.fortran_order)
        return snow_npy_fail(source,
                             "the array is in Fortran order; save it with "
                             "numpy.ascontiguousarray");
    bool has_channels = header.axes == 3;
    if ((header.axes != 2 && !has_channels) ||
        (has_channels && (header.shape[2] < 1 || header.shape[2] > 4)))
        return snow_npy_fail(source,
                             "the array does not have the shape of a picture; "
                             "it must be (h, w) or (h, w, 1 to 4)");
    if (has_channels)
        layout.channels = (int)header.shape[2];
    return snow_image_read_floats(source, header.shape[1], header.shape[0],
                                  &layout, out);
}

const snow_image_format snow_image_npy = {
    .name = "NPY",
    .suffix = ".npy",
    .write = write_npy,
    .probe = snow_npy_probe,
    .read = read_npy,
};
