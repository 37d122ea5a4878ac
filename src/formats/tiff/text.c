/* formats/tiff/text.c - parses the description that ImageJ writes into a TIFF.
 *
 *     ImageJ=1.53f
 *     images=82
 *     channels=2
 *     slices=41
 *     unit=micron
 *     spacing=0.125 */
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

/* Values of a straight line (cf=0), as ij.measure.Calibration has them. */
static void take_calibration(const char *text, tiff_shape *out) {
    char value[VALUE_BYTES];
    double line[2];
    if (!line_value(text, "cf", value) || !strcmp(value, "20"))
        return;
    out->bent = strcmp(value, "0") != 0 || !line_value(text, "c0", value) ||
                !snow_parse_double(value, &line[0]) ||
                !line_value(text, "c1", value) ||
                !snow_parse_double(value, &line[1]) || !isfinite(line[0]) ||
                !isfinite(line[1]) || line[1] == 0;
    if (out->bent)
        return;
    memcpy(out->scale, line, sizeof line);
    if (line_value(text, "vunit", value) && strcmp(value, "Gray Value") != 0)
        snow_copy_name(value, out->value_unit, sizeof out->value_unit);
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
    /* y and z have a unit only where it is not that of x. */
    static const char *const units[] = {"unit", "yunit", "zunit"};
    for (int i = 0; i < 3; i++) {
        if (!line_value(text, units[i], value))
            snprintf(value, sizeof value, "%s", out->units[0]);
        if (strcmp(value, "pixel") != 0 && strcmp(value, "pixels") != 0)
            snprintf(out->units[i], sizeof out->units[i], "%.15s", value);
    }
    take_calibration(text, out);
}

void snow_tiff_read_text(const char *text, tiff_shape *out) {
    *out = (tiff_shape){.scale = {0, 1}, .nodata = NAN};
    for (int n = 0; n < SNOW_CHANNELS_MAX; n++)
        out->channel[n].color[0] = -1;
    if (!text)
        return;
    if (!strncmp(text, "ImageJ=", 7))
        read_imagej(text, out);
}
