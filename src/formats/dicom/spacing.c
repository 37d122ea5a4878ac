/* formats/dicom/spacing.c - the distances of a stack's slices: even ones,
 * missing ones, and slices at even distances between uneven ones. */
#include "formats/dicom/dicom.h"

#include <math.h>
#include <stdlib.h>

/* Slices may deviate by this share of a gap from even positions: less than is
 * visible. */
#define EVEN 0.05

/* Gaps within this share of one another count as equal. */
#define SAME_GAP 0.1

/* Resampling uneven slices makes at most this many times as many. */
#define MOST_FINER 8

/* Slices that sparse ones may become anyhow: two can be far apart. */
#define MOST_SPARSE 4096

double snow_dicom_distance(const double a[3], const double b[3]) {
    const double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return snow_length(d);
}

/* A place along the normal. */
static double place_of(const dicom_stack *s, size_t i) {
    return snow_dot(snow_dicom_position(s, i), s->normal);
}

static double gap_at(const dicom_stack *s, size_t i) {
    return place_of(s, i + 1) - place_of(s, i);
}

/* From the first position to the last. */
static double length_of(const dicom_stack *s) {
    return place_of(s, s->places - 1) - place_of(s, 0);
}

static int by_size(const void *a, const void *b) {
    return snow_dicom_order(*(const double *)a, *(const double *)b);
}

/* The median gap. */
static snow_status usual_gap(const dicom_stack *s, double *out) {
    size_t count = s->places - 1;
    double *gaps = snow_allocate_array(s->context, count, sizeof *gaps);
    if (!gaps)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < count; i++)
        gaps[i] = gap_at(s, i);
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

static double most_slices(const dicom_stack *s) {
    double most = (double)MOST_FINER * (double)s->places;
    return s->starts && most < MOST_SPARSE ? MOST_SPARSE : most;
}

/* Finds a single gap of twice or three times the usual one between usual ones:
 * a missing slice; two in a row are how the slices were acquired.  `*found` is
 * the number of places if there is none. */
static snow_status find_missing(const dicom_stack *s, double *usual,
                                size_t *found) {
    double before = 1;
    *found = s->places;
    SNOW_TRY(usual_gap(s, usual));
    for (size_t i = 0; i + 1 < s->places && s->places >= 4; i++) {
        double times = multiple(gap_at(s, i), *usual);
        if (times < 1 || (times > 1 && before > 1)) {
            *found = s->places;
            return SNOW_STATUS_OK;
        }
        if (times > 1 && *found == s->places)
            *found = i;
        before = times;
    }
    return SNOW_STATUS_OK;
}

static snow_status refuse_missing(const dicom_stack *s, double usual,
                                  size_t found) {
    double gap = gap_at(s, found);
    double lost = multiple(gap, usual) - 1;
    const dicom_frame *low = &s->frames[found * s->times];
    const dicom_frame *high = &s->frames[(found + 1) * s->times];
    return snow_fail(
        s->context, SNOW_STATUS_BAD_INPUT,
        "%.0f of its slices %s missing between %s and %s (frames %lld and "
        "%lld), which lie %g mm apart while others lie %g; add %s, or give "
        "--allow-gaps",
        lost, lost > 1 ? "are" : "is", snow_dicom_name(low),
        snow_dicom_name(high), (long long)low->number, (long long)high->number,
        gap, usual, lost > 1 ? "them" : "it");
}

/* The number of slices if the missing ones were there, 0 if the others do not
 * lie on an even grid then, or if it is too large. */
static size_t full_count(const dicom_stack *s, double usual) {
    double first = place_of(s, 0);
    double all = length_of(s);
    double steps = 0, at = 0;
    for (size_t i = 0; i + 1 < s->places; i++) {
        double times = multiple(gap_at(s, i), usual);
        if (!(times >= 1))
            return 0;
        steps += times;
    }
    if (!(steps < most_slices(s)))
        return 0;
    for (size_t i = 0; i + 1 < s->places; i++) {
        double off = place_of(s, i) - first - at * all / steps;
        if (fabs(off) > SAME_GAP * all / steps)
            return 0;
        at += multiple(gap_at(s, i), usual);
    }
    return (size_t)steps + 1;
}

/* Makes a slice of each position, and one without values where one is
 * missing: what lies there is not known. */
