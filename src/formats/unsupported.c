/* formats/unsupported.c - recognises files that are not supported, and says how
 * to convert them.
 *
 * Magic numbers are those of file(1). */
#include "formats/opening.h"

#include <string.h>

static const struct {
    size_t offset;
    const char *magic;
    size_t length;
    const char *advice;
} unsupported_formats[] = {
    {257, "ustar", 5,
     "is a tar archive; unpack it and open the file or the folder in it"},
    {0, "PK\3\4", 4, "is a zip archive; unpack it and open what is in it"},
    {0, "BZh", 3, "is compressed by bzip2; decompress it with bunzip2"},
    {0,
     "\xFD"
     "7zXZ",
     5, "is compressed by xz; decompress it with unxz"},
    {0, "\x28\xB5\x2F\xFD", 4,
     "is compressed by zstd; decompress it with unzstd"},
    {0, "11111\n", 6,
     "is an SLC volume of VolVis, which is not supported; convert it to .vti "
     "with VTK's vtkSLCReader"},
    {0, "MATLAB 5.0", 10,
     "is a MATLAB file of version 5, which is not supported; save it with "
     "-v7.3, as HDF5"},
    {0, "RIFF", 4,
     "is a RIFF file (WebP, sound or film) and not a volume; use PNG or TIFF "
     "slices"},
    {0, "%PDF", 4, "is a PDF document and not a volume"},
};

const char *snow_stranger(const unsigned char *bytes, size_t size) {
    for (size_t i = 0;
         i < sizeof unsupported_formats / sizeof *unsupported_formats; i++)
        if (size >=
                unsupported_formats[i].offset + unsupported_formats[i].length &&
            !memcmp(bytes + unsupported_formats[i].offset,
                    unsupported_formats[i].magic,
                    unsupported_formats[i].length))
            return unsupported_formats[i].advice;
    return NULL;
}
