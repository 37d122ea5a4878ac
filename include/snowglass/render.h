/* snowglass/render.h - from a volume to a picture: the paper's pipeline. A
 * frame keeps the buffers of its stages (figure 7), and encodings. */
#ifndef SNOWGLASS_RENDER_H
#define SNOWGLASS_RENDER_H

#include <snowglass/image.h>
#include <snowglass/transfer.h>
#include <snowglass/view.h>

typedef struct snow_frame snow_frame;

typedef enum snow_method { /* how voxels reach the picture (docs/fast.md) */
    SNOW_METHOD_AUTO = 0,
    SNOW_METHOD_ORIGINAL,   /* every voxel, no sparse matrix: the baseline */
    SNOW_METHOD_FOOTPRINT,  /* interesting voxels, each onto the image */
    SNOW_METHOD_SHEAR_WARP, /* values of sheared slices, warped once: fast */
    SNOW_METHOD_RAYCAST     /* rays through interpolated values: slow truth */
} snow_method;

typedef enum snow_encoding { /* how their places are written: section 3.2 */
    SNOW_ENCODING_AUTO = 0,  /* by measured density and run length */
    SNOW_ENCODING_CRS,
    SNOW_ENCODING_BITMAP,
    SNOW_ENCODING_RLE
} snow_encoding;

typedef enum snow_kernel { /* along a grid axis (docs/model.md, section 7) */
    SNOW_KERNEL_AUTO = 0,  /* tent; bspline by original and footprint */
    SNOW_KERNEL_BSPLINE,
    SNOW_KERNEL_TENT,
    SNOW_KERNEL_GAUSS, /* by footprint and original only, as is box */
    SNOW_KERNEL_BOX
} snow_kernel;

/* Work for a picture; by raycast a ray's longest step, in smallest spacings. */
typedef enum snow_quality {
    SNOW_QUALITY_NORMAL = 0, /* one to four intermediate pixels a voxel; 1/4 */
    SNOW_QUALITY_DRAFT,      /* one; 1/2 */
    SNOW_QUALITY_HIGH        /* four or more, sheets between slices; 1/16 */
} snow_quality;

/* Of kernels. avx2 and avx512 give the same bits, others differ by rounding. */
typedef enum snow_isa {
    SNOW_ISA_AUTO = 0, /* the best that this machine runs */
    SNOW_ISA_SCALAR,
    SNOW_ISA_AVX2,
    SNOW_ISA_AVX512,
    SNOW_ISA_SSE4,
    SNOW_ISA_NEON,
    SNOW_ISA_WASM
} snow_isa;

typedef enum snow_shade { SNOW_SHADE_PHONG = 0, SNOW_SHADE_NONE } snow_shade;

typedef enum snow_light { /* from where (docs/model.md, section 4) */
    SNOW_LIGHT_AUTO = 0,  /* key; a direction where angles are not 0 */
    SNOW_LIGHT_KEY,       /* 0.65 from 25 degrees left, 35 up; 0.35 head */
    SNOW_LIGHT_HEAD,      /* from the viewer */
    SNOW_LIGHT_DIRECTION  /* from light_azimuth and light_elevation */
} snow_light;

/* How the sheets that a ray meets make a pixel (docs/modes.md). All but over
 * use every finite voxel, whatever its opacity and the threshold. */
typedef enum snow_mode {
    SNOW_MODE_OVER = 0, /* composited front to back */
    SNOW_MODE_MIP,      /* their largest value, as a colour */
    SNOW_MODE_MINIP,    /* their smallest value, as a colour */
    SNOW_MODE_MEAN, /* their mean, one channel; NaN where a ray meets none */
    SNOW_MODE_SUM,  /* the same of values times lengths in opacity_length */
    SNOW_MODE_ISO   /* the first that is not below `iso`, shaded */
} snow_mode;

