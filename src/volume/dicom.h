/* volume/dicom.h - DICOM images on their way to a volume.
 *
 *   files   dicom_files.c    which belong together
 *     |
 *   parse   dicom_parse.c    a file's elements
 *     |
 *   header  dicom_header.c   a file's image, and its frames
 *     |
 *   series  dicom_series.c   which frames are alike, in which order, where
 *     |
 *   voxels  dicom_voxels.c   frames scaled and put in place
 *     |
 *   pixels  dicom_palette.c  what numbers of colours are worth
 *           dicom_pixels.c   a frame's words, plain or packed
 *           dicom_codec.c    what packed ones say, before GDCM unpacks them
 *
 * Places are in LPS and mm, as DICOM has them, up to the matrix, which is RAS.
 * GDCM sees nothing but packed pixels. */
#ifndef SNOW_DICOM_H
#define SNOW_DICOM_H

#include "base/folder.h"
#include "base/random.h"
#include "volume/volume.h"

/* What tells images of one place apart, the first that differs counts: indices
 * of time first, then what is varied otherwise, then the order of taking. */
enum {
    DICOM_KEY_TIME,    /* temporal position */
    DICOM_KEY_TRIGGER, /* ms of the heart's beat */
    DICOM_KEY_ECHO,    /* ms */
    DICOM_KEY_B_VALUE, /* s/mm^2, of diffusion */
    DICOM_KEY_ACQUISITION,
    DICOM_KEY_INSTANCE,
    DICOM_KEYS
};

/* One file with an image, as its header tells it. */
typedef struct dicom_image {
    char *path; /* in the list of files; NULL for the file that was given */
    char series[65], instance[65], photometric[17], modality[17];
    char patient[256]; /* UTF-8; "" when not told */
    int64_t columns, rows, frames;
    int64_t series_number;
    int samples, allocated, stored, high;
    bool is_signed, planes; /* samples of a pixel are not side by side */
    bool pads;              /* stored values within padding are no values */
    double padding[2];
} dicom_image;

/* A picture of a slice: a file, or a part of one. */
typedef struct dicom_frame {
    const dicom_image *image;
    int64_t number;                        /* within its file, from 0 */
    bool placed;                           /* the next three are told */
    double position[3], row[3], column[3]; /* of the first pixel's centre; along
                                              a row, down a column */
    double pixel[2]; /* mm from column to column, from row to row */
    bool measured;   /* they are told */
    bool guessed;    /* depth is not told where it places frames, 1 is taken */
    bool unscaled;   /* a slope of 0 was left out */
    double depth;    /* mm from slice to slice as told, with its sign, 0: not */
    double thickness;
    double slope, intercept;
    double keys[DICOM_KEYS];
} dicom_frame;

/* --- dicom_parse.c --------------------------------------------------------
 */

#define DICOM_TAG_PIXELS 0x7fe00010u
#define DICOM_TAG_ITEM 0xfffee000u

/* Whether the bytes are the beginning of a DICOM file, with its mark at byte
 * 128 or without. */
bool snow_dicom_probe(const unsigned char *bytes, size_t size);

/* An element, an item or a fragment: `length` bytes of the store from `at` on.
 * Elements in it come next on the list; `next` is the first that is not. */
typedef struct dicom_element {
    uint32_t tag; /* group << 16 | element */
    uint32_t length;
    uint64_t at;
    size_t next;
    bool words; /* VR OW */
} dicom_element;

/* A file whose elements are known; their values are read when asked for. */
typedef struct dicom_reader {
    snow_context *context;
    snow_random *store; /* outlives it */
    dicom_element *elements;
    size_t count, room;
    char syntax[65];
    char class_told[65]; /* of what the file holds, as its beginning says */
    bool big_endian;
    bool packed;          /* the pixels are fragments */
    bool has_pixels;      /* where they were not asked for: they follow */
    uint32_t pixel_bytes; /* then, of plain ones */
    const dicom_element *frames, *shared; /* functional groups, or NULL */
    size_t last_item; /* groups of the frame last asked for; 0: none */
    int64_t last_frame;
    /* Where frames lie in slices or mm from the first, sought once. */
    double *offsets;
    enum { DICOM_UNSOUGHT, DICOM_NO_OFFSETS, DICOM_SLICES, DICOM_MM } offset_in;
    unsigned char *inflated; /* a deflated file's elements, and their store */
    snow_source *inner;
    snow_random *inner_store;
} dicom_reader;

/* Parses a file up to its pixels, or with them.
 * Errors: SNOW_BAD_INPUT (a value that is longer than the file, sequences that
 * are nested beyond all measure, packed pixels without an end),
 * SNOW_NO_MEMORY. */
snow_status snow_dicom_open(snow_context *context, snow_random *store,
                            bool pixels, dicom_reader *out);
void snow_dicom_close(dicom_reader *reader);

/* The first with a tag from list index `begin` up to `end`, not within others;
 * an item of a sequence, from 0; NULL where there is none. */
const dicom_element *snow_dicom_find(const dicom_reader *reader, size_t begin,
                                     size_t end, uint32_t tag);
const dicom_element *snow_dicom_item(const dicom_reader *reader,
                                     const dicom_element *sequence,
                                     int64_t number);

/* Where a value is: an element of the file itself, or of the first item of a
 * sequence.  A sequence is looked for among the functional groups of a frame
 * (from 0), then among those that all frames share, then in the file itself. */
