/* formats/dicom/series.c - finds which frames form a volume, and its position.
 *
 * Slices are ordered and spaced by their positions (PS3.3, C.7.6.2) along the
 * normal of their plane, row x column, which makes the volume right-handed
 * whatever the order of files.  SliceThickness, numbers and names are never
 * used. The third column of the matrix is the way from the first position to
 * the last, divided evenly: with a tilted gantry it is not the normal, and the
 * matrix contains the shear exactly.
 *
 * Several frames at each position are several times.  A position without its
 * frame is a missing slice.  Positions that are uneven for another reason get
 * slices at even distances between them. */
#include "formats/dicom/dicom.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cosines are written with six digits, or fewer. */
#define SAME_COSINE 1e-3

/* Positions closer than this share of a pixel are the same; positions are
 * written with a hundredth of it and less. */
#define SAME_PLACE 0.01

/* Slices may deviate by this share of a gap from even positions: less than is
 * visible. */
#define EVEN 0.05

/* Gaps within this share of one another count as equal. */
#define SAME_GAP 0.1

/* Resampling uneven slices makes at most this many times as many. */
#define MOST_FINER 8

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double distance(const double a[3], const double b[3]) {
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return sqrt(dot(d, d));
}

/* --- groups ----------------------------------------------------------------
 */

static int order(double a, double b) {
    return (a > b) - (a < b);
}

/* Numbers that differ only by rounding or printing are equal. */
static int order_about(double a, double b, double tolerance) {
    return fabs(a - b) <= tolerance ? 0 : order(a, b);
}

static int compare_images(const dicom_image *a, const dicom_image *b) {
    if (a->series_number != b->series_number)
        return a->series_number < b->series_number ? -1 : 1;
    int by = strcmp(a->series, b->series);
    if (!by)
        by = order((double)a->columns, (double)b->columns);
    if (!by)
        by = order((double)a->rows, (double)b->rows);
    if (!by)
        by = a->samples - b->samples;
    if (!by)
        by = a->allocated - b->allocated;
    if (!by)
        by = a->is_signed - b->is_signed;
    return by ? by : strcmp(a->photometric, b->photometric);
}

/* 0 if two frames may be slices of one volume. */
static int compare_frames(const dicom_frame *a, const dicom_frame *b) {
    int by = a->image == b->image ? 0 : compare_images(a->image, b->image);
    if (!by)
        by = b->placed - a->placed;
    for (int i = 0; i < 3 && !by && a->placed; i++) {
        by = order_about(a->row[i], b->row[i], SAME_COSINE);
        if (!by)
            by = order_about(a->column[i], b->column[i], SAME_COSINE);
    }
    for (int i = 0; i < 2 && !by; i++)
        by = order_about(a->pixel[i], b->pixel[i], 1e-4 * a->pixel[i]);
    return by;
}

/* By their files, if nothing else distinguishes them. */
static int compare_sources(const dicom_frame *a, const dicom_frame *b) {
    int by = order(a->keys[DICOM_KEY_INSTANCE], b->keys[DICOM_KEY_INSTANCE]);
    if (!by)
        by = strcmp(a->image->instance, b->image->instance);
    if (!by && a->image->path && b->image->path)
        by = strcmp(a->image->path, b->image->path);
    return by ? by : order((double)a->number, (double)b->number);
}

