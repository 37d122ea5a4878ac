/* word.c - the page of one option or of one preset. */
#include "help/help.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

/* --- options -------------------------------------------------------------- */

const option_row *help_option_named(const char *word) {
    size_t dashes = strspn(word, "-");
    const char *name = word + dashes;
    bool letter = strlen(name) == 1 && dashes < 2;
    for (const option_row *row = option_table; *name && row->name; row++)
        if (strcasecmp(name, row->name) == 0 ||
            (letter && row->letter == *name))
            return row;
    return NULL;
}

void help_views(void) {
    help_names("views", snow_view_name, NULL);
    help_wrapped("axial, coronal and sagittal show a patient as radiologists "
                 "look at slices, from the feet, the front and the left, and "
                 "other volumes from +z, -y and +x; front is the anterior side "
                 "of a patient, else -y; top is +z",
                 0, 0);
}

/* The names that an option takes. */
static void print_values(const option_row *row) {
    if (row->field == offsetof(options, preset))
        help_names("presets", snow_preset_name, snow_preset_description);
    else if (row->field == offsetof(options, colormap))
        help_names("colour maps", snow_colormap_name, NULL);
    else if (row->field == offsetof(options, view))
        help_views();
}

void help_option_page(const option_row *row) {
    char line[256] = "verbs:";
    size_t used = strlen(line);
    help_option(row, row->text);
    for (const verb_row *verb = verb_table; verb->name; verb++)
        if ((verb->bit & row->verbs) && used < sizeof line)
            used += (size_t)snprintf(line + used, sizeof line - used, " %s",
                                     verb->name);
    printf("\n");
    help_wrapped(line, 0, 7);
    if (topic_is_here(row->topic))
        printf("topic: %s (snowglass help %s)\n", topic_table[row->topic].name,
               topic_table[row->topic].name);
    else
        printf("only in snowglass-mpi\n");
    print_values(row);
}

/* --- presets -------------------------------------------------------------- */

#define LINE_BYTES 1024

/* What the values of control points are. */
static const char *text_of_domain(snow_domain domain) {
    switch (domain) {
    case SNOW_DOMAIN_DATA:
        return "in Hounsfield units; --window or --range spreads them over "
               "other "
               "values";
    case SNOW_DOMAIN_RANGE:
        return "as shares of the range from the smallest value to the largest, "
               "or "
               "of --window or --range";
    default:
        return "as shares of the range from the end of the background to the "
               "brightest value, both by the histogram, or of --window or "
               "--range";
    }
}

static void print_points(const char *title, const snow_opacity_point *points,
                         size_t count) {
    char line[LINE_BYTES];
    size_t used = (size_t)snprintf(line, sizeof line, "%s", title);
    for (size_t i = 0; i < count && used < sizeof line; i++)
        used +=
            (size_t)snprintf(line + used, sizeof line - used, "%s %g at %g",
                             i ? "," : "", points[i].opacity, points[i].value);
    help_wrapped(line, 0, 10);
}

static int level_of(double value) {
    return (int)(value * 255 + 0.5);
}

static void print_colors(const snow_color_point *points, size_t count) {
    char line[LINE_BYTES];
    size_t used = (size_t)snprintf(line, sizeof line, "colours: ");
    for (size_t i = 0; i < count && used < sizeof line; i++)
        used += (size_t)snprintf(
            line + used, sizeof line - used, "%s #%02x%02x%02x at %g",
            i ? "," : "", (unsigned)level_of(points[i].red),
            (unsigned)level_of(points[i].green),
            (unsigned)level_of(points[i].blue), points[i].value);
    help_wrapped(line, 0, 10);
}

/* From the first to the last point of either kind. */
static void print_range(const snow_look *look) {
    const snow_opacity_point *o = look->opacities;
    const snow_color_point *c = look->colors;
    double low = o[0].value, high = o[look->opacity_count - 1].value;
    low = c[0].value < low ? c[0].value : low;
    if (c[look->color_count - 1].value > high)
        high = c[look->color_count - 1].value;
    char line[LINE_BYTES];
    snprintf(line, sizeof line, "range:    %g to %g, %s", low, high,
             text_of_domain(look->domain));
    help_wrapped(line, 0, 10);
}

void help_preset_page(size_t index) {
    const snow_look *look = snow_preset_look(index);
    const char *name = snow_preset_name(index);
    printf("--preset %s: ", name);
    help_wrapped(snow_preset_description(index), 11 + (int)strlen(name), 2);
    printf("\n");
    if (!look->color_count) { /* made of a volume */
        help_wrapped(
            "colours:  those of the file or of --label-table, else one "
            "of a fixed palette for each number",
            0, 10);
        help_wrapped(
            "opacity:  1 of every label but 0; --opacity 1:0.3,2:1 sets "
            "others, each at its number",
            0, 10);
        printf("\nuse it:   snowglass INPUT -o OUT.png --preset %s\n", name);
        return;
    }
    print_range(look);
    print_points(look->per_mm ? "opacity of a millimetre:"
                              : "opacity of a voxel:",
                 look->opacities, look->opacity_count);
    if (look->gradient_opacity_count)
        print_points("factors by gradient magnitude, in values per mm:",
                     look->gradient_opacities, look->gradient_opacity_count);
    print_colors(look->colors, look->color_count);
    printf("\nuse it:   snowglass INPUT -o OUT.png --preset %s\n"
           "draw it:  snowglass tf show %s -o FILE.png\n",
           name, name);
}
