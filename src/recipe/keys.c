/* recipe/keys.c - the keys of a recipe: the kind of each and its place. */
#include "recipe/kinds.h"

#include <stddef.h>
#include <string.h>

/* --- names ---------------------------------------------------------------- */

/* Adapters between the library's tables, of enumerations and of plain indices,
 * and the rows. */
#define NAMES(word, type)                       \
    static const char *word##_name(int value) { \
        return snow_##word##_name((type)value); \
    }
NAMES(method, snow_method)
NAMES(encoding, snow_encoding)
NAMES(kernel, snow_kernel)
NAMES(quality, snow_quality)
NAMES(isa, snow_isa)
NAMES(mode, snow_mode)
NAMES(preset, size_t)
NAMES(colormap, size_t)
NAMES(view, size_t)

/* The first type is "none". */
static const char *type_name(int value) {
    return value > SNOW_TYPE_FLOAT64 ? NULL : snow_type_name((snow_type)value);
}

static int type_named(const char *name) {
    snow_type type = snow_type_from_name(name);
    return type == SNOW_TYPE_NONE ? -1 : (int)type;
}

/* Names that only recipes have. */
#define LIST(word, ...)                                           \
    static const char *word##_name(int value) {                   \
        static const char *const names[] = {__VA_ARGS__};         \
        const int count = sizeof names / sizeof *names;           \
        return value >= 0 && value < count ? names[value] : NULL; \
    }
LIST(shade, "phong", "none")
LIST(endian, "", "little", "big")
LIST(vertical, "levels", "height")
LIST(suv, "bw", "lbm", "bsa", "none")
LIST(fit, "", "visible", "volume")
LIST(box, "outline", "axes")

/* --- the table ------------------------------------------------------------ */

#define AT(name) offsetof(snow_recipe, name)
#define REAL(name, field, low, high) \
    { name, &recipe_real, AT(field), low, high, 0, NULL, NULL }
#define TEXT(name, field) \
    { name, &recipe_text, AT(field), 0, 0, 0, NULL, NULL }
#define NAME(name, field, names, named) \
    { name, &recipe_name, AT(field), 0, 0, 0, names, named }
#define GIVEN(name, field, names, named) \
    { name, &recipe_given_name, AT(field), 0, 0, 0, names, named }
#define KNOWN(name, field, names, named) \
    { name, &recipe_known, AT(field), 0, 0, 0, names, named }
