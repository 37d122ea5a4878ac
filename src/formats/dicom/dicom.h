/* formats/dicom/dicom.h - the parts of the DICOM reader.
 *
 *   files   files.c    which files belong together
 *           copies.c   those of one image
 *     |
 *   parse   parse.c    a file's elements, values.c their values
 *           deflated.c the bytes of deflated ones
 *     |
 *   header  header.c   a file's image, and its frames
 *           sizes.c    whether it agrees with the pixels
 *           mosaic.c   slices that are tiles of one frame
 *     |
 *   series  groups.c   which frames may be slices of one volume
 *           series.c   their order and positions
 *           spacing.c  their distances
 *     |
 *   voxels  voxels.c   frames scaled and put in place
 *           segments.c those of a segmentation: a volume of labels
 *           suv.c      the units of PET and of doses
 *     |
 *   pixels  palette.c  palette colours
 *           pixels.c   a frame's words, plain or compressed
 *           codec.c    the headers of compressed ones, checked before GDCM
 *           entropy.c  the codes of JPEG, all of which must be there
 *           codestream.c, packets.c  the parts and packets of JPEG 2000
 *
 * Positions are in LPS and mm, as in DICOM, up to the matrix, which is RAS.
 * GDCM sees nothing but compressed pixels. */
#ifndef SNOW_FORMATS_DICOM_DICOM_H
#define SNOW_FORMATS_DICOM_DICOM_H

#include "base/vec3.h"
#include "formats/format.h"
#include "io/folder.h"
#include "io/lookup.h"
#include "io/seekable.h"

/* What distinguishes images at one position; the first difference counts:
 * indices of time, then other variations, then the order of acquisition. */
enum {
    DICOM_KEY_SEGMENT, /* whose voxels these are, from 1 */
    DICOM_KEY_TIME,    /* temporal position */
    DICOM_KEY_TRIGGER, /* ms within the heartbeat */
    DICOM_KEY_ECHO,    /* ms */
    DICOM_KEY_B_VALUE, /* s/mm^2, of diffusion */
    DICOM_KEY_ACQUISITION,
    DICOM_KEY_INSTANCE,
    DICOM_KEYS
};

/* What the pixels of a segmentation are (PS3.3, C.8.20.2). */
typedef enum dicom_segments {
    DICOM_NO_SEGMENTS, /* other images */
    DICOM_BINARY,
    DICOM_FRACTIONAL, /* probabilities, or shares of a voxel */
    DICOM_LABELMAP,   /* numbers of segments */
    DICOM_UNKNOWN_SEGMENTS
} dicom_segments;

/* One file with an image, as described by its header. */
typedef struct dicom_image {
    char *path; /* in the list of files; NULL for the file that was given */
    char study[65], series[65], instance[65], photometric[17], modality[17],
        rescale_type[17];
    char clock[64];                     /* when it was acquired and made */
    char patient[256], description[65]; /* UTF-8; "" if missing */
    int64_t columns, rows, frames;
    int64_t slices; /* frames, or tiles of a mosaic */
    int64_t series_number;
    uint64_t more; /* bytes of pixels that it does not speak of */
    int samples, allocated, stored, high;
    dicom_segments segments;
    unsigned whole;         /* the fraction that is all, of segments */
    bool is_signed, planes; /* samples of a pixel are not interleaved */
    bool pads;              /* stored values within padding are not data */
    double padding[2];
    int tiles; /* a side of a mosaic; 0: none; below 0: they are not known */
    bool has_normal;         /* of the slices of a mosaic, as are these */
    double normal[3], apart; /* mm; 0: not given */
    bool no_frames;          /* it says, which is taken for 1 */
    size_t first;            /* its frame in the order of reading */
    uint64_t sum;            /* of its pixels; 0: not computed */
    double acquired; /* seconds since 1970, or of a day; NaN: not given */
} dicom_image;

/* The pixels of a slice: of a mosaic those of a tile. */
static inline int64_t snow_dicom_columns(const dicom_image *image) {
    return image->tiles > 1 ? image->columns / image->tiles : image->columns;
}

static inline int64_t snow_dicom_rows(const dicom_image *image) {
    return image->tiles > 1 ? image->rows / image->tiles : image->rows;
}