/* What a picture is made with; (defaults) where they are not 0. */
typedef struct snow_settings {
    size_t size;
    double threshold;       /* opacity 0 to 255; greater is interesting */
    snow_method method;     /* (auto) */
    snow_encoding encoding; /* (auto) */
    snow_kernel kernel;     /* (auto) */
    int footprint;          /* voxels, 2 to 9; 0: 2 for tent and box, else 4 */
    double opacity_length;  /* world length of an opacity; 0: least spacing */
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
    bool depth;             /* with snow_frame_depth; over and iso (false) */
    snow_stop_fn *stop;     /* whether the picture is to end early (NULL) */
    void *stop_user;        /* its argument (NULL) */
    snow_light light;       /* (auto) */
    double depth_darkening; /* over, iso: 0 to 1, of what lies deeper (0) */
    double occlusion;       /* over, iso: 0 to 1, of what is enclosed (0) */
} snow_settings;
SNOW_RECORD(snow_settings);
/* What the last picture took, settings as chosen. Seconds are wall time. */
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
    uint64_t ea_bytes, ia_bytes, pa_bytes; /* IA 0: voxels read in place */
    double seconds_classify, seconds_shade, seconds_encode; /* stages of */
    double seconds_splat, seconds_composite, seconds_warp;  /*   figure 7 */
    double seconds_frame, cpu_frame; /* the picture; in processor time */
    uint64_t kept_bytes, kept_most;  /* encodings along other slice axes */
    double seconds_shared, seconds_longest; /* threads 1: items; longest ones */
} snow_stats;
SNOW_RECORD(snow_stats);
SNOW_API snow_status snow_frame_new(snow_context *context, snow_frame **out);
SNOW_API void snow_frame_free(snow_frame *frame);

/* One picture: figure 8 of the paper on one processor. `settings` may be NULL.
 * Errors: BAD_USAGE, BAD_INPUT (no float can hold the geometry), STOPPED. */
SNOW_API snow_status snow_frame_render(snow_frame *frame,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings, snow_image **image);

/* Volumes on the grid of the picture's (dims and matrix; snow_volume_regrid),
 * or in their files, of which parts take what they need; drawn with it, slab by
 * slab, the last in front or, as channels, mixed (docs/model.md). They stay the
 * caller's; 0: none. Mode over, shear-warp and raycast. */
typedef struct snow_layer {
    const snow_volume *volume;
    const snow_transfer *transfer;
    bool mixes; /* with that before it, the first one with the volume */
} snow_layer;
#define SNOW_LAYERS_MOST 7
SNOW_API snow_status snow_frame_set_layers(
    snow_frame *frame, const snow_layer *layers, int count);

/* The same as bytes: red, green, blue, straight alpha, row 0 on top, rows
 * `stride` bytes apart; or opaque on a `background` of 0 to 1 (NULL: none).
 * Errors: also BAD_USAGE (stride below 4 times the width; modes mean, sum). */
SNOW_API snow_status snow_frame_render_bytes(snow_frame *frame,
    const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings,
    const double background[3], unsigned char *pixels, size_t stride);

/* The mode of a first picture: mip for emitted light, PET and thin slabs of MR
 * and CT, else over; its colour map: grey_r for PET, else NULL. */
SNOW_API snow_mode snow_mode_for(const snow_volume_info *info);
SNOW_API const char *snow_colormap_for(const snow_volume_info *info);

/* The automatic background of a mode, red, green and blue: of projections the
 * lowest colour of the look, black without one; white of a white ground. */
SNOW_API void snow_mode_background(snow_mode, const snow_transfer *, double[3]);

/* Fits a view's target and zoom to what a look shows from each azimuth (NULL:
 * the view's; docs/model.md, section 2). One process: `comm` NULL; or all. */
struct snow_comm;
SNOW_API snow_status snow_view_fit(struct snow_comm *, const snow_volume *,
    const snow_transfer *transfer, const snow_settings *settings,
    const double *azimuths, size_t count, snow_view *view);

