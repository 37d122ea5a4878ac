/* transfer/formats/csv.c - reads tables: rows of value,red,green,blue,opacity
 * or value,opacity or value,red,green,blue, one row per point, numbers
 * separated by commas, semicolons or blanks.  A first row of words, empty rows
 * and everything after # are skipped.  Colours range from 0 to 1, or to 255 if
 * one is above 1. */
#include "transfer/formats/tf.h"

#include <string.h>

typedef struct row {
    double number[5];
    int count;
} row;

static bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r';
}

/* Reads the numbers of a line; count is -1 if there is anything else. */
static row read_row(const char *at, const char *end) {
    row r = {.count = 0};
    while (at < end && is_blank(*at))
        at++;
    while (at < end && *at != '#') {
        if (r.count == 5 || !tf_take_number(&at, end, &r.number[r.count++]))
            return (row){.count = -1};
        while (at < end && is_blank(*at))
            at++;
        if (at < end && (*at == ',' || *at == ';'))
            at++;
        while (at < end && is_blank(*at))
            at++;
    }
    return r;
}

static snow_status add_row(const tf_input *in, snow_look_file *tf, const row *r,
                           double scale) {
    const double *n = r->number;
    const double rgb[3] = {n[1] / scale, n[2] / scale, n[3] / scale};
    if (r->count >= 4)
        TF_TRY(tf_add_color(in, tf, n[0], rgb));
    if (r->count == 4)
        return SNOW_STATUS_OK;
    return tf_add_opacity(in, tf, &tf->opacities, "opacity", n[0],
                          n[r->count - 1]);
}

/* Processes each line: first to find the number of columns, then to take the
 * values. */
typedef struct table {
    int columns; /* of the first row of numbers; 0: none yet */
    bool headed; /* a row of words was skipped */
    double most; /* the largest of the colours */
    bool take;
} table;

static snow_status walk_lines(const tf_input *in, snow_look_file *tf,
                              table *t) {
    const char *at = in->bytes, *end = in->bytes + in->size;
    for (long number = 1; at < end; number++) {
        const char *stop = memchr(at, '\n', (size_t)(end - at));
        stop = stop ? stop : end;
        const char *start = at;
        row r = read_row(at, stop);
        at = stop + 1;
        if (r.count == 0)
            continue;
        if (r.count < 0 && !t->columns && !t->headed) {
            /* Names of columns begin with a letter, possibly quoted. */
            while (*start == ' ' || *start == '\t' || *start == '"')
                start++;
            t->headed = (*start >= 'A' && *start <= 'Z') ||
                        (*start >= 'a' && *start <= 'z');
            if (t->headed)
                continue;
        }
        if (!t->columns)
            t->columns = r.count;
        if (r.count != t->columns || r.count == 3 || r.count == 1 ||
            r.count < 0)
            return tf_fail(
                in,
                "line %ld is not a row of value,opacity or "
                "value,red,green,blue,opacity like the others; correct it",
                number);
        for (int i = 1; i < 4 && r.count > 2; i++)
            t->most = r.number[i] > t->most ? r.number[i] : t->most;
        if (t->take)
            TF_TRY(add_row(in, tf, &r, t->most > 1 ? 255 : 1));
    }
    return SNOW_STATUS_OK;
}

snow_status tf_read_csv(const tf_input *in, snow_look_file *tf) {
    table t = {.columns = 0};
    TF_TRY(walk_lines(in, tf, &t));
    if (!t.columns)
        return tf_fail(in, "is not a transfer function; give a Snowglass .json "
                           "or .csv, a Slicer .vp or .xml, a ParaView or "
                           "niivue .json, or an Amrvis .pal");
    t.take = true;
    t.headed = false;
    t.columns = 0;
    tf->format = "csv";
    return walk_lines(in, tf, &t);
}