/* An image of a slice: a file, or a part of one. */
typedef struct dicom_frame {
    const dicom_image *image;
    int64_t number; /* within its file, from 0; of a mosaic the tile */
    bool placed;    /* the next three are given */
    double position[3], row[3],
        column[3];   /* centre of the first pixel; along a row, down a column */
    double pixel[2]; /* mm from column to column, from row to row */
    bool measured;   /* they are given */
    bool guessed;  /* depth is needed to place frames but missing; 1 is used */
    bool unscaled; /* a slope of 0 was ignored */
    bool unmapped; /* a table or map of values was */
    bool lost;     /* its pixels are cut; they count as NaN */
    double depth;  /* given mm from slice to slice, signed; 0: none */
    double thickness;
    double slope, intercept;
    double window[2]; /* data values; equal: none */
    double keys[DICOM_KEYS];
} dicom_frame;

/* --- groups.c, series.c, spacing.c ---------------------------------------- */

/* The order of two numbers: below 0, 0 or above 0. */
static inline int snow_dicom_order(double a, double b) {
    return (a > b) - (a < b);
}

/* The direction from slice to slice, unless a mosaic has the other one. */
static inline void snow_dicom_normal(const dicom_frame *frame, double out[3]) {
    snow_cross(frame->row, frame->column, out);
}

static inline double snow_dicom_smallest_pixel(const dicom_frame *frame) {
    return frame->pixel[0] < frame->pixel[1] ? frame->pixel[0]
                                             : frame->pixel[1];
}

/* The name of its file, for messages. */
static inline const char *snow_dicom_name(const dicom_frame *frame) {
    const char *path = frame->image->path;
    return path ? snow_path_name(path) : "it";
}

/* The order of two frames that nothing but their files distinguishes. */
int snow_dicom_compare_sources(const dicom_frame *a, const dicom_frame *b);

/* --- parse.c, values.c ---------------------------------------------------- */

/* One part in so many of the progress of reading a series is headers. */
#define DICOM_HEADER_SHARE 4

#define DICOM_TAG_PIXELS 0x7fe00010u
#define DICOM_TAG_ITEM 0xfffee000u

/* Returns whether the bytes begin a DICOM file, with its mark at byte 128 or
 * without. */
bool snow_dicom_probe(const unsigned char *bytes, size_t size);

/* An element, an item or a fragment: `length` bytes of the store from `at` on.
 * Elements in it follow on the list; `next` is the first that does not belong
 * to it. */
typedef struct dicom_element {
    uint32_t tag; /* group << 16 | element */
    uint32_t length;
    uint64_t at;
    size_t next;
    bool words; /* VR OW */
} dicom_element;

/* A file whose elements are known; their values are read on request. */
typedef struct dicom_reader {
    snow_context *context;
    snow_source *source;         /* of its own file; NULL: that is given */
    snow_seekable *file, *store; /* the file's bytes; those of the elements */
    dicom_element *elements;
    size_t count;
    char syntax[65];
    char class_known[65]; /* SOP class, from the file's beginning */
    bool big_endian;
    bool packed;          /* the pixels are fragments */
    bool has_pixels;      /* if they were not requested: they follow */
    bool cut;             /* but the file ends before they do */
    uint64_t pixels_at;   /* then, within the store */
    uint32_t pixel_bytes; /* for plain ones */
    const dicom_element *frames, *shared; /* functional groups, or NULL */
    size_t last_item; /* groups of the last requested frame; 0: none */
    int64_t last_frame;
    /* Positions of frames in slices or mm from the first, computed once. */
    double *offsets;
    enum { DICOM_UNSOUGHT, DICOM_NO_OFFSETS, DICOM_SLICES, DICOM_MM } offset_in;
    unsigned char
        *inflated; /* the elements of a deflated file, and their store */
    snow_source *inner;
    snow_seekable *inner_store;
} dicom_reader;

/* Parses a file, of a path or, where that is NULL, of a store that outlives the
 * reader, up to its pixels, or including those of an image.  In the first
 * case pixels that are cut are no error, but its message is there.  Errors:
 * SNOW_STATUS_BAD_INPUT (a value longer than the file, too deeply nested
 * sequences, compressed pixels without an end), SNOW_STATUS_NO_MEMORY, those of
 * opening. */
snow_status snow_dicom_open(snow_context *context, const char *path,
                            snow_seekable *given, const dicom_image *image,
                            dicom_reader *out);
void snow_dicom_close(dicom_reader *reader);

/* --- deflated.c ----------------------------------------------------------- */