/* The tool's first picture of a file or phantom:NAME, to the bit, its channels
 * mixed (channels.h); PNG, WebP and JPEG without options have its background
 * and letters. View, settings may be NULL. */
SNOW_API snow_status snow_render_file(snow_context *context, const char *path,
    const snow_view *view, const snow_settings *settings, snow_image **image);

/* The view straight on the slices across a grid axis: "x", "y", "z", or the one
 * that faces "axial", "coronal" or "sagittal" most; *found gets it. A slice
 * fills the view's size, or its own where a side is 0, at its least spacing. */
SNOW_API snow_status snow_slice_view(snow_context *context,
    const snow_volume_info *info, const char *axis, snow_view *view,
    int *found);

/* Slice `index` across the axis that a view faces, linear between its voxels,
 * or nearest (labels, kernel box). Opaque colours; or values (NULL). */
SNOW_API snow_status snow_slice_render(const snow_volume *volume, int64_t index,
    const snow_transfer *transfer, const snow_view *view,
    const snow_settings *settings, snow_image **image);

/* A slice in a picture of several: straight on it, across an axis of the grid;
 * its upper left pixel, and from there where the point lies in it. */
typedef struct snow_slice_place {
    size_t size;
    snow_view view;
    int axis, x, y;
    int64_t index;
    double cross[2];
} snow_slice_place;
SNOW_RECORD(snow_slice_place);

/* Number `part` of those through a point of the world: axial, coronal, sagittal
 * in a row at one scale; or of a grid across an axis, row by row (`index` 0).
 * Where a side of the picture is 0 it gets its own. Errors: BAD_USAGE. */
SNOW_API snow_status snow_slice_ortho(snow_context *, const snow_volume_info *,
    const double at[3], int part, int size[2], snow_slice_place *out);
SNOW_API snow_status snow_slice_grid(snow_context *, const snow_volume_info *,
    const char *axis, int columns, int rows, int part, int size[2],
    snow_slice_place *out);
/* Lays a slice over its place, with lines through the point; `sheet` has four
 * channels, or those of the slice. Ends of what a look shows 1 % of: above a
 * tenth of its range, or labels. */
SNOW_API snow_status snow_slice_lay(const snow_image *slice,
    const snow_slice_place *place, bool cross, snow_image *sheet);
SNOW_API snow_status snow_slice_shown(
    const snow_volume *, const snow_transfer *, int axis, int64_t ends[2]);

/* Owned by the frame until its next picture. Depths, or NULL: world distance
 * from the target's plane to where opacity passes 1/2, or the surface. */
SNOW_API const snow_image *snow_frame_depth(const snow_frame *frame);
SNOW_API const snow_stats *snow_frame_stats(const snow_frame *frame);

/* Of modes mean and sum: smallest and largest value (0 and 1 without any), and
 * its colours of a transfer function spread over low to high (low <= high). */
SNOW_API void snow_image_value_range(
    const snow_image *values, double *low, double *high);
SNOW_API snow_status snow_image_apply_colormap(const snow_image *values,
    const snow_transfer *transfer, double low, double high, snow_image **out);

/* Names, NULL past the last value, and back; -1 for an unknown name. */
SNOW_API const char *snow_method_name(snow_method method);
SNOW_API const char *snow_encoding_name(snow_encoding encoding);
SNOW_API const char *snow_kernel_name(snow_kernel kernel);
SNOW_API const char *snow_quality_name(snow_quality quality);
SNOW_API const char *snow_isa_name(snow_isa isa);
SNOW_API const char *snow_mode_name(snow_mode mode);
SNOW_API int snow_method_from_name(const char *name);
SNOW_API int snow_encoding_from_name(const char *name);
SNOW_API int snow_kernel_from_name(const char *name);
SNOW_API int snow_quality_from_name(const char *name);
SNOW_API int snow_isa_from_name(const char *name);
SNOW_API int snow_mode_from_name(const char *name);

#endif
