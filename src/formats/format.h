/* formats/format.h - a volume format, and what readers share.
 *
 * To add a format: write formats/NAME/NAME.c with one snow_format record,
 * declare the record below, and name it in the table of formats/table.c.
 * CONTRIBUTING.md lists the tests and pages that a format has. */
#ifndef SNOW_FORMATS_FORMAT_H
#define SNOW_FORMATS_FORMAT_H

#include "io/source.h"
#include "io/writer.h"
#include "volume/volume.h"

/* The most bytes of a tag or a comment of XML: expat reads an unfinished one
 * again with each piece of the file. */
#define SNOW_XML_TAG_BYTES ((uint64_t)1 << 20)

/* How a record names its `write`; the page without a server has none
 * (wasm/CMakeLists.txt). */
#ifdef SNOW_WRITES_PNG
#define SNOW_WRITER(function) NULL
#else
#define SNOW_WRITER(function) function
#endif

/* A volume format.  `read` gets the source at its first byte (gzip undone) and
 * makes the volume; its messages need not name the file, and its options are
 * never NULL; `probe` says whether the first `size` bytes look like the
 * format; `write` may be NULL.
 *
 * A format that `crops` reads no more than the box of its options: it lays a
 * window (volume/region.h) before the volume, and where `out` is NULL it stops
 * there, with all but the voxels in *info.  Other formats read all, and are
 * cropped afterwards; they leave *info alone. */
typedef struct snow_format {
    const char *name;        /* "nrrd" */
    const char *text;        /* one line for people */
    const char *suffixes[8]; /* ".nrrd", ".nhdr", NULL */
    bool (*probe)(const unsigned char *bytes, size_t size);
    bool crops;
    bool slices;   /* a folder or a pattern of its files is a volume */
    bool previews; /* but beside slices of another format they are previews */
    bool sets;     /* heeds the option that chooses a data set */
    bool channels; /* heeds the option that chooses a channel */
    bool series;   /* heeds the option that chooses a series */
    bool names;    /* its components have names, which the option may give */
    bool
        levels; /* of refinement: heeds the option that leaves out the finest */
    snow_status (*read)(snow_source *source, const snow_volume_options *options,
                        snow_volume_info *info, snow_volume **out);
    snow_status (*write)(const snow_volume *volume, const char *path,
                         snow_writer *writer);
} snow_format;

extern const snow_format snow_format_raw;
extern const snow_format snow_format_nrrd;
extern const snow_format snow_format_nifti;
extern const snow_format snow_format_metaimage;
extern const snow_format snow_format_npy;
extern const snow_format snow_format_mrc;
extern const snow_format snow_format_vtk;
extern const snow_format snow_format_vti;
extern const snow_format snow_format_vtr;
extern const snow_format snow_format_tiff;
extern const snow_format snow_format_png;
extern const snow_format snow_format_jpeg;
extern const snow_format snow_format_hdf5;
extern const snow_format snow_format_netcdf;
extern const snow_format snow_format_dicom;
extern const snow_format snow_format_den;
extern const snow_format snow_format_mgh;
extern const snow_format snow_format_gipl;
extern const snow_format snow_format_zarr;
extern const snow_format snow_format_pvd;
extern const snow_format snow_format_pvti;
extern const snow_format snow_format_vtm;
extern const snow_format snow_format_visit;
extern const snow_format snow_format_bov;
extern const snow_format snow_format_xdmf;
extern const snow_format snow_format_amrex;
extern const snow_format snow_format_vth;
extern const snow_format snow_format_cube;
extern const snow_format snow_format_vasp;

/* Returns whether the user gives the spacing, so that what a file lacks of it
 * needs no warning. */
static inline bool snow_spacing_given(const snow_volume_options *options) {
    return options->spacing[0] > 0;
}

/* The note about images that give the size of a pixel but not the distance of
 * their slices. */
#define SNOW_WIDTH_IS_DISTANCE                                             \
    "the distance of the slices is taken to be the width of a pixel, %g; " \
    "--spacing sets another"