static int by_image(const void *a, const void *b) {
    const dicom_frame *x = a, *y = b;
    int by = x->image == y->image ? 0 : compare_images(x->image, y->image);
    return by ? by : compare_sources(x, y);
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
            if (compare_frames(&frames[first], &frames[i]))
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

/* --- positions
 * --------------------------------------------------------------- */

/* What sorting needs besides the frame: its position along the normal. */
typedef struct ranked {
    dicom_frame frame;
    double along;
} ranked;

static int by_place(const void *a, const void *b) {
    const ranked *x = a, *y = b;
    int by = order(x->along, y->along);
    return by ? by : compare_sources(&x->frame, &y->frame);
}

static int by_keys(const void *a, const void *b) {
    const ranked *x = a, *y = b;
    int by = 0;
    for (int i = 0; i < DICOM_KEYS && !by; i++)
        by = order(x->frame.keys[i], y->frame.keys[i]);
    return by ? by : compare_sources(&x->frame, &y->frame);
}

static const char *name_of(const dicom_frame *frame) {
    const char *path = frame->image->path;
    const char *slash = path ? strrchr(path, '/') : NULL;
    return slash ? slash + 1 : path ? path : "it";
}

static double smallest_pixel(const dicom_frame *frame) {
    return frame->pixel[0] < frame->pixel[1] ? frame->pixel[0]
                                             : frame->pixel[1];
}

/* Tiles of one plane are not slices. */
static snow_status refuse_beside(const dicom_stack *s, const dicom_frame *a,
                                 const dicom_frame *b) {
    double off = distance(a->position, b->position);
    if (off <= smallest_pixel(a) / 2)
        return SNOW_STATUS_OK;
    return snow_fail(
        s->context, SNOW_STATUS_BAD_INPUT,
        "has slices beside one another in a plane: %s (frame %lld) and %s "
        "(frame %lld) are %g mm apart; open those of one position",
        name_of(a), (long long)a->number, name_of(b), (long long)b->number,
        off);
}

/* Checks that all positions have the same number of frames. */
static snow_status share_places(dicom_stack *s, ranked *all, size_t count) {
    double near = SAME_PLACE * smallest_pixel(&all[0].frame);
    size_t first = 0;
    for (size_t i = 1; i <= count; i++) {
        if (i < count && all[i].along - all[first].along <= near) {
            SNOW_TRY(refuse_beside(s, &all[first].frame, &all[i].frame));
            continue;
        }
        size_t here = i - first;
        if (!s->places)
            s->times = here;
        if (here != s->times)
            return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                             "has %zu images at the position of %s (frame "
                             "%lld) but %zu at others; remove images that do "
                             "not belong, or add the missing ones",
                             here, name_of(&all[first].frame),
                             (long long)all[first].frame.number, s->times);
        qsort(all + first, here, sizeof *all, by_keys);
        s->places++;
        first = i;
    }
    return SNOW_STATUS_OK;
}

static const double *place(const dicom_stack *s, size_t index) {
    return s->frames[index * s->times].position;
}

/* --- gaps ------------------------------------------------------------------
 */

static double gap_at(const dicom_stack *s, const double normal[3], size_t i) {
    return dot(place(s, i + 1), normal) - dot(place(s, i), normal);
}

static int by_size(const void *a, const void *b) {
    return order(*(const double *)a, *(const double *)b);
}

/* The median gap. */
static snow_status usual_gap(const dicom_stack *s, const double normal[3],
                             double *out) {
    size_t count = s->places - 1;
    double *gaps = snow_allocate_array(s->context, count, sizeof *gaps);
    if (!gaps)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < count; i++)
        gaps[i] = gap_at(s, normal, i);
    qsort(gaps, count, sizeof *gaps, by_size);
    *out = gaps[(count - 1) / 2];
    snow_release(s->context, gaps);
    return SNOW_STATUS_OK;
}

/* The multiple of the usual gap, 0 if it is not a whole number. */
static double multiple(double gap, double usual) {
    double times = floor(gap / usual + 0.5);
    return fabs(gap - times * usual) <= SAME_GAP * usual ? times : 0;
}

/* A single gap of twice or three times the usual one between usual ones is a
 * missing slice; two in a row are how the slices were acquired. */
