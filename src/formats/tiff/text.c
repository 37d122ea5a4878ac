/* formats/tiff/text.c - parses the description that ImageJ and OME write into a
 * TIFF.
 *
 *     ImageJ=1.53f              <OME ...><Image ...><Pixels SizeC="2"
 *     images=82                   SizeZ="41" SizeT="1"
 *     channels=2                  DimensionOrder="XYCZT"
 *     slices=41                   PhysicalSizeX="0.1"
 *     unit=micron                 PhysicalSizeXUnit="µm" ...>
 *     spacing=0.125
 *
 * From OME-XML the attributes of the first Pixels element are used.  They are
 * found by name: no other part of the text can contain them there. */
#include "formats/array.h"
#include "formats/tiff/tiff.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define VALUE_BYTES 64

/* Finds the value of "name=" at the front of a line. */
static bool line_value(const char *text, const char *name,
                       char out[VALUE_BYTES]) {
    size_t length = strlen(name);
    for (const char *at = text; at && *at;) {
        if (!strncmp(at, name, length) && at[length] == '=') {
            at += length + 1;
            size_t size = strcspn(at, "\r\n");
            if (size >= VALUE_BYTES)
                return false;
            memcpy(out, at, size);
            out[size] = 0;
            return true;
        }
        at = strchr(at, '\n');
        if (at)
            at++;
    }
    return false;
}

/* Finds the value of name="..." between `text` and the end of the element. */
static bool attribute(const char *text, const char *name,
                      char out[VALUE_BYTES]) {
    const char *end = strchr(text, '>');
    size_t length = strlen(name);
    for (const char *at = text; (at = strstr(at, name)) && at < end; at++) {
        const char *value = at + length;
        char quote = *value == '=' ? value[1] : 0;
        if ((at[-1] != ' ' && at[-1] != '\n') ||
            (quote != '"' && quote != '\''))
            continue;
        value += 2;
        const char *close = strchr(value, quote);
        if (!close || close - value >= VALUE_BYTES)
            return false;
        memcpy(out, value, (size_t)(close - value));
        out[close - value] = 0;
        return true;
    }
    return false;
}

static int64_t count_of(const char *value) {
    int64_t count;
    return snow_parse_int64(value, &count) && count > 0 ? count : 0;
}

static double length_of(const char *value) {
    double length;
    return snow_parse_double(value, &length) && length > 0 && isfinite(length)
               ? length
               : 0;
}

/* Unifies the many spellings of a micrometre; others stay as they are. */
static void take_unit(const char *text, char unit[16]) {
    static const char *const micro[] = {"micron",     "microns",   "micrometer",
                                        "micrometre", "\xc2\xb5m", "\xce\xbcm",
                                        "\xb5m",      "\\u00B5m",  "\\u00b5m",
                                        "&#181;m",    "um"};
    *unit = 0;
    text += strspn(text, " \t");
    if (!strcmp(text, "pixel") || !strcmp(text, "pixels"))
        return;
    for (size_t i = 0; i < sizeof micro / sizeof *micro; i++)
        if (!strcmp(text, micro[i]))
            text = "um";
    if (!strcmp(text, "\xc3\x85"))
        text = "angstrom";
    if (strlen(text) < 16)
        memcpy(unit, text, strlen(text) + 1);
}

static void read_imagej(const char *text, tiff_shape *out) {
    char value[VALUE_BYTES];
    out->imagej = true;
    memcpy(out->order, "XYCZT", sizeof out->order);
    if (line_value(text, "images", value))
        out->images = count_of(value);
    if (line_value(text, "channels", value))
        out->channels = count_of(value);
    if (line_value(text, "slices", value))
        out->slices = count_of(value);
    if (line_value(text, "frames", value))
        out->frames = count_of(value);
    /* A stack that was reversed has a spacing below 0. */
    if (line_value(text, "spacing", value))
        out->spacing[2] = length_of(value + (*value == '-'));
    if (line_value(text, "unit", value))
        take_unit(value, out->unit);
}