#define MADE(name, word, field, low, high, count) \
    { name, &recipe_##word, AT(field), low, high, count, NULL, NULL }

/* clang-format off */
const recipe_key recipe_keys[] = {
    MADE("input", input, input, 0, 0, 0),
    TEXT("output", output),
    TEXT("depth", depth),
    MADE("overwrite", flag, image.overwrite, 0, 0, 0),
    MADE("size", size, width, 1, 32768, 2),
    MADE("background", color, image, 0, 1, 3),
    MADE("bits", bits, image.bits, 8, 16, 0),
    NAME("mode", settings.mode, mode_name, snow_mode_from_name),
    MADE("iso", iso, settings.mode, 0, 0, 0),
    REAL("threshold", settings.threshold, 0, 255),
    NAME("encoding", settings.encoding, encoding_name, snow_encoding_from_name),
    NAME("method", settings.method, method_name, snow_method_from_name),
    {"kernel", &recipe_kernel, AT(settings), 2, 9, 0, kernel_name, snow_kernel_from_name},
    KNOWN("preset", preset, preset_name, snow_preset_from_name),
    KNOWN("colormap", colormap, colormap_name, snow_colormap_from_name),
    TEXT("tf", tf),
    MADE("scale", scale, symlog, 1e-300, 1e300, 0),
    MADE("opacity", points, opacity_count, 0, 0, 0),
    MADE("gradient-opacity", points, gradient_opacity_count, 0, 0, 0),
    MADE("range", range, range, 0, 0, 0),
    MADE("opacity-unit", unit, opacity_per_mm, 0, 0, 0),
    NAME("shade", settings.shade, shade_name, NULL),
    MADE("light", light, settings, 0, 0, 2),
    MADE("material", material, settings, 0, 1000, 4),
    REAL("depth-darkening", settings.depth_darkening, 0, 1),
    REAL("occlusion", settings.occlusion, 0, 1),
    NAME("quality", settings.quality, quality_name, snow_quality_from_name),
    KNOWN("view", view, view_name, NULL),
    REAL("azimuth", azimuth, 0, 0),
    REAL("elevation", elevation, 0, 0),
    REAL("roll", roll, 0, 0),
    REAL("zoom", zoom, 1e-6, 1e6),
    REAL("perspective", fov, 0, SNOW_FOV_MAX),
    GIVEN("fit", fit, fit_name, NULL),
    MADE("position", point, position, 0, 0, 3),
    MADE("target", point, target, 0, 0, 3),
    MADE("up", point, up, 0, 0, 3),
    MADE("no-labels", flag, no_labels, 0, 0, 0),
    MADE("legend", legend, legend_title, 0, 0, 0),
    TEXT("title", title),
    MADE("annotate", annotate, annotate, 0, 0, 0),
    KNOWN("box", box, box_name, NULL),
    MADE("measure", measure, measure, 0, 0, 0),
    MADE("threads", int, settings.threads, 1, 4096, 0),
    MADE("deterministic", flag, settings.deterministic, 0, 0, 0),
    NAME("isa", settings.isa, isa_name, snow_isa_from_name),
    MADE("dims", longs, data.dims, 1, 9e15, 3),
    GIVEN("type", data.type, type_name, type_named),
    MADE("spacing", given_reals, data.spacing, 1e-300, 1e300, 3),
    GIVEN("endian", data.endian, endian_name, NULL),
    MADE("offset", long, data.offset, 0, 9e15, 0),
    MADE("crop", crop, data.crop, 0, 9e15, 2),
    MADE("channel", channel, channels, 0, 9e15, 0),
    TEXT("component", data.component),
    TEXT("dataset", data.dataset),
    TEXT("series", data.series),
    MADE("allow-gaps", flag, data.allow_gaps, 0, 0, 0),
    KNOWN("suv", data.suv, suv_name, NULL),
    KNOWN("vertical", data.vertical, vertical_name, NULL),
    MADE("levels", long, data.levels, 1, 24, 0),
    MADE("z-scale", given_real, data.z_scale, 1e-9, 1e9, 0),
    TEXT("mask", data.mask),
    MADE("labels", labels, data.labels, 0, 0, 0),
    TEXT("label-table", data.label_table),
    TEXT("overlay", overlay),
    TEXT("overlay-look", overlay_look),
    MADE("clip", clip, data.clip, 0, 0, 4),
    MADE("time", time, steps, -9e15, 9e15, 0),
    MADE("frames", int, frames, 1, 1000000, 0),
    REAL("fps", fps, 0.01, 1000),
    TEXT("axis", axis),
    TEXT("at", at),
    TEXT("grid", grid),
    TEXT("slab", slab),
    MADE("ortho", flag, ortho, 0, 0, 0),
    TEXT("verb", verb),
    TEXT("version", version),
    MADE("reread", flag, reread, 0, 0, 0),
    MADE("sync", flag, sync, 0, 0, 0),
    MADE("limit-seconds", given_real, limit_seconds, 0, 1e9, 0),
    MADE("limit-bytes", long, limit_bytes, 0, 9e15, 0),
    {NULL, NULL, 0, 0, 0, 0, NULL, NULL},
};
/* clang-format on */

/* --- old spellings, which the release drops ------------------------------- */

#define MATERIAL "\"material\": [ambient, diffuse, specular, shininess]"

#define OVERLAY "\"overlay-look\": \"COLOURS[,RANGE[,OPACITY]]\""

const char *recipe_renamed(const char *name) {
    static const char *const rows[][2] = {
        {"axes", "\"box\": \"axes\""},
        {"ambient", MATERIAL},
        {"diffuse", MATERIAL},
        {"footprint", "\"kernel\": \"NAME:N\""},
        {"legend-title", "\"legend\": \"TITLE\""},
        {"level", "\"window\": [width, centre]"},
        {"log", "\"scale\": \"log\""},
        {"outline", "\"box\": \"outline\""},
        {"overlay-colormap", OVERLAY},
        {"overlay-opacity", OVERLAY},
        {"overlay-preset", OVERLAY},
        {"overlay-range", OVERLAY},
        {"scale-bar", "\"legend\": \"scale\""},
        {"shininess", MATERIAL},
        {"specular", MATERIAL},
        {"symlog", "\"scale\": \"symlog\" or \"symlog:X\""},
        {"time-format", "\"annotate\": \"time=FORMAT\""},
        {"time-label", "\"annotate\": \"step\""},
        {"unit", "\"legend\": \"TITLE (UNIT)\""},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(rows[i][0], name) == 0)
            return rows[i][1];
    return NULL;
}
