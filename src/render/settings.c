/* render/settings.c - the settings of a picture: their names and defaults.
 * settings_resolve.c finds what they mean for one volume. */
#include "base/base.h"

static const char *const methods[] = {
    [SNOW_METHOD_AUTO] = "auto",
    [SNOW_METHOD_ORIGINAL] = "original",
    [SNOW_METHOD_FOOTPRINT] = "footprint",
    [SNOW_METHOD_SHEAR_WARP] = "shear-warp",
    [SNOW_METHOD_RAYCAST] = "raycast",
};

static const char *const encodings[] = {
    [SNOW_ENCODING_AUTO] = "auto",
    [SNOW_ENCODING_CRS] = "crs",
    [SNOW_ENCODING_BITMAP] = "bitmap",
    [SNOW_ENCODING_RLE] = "rle",
};

static const char *const qualities[] = {
    [SNOW_QUALITY_NORMAL] = "normal",
    [SNOW_QUALITY_DRAFT] = "draft",
    [SNOW_QUALITY_HIGH] = "high",
};

static const char *const modes[] = {
    [SNOW_MODE_OVER] = "over",   [SNOW_MODE_MIP] = "mip",
    [SNOW_MODE_MINIP] = "minip", [SNOW_MODE_MEAN] = "mean",
    [SNOW_MODE_SUM] = "sum",     [SNOW_MODE_ISO] = "iso",
};

#define COUNT(table) (int)(sizeof(table) / sizeof(table)[0])

/* The index of a name, or -1. */
static int find_name(const char *const *names, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (snow_same_name(name, names[i]))
            return i;
    return -1;
}

const char *snow_method_name(snow_method method) {
    return (int)method < COUNT(methods) ? methods[method] : NULL;
}

const char *snow_encoding_name(snow_encoding encoding) {
    return (int)encoding < COUNT(encodings) ? encodings[encoding] : NULL;
}

int snow_method_from_name(const char *name) {
    return find_name(methods, COUNT(methods), name);
}

int snow_encoding_from_name(const char *name) {
    return find_name(encodings, COUNT(encodings), name);
}

const char *snow_quality_name(snow_quality quality) {
    return (int)quality < COUNT(qualities) ? qualities[quality] : NULL;
}

int snow_quality_from_name(const char *name) {
    return find_name(qualities, COUNT(qualities), name);
}

const char *snow_mode_name(snow_mode mode) {
    return (int)mode < COUNT(modes) ? modes[mode] : NULL;
}

int snow_mode_from_name(const char *name) {
    return find_name(modes, COUNT(modes), name);
}

static const snow_settings defaults = {
    .ambient = 0.2,
    .diffuse = 0.7,
    .specular = 0.2,
    .shininess = 20,
};

void snow_settings_init_sized(snow_settings *settings, size_t size) {
    snow_record_init(settings, size, &defaults, sizeof defaults);
}
