/* snowglass/render.h - from a volume to a picture: the paper's pipeline.
 *
 * A frame owns the buffers of the pipeline's stages (figure 7 of the paper)
 * and keeps them from picture to picture. */
#ifndef SNOWGLASS_RENDER_H
#define SNOWGLASS_RENDER_H

#include <snowglass/image.h>
#include <snowglass/transfer.h>
#include <snowglass/view.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct snow_frame snow_frame;

/* How voxels reach the picture. */
typedef enum snow_method {
    SNOW_METHOD_AUTO = 0,
    SNOW_METHOD_ORIGINAL,   /* every voxel, no sparse matrix, whatever the
                                threshold: the baseline */
    SNOW_METHOD_TESTED,     /* as original, but each voxel's opacity is tested
                               against the threshold first: the honest one */
    SNOW_METHOD_FOOTPRINT,  /* interesting voxels only, through an encoding;
                               each onto the image itself: the exact one */
    SNOW_METHOD_SHEAR_WARP, /* interesting voxels only; slices are splatted and
                           composited on their own grid, sheared, and the
                           result is warped to the image once: the fast one */
    SNOW_METHOD_RAYCAST, /* values are interpolated along each ray and coloured
                           after: the truth that the others are held against,
                           and slow.  One process, all voxels in memory */
    SNOW_METHOD_VALUE /* interpolates values on sheared slices and colours them
                         after: what is to become shear-warp; parallel views of
                         mode over so far */
} snow_method;

/* How the places of interesting voxels are written: section 3.2. */
typedef enum snow_encoding {
    SNOW_ENCODING_AUTO = 0, /* by measured density and run length */
    SNOW_ENCODING_CRS,
    SNOW_ENCODING_BITMAP,
    SNOW_ENCODING_RLE
} snow_encoding;

/* The reconstruction kernel along one grid axis (model, point 7). */
typedef enum snow_kernel {
    SNOW_KERNEL_BSPLINE = 0,
    SNOW_KERNEL_TENT,
    SNOW_KERNEL_GAUSS,
    SNOW_KERNEL_BOX
} snow_kernel;

/* How much work the sheared method puts into a picture; by raycast the longest
 * step of a ray: 1/4 (normal), 1/2 (draft), 1/16 (high) of the smallest
 * spacing. */
typedef enum snow_quality {
    SNOW_QUALITY_NORMAL = 0, /* two intermediate pixels a voxel, one where
                                pixels are wide */
    SNOW_QUALITY_DRAFT,      /* one, and the tent kernel of 2 voxels in place of
                                the default one, also where a picture is left
                                to footprints: while a view is turned.  Where a
                                pixel is two voxels wide and more a volume of
                                half the resolution is drawn, unless the volume
                                is a part, the picture deterministic, its mode
                                not over, or its colours have steps */
    SNOW_QUALITY_HIGH        /* as normal, with a slice between each two, and
                                both axes where the slice axis switches */
} snow_quality;

/* The instruction set of the kernels.  avx2 and avx512 give the same bits;
 * scalar and neon differ from them by rounding. */
typedef enum snow_isa {
    SNOW_ISA_AUTO = 0, /* the best that this machine runs */
    SNOW_ISA_SCALAR,
    SNOW_ISA_AVX2,
    SNOW_ISA_AVX512,
    SNOW_ISA_NEON
} snow_isa;

typedef enum snow_shade { SNOW_SHADE_PHONG = 0, SNOW_SHADE_NONE } snow_shade;

/* How the sheets that a ray meets make a pixel (model, point 8).  All but over
 * use every finite voxel, whatever its opacity and the threshold. */
typedef enum snow_mode {
    SNOW_MODE_OVER = 0, /* laid over one another, front to back */
    SNOW_MODE_MIP,      /* their largest value, as a colour */
    SNOW_MODE_MINIP,    /* their smallest value, as a colour */
    SNOW_MODE_MEAN,     /* their mean value: a picture of one channel, in data
                           units, NaN where a ray misses the volume */
    SNOW_MODE_SUM,      /* the same of values times the length of the ray in a
                           sheet, in reference lengths (opacity_length) */
    SNOW_MODE_ISO       /* the first that is not below `iso`, shaded */
} snow_mode;

/* What a picture is made with.  Fill with snow_settings_init, then change.
 * The record may grow: `size` tells the library which fields the caller knows;
 * the others keep their defaults. */
typedef struct snow_settings {
    size_t size;
    double threshold;       /* opacity 0 to 255; greater is interesting (0) */
    snow_method method;     /* (auto) */
    snow_encoding encoding; /* (auto) */
    snow_kernel kernel;     /* (bspline) */
    int footprint;          /* support in voxels, 2 to 9; 0: the kernel's
                               own, 2 for tent and box, else 4 (0).  Raycast
                               takes the tent for bspline and 0, and knows no
                               other kernels than the tent of 2 and the
                               B-spline of 4 */
    double opacity_length;  /* world length that an opacity is for; 0: the
                               smallest voxel spacing (0) */
    snow_shade shade;       /* (phong) */
    double ambient;         /* 0 to 1 (0.2) */
    double diffuse;         /* 0 to 1 (0.7) */
    double specular;        /* 0 to 1 (0.2) */
    double shininess;       /* exponent, at least 0 (20) */
    double light_azimuth;   /* degrees to the camera's right (0: head light) */
    double light_elevation; /* degrees up (0) */
    snow_quality quality;   /* (normal) */
    snow_isa isa;           /* (auto) */
    int threads;            /* 1 to 4096; 0: as many as this process may use;
                               the picture is the same for any number (0) */
    bool deterministic;     /* the same bits on every machine, by the
                               scalar kernels (false) */
    snow_mode mode;         /* (over) */
    double iso;             /* data value of mode iso, finite (0) */
    bool depth;             /* with snow_frame_depth, in modes over and iso
                               (false) */
    snow_stop_fn *stop;     /* asked whether the picture is to end early; NULL:
                               it is not (NULL) */
    void *stop_user;        /* its argument (NULL) */
} snow_settings;
SNOW_RECORD(snow_settings);

