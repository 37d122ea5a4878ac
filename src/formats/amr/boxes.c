/* formats/amr/boxes.c - the boxes of a level of a plotfile, and where their
 * values are: a file such as Level_0/Cell_H,
 *
 *     1                                    version
 *     1                                    how it was written
 *     5                                    components
 *     0                                    ghost cells around each box
 *     (2 0                                 boxes
 *     ((0,0,0) (15,15,15) (0,0,0))         first and last cell, centring
 *     ((16,0,0) (31,15,15) (0,0,0))
 *     )
 *     2
 *     FabOnDisk: Cell_D_00000 0            file, offset in bytes
 *     FabOnDisk: Cell_D_00000 163909
 *
 *
 *     2,5                                  least values: boxes, components
 *     1.0e+00,0.0e+00,0.0e+00,2.0e+00,3.0e+00,
 *     1.5e+00,0.0e+00,0.0e+00,2.0e+00,3.0e+00,
 *
 *     2,5                                  greatest values
 *     ...
 *
 * Versions 2 and 4 lack the extremes of boxes.  Of version 2 on the type, which
 * is in each FAB's header else, ends the file.  After AMReX_VisMF.cpp. */
#include "formats/amr/amr.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINE_BYTES 4096

/* Bytes of a number in a list of extremes, and its comma. */
#define NUMBER_BYTES 40

/* How a line is read. */
typedef struct reading {
    amr_plotfile *file;
    snow_source *source;
    int level;
    int64_t version;
    char line[LINE_BYTES];
} reading;

static snow_status fail_boxes(const reading *r, const char *what) {
    return snow_amr_refuse(r->file->context, r->line, what);
}

static snow_status next_line(reading *r, const char *what) {
    return snow_amr_line(r->source, r->line, LINE_BYTES, what);
}

/* Reads a line of `least` to `most` whole numbers. */
static snow_status take_line(reading *r, const char *what, int least, int most,
                             int64_t *out, int *count) {
    SNOW_TRY(next_line(r, what));
    *count = snow_amr_integers(r->line, out, most);
    return *count < least ? fail_boxes(r, what) : SNOW_STATUS_OK;
}

/* All before the boxes; how many these are. */
static snow_status take_front(reading *r, int64_t *boxes) {
    int64_t values[3];
    int64_t *ghosts = r->file->ghosts[r->level];
    int count;
    SNOW_TRY(take_line(r, "a version", 1, 1, values, &count));
    r->version = values[0];
    if (r->version < 1 || r->version > 4)
        return snow_fail(r->file->context, SNOW_STATUS_BAD_INPUT,
                         "has version %lld, which is not known; write it with "
                         "vismf.headerversion = 1",
                         (long long)values[0]);
    SNOW_TRY(take_line(r, "how it was written", 1, 1, values, &count));
    SNOW_TRY(take_line(r, "the number of components", 1, 1, values, &count));
    if (values[0] < r->file->components || values[0] > AMR_MOST_COMPONENTS)
        return fail_boxes(r, "the number of components of the header");
    r->file->level[r->level].components = values[0];
    SNOW_TRY(take_line(r, "the ghost cells", 1, 3, values, &count));
    for (int i = 0; i < 3; i++) {
        ghosts[i] = i < r->file->axes ? values[i < count ? i : 0] : 0;
        if (ghosts[i] < 0 || ghosts[i] > 1024)
            return fail_boxes(r, "a number of ghost cells");
    }
    SNOW_TRY(take_line(r, "the number of boxes", 1, 2, values, &count));
    *boxes = values[0];
    return *boxes < 0 || *boxes > AMR_MOST_BOXES
               ? fail_boxes(r, "the number of boxes")
               : SNOW_STATUS_OK;
}

