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

/* Positions closer than this share of a pixel are the same; positions are
 * written with a hundredth of it and less. */
#define SAME_PLACE 0.01

/* --- positions ------------------------------------------------------------ */

/* What sorting needs besides the frame: its position along the normal. */
typedef struct ranked {
    dicom_frame frame;
    double along;
} ranked;

static int by_place(const void *a, const void *b) {
    const ranked *x = a, *y = b;
    int by = snow_dicom_order(x->along, y->along);
    return by ? by : snow_dicom_compare_sources(&x->frame, &y->frame);
}

static int by_keys(const void *a, const void *b) {
    const ranked *x = a, *y = b;
    int by = 0;
    for (int i = 0; i < DICOM_KEYS && !by; i++)
        by = snow_dicom_order(x->frame.keys[i], y->frame.keys[i]);
    return by ? by : snow_dicom_compare_sources(&x->frame, &y->frame);
}

/* Tiles of one plane are not slices. */
static snow_status refuse_beside(const dicom_stack *s, const dicom_frame *a,
                                 const dicom_frame *b) {
    double off = snow_dicom_distance(a->position, b->position);
    if (off <= snow_dicom_smallest_pixel(a) / 2)
        return SNOW_STATUS_OK;
    return snow_fail(
        s->context, SNOW_STATUS_BAD_INPUT,
        "has slices beside one another in a plane: %s (frame %lld) and %s "
        "(frame %lld) are %g mm apart; open those of one position",
        snow_dicom_name(a), (long long)a->number, snow_dicom_name(b),
        (long long)b->number, off);
}

/* Checks that all positions have the same number of frames. */
static snow_status share_places(dicom_stack *s, ranked *all, size_t count) {
    double near = SAME_PLACE * snow_dicom_smallest_pixel(&all[0].frame);
    size_t first = 0;
    for (size_t i = 1; i <= count; i++) {
        if (i < count && all[i].along - all[first].along <= near) {
            SNOW_TRY(refuse_beside(s, &all[first].frame, &all[i].frame));
            continue;
        }
        size_t here = i - first;
        if (s->starts)
            s->starts[s->places + 1] = i;
        else if (!s->places)
            s->times = here;
        if (!s->starts && here != s->times)
            return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                             "has %zu images at the position of %s (frame "
                             "%lld) but %zu at others; remove images that do "
                             "not belong, or add the missing ones",
                             here, snow_dicom_name(&all[first].frame),
                             (long long)all[first].frame.number, s->times);
        qsort(all + first, here, sizeof *all, by_keys);
        s->places++;
        first = i;
    }
    return SNOW_STATUS_OK;
}

/* --- the matrix ----------------------------------------------------------- */

/* Columns along a row, down a column, from slice to slice; LPS becomes RAS.
 * Frames without a position are images, whose first row is the top. */
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
    if (!s->placed)
        snow_image_turn(s->matrix);
}

static void step_of_slices(dicom_stack *s, double step[3]) {
    if (s->places == 1 || !s->placed) {
        double depth = fabs(s->frames->depth);
        if (s->places == 1 && !(depth > 0)) /* there is no other */
            depth = s->frames->thickness;
        s->given = depth > 0;
        s->gap = s->given ? depth : 1;
        for (int i = 0; i < 3; i++)
            step[i] = s->normal[i] * s->gap;
        return;
    }
    const double *a = snow_dicom_position(s, 0),
                 *b = snow_dicom_position(s, s->places - 1);
    double steps = (double)((s->slices ? s->slice_count : s->places) - 1);
    for (int i = 0; i < 3; i++)
        step[i] = (b[i] - a[i]) / steps;
}

static snow_status lay_stack(dicom_stack *s, dicom_frame *frames, ranked *all,
                             size_t count) {
    double step[3];
    snow_dicom_normal(frames, s->normal);
    s->placed = frames[0].placed;
    /* Frames without a position are slices in the order of their numbers. */
    for (size_t i = 0; i < count; i++)
        all[i] = (ranked){
            frames[i], s->placed ? snow_dot(frames[i].position, s->normal) : 0};
    qsort(all, count, sizeof *all, by_place);
    s->times = 1;
    s->places = s->placed ? 0 : count;
    if (s->placed)
        SNOW_TRY(share_places(s, all, count));
    for (size_t i = 0; i < count; i++)
        frames[i] = all[i].frame;
    s->frames = frames;
    if (s->placed && s->places > 1)
        SNOW_TRY(snow_dicom_space_slices(s));
    if (!s->slices)
        s->slice_count = s->places;
    step_of_slices(s, step);
    fill_matrix(s, step);
    return SNOW_STATUS_OK;
}

snow_status snow_dicom_stack(snow_context *context, dicom_frame *frames,
                             size_t count, bool gaps, dicom_stack *out) {
    dicom_stack stack = {.context = context, .gaps = gaps};
    bool sparse = frames->image->segments != DICOM_NO_SEGMENTS;
    ranked *all = snow_allocate_array(context, count, sizeof *all);
    if (sparse)
        stack.starts =
            snow_allocate_array(context, count + 1, sizeof *stack.starts);
    snow_status status = SNOW_STATUS_NO_MEMORY;
    if (stack.starts)
        stack.starts[0] = 0;
    if (all && (stack.starts || !sparse))
        status = lay_stack(&stack, frames, all, count);
    snow_release(context, all);
    if (status == SNOW_STATUS_OK)
        *out = stack;
    else
        snow_dicom_stack_free(&stack);
    return status;
}

void snow_dicom_stack_free(dicom_stack *stack) {
    snow_release(stack->context, stack->slices);
    snow_release(stack->context, stack->starts);
    stack->slices = NULL;
    stack->starts = NULL;
}

void snow_dicom_describe(const dicom_stack *stack, snow_volume_info *info) {
    const dicom_image *image = stack->frames->image;
    *info = snow_volume_info_default("dicom");
    info->dims[0] = snow_dicom_columns(image);
    info->dims[1] = snow_dicom_rows(image);
    info->dims[2] = (int64_t)stack->slice_count;
    info->times = (int64_t)stack->times;
    info->medical = stack->placed;
    memcpy(info->unit, "mm", 3);
    memcpy(info->matrix, stack->matrix, sizeof info->matrix);
    memcpy(info->modality, image->modality, sizeof info->modality);
    memcpy(info->description, image->description, sizeof info->description);
}
