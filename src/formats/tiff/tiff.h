/* formats/tiff/tiff.h - the parts of the TIFF reader, private to this folder.
 *
 *   tiff.c   the file -> the pages that are slices, the volume
 *   text.c   descriptions by ImageJ and tifffile -> tiff_shape
 *   ome.c    OME-XML -> tiff_shape, and which page has which plane
 *   set.c    the files that OME-XML names
 *   planes.c   planes that are there or missing -> the volume's voxels
 *   tags.c   what tags say of channels and missing values
 *   page.c   a page -> voxels of a slice, by libtiff */
#ifndef SNOW_FORMATS_TIFF_TIFF_H
#define SNOW_FORMATS_TIFF_TIFF_H

#include "formats/format.h"
#include "io/tiff.h"

/* What a description says about all pages together; 0 and "" if nothing, and 1
 * of channels, slices and frames. */
typedef struct tiff_shape {
    bool imagej;    /* written by ImageJ */
    bool metamorph; /* ... by MetaMorph: planes lie behind the first page */
    int64_t images; /* ... which may exceed the number of pages */
    int64_t channels, slices, frames;
    char order[6];     /* the order of C, Z and T, "XYCZT" */
    double spacing[3]; /* ImageJ stores x and y elsewhere */
    char units[3][16]; /* of x, y, z, as the file has them */
    double scale[2];   /* ImageJ: value = [0] + [1] * stored */
    bool bent;         /* ... or another function, which is not read */
    char value_unit[32];
    double nodata; /* the value of missing voxels; NaN: none */
    snow_channel channel[SNOW_CHANNELS_MAX];
    bool colors, opacity; /* of samples of a pixel: they are; the last is */
    bool ome;
    uint64_t through; /* bit n: light passes through, says OME of channel n */
} tiff_shape;

/* Reads the text of the ImageDescription, which may be NULL. */
void snow_tiff_read_text(const char *text, tiff_shape *out);

/* Planes that OME-XML says to be consecutive pages of a file: a TiffData. */
typedef struct tiff_run {
    int64_t first[3];    /* the first plane's c, z and t */
    int64_t page, count; /* count 0: as many as there are */
    size_t file;         /* index of a member */
} tiff_run;

/* A file of the set: member 0 is where the XML is; others have a name, a UUID,
 * or both.  Names are places in the block of text. */
typedef struct tiff_member {
    size_t name, uuid;
    size_t found; /* the name of a file with its UUID; 0: none is known */
    enum { TIFF_UNKNOWN, TIFF_OWN, TIFF_OTHER, TIFF_ABSENT } state;
    int64_t pages, used; /* of a file that was opened; pages that are wanted */
    uint64_t bytes;      /* ... its size */
} tiff_member;

/* The image of an OME-XML that is read. */
typedef struct tiff_ome {
    tiff_shape shape;
    int64_t images;         /* in the XML; */
    int64_t taken, has_own; /* ... read; with pages in a file, -1: none */
    char list[512];         /* ... their numbers and names, cut */
    char uuid[64];          /* of the file that the XML is in, "": none */
    char elsewhere[256];    /* the file with the XML, if it is not this one */
    tiff_run *runs;
    tiff_member *members;
    size_t run_count, member_count, files; /* files that have planes */
    char *text;
    size_t used;
} tiff_ome;

/* Reads XML: of several images that of a name, a number or an ID, or the first
 * for NULL; notes which has pages in the file `own`.  The caller frees it
 * whatever the status.  Errors: SNOW_STATUS_BAD_INPUT (damaged),
 * SNOW_STATUS_BAD_USAGE (no such image). */
snow_status snow_tiff_read_ome(snow_source *source, const char *wanted,
                               const char *own, tiff_ome *out);

/* Copies a text into the block; *at is its place. */
snow_status snow_tiff_keep(snow_context *context, tiff_ome *ome,
                           const char *text, size_t length, size_t *at);
void snow_tiff_free_ome(snow_context *context, tiff_ome *ome);

#if SNOW_HAVE_TIFF

/* How a value is stored; an unsupported type becomes a larger one. */
typedef enum tiff_coding {
    TIFF_PLAIN,
    TIFF_PACKED, /* of other bits than whole bytes: the next larger integer */
    TIFF_HALF,   /* float32 */
    TIFF_TRIPLE  /* 24 bits; 32 */
} tiff_coding;

/* What all pages of a volume must have in common. */
typedef struct tiff_page {
    int64_t width, height, samples;
    snow_type type;
    tiff_coding coding;
    uint16_t bits, compression;
    bool is_signed;
    bool separate; /* samples are in planes, not interleaved */
    uint16_t turn; /* its tag Orientation; 1: none */
    bool white;    /* 0 is white: */
    uint64_t flip; /* bits that are inverted therefore; 0: none */
} tiff_page;