/* Metres in a unit of length by its OME name; 0 if unknown. */
static double metres(const char *unit) {
    static const struct {
        const char *name;
        double metres;
    } units[] = {{"m", 1},     {"cm", 1e-2},  {"mm", 1e-3},       {"um", 1e-6},
                 {"nm", 1e-9}, {"pm", 1e-12}, {"angstrom", 1e-10}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (!strcmp(unit, units[i].name))
            return units[i].metres;
    return 0;
}

/* All in the unit of x; micrometres by default. */
static void read_ome_spacing(const char *pixels, tiff_shape *out) {
    static const char *const names[3][2] = {
        {"PhysicalSizeX", "PhysicalSizeXUnit"},
        {"PhysicalSizeY", "PhysicalSizeYUnit"},
        {"PhysicalSizeZ", "PhysicalSizeZUnit"}};
    char value[VALUE_BYTES], unit[16];
    for (int i = 0; i < 3; i++) {
        if (!attribute(pixels, names[i][0], value))
            continue;
        double length = length_of(value);
        memcpy(unit, "um", 3);
        if (attribute(pixels, names[i][1], value))
            take_unit(value, unit);
        if (!*out->unit)
            memcpy(out->unit, unit, sizeof unit);
        double own = metres(unit), first = metres(out->unit);
        if (own > 0 && first > 0 && strcmp(unit, out->unit) != 0)
            length *= own / first;
        out->spacing[i] = length;
    }
}

/* A colour is red, green, blue and alpha, the bytes of a number with a sign. */
static void read_ome_channel(const char *text, snow_channel *out) {
    char value[VALUE_BYTES];
    int64_t rgba;
    if (attribute(text, "Name", value))
        snow_copy_name(value, out->name, sizeof out->name);
    if (!attribute(text, "Color", value) || !snow_parse_int64(value, &rgba))
        return;
    for (int c = 0; c < 3; c++)
        out->color[c] = (double)((uint32_t)rgba >> (24 - 8 * c) & 255) / 255;
}

/* Elements "Channel" of the same Pixels, in its order. */
static void read_ome_channels(const char *pixels, tiff_shape *out) {
    const char *end = strstr(pixels, "Pixels>");
    const char *at = pixels;
    for (int n = 0; n < SNOW_CHANNELS_MAX; at++) {
        at = strstr(at, "Channel ");
        if (!at || (end && at > end))
            return;
        if ((at[-1] == '<' || at[-1] == ':') && strchr(at, '>'))
            read_ome_channel(at + 7, &out->channel[n++]);
    }
}

static void read_ome(const char *pixels, tiff_shape *out) {
    char value[VALUE_BYTES];
    if (attribute(pixels, "SizeC", value))
        out->channels = count_of(value);
    if (attribute(pixels, "SizeZ", value))
        out->slices = count_of(value);
    if (attribute(pixels, "SizeT", value))
        out->frames = count_of(value);
    /* An order has five letters, X and Y first. */
    if (attribute(pixels, "DimensionOrder", value) && strlen(value) == 5 &&
        !strncmp(value, "XY", 2) && strchr(value, 'C') && strchr(value, 'Z') &&
        strchr(value, 'T'))
        memcpy(out->order, value, sizeof out->order);
    else
        memcpy(out->order, "XYCZT", sizeof out->order);
    read_ome_spacing(pixels, out);
    read_ome_channels(pixels, out);
}

void snow_tiff_read_text(const char *text, tiff_shape *out) {
    *out = (tiff_shape){0};
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++)
        out->channel[n].color[0] = -1;
    if (!text)
        return;
    const char *ome = strstr(text, "<OME");
    if (!ome)
        ome = strstr(text, ":OME ");
    const char *pixels = ome ? strstr(ome, "Pixels ") : NULL;
    if (pixels && strchr(pixels, '>'))
        read_ome(pixels, out);
    else if (!strncmp(text, "ImageJ=", 7))
        read_imagej(text, out);
}
