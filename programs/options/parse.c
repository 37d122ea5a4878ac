/* parse.c - parses an option's argument into its field, or writes the end of an
 * error message that says what is valid.
 *
 * All errors of a single argument are found here, before anything is opened.
 * Checks that need the volume or another option come later. */
#include "options/parse.h"
#include "options/guess.h"

#include <snowglass/snowglass.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The limit of snow_image_new, checked here before any volume is read. */
#define IMAGE_SIDE_MAX 32768

/* Ends every reader that cannot accept the text. */
bool parse_refuse(char wrong[WRONG_BYTES], const char *text) {
    snprintf(wrong, WRONG_BYTES, "%s", text);
    return false;
}

/* An empty word usually comes from a shell variable that was never set. */
bool read_text(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    if (!*text)
        return parse_refuse(wrong, "is empty; give a value");
    *(const char **)field = text;
    return true;
}

/* Flags have no text; getopt has refused --flag=text already. */
bool read_flag(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    (void)text;
    (void)wrong;
    *(bool *)field = true;
    return true;
}

/* For pairs such as -v and -q, which write one field. */
bool read_constant(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    (void)text;
    (void)wrong;
    *(int *)field = (int)row->low;
    return true;
}

/* Writes "a|b|c" as "a, b, c". */
static void spell_choices(const char *choices, char *out, size_t size) {
    size_t used = 0;
    for (; *choices && used + 3 < size; choices++) {
        out[used++] = *choices == '|' ? ',' : *choices;
        if (*choices == '|')
            out[used++] = ' ';
    }
    out[used] = '\0';
}

/* Writes " (did you mean a?)" for a word that is near a choice, else "". */
void parse_near(const char *choices, const char *text, char *out, size_t size) {
    char words[128], near[96];
    guess nearest;
    guess_begin(&nearest, text);
    snprintf(words, sizeof words, "%s", choices);
    for (char *rest = words, *word; (word = strtok_r(rest, "| ", &rest));)
        guess_offer(&nearest, word);
    out[0] = '\0';
    if (guess_write(&nearest, "", near, sizeof near))
        snprintf(out, size, " (did you mean %s?)", near);
}

bool read_choice(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    if (value_is_choice(row->argument, text)) {
        *(const char **)field = text;
        return true;
    }
    char choices[128], near[128];
    spell_choices(row->argument, choices, sizeof choices);
    parse_near(row->argument, text, near, sizeof near);
    snprintf(wrong, WRONG_BYTES, "is unknown%s; choose from: %s", near,
             choices);
    return false;
}

/* A row with both limits 0 has none; written so that NaN is never within. */
bool parse_within(const option_row *row, double value) {
    bool any = row->low == 0 && row->high == 0;
    return any || (value >= row->low && value <= row->high);
}

/* Names the limits, so that the second attempt succeeds. */
bool parse_refuse_number(const option_row *row, const char *kind,
                         char wrong[WRONG_BYTES]) {
    if (row->low == 0 && row->high == 0)
        snprintf(wrong, WRONG_BYTES, "is not a finite number; give %s", kind);
    else
        snprintf(wrong, WRONG_BYTES,
                 "is out of range; give %s from %.10g to "
                 "%.10g",
                 kind, row->low, row->high);
    return false;
}

bool read_real(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    double value;
    if (!value_real(text, &value) || !parse_within(row, value))
        return parse_refuse_number(row, "a decimal number", wrong);
    *(double *)field = value;
    return true;
}

bool read_fov(const option_row *row, const char *text, void *field,
              char wrong[WRONG_BYTES]) {
    if (*text)
        return read_real(row, text, field, wrong);
    *(double *)field = SNOW_FOV_DEFAULT;
    return true;
}

/* Differences are of values from 0 to 1, but people often think in steps of
 * 1/255. */
bool read_tolerance(const option_row *row, const char *text, void *field,
                    char wrong[WRONG_BYTES]) {
    double value;
    if (!value_quotient(text, &value) || !parse_within(row, value))
        return parse_refuse(wrong,
                            "is not a difference; give a number from 0 to 1 "
                            "such as 0.004 or 1/255");
    *(double *)field = value;
    return true;
}

/* The limits are doubles below 2^53, where whole numbers are exact. */
bool read_integer(const option_row *row, const char *text, void *field,
                  char wrong[WRONG_BYTES]) {
    int64_t value;
    if (!value_integer(text, &value) || !parse_within(row, (double)value))
        return parse_refuse_number(row, "a whole number", wrong);
    *(int64_t *)field = value;
    return true;
}

bool read_count(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_count(text, (uint64_t *)field))
        return parse_refuse(
            wrong, "is not a whole number of 0 or more; use digits only");
    return true;
}

bool read_size(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    (void)row;
    int64_t size[2];
    bool square = value_integer(text, &size[0]);
    if (square)
        size[1] = size[0];
    if ((!square && !value_integers(text, 'x', 2, size)) || size[0] < 1 ||
        size[1] < 1 || size[0] > IMAGE_SIDE_MAX || size[1] > IMAGE_SIDE_MAX)
        return parse_refuse(wrong,
                            "is not a picture size; give WIDTHxHEIGHT of 1 to "
                            "32768 pixels each, such as 640x480, or one number "
                            "for both");
    memcpy(field, size, sizeof size);
    return true;
}

/* 1G is 1024 M, as memory is sold. */
bool read_bytes(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    uint64_t bytes;
    if (!value_bytes(text, &bytes) || !bytes)
        return parse_refuse(wrong,
                            "is not an amount of memory; give bytes, or a "
                            "number with K, M, G or T, such as 800M");
    *(uint64_t *)field = bytes;
    return true;
}

