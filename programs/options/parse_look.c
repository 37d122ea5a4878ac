/* parse_look.c - the readers of options of the look: colours, ranges,
 * opacities, light; and of what is measured. */
#include "options/parse.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

bool read_strength(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    return read_real(row, *text ? text : "1", field, wrong);
}

/* Three strengths, and an exponent up to 1000. */
bool read_material(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    double parts[4];
    bool good =
        value_reals(text, ',', 4, parts) && parts[3] >= 0 && parts[3] <= 1000;
    for (int i = 0; i < 3 && good; i++)
        good = parse_within(row, parts[i]);
    if (!good)
        return parse_refuse(wrong, "is not a material; give AMBIENT,DIFFUSE,"
                                   "SPECULAR from 0 to 1 and an exponent up to "
                                   "1000, such as 0.2,0.7,0.2,20");
    memcpy(field, parts, sizeof parts);
    return true;
}

bool read_scale(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    static const char from[] = "symlog:";
    scale_value scale = {.log = strcmp(text, "log") == 0};
    if (strcmp(text, "symlog") == 0)
        scale.symlog = -1;
    else if (strncmp(text, from, strlen(from)) == 0) {
        if (!read_real(row, text + strlen(from), &scale.symlog, wrong))
            return false;
    } else if (!scale.log && strcmp(text, "linear") != 0) {
        char near[128];
        parse_near(row->argument, text, near, sizeof near);
        snprintf(wrong, WRONG_BYTES,
                 "is unknown%s; choose from: linear, log, symlog, symlog:X",
                 near);
        return false;
    }
    *(scale_value *)field = scale;
    return true;
}

bool read_window(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    double pair[2];
    if (!value_reals(text, ',', 2, pair))
        return parse_refuse(wrong, "is not a window; give its width and its "
                                   "centre, such as 400,40");
    if (!parse_within(row, pair[0]))
        return parse_refuse_number(row, "a width", wrong);
    memcpy(field, pair, sizeof pair);
    return true;
}

/* The library would refuse wrong names too, but only after reading the
 * volume. */
bool read_preset(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    if (snow_preset_from_name(text) < 0)
        return parse_refuse_name(row, text, snow_preset_name, wrong);
    return read_text(row, text, field, wrong);
}

bool read_colormap(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    const bool known = snow_colormap_from_name(text) >= 0;
    if (!known && strchr(text, ':')) {
        snprintf(wrong, WRONG_BYTES,
                 "is no list of colours: must be at most %d VALUE:#RRGGBB, "
                 "values rising; correct it",
                 SNOW_COLORMAP_POINTS_MAX);
        return false;
    }
    return known ? read_text(row, text, field, wrong)
                 : parse_refuse_name(row, text, snow_colormap_name, wrong);
}

bool read_color(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    if (value_color(text, field))
        return true;
    char names[128], near[128];
    value_color_names(names, sizeof names);
    parse_near(names, text, near, sizeof near);
    snprintf(wrong, WRONG_BYTES,
             "is not a colour%s; give auto, none, #rgb, #rrggbb, "
             "red,green,blue from 0 to 1, or a name: %s",
             near, names);
    return false;
}

bool read_range(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_range(text, field))
        return parse_refuse(wrong,
                            "is not a range; give LOW,HIGH in data values, "
                            "pLOW,pHIGH in percent such as p1,p99, or full");
    return true;
}

bool read_points(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_points(text, field))
        return parse_refuse(
            wrong,
            "are not control points; give VALUE:OPACITY pairs, values rising, "
            "opacities 0 to 1, at most 256, such as 80:0,200:0.5");
    return true;
}

bool read_overlay_look(const option_row *row, const char *text, void *field,
                       char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_overlay_look(text, field))
        return parse_refuse(
            wrong,
            "is not a look; give COLOURS,RANGE,OPACITY, each or none of "
            "them: a preset or colour map, two values or percentiles or "
            "full, and a factor from 0 to 1 or VALUE:OPACITY pairs, such "
            "as hot,2,12,0.6");
    return true;
}

bool read_gradient_points(const option_row *row, const char *text, void *field,
                          char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_points(text, field))
        return parse_refuse(
            wrong,
            "are not control points; give MAGNITUDE:FACTOR pairs, magnitudes "
            "rising, factors 0 to 1, at most 256, such as 0:0,20:1");
    return true;
}

/* Any angle is valid: full turns do not matter. */
bool read_light(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    double pair[2] = {0};
    light_value light = {.light = SNOW_LIGHT_DIRECTION};
    if (strcasecmp(text, "key") == 0)
        light.light = SNOW_LIGHT_KEY;
    else if (strcasecmp(text, "head") == 0)
        light.light = SNOW_LIGHT_HEAD;
    else if (!value_reals(text, ',', 2, pair)) {
        char near[128];
        parse_near("key|head", text, near, sizeof near);
        snprintf(wrong, WRONG_BYTES,
                 "is not a light%s; give key, head, or AZIMUTH,ELEVATION in "
                 "degrees, such as 30,45",
                 near);
        return false;
    }
    light.azimuth = pair[0];
    light.elevation = pair[1];
    *(light_value *)field = light;
    return true;
}

/* What does not depend on a volume is checked at once. */
bool read_measure(const option_row *row, const char *text, void *field,
                  char wrong[WRONG_BYTES]) {
    snow_context *context = NULL;
    snow_measure one = {.size = sizeof one};
    snow_status status = snow_context_new(NULL, &context);
    for (int n = 0; status == SNOW_STATUS_OK && (!n || one.kind); n++)
        status = snow_measure_read(context, text, n, NULL, &one);
    if (status == SNOW_STATUS_BAD_USAGE)
        snprintf(wrong, WRONG_BYTES, "is wrong: %s",
                 snow_context_message(context));
    snow_context_free(context);
    if (status == SNOW_STATUS_BAD_USAGE)
        return false;
    return read_text(row, text, field, wrong);
}
