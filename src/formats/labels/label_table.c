/* formats/labels/label_table.c - names and colours of labels, a line each:
 *
 *   1 255 0 0 1 1 1 "Left kidney"      ITK-SNAP: opacity, visible, mesh
 *   17 Left-Hippocampus 220 216 20 0   FreeSurfer, 3D Slicer: opacity unused
 */
#include "formats/opening.h"

#include "io/source.h"

#include <string.h>

#define LINE 1024

/* What ITK-SNAP says behind the number. */
static bool read_snap(const char *text, double numbers[6], snow_label *out) {
    if (snow_text_scan(text, "%lf %lf %lf %lf %lf %lf \"%63[^\"]", &numbers[0],
                       &numbers[1], &numbers[2], &numbers[3], &numbers[4],
                       &numbers[5], out->name) < 6)
        return false;
    out->color[3] = numbers[4] > 0 ? numbers[3] : 0;
    return true;
}

static bool read_line(const char *text, snow_label *out) {
    double numbers[6];
    int at = 0;
    *out = (snow_label){.color = {-1, 0, 0, -1}};
    if (snow_text_scan(text, "%lf%n", &out->value, &at) != 1)
        return false;
    text += at;
    if (!read_snap(text, numbers, out) &&
        snow_text_scan(text, " %63s %lf %lf %lf", out->name, &numbers[0],
                       &numbers[1], &numbers[2]) != 4)
        return false;
    for (int c = 0; c < 3; c++) {
        out->color[c] = numbers[c] / 255;
        if (!(out->color[c] >= 0 && out->color[c] <= 1))
            return false;
    }
    return out->color[3] <= 1;
}

static snow_status read_lines(snow_source *source, snow_label **labels,
                              size_t *count) {
    snow_context *context = snow_source_context(source);
    char line[LINE];
    bool got = true;
    for (int number = 1; got; number++) {
        SNOW_TRY(snow_source_read_line(source, line, sizeof line, &got));
        const char *text = line + strspn(line, " \t\r");
        if (!got || !*text || *text == '#')
            continue;
        SNOW_TRY(SNOW_RESERVE(context, *labels, *count, *count + 1));
        if (!read_line(text, &(*labels)[(*count)++]))
            return snow_fail(
                context, SNOW_STATUS_BAD_INPUT,
                "line %d is not a label's number, name and colour of 0 to 255; "
                "give a table of ITK-SNAP, FreeSurfer or 3D Slicer",
                number);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_label_table_read(snow_context *context, const char *path,
                                  snow_volume *volume) {
    snow_source *source;
    snow_label *labels = NULL;
    size_t count = 0;
    snow_status status = snow_source_is_stream(path)
                             ? snow_fail(context, SNOW_STATUS_BAD_INPUT,
                                         "is no file; name a table of labels")
                             : snow_source_open(context, path, &source);
    if (status == SNOW_STATUS_OK) {
        status = read_lines(source, &labels, &count);
        snow_source_close(source);
    }
    if (status != SNOW_STATUS_OK)
        snow_fail_in_file(context, status, path);
    else
        status = snow_volume_set_labels(volume, labels, count);
    snow_release(context, labels);
    return status;
}