/* An open file and the places of its pages. */
typedef struct tiff_reader {
    snow_source *source;
    snow_tiff file;
    bool open;
    uint64_t *pages;
    int64_t count;
} tiff_reader;

/* The files of an image: that which is opened, and another at a time. */
typedef struct tiff_set {
    snow_context *context;
    tiff_reader own, other;
    size_t number; /* of `other` */
    bool is_ome;
    tiff_ome ome;
    char uuid[64];            /* of the own file */
    bool scanned;             /* UUIDs of all files of the folder are known */
    int64_t renamed, strange; /* files of another name, of another UUID */
} tiff_set;

/* How the file's planes form volumes. */
typedef struct tiff_plan {
    tiff_page page;
    tiff_shape shape;
    int64_t planes;       /* that there should be */
    int64_t present;      /* pages that are there, if nothing names them */
    struct place *places; /* the page of each plane; NULL: in order */
    bool raw;             /* ImageJ's: they lie behind the first page */
    bool measured; /* the size of a pixel is known by the resolution alone */
    /* Distances, in planes, of channels, slices and times. */
    int64_t channel_step, slice_step, time_step;
    int64_t channels, slices, times;
} tiff_plan;

/* Opens the source and reads its OME-XML, wherever that is.  The set is closed
 * whatever the status.  Errors: SNOW_STATUS_BAD_INPUT, SNOW_STATUS_BAD_USAGE
 * (no image of the name in the options). */
snow_status snow_tiff_open_set(snow_source *source,
                               const snow_volume_options *options,
                               tiff_set *set);
void snow_tiff_close_set(tiff_set *set);

/* Opens member `n` of the set; *out is NULL if it is not there. */
snow_status snow_tiff_open_member(tiff_set *set, size_t n, tiff_reader **out);

/* Whether it is there, without opening it. */
snow_status snow_tiff_find_member(tiff_set *set, size_t n);

/* Adds the places of pages, from the open one to the last: all, or those that
 * are no reduced copies, of which the first `most` must be like `page`. */
snow_status snow_tiff_list_pages(tiff_reader *reader, bool all,
                                 const tiff_page *page, int64_t most);

/* Fails unless the current page, `number`, is like others. */
snow_status snow_tiff_compare(snow_tiff *file, const tiff_page *page,
                              int64_t number);

/* Fails where next to nothing of an image is there. */
snow_status snow_tiff_check_count(const tiff_set *set, int64_t present,
                                  int64_t all);

/* Finds the page of each plane of an OME image. */
snow_status snow_tiff_place(tiff_set *set, tiff_plan *plan);

/* Checks that the slices of a channel and time step are there, or that the
 * options allow gaps: *gaps. */
snow_status snow_tiff_check_planes(tiff_set *set, const tiff_plan *plan,
                                   const snow_volume_options *options,
                                   int64_t channel, int64_t time, bool *gaps);

/* Reads one sample of their box; slices that are missing are left alone, and
 * marked in `missing`. */
snow_status snow_tiff_read_planes(tiff_set *set, const tiff_plan *plan,
                                  int64_t first, int64_t sample,
                                  const snow_region *region,
                                  snow_volume *volume, bool *missing);

/* Describes the current page.  Errors: SNOW_STATUS_BAD_INPUT if it is not
 * supported. */
snow_status snow_tiff_describe(snow_tiff *file, tiff_page *out);

/* Takes channels, slices and frames from the shape of an array, if the text has
 * one of such pages.  Errors: SNOW_STATUS_BAD_INPUT (axes in no such order). */
snow_status snow_tiff_read_shape(snow_context *context, const char *text,
                                 const tiff_page *page, tiff_shape *out);

/* Adds what private tags of the current page say. */
void snow_tiff_read_tags(const snow_tiff *file, const tiff_page *page,
                         tiff_shape *shape);

/* Adds what the current page says of channels beside its description. */
void snow_tiff_read_channels(const snow_tiff *file, const tiff_page *page,
                             tiff_shape *shape);

/* A lower bound for the size of a file with so many bytes of pixels, from the
 * compression. */
uint64_t snow_tiff_least(const tiff_page *page, uint64_t bytes);

/* Reads the box's columns and rows of one sample of the current page into the
 * voxels of a slice. */
snow_status snow_tiff_read_page(snow_tiff *file, const tiff_page *page,
                                int64_t sample, const snow_region *region,
                                unsigned char *slice);

/* The same for image `index` of those stored after the first page's, which is
 * how ImageJ writes more than 4 GB. */
snow_status snow_tiff_read_raw(snow_tiff *file, const tiff_page *page,
                               int64_t index, int64_t sample,
                               const snow_region *region, unsigned char *slice);

#endif
#endif