/* Axes that the file has not are one cell. */
static snow_status take_box(reading *r) {
    const amr_plotfile *file = r->file;
    const int64_t *corner = file->first[r->level];
    int64_t ends[9];
    int count;
    snow_box box = {{0, 0, 0}, {1, 1, 1}};
    SNOW_TRY(
        take_line(r, "a box", 3 * file->axes, 3 * file->axes, ends, &count));
    for (int i = 0; i < file->axes; i++) {
        const int64_t low = ends[i], high = ends[file->axes + i];
        if (ends[2 * file->axes + i] != 0)
            return snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                             "has values on faces or nodes, which are not "
                             "supported; write those of cells");
        if (low < -INT32_MAX || low > high || high > INT32_MAX)
            return fail_boxes(r, "a box with cells");
        box.first[i] = low - corner[i];
        box.count[i] = high - low + 1;
    }
    return snow_amr_add(&r->file->grid, r->level, &box);
}

/* "FabOnDisk: Cell_D_00000 163909". */
static snow_status take_place(reading *r, const char *folder, size_t number) {
    static const char key[] = "FabOnDisk:";
    amr_plotfile *file = r->file;
    int64_t offset;
    SNOW_TRY(next_line(r, "the places of its boxes"));
    char *name = r->line + sizeof key - 1;
    if (strncmp(r->line, key, sizeof key - 1) != 0)
        return fail_boxes(r, "a file and an offset");
    name += strspn(name, " \t");
    char *blank = strrchr(name, ' ');
    if (!blank || blank == name || !snow_parse_int64(blank + 1, &offset) ||
        offset < 0)
        return fail_boxes(r, "a file and an offset");
    const size_t front = strlen(folder), length = (size_t)(blank - name);
    if (front + length >= AMR_NAME_BYTES)
        return fail_boxes(r, "a shorter name");
    SNOW_TRY(SNOW_RESERVE(file->context, file->fabs, number, number + 1));
    SNOW_TRY(SNOW_RESERVE(file->context, file->names, file->names_used,
                          file->names_used + front + length + 1));
    char *to = file->names + file->names_used;
    memcpy(to, folder, front);
    memcpy(to + front, name, length);
    to[front + length] = 0;
    file->fabs[number] =
        (amr_fab){file->names_used, offset, INT64_MAX, NAN, NAN};
    file->names_used += front + length + 1;
    return SNOW_STATUS_OK;
}

/* --- the end of each FAB -------------------------------------------------- */

typedef struct place {
    const char *name;
    amr_fab *fab;
} place;

static int by_place(const void *a, const void *b) {
    const place *x = a, *y = b;
    const int names = strcmp(x->name, y->name);
    return names ? names
                 : (x->fab->offset > y->fab->offset) -
                       (x->fab->offset < y->fab->offset);
}

/* FABs of one file end where the next one begins. */
static snow_status find_ends(const amr_plotfile *file, size_t first,
                             size_t count) {
    place *places = snow_allocate_array(file->context, count, sizeof *places);
    if (!places)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        amr_fab *fab = &file->fabs[first + i];
        places[i] = (place){file->names + fab->name, fab};
    }
    qsort(places, count, sizeof *places, by_place);
    for (size_t i = count; i-- > 1;)
        if (!strcmp(places[i].name, places[i - 1].name))
            places[i - 1].fab->end = places[i].fab->offset;
    snow_release(file->context, places);
    return SNOW_STATUS_OK;
}

/* --- extremes ------------------------------------------------------------- */

/* The next line that is not empty; false at the end. */
static snow_status next_words(reading *r, bool *got) {
    do
        SNOW_TRY(snow_source_read_line(r->source, r->line, LINE_BYTES, got));
    while (*got && !r->line[strspn(r->line, " \t")]);
    return SNOW_STATUS_OK;
}

/* A number of a line of them; NaN if it is none. */
static double number_in(const char *line, int64_t index) {
    char word[NUMBER_BYTES];
    double value;
    for (; line && index > 0; index--)
        line = (line = strchr(line, ',')) ? line + 1 : NULL;
    if (!line)
        return NAN;
    snprintf(word, sizeof word, "%.*s", (int)strcspn(line, ","), line);
    return snow_parse_double(word + strspn(word, " \t"), &value) ? value : NAN;
}

