/* snowglass/render.h - from a volume to a picture.
 *
 * A picture is made by the stages of the paper's figure 7, the parallel
 * rendering pipeline: transformation, classification and shading, encoding,
 * reconstruction (splatting), composition, combination. A frame keeps the
 * buffers of these stages from picture to picture, and the encoding of the
 * volume, which serves as long as volume and transfer function allow. */
#ifndef SNOWGLASS_RENDER_H
#define SNOWGLASS_RENDER_H

#include <snowglass/image.h>
#include <snowglass/transfer.h>
#include <snowglass/view.h>

typedef struct snow_frame snow_frame;

/* How voxels reach the picture (docs/fast.md). */
typedef enum snow_method {
    SNOW_METHOD_AUTO = 0,
    SNOW_METHOD_ORIGINAL,   /* every voxel, no sparse matrix: the baseline */
    SNOW_METHOD_FOOTPRINT,  /* interesting voxels, each onto the image */
    SNOW_METHOD_SHEAR_WARP, /* values of sheared slices, warped once: fast */
    SNOW_METHOD_RAYCAST     /* rays through interpolated values: slow truth */
} snow_method;

/* How the places of interesting voxels are written: the paper's section 3.2.
 * The picture is the same for all. */
typedef enum snow_encoding {
    SNOW_ENCODING_AUTO = 0, /* by measured density and run length */
    SNOW_ENCODING_CRS,
    SNOW_ENCODING_BITMAP,
    SNOW_ENCODING_RLE
} snow_encoding;

/* How values between voxels are reconstructed, along each axis of the grid
 * (docs/model.md, section 7). Only footprint and original draw gauss, box, and
 * other footprints than tent of 2 and bspline of 4: there shear-warp leaves the
 * picture to footprint (snow_stats.method says so), and raycast and mode iso
 * return BAD_USAGE. */
typedef enum snow_kernel {
    SNOW_KERNEL_AUTO = 0, /* tent; bspline by original and footprint */
    SNOW_KERNEL_BSPLINE,
    SNOW_KERNEL_TENT,
    SNOW_KERNEL_GAUSS,
    SNOW_KERNEL_BOX
} snow_kernel;

/* How much work a picture is: of shear-warp the samples of a voxel on the
 * intermediate image, of raycast the longest step along a ray, in smallest
 * spacings. */
typedef enum snow_quality {
    SNOW_QUALITY_NORMAL = 0, /* one to four; step 1/4 */
    SNOW_QUALITY_DRAFT,      /* one; step 1/2 */
    SNOW_QUALITY_HIGH /* four or more, slices between slices; step 1/16 */
} snow_quality;

/* The instruction set that draws. avx2 and avx512 give the same bits, the
 * others differ by rounding. */
typedef enum snow_isa {
    SNOW_ISA_AUTO = 0, /* the best that this machine runs */
    SNOW_ISA_SCALAR,
    SNOW_ISA_AVX2,
    SNOW_ISA_AVX512,
    SNOW_ISA_SSE4,
    SNOW_ISA_NEON,
    SNOW_ISA_WASM
} snow_isa;

/* How colours are lit. */
typedef enum snow_shade { SNOW_SHADE_PHONG = 0, SNOW_SHADE_NONE } snow_shade;

/* From where the light comes (docs/model.md, section 4). */
typedef enum snow_light {
    SNOW_LIGHT_AUTO = 0, /* key; a direction where angles are not 0 */
    SNOW_LIGHT_KEY,      /* 0.65 from 25 degrees left, 35 up; 0.35 head */
    SNOW_LIGHT_HEAD,     /* from the viewer */
    SNOW_LIGHT_DIRECTION /* from light_azimuth and light_elevation */
} snow_light;

/* What becomes of the values that a ray meets (docs/modes.md). All modes but
 * over use every finite voxel, whatever its opacity and the threshold. */