/* What the last picture took.  Seconds are wall time. */
typedef struct snow_stats {
    size_t size;
    snow_method method;       /* as chosen */
    snow_encoding encoding;   /* as chosen; AUTO when none was used */
    int footprint;            /* as chosen */
    int slice_axis;           /* 0 x, 1 y, 2 z */
    int threads;              /* as chosen */
    snow_isa isa;             /* as chosen */
    snow_kernel kernel;       /* as chosen */
    snow_quality quality;     /* as chosen; it matters to sheared only */
    bool encoded;             /* the volume was encoded for this picture; false:
                                 the encoding of an earlier one was used, or
                                 none */
    int64_t voxels;           /* all voxels */
    int64_t interesting;      /* those above the threshold */
    double sparse_ratio;      /* share of uninteresting voxels, 0 to 1 */
    uint64_t ea_bytes;        /* encoded array */
    uint64_t ia_bytes;        /* interesting-voxel array */
    uint64_t pa_bytes;        /* slice-pointer array */
    double seconds_classify;  /* transfer function applied */
    double seconds_shade;     /* gradients and Phong's model */
    double seconds_encode;    /* EA, IA, PA written */
    double seconds_splat;     /* footprints into sheets */
    double seconds_composite; /* sheets into the image */
    double seconds_warp;      /* the intermediate image into the picture */
    double seconds_frame;     /* the whole picture */
    double cpu_frame;         /* the same in processor time of the process */
    /* How often each axis of the volume was halved for a picture that has few
     * pixels; the counts of voxels above are those of what came of it. */
    int halvings[3];
} snow_stats;
SNOW_RECORD(snow_stats);

/* A frame with empty buffers.  Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_frame_new(snow_context *context, snow_frame **out);
SNOW_API void snow_frame_free(snow_frame *frame);

/* Renders one picture: figure 8 of the paper on one processor.  `*image` is
 * made anew and owned by the caller.  volume, transfer and frame must come from
 * one context; `settings` NULL are those of snow_settings_init.  Errors:
 * SNOW_STATUS_BAD_USAGE (a setting out of range, with its name),
 * SNOW_STATUS_BAD_INPUT (a geometry beyond all measure), SNOW_STATUS_NO_MEMORY,
 * SNOW_STATUS_STOPPED (asked for by settings.stop or by the progress function);
 * then no image is made, and the frame is as good as before. */
SNOW_API snow_status snow_frame_render(
    snow_frame *frame, const snow_volume *volume, const snow_transfer *transfer,
    const snow_view *view, const snow_settings *settings, snow_image **image);

/* Opens a file (or phantom:NAME), renders one picture with the look that its
 * histogram suggests, and closes the file.  `view` NULL: 512x512 pixels from
 * the default side; `settings` NULL: the defaults.  `*image` is owned by the
 * caller; free it with snow_image_free.  Errors: those of snow_volume_open and
 * snow_frame_render; then no image is made.  A core without formats
 * (-DSNOW_FORMATS=OFF) lacks this function. */
SNOW_API snow_status snow_render_file(snow_context *context, const char *path,
                                      const snow_view *view,
                                      const snow_settings *settings,
                                      snow_image **image);

/* How far away the last picture is: values of one channel, NaN where there is
 * nothing; NULL unless settings.depth asked for it.  It is the world distance
 * from the target's plane along the camera's line of sight, larger farther
 * away, to where opacity passes 1/2, or to the surface of mode iso.  Owned by
 * the frame, until its next picture. */
SNOW_API const snow_image *snow_frame_depth(const snow_frame *frame);

/* The smallest and the largest value of a picture of modes mean and sum; 0 and
 * 1 when it has none. */
SNOW_API void snow_image_value_range(const snow_image *values, double *low,
                                     double *high);

/* Makes colours of such a picture: those of the transfer function, from its
 * first control point to its last, spread over low to high (low <= high);
 * opaque, and transparent where there is no value.  Errors:
 * SNOW_STATUS_BAD_USAGE, SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_image_apply_colormap(const snow_image *values,
                                               const snow_transfer *transfer,
                                               double low, double high,
                                               snow_image **out);

/* Figures of the last picture; owned by the frame.  Zeros before the first one;
 * after a failure what was counted until then. */
SNOW_API const snow_stats *snow_frame_stats(const snow_frame *frame);

/* Names as the command line writes them (NULL past the last value), and back;
 * a name that is unknown gives -1.  SNOW_METHOD_TESTED is "tested". */
SNOW_API const char *snow_method_name(snow_method method);
SNOW_API const char *snow_encoding_name(snow_encoding encoding);
SNOW_API const char *snow_kernel_name(snow_kernel kernel);
SNOW_API int snow_method_from_name(const char *name);
SNOW_API int snow_encoding_from_name(const char *name);
SNOW_API int snow_kernel_from_name(const char *name);
SNOW_API const char *snow_quality_name(snow_quality quality);
SNOW_API int snow_quality_from_name(const char *name);
SNOW_API const char *snow_isa_name(snow_isa isa);
SNOW_API int snow_isa_from_name(const char *name);
SNOW_API const char *snow_mode_name(snow_mode mode);
SNOW_API int snow_mode_from_name(const char *name);

#ifdef __cplusplus
}
#endif
#endif