typedef struct dicom_place {
    int64_t frame;
    uint32_t sequence; /* 0: none */
    uint32_t tag;
} dicom_place;

/* Copies up to `room` bytes of a value as they are in the file; returns how
 * many, 0 where there is no such value. */
size_t snow_dicom_value(dicom_reader *reader, dicom_place place, void *out,
                        size_t room);

/* --- dicom_series.c ------------------------------------------------------- */

/* Frames of one series that are alike, in the order of the list. */
typedef struct dicom_group {
    size_t first, count;
} dicom_group;

/* Sorts frames so that those of a group follow one another, groups in the order
 * of series' numbers; `groups` has room for `count`.  Returns how many. */
size_t snow_dicom_group(dicom_frame *frames, size_t count, dicom_group *groups);

/* Slice z of the volume lies between two of its places. */
typedef struct dicom_slice {
    size_t low, high; /* places */
    double weight;    /* of the high one */
} dicom_slice;

/* How the frames of a group make a volume: `places` of `times` frames each, in
 * the order of the frames, and slices that lie at them or between. */
typedef struct dicom_stack {
    snow_context *context;
    const dicom_frame *frames; /* a group's, in the order of places, then times
                                */
    size_t places, times;
    dicom_slice *slices; /* NULL: one at each place */
    size_t slice_count;
    bool placed; /* the matrix is in a patient's world */
    double matrix[4][4];
    double gap_least, gap_most, gap; /* mm between places; between slices */
    bool told;                       /* gap is */
} dicom_stack;

/* Orders the frames of a group and finds where its slices lie.  Remarks are
 * not made here.  Free with snow_dicom_stack_free.
 * Errors: SNOW_BAD_INPUT (a slice that is missing, images too many at a place,
 * slices that lie beside one another), SNOW_NO_MEMORY. */
snow_status snow_dicom_stack(snow_context *context, dicom_frame *frames,
                             size_t count, dicom_stack *out);
void snow_dicom_stack_free(dicom_stack *stack);

/* --- dicom_files.c -------------------------------------------------------- */

/* True when a file of the list looks like DICOM; slices of other formats by
 * their names are not looked at. */
bool snow_dicom_among(snow_context *context, const snow_folder *files);

/* As a format's read, of all files of the list that are DICOM. */
snow_status snow_dicom_read_files(snow_context *context, snow_folder *files,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out);

/* --- dicom_header.c -------------------------------------------------------
 */

/* What the header tells; rows is 0 where it has no image.
 * Errors: SNOW_BAD_INPUT (sizes that are none). */
snow_status snow_dicom_read_image(snow_context *context, dicom_reader *reader,
                                  dicom_image *out);

/* One of its frames. */
void snow_dicom_read_frame(dicom_reader *reader, const dicom_image *image,
                           int64_t number, dicom_frame *out);

/* --- dicom_pixels.c -------------------------------------------------------
 */

/* What a frame's words are like, which a codec may say otherwise than the
 * header. */
typedef struct dicom_words {
    int size;         /* bytes of a word: 1, 2 or 4 */
    int stored, high; /* bits of a value; the highest one, from 0 */
    bool is_signed;
    bool planes; /* one for each sample, not side by side */
} dicom_words;

/* Bytes of a frame: columns * rows * samples words. */
uint64_t snow_dicom_frame_bytes(const dicom_image *image);

/* A frame's words in the machine's byte order into `out`, as many bytes as
 * above.
 * Errors: SNOW_BAD_INPUT (what is cut, damaged, or packed in a way that is not
 * known), SNOW_NO_MEMORY. */
snow_status snow_dicom_read_words(dicom_reader *reader,
                                  const dicom_image *image, int64_t number,
                                  void *out, dicom_words *words);

/* --- dicom_palette.c ------------------------------------------------------
 */

/* Brightness, 0 to 255 in whole steps, of `count` stored values from `first`
 * on; what is beyond has that of the nearest. */
typedef struct dicom_palette {
    int64_t first;
    size_t count;
    float *levels; /* of the context; NULL: no palette */
} dicom_palette;

/* That of a file whose values are numbers of colours.  Errors: SNOW_BAD_INPUT
 * (it has none, or one that is not read), SNOW_NO_MEMORY. */
snow_status snow_dicom_palette_read(dicom_reader *reader,
                                    const dicom_image *image,
                                    dicom_palette *out);

/* --- dicom_codec.c --------------------------------------------------------
 */

/* Whether the packed bytes of a frame are what the image is, by their own
 * head, and begin in a way that codecs stand; narrows them to the code stream.
 * Errors: SNOW_BAD_INPUT. */
snow_status snow_dicom_check_packed(snow_context *context, const char *syntax,
                                    const dicom_image *image,
                                    const unsigned char **bytes, size_t *size);

/* Run lengths (PS3.5, annex G), as planes of bytes; false when they are not
 * those of the image. */
bool snow_dicom_unpack_runs(const dicom_image *image,
                            const unsigned char *bytes, size_t size,
                            unsigned char *out);

/* --- dicom_voxels.c ------------------------------------------------------- */

/* What frames are read from: the given file, or those of paths. */
typedef struct dicom_input {
    snow_context *context;
    snow_random *store; /* of images without a path */
} dicom_input;

/* Makes the volume of a stack, of its time and box. */
snow_status snow_dicom_read_stack(const dicom_input *input,
                                  const dicom_stack *stack,
                                  const snow_volume_options *options,
                                  snow_volume_info *info, snow_volume **out);

#endif