typedef struct dicom_inflater dicom_inflater;

/* Begins at a byte of the packed store, which outlives it.  `pixels` is the
 * number of their bytes, 0 if they are not wanted. */
snow_status snow_dicom_inflate_begin(snow_context *context,
                                     snow_seekable *packed, uint64_t at,
                                     uint64_t pixels, dicom_inflater **out);
void snow_dicom_inflate_end(dicom_inflater *inflater); /* NULL is accepted */

/* Inflates until *bytes, a growing block of the context, has at least `wanted`
 * bytes or the stream ends.  Errors: SNOW_STATUS_BAD_INPUT (damaged, or far
 * more bytes than an image has), SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_inflate_to(dicom_inflater *inflater, uint64_t wanted,
                                  unsigned char **bytes, size_t *used);

bool snow_dicom_inflate_ended(const dicom_inflater *inflater);

/* --- values.c ------------------------------------------------------------- */

/* Finds the first element with a tag from list index `begin` up to `end`, not
 * within others; an item of a sequence counts from 0; NULL if there is none. */
const dicom_element *snow_dicom_find(const dicom_reader *reader, size_t begin,
                                     size_t end, uint32_t tag);

/* The same of an item, NULL for none. */
const dicom_element *snow_dicom_find_in(const dicom_reader *reader,
                                        const dicom_element *item,
                                        uint32_t tag);

/* The place of a value: an element of the file itself, or of the first item of
 * a sequence.  A sequence is searched among the functional groups of a frame
 * (from 0), then among those that all frames share, then in the file itself. */
typedef struct dicom_place {
    int64_t frame;
    uint32_t sequence; /* 0: none */
    uint32_t tag;
} dicom_place;

const dicom_element *snow_dicom_locate(dicom_reader *reader, dicom_place place);

/* Copies up to `room` bytes of an element's value as stored; returns their
 * number, 0 if there is no element. */
size_t snow_dicom_bytes(const dicom_reader *reader,
                        const dicom_element *element, void *out,
                        size_t capacity);

static inline size_t snow_dicom_value(dicom_reader *reader, dicom_place place,
                                      void *out, size_t capacity) {
    return snow_dicom_bytes(reader, snow_dicom_locate(reader, place), out,
                            capacity);
}

/* Reads a text of the file itself; text for people, in UTF-8 as far as it
 * fits. */
void snow_dicom_text(dicom_reader *reader, uint32_t tag, char *out,
                     size_t capacity);
void snow_dicom_words(dicom_reader *reader, const dicom_element *element,
                      char *out, size_t capacity);

/* --- series.c ------------------------------------------------------------- */

/* Frames of one series that match, in the order of the list. */
typedef struct dicom_group {
    size_t first, count;
} dicom_group;

/* Sorts frames so that those of a group are adjacent, groups in the order of
 * series numbers; `groups` has room for `count`.  Returns the number of
 * groups. */
size_t snow_dicom_group(dicom_frame *frames, size_t count, dicom_group *groups);

/* Whether frames, one of each series, are the slices of one volume, since they
 * lie evenly behind one another and differ in their series only, as some
 * programs that remove names leave it; a note says so. */
bool snow_dicom_join(snow_context *context, dicom_frame *frames, size_t count);

/* Slice z of the volume lies between two of its positions. */
typedef struct dicom_slice {
    size_t low, high; /* positions */
    double weight;    /* of the high one; NaN: the slice is missing */
} dicom_slice;

/* How the frames of a group form a volume: `places` of `times` frames each, in
 * the order of the frames, and slices at them or between them.  Segments are
 * sparse: a place has as many frames as there are segments at it, and slices
 * without any are missing because they are empty. */
typedef struct dicom_stack {
    snow_context *context;
    const dicom_frame
        *frames; /* of one group, in the order of positions, then times */
    size_t places, times;
    size_t *starts;      /* sparse: first frames of the places, and the end */
    dicom_slice *slices; /* NULL: one at each position */
    size_t slice_count;
    bool gaps;        /* missing slices are allowed */
    size_t missing;   /* of the slices */
    bool placed;      /* the matrix refers to a patient */
    double normal[3]; /* set before the distances are measured */
    double matrix[4][4];
    double gap_least, gap_most, gap; /* mm between positions; between slices */
    bool given;                      /* gap is given */
} dicom_stack;