typedef enum snow_mode {
    SNOW_MODE_OVER = 0, /* composited front to back */
    SNOW_MODE_MIP,      /* the largest value, as a colour */
    SNOW_MODE_MINIP,    /* the smallest value, as a colour */
    SNOW_MODE_MEAN,     /* the mean, one channel; NaN where a ray meets none */
    SNOW_MODE_SUM,      /* the integral over the ray's length, divided by
                           opacity_length: by default in smallest spacings */
    SNOW_MODE_ISO       /* the first surface where a value reaches `iso` (the
                           isovalue), shaded */
} snow_mode;

/* What a picture is made with. Defaults in brackets where they are not 0. */
typedef struct snow_settings {
    size_t size;
    double threshold;       /* 0 to 255, as the paper's levels: a voxel of
                               opacity a is interesting if 255 a is greater */
    snow_method method;     /* (auto) */
    snow_encoding encoding; /* (auto) */
    snow_kernel kernel;     /* (auto) */
    int footprint;          /* voxels, 2 to 9; 0: 2 for tent and box, else 4 */
    double opacity_length;  /* unit distance of opacities and of mode sum, in
                               the world; 0: the smallest spacing */
    snow_shade shade;       /* (phong) */
    double ambient, diffuse, specular;     /* 0 to 1 (0.2, 0.7, 0.2) */
    double shininess;                      /* exponent, at least 0 (20) */
    double light_azimuth, light_elevation; /* degrees: camera's right, up */
    snow_quality quality;                  /* (normal) */
    snow_isa isa;                          /* (auto) */
    int threads; /* 1 to 4096, of no effect on the picture; 0: all there are */
    bool deterministic;     /* the same bits on every machine (false) */
    snow_mode mode;         /* (over) */
    double iso;             /* data value of mode iso, finite */
    bool depth;             /* makes snow_frame_depth; over and iso (false) */
    snow_stop_fn *stop;     /* whether the picture is to end early (NULL) */
    void *stop_user;        /* the argument of `stop` (NULL) */
    snow_light light;       /* (auto) */
    double depth_darkening; /* over, iso: 0 to 1, of what lies deeper (0) */
    double occlusion;       /* over, iso: 0 to 1, of what is enclosed (0) */
} snow_settings;
SNOW_RECORD(snow_settings);

/* What the last picture took. Settings are as chosen; seconds are wall time.
 * `interesting` and `sparse_ratio` are those of the transfer function that the
 * encoding was made for: a picture that reuses an encoding (`encoded` is false)
 * repeats them; snow_transfer_sparse_ratio counts anew. */
typedef struct snow_stats {
    size_t size;
    snow_method method;
    snow_encoding encoding;             /* AUTO when none was used */
    int footprint, slice_axis, threads; /* the axis: 0 x, 1 y, 2 z */
    snow_isa isa;
    snow_kernel kernel;
    snow_quality quality;
    bool encoded; /* anew, for this picture */
    int64_t voxels, interesting;
    double sparse_ratio; /* share of uninteresting voxels, 0 to 1 */
    uint64_t ea_bytes, ia_bytes, pa_bytes; /* of the encoding, the paper's
                           figure 3: places, samples, slices; samples are 0
                           where voxels are read in place */
    double seconds_classify, seconds_shade, seconds_encode; /* stages of */
    double seconds_splat, seconds_composite, seconds_warp;  /*   figure 7 */
    double seconds_frame, cpu_frame; /* the picture; in processor time */
    uint64_t kept_bytes, kept_most;  /* encodings along other slice axes:
                                        what is kept, and what may be */
    double seconds_shared;  /* one thread: in work that more would share */
    double seconds_longest; /* of it, the longest item of each stage */
} snow_stats;
SNOW_RECORD(snow_stats);

/* Makes a frame. Use one for all pictures of a window or a movie. */
SNOW_API snow_status snow_frame_new(snow_context *context, snow_frame **out);

/* Frees a frame, before or after the volumes that it has drawn. */
SNOW_API void snow_frame_free(snow_frame *frame);

/* Renders a picture of a volume in one process: the paper's figure 8. `view`
 * and `settings` may be NULL. *image is a new picture each time, which the
 * caller frees: free the last one first, or take snow_frame_render_bytes in
 * loops. It has four channels; two, grey and alpha, where all colours are grey
 * (snow_transfer_is_grey); one, of values, in modes mean and sum. Errors:
 * BAD_USAGE, BAD_INPUT (no float can hold the geometry), STOPPED. */