static snow_status refuse_missing(const dicom_stack *s,
                                  const double normal[3]) {
    double usual, before = 1;
    size_t found = s->places;
    SNOW_TRY(usual_gap(s, normal, &usual));
    for (size_t i = 0; i + 1 < s->places; i++) {
        double times = multiple(gap_at(s, normal, i), usual);
        if (times < 1 || (times > 1 && before > 1))
            return SNOW_STATUS_OK;
        if (times > 1 && found == s->places)
            found = i;
        before = times;
    }
    if (found == s->places || s->places < 4)
        return SNOW_STATUS_OK;
    double gap = gap_at(s, normal, found);
    double lost = multiple(gap, usual) - 1;
    const dicom_frame *low = &s->frames[found * s->times];
    const dicom_frame *high = &s->frames[(found + 1) * s->times];
    return snow_fail(
        s->context, SNOW_STATUS_BAD_INPUT,
        "%.0f of its slices %s missing between %s and %s (frames %lld and "
        "%lld), which lie %g mm apart while others lie %g; add %s",
        lost, lost > 1 ? "are" : "is", name_of(low), name_of(high),
        (long long)low->number, (long long)high->number, gap, usual,
        lost > 1 ? "them" : "it");
}

/* The largest distance of a position from its place on the line from the first
 * to the last at `share` of it; along the line, or only across it. */
static double farthest(const dicom_stack *s, const double normal[3],
                       bool beside) {
    const double *a = place(s, 0), *b = place(s, s->places - 1);
    double all = dot(b, normal) - dot(a, normal), most = 0;
    for (size_t i = 0; i < s->places; i++) {
        const double *p = place(s, i);
        double share = beside ? (dot(p, normal) - dot(a, normal)) / all
                              : (double)i / (double)(s->places - 1);
        double want[3];
        for (int k = 0; k < 3; k++)
            want[k] = a[k] + share * (b[k] - a[k]);
        double off = distance(p, want);
        most = off > most || isnan(off) ? off : most;
    }
    return most;
}

/* Makes slices at even distances from the first position to the last, as close
 * as the closest positions. */
static snow_status even_out(dicom_stack *s, const double normal[3]) {
    double first = dot(place(s, 0), normal);
    double all = dot(place(s, s->places - 1), normal) - first;
    double most = (double)MOST_FINER * (double)s->places;
    double steps = ceil(all / s->gap_least - 1e-3);
    if (!(steps < most))
        return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                         "its slices lie %g to %g mm apart, too unevenly for "
                         "resampling; open a part of them",
                         s->gap_least, s->gap_most);
    s->slice_count = (size_t)steps + 1;
    s->slices =
        snow_allocate_array(s->context, s->slice_count, sizeof *s->slices);
    if (!s->slices)
        return SNOW_STATUS_NO_MEMORY;
    s->gap = all / steps;
    size_t low = 0;
    for (size_t i = 0; i < s->slice_count; i++) {
        double at = first + s->gap * (double)i;
        while (low + 2 < s->places && dot(place(s, low + 1), normal) <= at)
            low++;
        double below = dot(place(s, low), normal);
        double weight = (at - below) / gap_at(s, normal, low);
        weight = weight < 1e-9 ? 0 : weight > 1 - 1e-9 ? 1 : weight;
        s->slices[i] = (dicom_slice){low, low + 1, weight};
    }
    return SNOW_STATUS_OK;
}

/* Measures the distances of neighbours, and decides whether an even grid
 * fits. */
static snow_status space_out(dicom_stack *s, const double normal[3]) {
    double all =
        dot(place(s, s->places - 1), normal) - dot(place(s, 0), normal);
    s->gap = all / (double)(s->places - 1);
    s->gap_least = s->gap_most = gap_at(s, normal, 0);
    for (size_t i = 1; i + 1 < s->places; i++) {
        double gap = gap_at(s, normal, i);
        s->gap_least = gap < s->gap_least ? gap : s->gap_least;
        s->gap_most = gap > s->gap_most ? gap : s->gap_most;
    }
    s->given = true;
    if (farthest(s, normal, false) <= EVEN * s->gap)
        return SNOW_STATUS_OK;
    double beside = farthest(s, normal, true);
    if (!(beside <= smallest_pixel(s->frames) / 2) &&
        !(beside <= EVEN * s->gap_least))
        return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                         "its slices are not aligned: one is %g mm off the "
                         "line from the first to the last; open a part of them",
                         beside);
    SNOW_TRY(refuse_missing(s, normal));
    return even_out(s, normal);
}

