/* snowglass/recipe.h - a render as a text, for the tool, programs, simulations.
 *
 * A recipe is one JSON object. Its keys are the long options of the tool:
 *   {"input": "head.nii.gz", "size": [640, 480], "range": [10, 200]}
 * In libsnowglass-recipe, which needs jansson. */
#ifndef SNOWGLASS_RECIPE_H
#define SNOWGLASS_RECIPE_H

#include <snowglass/insitu.h>

#define SNOW_RECIPE_POINTS_MAX 256

/* A recipe. By default texts are NULL; points of the camera are NaN: not
 * given. */
typedef struct snow_recipe {
    size_t size;
    const char *input, *output;    /* paths; in situ only a movie's pattern */
    snow_volume_options data;      /* how to open the input */
    const char *preset, *colormap; /* the look, as in snow_look */
    snow_range range;
    double low, high;
    size_t opacity_count; /* 0: the preset's */
    snow_opacity_point opacities[SNOW_RECIPE_POINTS_MAX];
    bool opacity_per_mm, opacity_per_voxel; /* neither: as the file of `tf` */
    const char *view;                       /* name; NULL: the volume's own */
    int width, height;                      /* (512, 512) */
    double azimuth, elevation, roll, zoom, fov; /* as in snow_view */
    double position[3], target[3], up[3];       /* of the camera: snow_view */
    bool no_labels, legend;                     /* letters; bars */
    snow_settings settings;                     /* opacity_length stays 0 */
    snow_image_options image;                   /* of the file */
    void *owned;                   /* the texts; NULL: the caller's */
    size_t gradient_opacity_count; /* of the look; 0: none */
    snow_opacity_point gradient_opacities[SNOW_RECIPE_POINTS_MAX];
    const char *tf;    /* file of the look's base (look_file.h), or NULL */
    bool log;          /* as in snow_look */
    const char *depth; /* path of the depths, or NULL */
    int fit, frames;   /* of the tool: 1 visible, 2 volume; in a turn, or 0 */
    double fps;        /* of the tool (25) */
    const char *verb, *version;       /* of the tool that wrote it, or NULL */
    bool scale_bar;                   /* without the colour bar of `legend` */
    const char *axis, *at;            /* of the tool's slice, or NULL */
    double symlog;                    /* as in snow_look */
    const char *title, *legend_title; /* of the bar "name (unit)"; or NULL */
    const char *annotate, *box; /* "step", "time=FORMAT"; "axes"; or NULL */
    bool reread;                /* in situ: when the file changes */
    const char *overlay, *overlay_look; /* of the tool, or NULL */
    double limit_seconds; /* in situ, as in snow_insitu_limits; 0: not given */
    int64_t limit_bytes;
    const char *channels, *steps; /* of the tool: --channel, --time; or NULL */
    const char *grid;             /* of the tool's slices, as is `ortho` */
    bool ortho, sync;             /* sync: as in snow_insitu_settings */
    const char *measure, *slab;   /* of the tool; or NULL */
} snow_recipe;
SNOW_RECORD(snow_recipe);

/* Reads a recipe from a file. Its texts live until snow_recipe_clear, which
 * must follow. Errors: BAD_INPUT (no file; no JSON, with the line; a key). */
SNOW_API snow_status snow_recipe_load(
    snow_context *context, const char *path, snow_recipe *out);

/* The same from bytes, which messages call `name`. */
SNOW_API snow_status snow_recipe_parse(snow_context *context, const char *name,
    const char *text, size_t bytes, snow_recipe *out);

/* Frees the texts of a recipe, and gives it all defaults. */
SNOW_API void snow_recipe_clear(snow_recipe *recipe);

/* Writes a recipe's text, as snow_look_write_json does. */
SNOW_API snow_status snow_recipe_write(snow_context *context,
    const snow_recipe *recipe, char *text, size_t room, size_t *length);

/* Gives the look, whose arrays are the recipe's, without the base of `tf`. */
SNOW_API snow_status snow_recipe_get_look(
    snow_context *context, const snow_recipe *recipe, snow_look *out);

/* Gives the view; over `usual` where the recipe names none. Errors: BAD_USAGE
 * (no such view). */
SNOW_API snow_status snow_recipe_get_view(snow_context *context,
    const snow_recipe *recipe, const snow_view *usual, snow_view *out);

/* Gives the settings for a volume in `unit`, with their opacity_length. Errors:
 * BAD_USAGE (opacities of a millimetre, and a unit that is no length). */
SNOW_API snow_status snow_recipe_get_settings(snow_context *context,
    const snow_recipe *recipe, const char *unit, snow_settings *out);

/* Applies a recipe to pictures in situ, whose unit is a millimetre. Errors: as
 * above and of the setters; BAD_USAGE (a depth). */
SNOW_API snow_status snow_recipe_apply(
    const snow_recipe *recipe, snow_insitu *insitu);

/* The same from a text. */
SNOW_API snow_status snow_recipe_apply_text(
    snow_insitu *insitu, const char *text);

/* Collective. The same from a file, which rank 0 reads. */
SNOW_API snow_status snow_recipe_apply_file(
    snow_insitu *insitu, const char *path);

#endif