SNOW_API snow_status snow_frame_render(snow_frame *frame,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings, snow_image **image);

/* A volume that is drawn with the picture's own. `mixes`: it is a channel,
 * whose colours are mixed with those of the layer before it, of the first layer
 * with those of the volume; else it lies in front of them (docs/model.md). */
typedef struct snow_layer {
    const snow_volume *volume;
    const snow_transfer *transfer;
    bool mixes;
} snow_layer;
#define SNOW_LAYERS_MAX 7

/* Sets the volumes that are drawn with the one of snow_frame_render, slab by
 * slab; a count of 0 removes them. They are on its grid (dims and matrix;
 * snow_volume_regrid), or stay in their files, of which parts are read. Mode
 * over, methods shear-warp and raycast. `layers` is copied, but the volumes and
 * transfer functions in it stay the caller's: they must live until the next
 * call of this function, or until the frame is freed. */
SNOW_API snow_status snow_frame_set_layers(
    snow_frame *frame, const snow_layer *layers, int count);

/* Renders the same picture as bytes: red, green, blue, straight alpha, row 0 on
 * top, rows `stride` bytes apart. With a `background` of 0 to 1 (or NULL) it is
 * opaque. A picture that fails or is stopped may have written some of
 * `pixels`. Errors: as snow_frame_render; BAD_USAGE (a stride below 4 times the
 * width; modes mean and sum). */
SNOW_API snow_status snow_frame_render_bytes(snow_frame *frame,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings,
    const double background[3], unsigned char *pixels, size_t stride);

/* Returns the depths of the last picture with settings->depth, one channel, or
 * NULL. They are the frame's, until its next picture. A depth is the distance
 * in the world from the plane through the target along the line of sight:
 * negative towards the camera, positive behind the target. It is where the
 * opacity passes 1/2, or the surface is; NaN where there is none. */
SNOW_API const snow_image *snow_frame_depth(const snow_frame *frame);

/* Returns the figures of the last picture, which are the frame's until the next
 * one. All are 0, and so is `size`, before the first. */
SNOW_API const snow_stats *snow_frame_stats(const snow_frame *frame);

/* Renders a file or phantom:NAME in one call: the tool's first picture of it,
 * to the bit, with its channels mixed (channels.h). `view` and `settings` may
 * be NULL. Saved as PNG, WebP or JPEG without options, the picture has the
 * tool's background and letters. Errors: of snow_volume_open and
 * snow_frame_render. */
SNOW_API snow_status snow_render_file(snow_context *context, const char *path,
    const snow_view *view, const snow_settings *settings, snow_image **image);

/* Returns the mode of a first picture: mip for emitted light, PET, and thin
 * slabs of MR and CT, else over. */
SNOW_API snow_mode snow_mode_for(const snow_volume_info *info);

/* Returns the colour map of a first picture: "grey_r" for PET, else NULL. */
SNOW_API const char *snow_colormap_for(const snow_volume_info *info);

/* Gives the automatic background of a mode, red, green and blue: the lowest
 * colour of the transfer function for projections (black where it is NULL),
 * white for colours on a white ground, else a dark grey. */
SNOW_API void snow_mode_background(
    snow_mode mode, const snow_transfer *transfer, double rgb[3]);

/* Fits a view to what a transfer function shows, from each of `count` azimuths
 * (NULL: the view's own; docs/model.md, section 2): it sets target, has_target
 * and zoom. A view with a position or a target stays as it is. `transfer` NULL
 * stands for all of the volume. `comm` is NULL in one process; with ranks all
 * make the call. Errors: of snow_frame_render. */
SNOW_API snow_status snow_view_fit(snow_comm *comm, const snow_volume *volume,
    const snow_transfer *transfer, const snow_settings *settings,
    const double *azimuths, size_t count, snow_view *view);