static snow_status leave_gaps(dicom_stack *s, double usual, size_t count) {
    size_t n = 0;
    s->slices = snow_allocate_array(s->context, count, sizeof *s->slices);
    if (!s->slices)
        return SNOW_STATUS_NO_MEMORY;
    for (size_t i = 0; i < s->places; i++) {
        size_t next =
            i + 1 < s->places ? (size_t)multiple(gap_at(s, i), usual) : 1;
        s->slices[n++] = (dicom_slice){i, i, 0};
        while (--next)
            s->slices[n++] = (dicom_slice){i, i + 1, NAN};
    }
    s->gap *= (double)(s->places - 1) / (double)(count - 1);
    s->missing = count - s->places;
    s->slice_count = count;
    return SNOW_STATUS_OK;
}

/* The largest snow_dicom_distance of a position from its place on the line from
 * the first to the last at `share` of it; along the line, or only across it. */
static double farthest(const dicom_stack *s, bool beside) {
    const double *a = snow_dicom_position(s, 0),
                 *b = snow_dicom_position(s, s->places - 1);
    double all = length_of(s), most = 0;
    for (size_t i = 0; i < s->places; i++) {
        const double *p = snow_dicom_position(s, i);
        double share = beside ? (place_of(s, i) - place_of(s, 0)) / all
                              : (double)i / (double)(s->places - 1);
        double want[3];
        for (int k = 0; k < 3; k++)
            want[k] = a[k] + share * (b[k] - a[k]);
        double off = snow_dicom_distance(p, want);
        most = off > most || isnan(off) ? off : most;
    }
    return most;
}

/* Makes slices at even distances from the first position to the last, as close
 * as the closest positions. */
static snow_status even_out(dicom_stack *s) {
    double first = place_of(s, 0);
    double all = length_of(s);
    double steps = ceil(all / s->gap_least - 1e-3);
    if (!(steps < most_slices(s)))
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
        while (low + 2 < s->places && place_of(s, low + 1) <= at)
            low++;
        double below = place_of(s, low);
        double weight = (at - below) / gap_at(s, low);
        weight = weight < 1e-9 ? 0 : weight > 1 - 1e-9 ? 1 : weight;
        s->slices[i] = (dicom_slice){low, low + 1, weight};
    }
    return SNOW_STATUS_OK;
}

/* Empties slices that are farther from any position than positions usually are
 * from one another: nothing says that a segment reaches as far. */
static snow_status empty_far(dicom_stack *s) {
    double usual;
    SNOW_TRY(usual_gap(s, &usual));
    for (size_t i = 0; i < s->slice_count; i++) {
        dicom_slice *slice = &s->slices[i];
        double nearer = fmin(slice->weight, 1 - slice->weight);
        if (nearer * gap_at(s, slice->low) > usual)
            slice->weight = NAN;
    }
    return SNOW_STATUS_OK;
}

/* Segments need only have the slices that are not empty. The distance is the
 * given one, or that of the closest two, if all lie on its grid. */
static snow_status space_sparse(dicom_stack *s) {
    const double steps[2] = {fabs(s->frames->depth), s->gap_least};
    for (int i = 0; i < 2; i++) {
        size_t count = steps[i] > 0 ? full_count(s, steps[i]) : 0;
        if (count)
            return count == s->places ? SNOW_STATUS_OK
                                      : leave_gaps(s, steps[i], count);
    }
    SNOW_TRY(even_out(s));
    return empty_far(s);
}

snow_status snow_dicom_space_slices(dicom_stack *s) {
    s->gap = length_of(s) / (double)(s->places - 1);
    s->gap_least = s->gap_most = gap_at(s, 0);
    for (size_t i = 1; i + 1 < s->places; i++) {
        double gap = gap_at(s, i);
        s->gap_least = gap < s->gap_least ? gap : s->gap_least;
        s->gap_most = gap > s->gap_most ? gap : s->gap_most;
    }
    s->given = true;
    if (!s->starts && farthest(s, false) <= EVEN * s->gap)
        return SNOW_STATUS_OK;
    double beside = farthest(s, true);
    if (!(beside <= snow_dicom_smallest_pixel(s->frames) / 2) &&
        !(beside <= EVEN * s->gap_least))
        return snow_fail(s->context, SNOW_STATUS_BAD_INPUT,
                         "its slices are not aligned: one is %g mm off the "
                         "line from the first to the last; open a part of them",
                         beside);
    if (s->starts)
        return space_sparse(s);
    double usual;
    size_t found;
    SNOW_TRY(find_missing(s, &usual, &found));
    if (found == s->places)
        return even_out(s);
    size_t count = s->gaps ? full_count(s, usual) : 0;
    return count ? leave_gaps(s, usual, count)
                 : refuse_missing(s, usual, found);
}