static inline const double *snow_dicom_position(const dicom_stack *stack,
                                                size_t index) {
    return stack
        ->frames[stack->starts ? stack->starts[index] : index * stack->times]
        .position;
}

double snow_dicom_distance(const double a[3], const double b[3]);

/* Measures the distances of neighbours along the normal, and makes even slices
 * between them if they are not on an even grid.  Errors: as below. */
snow_status snow_dicom_space_slices(dicom_stack *stack);

/* Orders the frames of a group and finds the positions of its slices, of which
 * some may be missing if `gaps` are allowed.  Gives no warnings.  Free with
 * snow_dicom_stack_free.  Errors: SNOW_STATUS_BAD_INPUT (a missing slice, too
 * many images at a position, slices that lie beside one another),
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_stack(snow_context *context, dicom_frame *frames,
                             size_t count, bool gaps, dicom_stack *out);
void snow_dicom_stack_free(dicom_stack *stack);

/* What info says of any stack. */
void snow_dicom_describe(const dicom_stack *stack, snow_volume_info *info);

/* --- files.c -------------------------------------------------------------- */

/* True when a file of the list looks like DICOM; slices of other formats by
 * their names are not looked at. */
bool snow_dicom_among(snow_context *context, const snow_folder *files,
                      snow_format_finder *find);

/* Reads as a format does, for all DICOM files of the list. */
snow_status snow_dicom_read_files(snow_context *context, snow_folder *files,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out);

/* --- header.c ------------------------------------------------------------- */

/* Reads the header; rows is 0 if there is no image.  Errors:
 * SNOW_STATUS_BAD_INPUT (invalid sizes). */
snow_status snow_dicom_read_image(snow_context *context, dicom_reader *reader,
                                  dicom_image *out);

/* Reads whole numbers of 16 bits; returns how many there are. */
int snow_dicom_shorts(const dicom_reader *reader, const dicom_element *element,
                      double *out, int most);

/* Describes one of its frames. */
void snow_dicom_read_frame(dicom_reader *reader, const dicom_image *image,
                           int64_t number, dicom_frame *out);

/* Finds whether the file of an open reader ends before the image's pixels do;
 * that of compressed ones shows only when they are looked through. */
snow_status snow_dicom_find_cut(const dicom_reader *reader,
                                const dicom_image *image, bool *cut);

/* --- mosaic.c ------------------------------------------------------------- */

/* Finds whether the frame of an image is a mosaic of Siemens', and sets its
 * slices. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_read_mosaic(dicom_reader *reader, dicom_image *image);

/* Refuses a mosaic whose tiles are not known: SNOW_STATUS_BAD_INPUT; warns
 * where their order is not. */
snow_status snow_dicom_check_mosaic(snow_context *context,
                                    const dicom_frame *frame);

/* Moves a slice of a mosaic to its own position. */
void snow_dicom_place_tile(const dicom_image *image, dicom_frame *frame);

/* --- sizes.c -------------------------------------------------------------- */

/* Plain bytes behind the pixels that are whole rows, which no padding is. */
uint64_t snow_dicom_count_more(const dicom_reader *reader,
                               const dicom_image *image);

/* Checks that the file of a reader without pixels can hold those of the image,
 * and has no more of them. Errors: SNOW_STATUS_BAD_INPUT. */
snow_status snow_dicom_check_sizes(snow_context *context,
                                   const dicom_reader *reader,
                                   const dicom_image *image);

/* --- pixels.c ------------------------------------------------------------- */

/* The transfer syntax of deflated files. */
#define DICOM_DEFLATED "1.2.840.10008.1.2.1.99"

/* Refuses pixels in a transfer syntax that is not known: SNOW_STATUS_BAD_INPUT.
 */
snow_status snow_dicom_check_syntax(const dicom_reader *r);

/* The layout of a frame's words; a codec may differ from the header. */
typedef struct dicom_words {
    int size;         /* bytes of a word: 1, 2 or 4 */
    int stored, high; /* bits of a value; the highest one, from 0 */
    bool is_signed;
    bool planes; /* one plane per sample, not interleaved */
} dicom_words;

/* Bytes of a frame: columns * rows * samples words, of single bits a byte for
 * each. */
uint64_t snow_dicom_frame_bytes(const dicom_image *image);

/* Returns whether the bytes of Y, Cb, Cr become red, green, blue. */
bool snow_dicom_is_ybr(const dicom_image *image);