/* --- the matrix ------------------------------------------------------------
 */

/* Columns along a row, down a column, from slice to slice; LPS becomes RAS. */
static void fill_matrix(dicom_stack *s, const double step[3]) {
    const dicom_frame *frame = s->frames;
    for (int i = 0; i < 3; i++) {
        double sign = s->placed && i < 2 ? -1 : 1;
        s->matrix[i][0] = sign * frame->row[i] * frame->pixel[0];
        s->matrix[i][1] = sign * frame->column[i] * frame->pixel[1];
        s->matrix[i][2] = sign * step[i];
        s->matrix[i][3] = sign * frame->position[i];
        s->matrix[3][i] = 0;
        /* no -0 in what is printed */
        for (int k = 0; k < 4; k++)
            s->matrix[i][k] += 0.0;
    }
    s->matrix[3][3] = 1;
}

/* A single slice has its given depth: there is no other to measure from. */
static double lone_depth(const dicom_frame *frame) {
    double depth = fabs(frame->depth);
    return depth > 0 ? depth : frame->thickness;
}

static void step_of_slices(dicom_stack *s, const double normal[3],
                           double step[3]) {
    if (s->places == 1 || !s->placed) {
        double depth =
            s->places == 1 ? lone_depth(s->frames) : fabs(s->frames->depth);
        s->given = depth > 0;
        s->gap = s->given ? depth : 1;
        for (int i = 0; i < 3; i++)
            step[i] = normal[i] * s->gap;
        return;
    }
    const double *a = place(s, 0), *b = place(s, s->places - 1);
    double steps = (double)((s->slices ? s->slice_count : s->places) - 1);
    for (int i = 0; i < 3; i++)
        step[i] = (b[i] - a[i]) / steps;
}

/* Frames without a position are slices in the order of their numbers. */
static void order_frames(ranked *all, size_t count, const double normal[3]) {
    bool placed = all[0].frame.placed;
    for (size_t i = 0; i < count; i++)
        all[i].along = placed ? dot(all[i].frame.position, normal) : 0;
    qsort(all, count, sizeof *all, by_place);
}

static snow_status lay_stack(dicom_stack *s, dicom_frame *frames, ranked *all,
                             size_t count) {
    double normal[3], step[3];
    for (size_t i = 0; i < count; i++)
        all[i].frame = frames[i];
    cross(frames[0].row, frames[0].column, normal);
    order_frames(all, count, normal);
    s->placed = frames[0].placed;
    s->times = 1;
    s->places = s->placed ? 0 : count;
    if (s->placed)
        SNOW_TRY(share_places(s, all, count));
    for (size_t i = 0; i < count; i++)
        frames[i] = all[i].frame;
    s->frames = frames;
    if (s->placed && s->places > 1)
        SNOW_TRY(space_out(s, normal));
    if (!s->slices)
        s->slice_count = s->places;
    step_of_slices(s, normal, step);
    fill_matrix(s, step);
    return SNOW_STATUS_OK;
}

snow_status snow_dicom_stack(snow_context *context, dicom_frame *frames,
                             size_t count, dicom_stack *out) {
    dicom_stack stack = {.context = context};
    ranked *all = snow_allocate_array(context, count, sizeof *all);
    if (!all)
        return SNOW_STATUS_NO_MEMORY;
    snow_status status = lay_stack(&stack, frames, all, count);
    snow_release(context, all);
    if (status == SNOW_STATUS_OK)
        *out = stack;
    else
        snow_dicom_stack_free(&stack);
    return status;
}

void snow_dicom_stack_free(dicom_stack *stack) {
    snow_release(stack->context, stack->slices);
    stack->slices = NULL;
}