/* Makes the view straight on the slices across an axis of the grid: "x", "y" or
 * "z", or the one that faces "axial", "coronal" or "sagittal" most. *found gets
 * the axis, 0 to 2. A slice fills the view's size, or its own at its smallest
 * spacing, where a side of the view is 0. Errors: BAD_USAGE (no such axis). */
SNOW_API snow_status snow_slice_view(snow_context *context,
    const snow_volume_info *info, const char *axis, snow_view *view,
    int *found);

/* Renders slice `index` across the axis that a view faces: opaque colours, or
 * values in one channel where `transfer` is NULL. Values between voxels are
 * linear, or those of the nearest voxel of labels and with kernel box. Errors:
 * BAD_USAGE (no such slice; voxels in a file). */
SNOW_API snow_status snow_slice_render(const snow_volume *volume, int64_t index,
    const snow_transfer *transfer, const snow_view *view,
    const snow_settings *settings, snow_image **image);

/* Where a slice lies in a picture of several. */
typedef struct snow_slice_place {
    size_t size;
    snow_view view;  /* straight on it, of its size */
    int axis, x, y;  /* of the grid; the upper left pixel in the picture */
    int64_t index;   /* of the slice across the axis */
    double cross[2]; /* where the point lies, in pixels from (x, y) */
} snow_slice_place;
SNOW_RECORD(snow_slice_place);

/* Places slice `part` of three through a point of the world: axial, coronal and
 * sagittal, in a row and at one scale. `size` is that of the picture; where a
 * side is 0 both are set. Errors: BAD_USAGE (a point outside of the volume). */
SNOW_API snow_status snow_slice_ortho(snow_context *context,
    const snow_volume_info *info, const double at[3], int part, int size[2],
    snow_slice_place *out);

/* Places slice `part` of columns * rows slices across an axis, row by row.
 * `size` as above; the caller chooses the index. Errors: BAD_USAGE (no such
 * axis or part; more than 100 across or down). */
SNOW_API snow_status snow_slice_grid(snow_context *context,
    const snow_volume_info *info, const char *axis, int columns, int rows,
    int part, int size[2], snow_slice_place *out);

/* Copies a slice to its place in a picture of several, with lines through the
 * point where `cross` is true. The picture has four channels, or those of the
 * slice, and then no lines. Errors: BAD_USAGE (the slice does not fit). */
SNOW_API snow_status snow_slice_lay(const snow_image *slice,
    const snow_slice_place *place, bool cross, snow_image *picture);

/* Finds the first and the last slice across an axis of which a transfer
 * function shows 1 %: values above a tenth of its range, or labels. Errors:
 * BAD_USAGE (voxels in a file). */
SNOW_API snow_status snow_slice_shown(const snow_volume *volume,
    const snow_transfer *transfer, int axis, int64_t ends[2]);

/* Gives the smallest and the largest value of a picture of values, as of modes
 * mean and sum; 0 and 1 where there is none. */
SNOW_API void snow_image_value_range(
    const snow_image *values, double *low, double *high);

/* Makes a picture of colours from one of values: those of a transfer function,
 * spread over low to high. Errors: BAD_USAGE (not one channel; low > high). */
SNOW_API snow_status snow_image_apply_colormap(const snow_image *values,
    const snow_transfer *transfer, double low, double high, snow_image **out);

/* Return the name of a value, NULL where it is none. */
SNOW_API const char *snow_method_name(snow_method method);
SNOW_API const char *snow_encoding_name(snow_encoding encoding);
SNOW_API const char *snow_kernel_name(snow_kernel kernel);
SNOW_API const char *snow_quality_name(snow_quality quality);
SNOW_API const char *snow_isa_name(snow_isa isa);
SNOW_API const char *snow_mode_name(snow_mode mode);

/* Return the value of a name, -1 where it is unknown. */
SNOW_API int snow_method_from_name(const char *name);
SNOW_API int snow_encoding_from_name(const char *name);
SNOW_API int snow_kernel_from_name(const char *name);
SNOW_API int snow_quality_from_name(const char *name);
SNOW_API int snow_isa_from_name(const char *name);
SNOW_API int snow_mode_from_name(const char *name);

#endif