/* Ends an error message with the nearest of the library's names, or with all of
 * them. */
bool parse_refuse_name(const option_row *row, const char *text,
                       const char *(*name)(size_t), char wrong[WRONG_BYTES]) {
    char near[128];
    guess nearest;
    guess_begin(&nearest, text);
    guess_offer_all(&nearest, name);
    if (guess_write(&nearest, "", near, sizeof near)) {
        snprintf(wrong, WRONG_BYTES,
                 "is unknown; did you mean %s? snowglass help %s lists all",
                 near, row->name);
        return false;
    }
    size_t used = (size_t)snprintf(wrong, WRONG_BYTES,
                                   "is unknown; choose from: %s", name(0));
    for (size_t i = 1; name(i) && used < WRONG_BYTES; i++)
        used +=
            (size_t)snprintf(wrong + used, WRONG_BYTES - used, ", %s", name(i));
    return false;
}

/* The library knows all spellings of a view, but needs a context for its
 * message. If there is no memory for one, the name is accepted: the command
 * will fail for the same reason. */
bool read_view(const option_row *row, const char *text, void *field,
               char wrong[WRONG_BYTES]) {
    snow_context *context = NULL;
    snow_view view = {.size = sizeof view};
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_view_from_name(context, text, &view);
    snow_context_free(context);
    if (status == SNOW_STATUS_BAD_USAGE)
        return parse_refuse_name(row, text, snow_view_name, wrong);
    return read_text(row, text, field, wrong);
}

bool read_place(const option_row *row, const char *text, void *field,
                char wrong[WRONG_BYTES]) {
    (void)row;
    place_value place = {.given = true};
    if (!value_reals(text, ',', 3, place.at))
        return parse_refuse(wrong,
                            "is not a position; give X,Y,Z in the volume's "
                            "world, such as 0,250,-12.5");
    *(place_value *)field = place;
    return true;
}

/* The word scale is no title. */
bool read_legend(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    legend_value legend = {.bar = strcmp(text, "scale") != 0, .scale = true};
    const size_t length = strlen(text);
    const char *open = strrchr(text, '(');
    (void)row;
    if (length >= sizeof legend.name)
        return parse_refuse(wrong, "is too long; give up to 100 bytes");
    if (legend.bar && *text)
        legend.title = text;
    if (!open || text[length - 1] != ')')
        open = text + length;
    else
        snprintf(legend.unit, sizeof legend.unit, "%.*s",
                 (int)(text + length - open - 2), open + 1);
    while (open > text && open[-1] == ' ')
        open--;
    if (legend.title)
        memcpy(legend.name, text, (size_t)(open - text));
    *(legend_value *)field = legend;
    return true;
}

/* What snow_time_text makes of a format is known without a file. */
bool read_annotate(const option_row *row, const char *text, void *field,
                   char wrong[WRONG_BYTES]) {
    const snow_volume_info dated = {.size = sizeof dated,
                                    .time_unit = "days since 2000-01-01"};
    annotate_value value = {.text = text};
    char made[256];
    if (strncasecmp(text, "time=", 5) == 0)
        value.format = text + 5;
    else if (strcasecmp(text, "time") != 0 && strcasecmp(text, "step") != 0)
        return read_choice(row, text, &(const char *){NULL}, wrong);
    if (value.format &&
        !snow_time_text(&dated, value.format, made, sizeof made))
        return parse_refuse(wrong,
                            "has a format that is neither one number as in "
                            "\"time=t = %.2f s\" nor a date of %Y, %m, %d, "
                            "%H, %M and %S");
    value.time = strcasecmp(text, "step") != 0;
    *(annotate_value *)field = value;
    return true;
}

/* "NAME" or "NAME:N": one of the row's choices, and a whole number within its
 * limits, 0 where it is not given. */
static bool read_numbered(const option_row *row, const char *text,
                          const char **name, int64_t *number,
                          char wrong[WRONG_BYTES]) {
    static const char *const names[] = {"auto",    "tent",   "gauss",
                                        "bspline", "box",    "tree",
                                        "swap",    "direct", "radix"};
    char word[32];
    int64_t value = 0;
    const char *colon = strchr(text, ':');
    snprintf(word, sizeof word, "%.*s", (int)strcspn(text, ":"), text);
    if (!read_choice(row, word, &(const char *){NULL}, wrong) ||
        (colon && !read_integer(row, colon + 1, &value, wrong)))
        return false;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcasecmp(word, names[i]) == 0)
            *name = names[i];
    *number = value;
    return true;
}

bool read_kernel(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    options *out = (options *)(void *)((char *)field - row->field);
    return read_numbered(row, text, field, &out->footprint, wrong);
}

/* Only radix has groups. */
bool read_combine(const option_row *row, const char *text, void *field,
                  char wrong[WRONG_BYTES]) {
    options *out = (options *)(void *)((char *)field - row->field);
    if (strchr(text, ':') && strncasecmp(text, "radix:", 6) != 0)
        return parse_refuse(wrong, "has a number; only radix has one");
    return read_numbered(row, text, field, &out->radix, wrong);
}

bool read_listen(const option_row *row, const char *text, void *field,
                 char wrong[WRONG_BYTES]) {
    (void)row;
    if (!value_listen(text, field))
        return parse_refuse(wrong, "is no place to listen; give a port such as "
                                   ":8000, ADDRESS:PORT, [ADDRESS]:PORT, or "
                                   "unix:PATH");
    return true;
}