/* In info->storage, of a volume whose file leads to others that hold it too;
 * and how a file ends that has no pages itself. */
#define SNOW_SET_OF_FILES "set of %zu files"
#define SNOW_COMPANION ".companion.ome"

/* A format's number for a scalar type; one for no type ends a table of them. */
typedef struct snow_coded_type {
    int code;
    snow_type type;
} snow_coded_type;
snow_type snow_type_of_code(const snow_coded_type *table, int code);

/* The type of a kind, "i", "u" or "f", of so many bytes. */
snow_type snow_type_of_kind(char kind, size_t bytes);

/* The usual end of a binary reader whose time steps follow one another behind
 * `skip` bytes; see snow_array_read (formats/array.h). */
snow_status snow_volume_read(snow_source *source,
                             const snow_volume_options *options,
                             bool big_endian, uint64_t skip,
                             snow_volume_info *info, snow_volume **out);

/* Opens a volume that the file of `source` names: relative to its folder, or
 * absolute; "run.h5:/rho" names a data set.  The box of the options is read,
 * but the matrix is that of the whole.  Options that describe the whole, as
 * sizes and spacing, are left out.  Errors: those of opening;
 * SNOW_STATUS_BAD_INPUT (files that name one another without end). */
snow_status snow_volume_open_named(snow_source *source, const char *name,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out);

/* Adds to a text, with a decimal point in every locale; cut where there is no
 * room. */
void snow_append(char *text, size_t capacity, const char *format, ...)
    SNOW_PRINTF(3, 4);

/* Swaps the bytes of the voxels as read when the file's order is not the
 * machine's. */
void snow_volume_order_bytes(snow_volume *volume, bool big_endian);

/* For a reader that has set info->times: takes the time step of the options
 * into info->time, and warns when there are several.  `what` the
 * format calls one: "time step", or "volume" where it need not be time.
 * Errors: SNOW_STATUS_BAD_USAGE when there is no such step. */
snow_status snow_volume_pick_time(snow_context *context, const char *what,
                                  const snow_volume_options *options,
                                  snow_volume_info *info);

/* Scales the columns of the matrix to the spacing that the user gave. */
snow_status snow_volume_replace_spacing(snow_context *context,
                                        const snow_volume_options *options,
                                        snow_volume_info *info);

/* Ends the making of a volume: gives it, or closes it where that has failed.
 * `volume` and `out` may be NULL. */
snow_status snow_volume_give(snow_status status, snow_volume *volume,
                             snow_volume **out);

/* The same for what snow_lookup_begin began (io/lookup.h): it has failed where
 * something could not be looked up or read, even if the reader has gone on
 * without it. */
snow_status snow_volume_finish(snow_context *context, snow_status status,
                               snow_volume *volume, snow_volume **out);

/* Adds a name to a list for messages, as long as there is room. */
void snow_list_add(char *list, size_t capacity, const char *format, ...)
    SNOW_PRINTF(3, 4);

/* Crops a volume that was read as a whole. */
snow_status snow_volume_crop(const snow_volume_options *options,
                             snow_volume **volume);

/* For readers of images, whose row 0 is the top: turns an unturned matrix half
 * around x, so that seen from +z slice 0 is in front and rows go down. */
static inline void snow_image_turn(double matrix[4][4]) {
    for (int row = 1; row < 3; row++)
        for (int i = 0; i < 4; i++)
            matrix[row][i] = 0 - matrix[row][i]; /* never -0 */
}

/* Returns whether a file name ends as those of the format do. */
bool snow_format_has_name(const snow_format *format, const char *name);

/* Does what snow_format_of_name does; handed to readers of many files. */
typedef const snow_format *snow_format_finder(const char *name);

/* The format whose files begin like these bytes; the one of a file name; NULL
 * when there is none. */
const snow_format *snow_format_of_bytes(const void *bytes, size_t size);
const snow_format *snow_format_of_name(const char *name);

#endif
