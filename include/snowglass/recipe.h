/* snowglass/recipe.h - a whole render as a text: the same for the command line,
 * for programs, and for pictures of a running simulation.
 *
 * A recipe is one JSON object.  Its keys are the long options of the tool, its
 * values what they take:
 *
 *   {"input": "head.nii.gz", "output": "head_%04d.png", "size": [640, 480],
 *    "colormap": "viridis", "range": [10, 200], "view": "anterior",
 *    "azimuth": 30, "quality": "high", "background": [1, 1, 1]}
 *
 * What is left out has its default.  A key that is unknown is refused.
 *
 * These functions are a library of their own (libsnowglass-recipe), because
 * they need a JSON library (jansson) and nothing else here does. */
#ifndef SNOWGLASS_RECIPE_H
#define SNOWGLASS_RECIPE_H

#include <snowglass/insitu.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SNOW_RECIPE_POINTS_MAX 256

/* Texts are NULL where not told, numbers as each field says. */
typedef struct snow_recipe {
    size_t size;
    const char *input;        /* path; not used in situ */
    const char *output;       /* path, or a movie's pattern */
    snow_volume_options data; /* how to open the input */
    const char *preset;       /* the look, as in snow_look */
    const char *colormap;
    snow_range range;
    double low, high;
    size_t opacity_count; /* 0: the preset's */
    snow_opacity_point opacities[SNOW_RECIPE_POINTS_MAX];
    bool opacity_per_mm; /* opacities are those of a millimetre, instead of the
                            smallest voxel spacing */
    bool opacity_per_voxel; /* they are not, whatever the file of `tf` says */
    const char *view;       /* name; NULL: the volume's own */
    int width, height;      /* (512, 512) */
    double azimuth, elevation, roll;
    double zoom;              /* (1) */
    double fov;               /* 0: parallel */
    double position[3];       /* of the camera in the world, in place of the */
    double target[3];         /*   name; what it looks at; and what is up: as */
    double up[3];             /*   in snow_view.  NaN: not told (NaN) */
    bool no_labels;           /* without letters of orientation */
    bool legend, time_label;  /* with bars, and the number of the step */
    snow_settings settings;   /* as snow_settings_init makes them; the opacity
                                 length stays 0 */
    snow_image_options image; /* of the file */
    void *owned;              /* what texts lie in; NULL: the caller's */
    size_t gradient_opacity_count; /* of the look; 0: none */
    snow_opacity_point gradient_opacities[SNOW_RECIPE_POINTS_MAX];
    const char *tf; /* a file that stands for a preset (transfer/formats/tf.h),
                       or NULL */
    bool log;       /* as in snow_look */
    const char *depth; /* path of the depths, or NULL; the output's own .exr
                          gets them as a channel (image.h) */
} snow_recipe;
SNOW_RECORD(snow_recipe);

/* Reads a recipe from a file, or from `bytes` of text, which messages call
 * `name`.  The record's texts live until snow_recipe_clear, which must follow.
 * Errors: SNOW_STATUS_BAD_INPUT (no file, no JSON: with the line; a key that is
 * unknown or whose value does not fit), SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_recipe_load(snow_context *context, const char *path,
                                      snow_recipe *out);
SNOW_API snow_status snow_recipe_parse(snow_context *context, const char *name,
                                       const char *text, size_t bytes,
                                       snow_recipe *out);
SNOW_API void snow_recipe_clear(snow_recipe *recipe);

/* Writes a recipe's text, several lines and a final zero byte, into `room`
 * bytes, and tells how many it has, without that byte: of a text that does not
 * fit nothing but a zero byte is written, and the call may be made again with
 * *length + 1.  Errors: SNOW_STATUS_NO_MEMORY. */
SNOW_API snow_status snow_recipe_write(snow_context *context,
                                       const snow_recipe *recipe, char *text,
                                       size_t room, size_t *length);

/* The look, whose texts and points are the recipe's, but for those of the file
 * `tf`, which the caller loads (snow_recipe_apply does); the view, for which
 * `usual` stands in where the recipe names none; the settings for a volume, in
 * whose unit of length opacities per millimetre are told.  Errors:
 * SNOW_STATUS_BAD_USAGE (no such view; a unit that is no length). */
SNOW_API snow_status snow_recipe_get_look(snow_context *context,
                                          const snow_recipe *recipe,
                                          snow_look *out);
SNOW_API snow_status snow_recipe_get_view(snow_context *context,
                                          const snow_recipe *recipe,
                                          const snow_view *usual,
                                          snow_view *out);
SNOW_API snow_status snow_recipe_get_settings(snow_context *context,
                                              const snow_recipe *recipe,
                                              const char *unit,
                                              snow_settings *out);

/* Tells it all to pictures in situ: look, view, settings, and the output where
 * there is one.  A grid in situ has no unit: opacities per millimetre are those
 * of a length of 1.  Errors: as above and of the setters; SNOW_STATUS_BAD_USAGE
 * (a depth, which pictures in situ have none of). */
SNOW_API snow_status snow_recipe_apply(const snow_recipe *recipe,
                                       snow_insitu *insitu);

/* Loads a recipe, applies it, and clears it: for a rank each, or for programs
 * in Fortran.  A failure of one rank is that of all at the next collective
 * call. */
SNOW_API snow_status snow_recipe_apply_file(snow_insitu *insitu,
                                            const char *path);

#ifdef __cplusplus
}
#endif
#endif
