/* render/settings.c - the settings of a picture: their names and defaults.
 * settings_resolve.c finds what they mean for one volume. */
#include "base/base.h"
#include "transfer/look.h"
#include "volume/volume.h"

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

/* The name of a value, or NULL. */
static const char *name_at(const char *const *names, int count, int value) {
    return value >= 0 && value < count ? names[value] : NULL;
}

/* The index of a name, or -1. */
static int find_name(const char *const *names, int count, const char *name) {
    for (int i = 0; i < count; i++)
        if (snow_same_name(name, names[i]))
            return i;
    return -1;
}

const char *snow_method_name(snow_method method) {
    return name_at(methods, COUNT(methods), (int)method);
}

const char *snow_encoding_name(snow_encoding encoding) {
    return name_at(encodings, COUNT(encodings), (int)encoding);
}

int snow_method_from_name(const char *name) {
    return find_name(methods, COUNT(methods), name);
}

int snow_encoding_from_name(const char *name) {
    return find_name(encodings, COUNT(encodings), name);
}

const char *snow_quality_name(snow_quality quality) {
    return name_at(qualities, COUNT(qualities), (int)quality);
}

int snow_quality_from_name(const char *name) {
    return find_name(qualities, COUNT(qualities), name);
}

const char *snow_mode_name(snow_mode mode) {
    return name_at(modes, COUNT(modes), (int)mode);
}

int snow_mode_from_name(const char *name) {
    return find_name(modes, COUNT(modes), name);
}

/* A few slices of a scan, whose surface is a cut: nothing but its projection
 * shows what is in it. */
static bool is_slab_of_scan(const snow_volume_info *info) {
    const int thin = snow_volume_thin_axis(info);
    return snow_volume_is_scan(info) && thin >= 0 && info->dims[thin] > 1;
}

snow_mode snow_mode_for(const snow_volume_info *given) {
    snow_volume_info info;
    const bool known = SNOW_RECORD_READ(NULL, snow_volume_info, given, &info) ==
                       SNOW_STATUS_OK;
    return known && (info.light || snow_is_pet(&info) || is_slab_of_scan(&info))
               ? SNOW_MODE_MIP
               : SNOW_MODE_OVER;
}

const char *snow_colormap_for(const snow_volume_info *given) {
    snow_volume_info info;
    const bool known = SNOW_RECORD_READ(NULL, snow_volume_info, given, &info) ==
                       SNOW_STATUS_OK;
    return known && snow_is_pet(&info) ? "grey_r" : NULL;
}

#define DARK (20 / 255.0)

/* A projection has its lowest value where it meets next to nothing.  The dark
 * sides of a shaded object still stand out from a background that is a little
 * lighter than black.  Both are grey where the picture is, so that it stays a
 * grey file.  What lay on a white ground is dark. */
void snow_mode_background(snow_mode mode, const snow_transfer *transfer,
                          double rgb[3]) {
    const bool shaded = mode == SNOW_MODE_OVER || mode == SNOW_MODE_ISO;
    double ends[2], low[4] = {0};
    if (transfer && !shaded) {
        snow_transfer_domain(transfer, &ends[0], &ends[1]);
        snow_transfer_evaluate(transfer, ends[0], low);
    }
    for (int i = 0; i < 3; i++)
        rgb[i] = !shaded ? low[i] : transfer && transfer->white > 0 ? 1 : DARK;
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
