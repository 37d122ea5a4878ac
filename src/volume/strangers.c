/* volume/strangers.c - files that are not read but known: what they are, and
 * the way from them to one that is read.
 *
 * Magic numbers are those of file(1). */
#include "volume/strangers.h"

#include <string.h>

static const struct {
    size_t offset;
    const char *magic;
    size_t length;
    const char *advice;
} strangers[] = {
    {257, "ustar", 5,
     "is a tar archive; unpack it and open the file or the folder in it"},
    {0, "PK\3\4", 4, "is a zip archive; unpack it and open what is in it"},
    {0, "BZh", 3, "is packed by bzip2; unpack it with bunzip2"},
    {0,
     "\xFD"
     "7zXZ",
     5, "is packed by xz; unpack it with unxz"},
    {0, "\x28\xB5\x2F\xFD", 4, "is packed by zstd; unpack it with unzstd"},
    {0, "11111\n", 6,
     "is an SLC volume of VolVis, which is not read; have VTK's vtkSLCReader "
     "write it as .vti"},
    {0, "MATLAB 5.0", 10,
     "is a MATLAB file of version 5, which is not read; save it with -v7.3, "
     "as HDF5"},
    {0, "\xFF\xD8\xFF", 3,
     "is a JPEG picture, whose values are not those that were measured; bring "
     "PNG or TIFF slices"},
    {0, "RIFF", 4,
     "is a RIFF file (WebP, sound or film) and no volume; bring PNG or TIFF "
     "slices"},
    {0, "%PDF", 4, "is a PDF document and no volume"},
};

const char *snow_stranger(const unsigned char *bytes, size_t size) {
    for (size_t i = 0; i < sizeof strangers / sizeof *strangers; i++)
        if (size >= strangers[i].offset + strangers[i].length &&
            !memcmp(bytes + strangers[i].offset, strangers[i].magic,
                    strangers[i].length))
            return strangers[i].advice;
    return NULL;
}