/* Reads a frame's words in the machine's byte order into `out`, of the size
 * above; colours are red, green, blue. Errors: SNOW_STATUS_BAD_INPUT
 * (truncated, damaged, or an unknown compression), SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_read_words(dicom_reader *reader,
                                  const dicom_image *image, int64_t number,
                                  void *out, dicom_words *words);

/* --- palette.c ------------------------------------------------------------ */

/* Red, green and blue, each of `count` stored values from `first` on; values
 * outside have the colour of the nearest. */
typedef struct dicom_palette {
    int64_t first;
    size_t count;
    unsigned char *levels; /* of the context; NULL: no palette */
} dicom_palette;

/* Reads the palette of a file that has one.  Errors: SNOW_STATUS_BAD_INPUT
 * (missing or not supported), SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_palette_read(dicom_reader *reader,
                                    const dicom_image *image,
                                    dicom_palette *out);

/* --- codec.c -------------------------------------------------------------- */

/* Checks that the compressed bytes of a frame match the image, by their own
 * header, and that they are whole as far as codecs do not find it; narrows
 * them to the code stream, whose values have *bits.  Errors:
 * SNOW_STATUS_BAD_INPUT. */
snow_status snow_dicom_check_packed(snow_context *context, const char *syntax,
                                    const dicom_image *image,
                                    const unsigned char **bytes, size_t *size,
                                    int *bits);

/* "its pixels cannot be decompressed". */
snow_status snow_dicom_fail_unpack(snow_context *context, const char *syntax);

/* Decodes run lengths (PS3.5, annex G) as planes of bytes; returns false if
 * they do not match the image. */
bool snow_dicom_unpack_runs(const dicom_image *image,
                            const unsigned char *bytes, size_t size,
                            unsigned char *out);

/* --- entropy.c ------------------------------------------------------------ */

/* Returns whether a JPEG stream of DICOM (not JPEG-LS) is sequential or
 * lossless and has all its codes, each of which its tables know. */
bool snow_dicom_jpeg_is_whole(const unsigned char *bytes, size_t size);

/* Returns whether JPEG-LS has the marker of its end: without, some versions of
 * CharLS read on for ever. */
bool snow_dicom_jpeg_ls_has_end(const unsigned char *bytes, size_t size);

/* --- codestream.c, packets.c ---------------------------------------------- */

/* Finds whether all tiles of a JPEG 2000 stream are there, and their packets
 * fill them. Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_walk_jpeg2000(snow_context *context,
                                     const unsigned char *bytes, size_t size,
                                     bool *whole);

/* --- voxels.c ------------------------------------------------------------- */

/* The source of frames: the given file, or files by their paths. */
typedef struct dicom_input {
    snow_context *context;
    snow_seekable *store;       /* of images without a path */
    dicom_image *const *images; /* all, also of other series */
    size_t image_count;
} dicom_input;

/* Makes the volume of a stack, for a time step and box. */
snow_status snow_dicom_read_stack(const dicom_input *input,
                                  const dicom_stack *stack,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out);

/* --- suv.c ---------------------------------------------------------------- */

/* When the slices of a file were acquired: seconds since 1970, or of a day
 * without a date; NaN if it does not say. */
double snow_dicom_acquired(dicom_reader *reader);

/* Names the unit of PET and doses, and scales PET to the one that is wanted (as
 * in options), or says what it lacks. Errors: those of opening. */
snow_status snow_dicom_set_unit(const dicom_input *input,
                                const dicom_stack *stack, const char *wanted,
                                snow_volume_info *info);

/* --- copies.c ------------------------------------------------------------- */

/* Whether the image of an open reader is that of another with its SOP instance
 * UID; the first frames of both are known.  `given`: the store of one without a
 * path. */
snow_status snow_dicom_is_copy(dicom_reader *reader, snow_seekable *given,
                               dicom_image *image, const dicom_frame *frame,
                               dicom_image *other, const dicom_frame *known,
                               bool *same);

/* --- segments.c ----------------------------------------------------------- */

/* The same of a segmentation: a volume of labels.  Errors:
 * SNOW_STATUS_BAD_INPUT (frames without a place or segment, another type of
 * segmentation), SNOW_STATUS_NO_MEMORY. */
snow_status snow_dicom_read_segments(const dicom_input *input,
                                     const dicom_stack *stack,
                                     const snow_volume_options *options,
                                     snow_volume_info *info, snow_volume **out);

#endif
