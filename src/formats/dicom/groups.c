/* formats/dicom/groups.c - which frames may be slices of one volume. */
#include "formats/dicom/dicom.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cosines are written with six digits, or fewer. */
#define SAME_COSINE 1e-3

/* What the pixels of an image are, in numbers. */
#define KINDS 8
static void kind_of(const dicom_image *image, int64_t out[KINDS]) {
    const int64_t kind[KINDS] = {
        image->columns,   image->rows,
        image->tiles,     image->tiles > 1 ? image->slices : 0,
        image->samples,   image->allocated,
        image->is_signed, image->segments};
    memcpy(out, kind, sizeof kind);
}

static int compare_kinds(const dicom_image *a, const dicom_image *b) {
    int64_t x[KINDS], y[KINDS];
    int by = 0;
    kind_of(a, x);
    kind_of(b, y);
    for (int i = 0; i < KINDS && !by; i++)
        by = (x[i] > y[i]) - (x[i] < y[i]);
    if (!by && a->segments)
        by = strcmp(a->instance, b->instance); /* each has its own numbers */
    return by ? by : strcmp(a->photometric, b->photometric);
}

static int compare_images(const dicom_image *a, const dicom_image *b) {
    if (a->series_number != b->series_number)
        return a->series_number < b->series_number ? -1 : 1;
    int by = strcmp(a->series, b->series);
    return by ? by : compare_kinds(a, b);
}

/* Numbers that differ only by rounding or printing are equal. */
static int compare_about(double a, double b, double near) {
    return fabs(a - b) <= near ? 0 : snow_dicom_order(a, b);
}

/* By their plane. */
static int compare_planes(const dicom_frame *a, const dicom_frame *b) {
    int by = b->placed - a->placed;
    for (int i = 0; i < 3 && !by && a->placed; i++) {
        by = compare_about(a->row[i], b->row[i], SAME_COSINE);
        if (!by)
            by = compare_about(a->column[i], b->column[i], SAME_COSINE);
    }
    for (int i = 0; i < 2 && !by; i++)
        by = compare_about(a->pixel[i], b->pixel[i], 1e-4 * a->pixel[i]);
    return by;
}

/* Whether frames are alike but for their series. */
static bool are_alike(const dicom_frame *frames, size_t count) {
    for (size_t i = 0; i < count; i++)
        if (!frames[i].placed || !*frames[i].image->study ||
            frames[i].image->segments || frames[i].image->frames != 1 ||
            strcmp(frames[i].image->study, frames->image->study) != 0 ||
            (i && compare_kinds(frames[i].image, frames->image)) ||
            compare_planes(frames, &frames[i]))
            return false;
    return true;
}

/* By their files, if nothing else distinguishes them. */
int snow_dicom_compare_sources(const dicom_frame *a, const dicom_frame *b) {
    int by = snow_dicom_order(a->keys[DICOM_KEY_INSTANCE],
                              b->keys[DICOM_KEY_INSTANCE]);
    if (!by)
        by = strcmp(a->image->instance, b->image->instance);
    if (!by && a->image->path && b->image->path)
        by = strcmp(a->image->path, b->image->path);
    return by ? by : snow_dicom_order((double)a->number, (double)b->number);
}

static int by_image(const void *a, const void *b) {
    const dicom_frame *x = a, *y = b;
    int by = x->image == y->image ? 0 : compare_images(x->image, y->image);
    return by ? by : snow_dicom_compare_sources(x, y);
}

/* "About equal" is not an order for sorting: each group is gathered around its
 * first frame instead.  Series have few groups. */
size_t snow_dicom_group(dicom_frame *frames, size_t count,
                        dicom_group *groups) {
    size_t made = 0;
    qsort(frames, count, sizeof *frames, by_image);
    for (size_t first = 0; first < count;) {
        size_t end = first + 1;
        for (size_t i = end; i < count; i++) {
            if (frames[i].image != frames[first].image &&
                compare_images(frames[i].image, frames[first].image))
                break; /* sorted: no other belongs to it */
            if (compare_planes(&frames[first], &frames[i]))
                continue;
            dicom_frame moved = frames[i];
            memmove(&frames[end + 1], &frames[end], (i - end) * sizeof moved);
            frames[end++] = moved;
        }
        groups[made++] = (dicom_group){first, end - first};
        first = end;
    }
    return made;
}

/* The fewest images of a series each that are taken for slices. */
#define LEAST_JOINED 3

bool snow_dicom_join(snow_context *context, dicom_frame *frames, size_t count) {
    dicom_stack stack;
    if (count < LEAST_JOINED || !are_alike(frames, count))
        return false;
    bool joined = snow_dicom_stack(context, frames, count, false, &stack) ==
                  SNOW_STATUS_OK;
    if (joined) {
        joined = stack.times == 1 && !stack.slices;
        snow_dicom_stack_free(&stack);
    }
    qsort(frames, count, sizeof *frames, by_image);
    if (joined)
        snow_notify(context,
                    "each of its %zu images has a series UID of its own, as "
                    "some programs that remove names leave it; they lie evenly "
                    "behind one another and are taken for one series; --series "
                    "takes one of them",
                    count);
    return joined;
}