/* Lines of one box each, with a number of each component. */
static snow_status take_rows(reading *r, size_t first, size_t count,
                             bool highest) {
    const amr_plotfile *file = r->file;
    const int64_t components = file->level[r->level].components;
    const size_t bytes = (size_t)components * NUMBER_BYTES + NUMBER_BYTES;
    char *line = snow_allocate(file->context, bytes);
    snow_status status = line ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < count && status == SNOW_STATUS_OK; i++) {
        amr_fab *fab = &file->fabs[first + i];
        status = snow_amr_line(r->source, line, bytes, "the extremes of boxes");
        if (status == SNOW_STATUS_OK)
            *(highest ? &fab->high : &fab->low) =
                number_in(line, file->component);
    }
    snow_release(file->context, line);
    return status;
}

/* Old files may end before. */
static snow_status take_extremes(reading *r, size_t first, size_t count) {
    for (int i = 0; i < 2; i++) {
        int64_t sizes[2];
        bool got;
        SNOW_TRY(next_words(r, &got));
        if (!got)
            return SNOW_STATUS_OK;
        if (snow_amr_integers(r->line, sizes, 2) != 2 ||
            sizes[0] != (int64_t)count ||
            (count && sizes[1] != r->file->level[r->level].components))
            return fail_boxes(r, "the number of boxes and components");
        SNOW_TRY(take_rows(r, first, count, i > 0));
    }
    return SNOW_STATUS_OK;
}

/* The type that FABs without headers have, in the last line. */
static snow_status take_type(reading *r) {
    amr_fabs *fabs = &r->file->level[r->level];
    int64_t numbers[32];
    bool got;
    int used;
    SNOW_TRY(next_words(r, &got));
    for (int i = 0; i < 2 && r->version == 4; i++)
        SNOW_TRY(next_words(r, &got));
    const int count = got ? snow_amr_integers(r->line, numbers, 32) : 0;
    fabs->bare = true;
    return snow_plotfile_take_type(numbers, count, &used, &fabs->type,
                                   &fabs->big_endian)
               ? SNOW_STATUS_OK
               : fail_boxes(r, "the type of its values");
}

/* --- all of it ------------------------------------------------------------ */

static snow_status take_all(reading *r, const char *folder) {
    const size_t first = r->file->grid.count;
    int64_t boxes = 0, values[2];
    int count;
    SNOW_TRY(take_front(r, &boxes));
    for (int64_t i = 0; i < boxes; i++)
        SNOW_TRY(take_box(r));
    SNOW_TRY(take_line(r, "the end of the boxes", 0, 0, values, &count));
    SNOW_TRY(take_line(r, "the number of boxes", 1, 1, values, &count));
    if (values[0] != boxes)
        return fail_boxes(r, "the number of boxes");
    for (int64_t i = 0; i < boxes; i++)
        SNOW_TRY(take_place(r, folder, first + (size_t)i));
    SNOW_TRY(find_ends(r->file, first, (size_t)boxes));
    if (r->version == 1 || r->version == 3)
        SNOW_TRY(take_extremes(r, first, (size_t)boxes));
    return r->version > 1 ? take_type(r) : SNOW_STATUS_OK;
}

snow_status snow_plotfile_read_boxes(amr_plotfile *file, int level,
                                     const char *name) {
    char folder[AMR_NAME_BYTES];
    const char *slash = strrchr(name, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - name) + 1 : 0,
             name);
    reading *r = snow_allocate(file->context, sizeof *r);
    if (!r)
        return SNOW_STATUS_NO_MEMORY;
    *r = (reading){.file = file, .level = level};
    snow_status status = file->open(file->user, name, &r->source);
    if (status == SNOW_STATUS_OK) {
        status = take_all(r, folder);
        if (status != SNOW_STATUS_OK)
            snow_fail_in_file(file->context, status,
                              snow_source_name(r->source));
        snow_source_close(r->source);
    }
    snow_release(file->context, r);
    return status;
}
