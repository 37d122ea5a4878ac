/* transfer/labels.c - the look of volumes whose values are the numbers of
 * things: a colour each.
 *
 * A file may say so, or whoever opens it.  Else whole numbers are labels that
 * have few values, and of which enough voxels beside the background equal their
 * six neighbours.  Of a part those neighbours count that it has.  Quantities
 * have few values too, where they are coarse: their neighbours differ by one
 * step, which those of many labels do not.
 *
 * An overlay is more often labels than a volume alone, and these may be lesions
 * of a few voxels: so are all overlays of five values, and of more, unless
 * they are counts, whose neighbours differ by 1, or noise, whose neighbours
 * differ.  A volume alone of 0 and one value is a mask, but not a single
 * image. */
#include "transfer/walk.h"

#include <math.h>
#include <string.h>

/* Found by trying regions of 32^3 to 128^3 voxels, single voxels and coarse
 * heaps: regions have an even share of 0.4 to 0.9, noise none. */
#define FEW 64
#define EVEN 0.4
#define STEPPED 0.95
#define STEPS 6

/* Values of an overlay, and of a mask. */
#define OVERLAID 5
#define MASK 2

/* The most labels; and about how many voxels are compared with neighbours. */
#define MOST 4096
#define COMPARED (INT64_C(1) << 24)

/* Two passes over the voxels, for the values, and for neighbours. */
typedef struct label_scan {
    bool compares;
    double values[MOST]; /* rising */
    double seen[MOST];   /* one of them at each hash; NaN: none */
    size_t count;
    uint64_t many;        /* whether there are more values */
    double background;    /* its voxels are not compared */
    uint64_t even, all;   /* voxels */
    uint64_t next, apart; /* neighbours that differ: by a step, in all */
    /* Neighbours that are no background either: they are alike, differ, differ
     * by 1. */
    uint64_t alike, unlike, counted;
    int64_t step;  /* of the rows whose voxels are compared */
    bool labelled; /* of the file */
    snow_label *labels;
    size_t label_count;
} label_scan;

/* --- which volumes -------------------------------------------------------- */

static size_t place_of(const double *values, size_t count, double value) {
    size_t low = 0;
    while (low < count) {
        size_t middle = low + (count - low) / 2;
        if (values[middle] < value)
            low = middle + 1;
        else
            count = middle;
    }
    return low;
}

static void add_value(label_scan *s, double value) {
    uint64_t hash;
    memcpy(&hash, &value, sizeof hash);
    double *seen = &s->seen[hash * UINT64_C(0x9e3779b97f4a7c15) >> 52];
    if (value == *seen)
        return;
    *seen = value;
    size_t at = place_of(s->values, s->count, value);
    if (at < s->count && s->values[at] == value)
        return;
    if (s->count == MOST) {
        s->many = 1;
        return;
    }
    memmove(s->values + at + 1, s->values + at,
            (s->count - at) * sizeof *s->values);
    s->values[at] = value;
    s->count++;
}

/* Row y of slice z of the grid, or another one where it is not at hand. */
static const double *read_row(const snow_volume *v, const snow_extent *e,
                              int64_t y, int64_t z, double *scratch,
                              const double *other) {
    const int64_t *dims = v->info.dims;
    int64_t row = y - e->stored[1], slice = z - e->stored[2];
    if (row < 0 || row >= dims[1] || slice < 0 || slice >= dims[2])
        return other;
    snow_volume_stored(v, (slice * dims[1] + row) * dims[0], (size_t)dims[0],
                       scratch);
    for (int64_t x = 0; x < dims[0]; x++)
        scratch[x] = v->info.slope * scratch[x] + v->info.intercept;
    return scratch;
}

/* A neighbour without a value does not count. */
static void compare_voxel(label_scan *s, double value, const double near[6]) {
    size_t at = place_of(s->values, s->count, value);
    bool even = true;
    for (int n = 0; n < 6; n++) {
        s->alike += near[n] == value;
        if (near[n] == value || isnan(near[n]))
            continue;
        s->unlike += near[n] != s->background;
        s->counted += near[n] != s->background && fabs(near[n] - value) == 1;
        size_t other = place_of(s->values, s->count, near[n]);
        s->next += at + 1 == other || other + 1 == at;
        s->apart++;
        even = false;
    }
    s->even += even;
    s->all++;
}

static void compare_row(label_scan *s, const double *rows[5], int64_t width,
                        int64_t first, int64_t end) {
    const double *here = rows[0];
    for (int64_t x = first; x < end; x++) {
        const double near[6] = {here[x - (x > 0)], here[x + (x + 1 < width)],
                                rows[1][x],        rows[2][x],
                                rows[3][x],        rows[4][x]};
        if (!isnan(here[x]) && here[x] != s->background)
            compare_voxel(s, here[x], near);
    }
}

static void scan_row(label_scan *s, const snow_volume *v, const snow_extent *e,
                     int64_t y, int64_t z, double *scratch) {
    const int64_t width = v->info.dims[0];
    const int64_t first = e->first[0] - e->stored[0], end = first + e->count[0];
    const double *rows[5];
    if (s->many || (s->compares && (z * e->dims[1] + y) % s->step != 0))
        return;
    rows[0] = read_row(v, e, y, z, scratch, NULL);
    for (int64_t x = first; x < end && !s->compares; x++)
        if (isfinite(rows[0][x]))
            add_value(s, rows[0][x]);
    for (int n = 1; n < 5 && s->compares; n++)
        rows[n] =
            read_row(v, e, y + (n == 1) - (n == 2), z + (n == 3) - (n == 4),
                     scratch + n * width, rows[0]);
    if (s->compares)
        compare_row(s, rows, width, first, end);
}

static snow_status scan_slab(const snow_volume *slab, label_scan *s) {
    snow_extent e;
    double *scratch = NULL;
    snow_volume_find_extent(slab, &e);
    SNOW_TRY(SNOW_RESERVE(slab->context, scratch, 0, 5 * slab->info.dims[0]));
    for (int64_t z = e.first[2]; z < e.first[2] + e.count[2]; z++)
        for (int64_t y = e.first[1]; y < e.first[1] + e.count[1]; y++)
            scan_row(s, slab, &e, y, z, scratch);
    snow_release(slab->context, scratch);
    s->labelled |= slab->labelled;
    if (!slab->label_count || s->labels)
        return SNOW_STATUS_OK;
    SNOW_TRY(SNOW_RESERVE(slab->context, s->labels, 0, slab->label_count));
    memcpy(s->labels, slab->labels, slab->label_count * sizeof *s->labels);
    s->label_count = slab->label_count;
    return SNOW_STATUS_OK;
}

/* Up to the slab with too many values. */
static snow_status scan_slabs(const snow_volume *volume, label_scan *s) {
    const snow_slab_cut cut = {.ghosts = 1};
    const snow_volume *slab;
    snow_slabs slabs;
    snow_slabs_open(volume, &cut, &slabs);
    snow_status status = snow_slabs_next(&slabs, &slab);
    while (status == SNOW_STATUS_OK && slab) {
        status = scan_slab(slab, s);
        if (status != SNOW_STATUS_OK || s->many)
            break;
        status = snow_slabs_next(&slabs, &slab);
    }
    snow_slabs_close(&slabs);
    return status;
}

/* Collective: the values of all ranks, one by one. */
static snow_status join_values(snow_comm *comm, label_scan *s) {
    double *all = s->values, own[MOST];
    size_t count = s->count;
    memcpy(own, s->values, count * sizeof *own);
    for (s->count = 0; s->count <= MOST; s->count++) {
        double last = s->count ? all[s->count - 1] : -INFINITY;
        size_t at = place_of(own, count, last);
        at += at < count && own[at] == last;
        double next = at < count ? own[at] : INFINITY;
        SNOW_TRY(snow_comm_reduce_doubles(comm, &next, 1, SNOW_REDUCE_MIN));
        if (isinf(next))
            return SNOW_STATUS_OK;
        if (s->count < MOST)
            all[s->count] = next;
    }
    s->many = 1;
    return SNOW_STATUS_OK;
}

/* Collective: what the first rank's file says is known to all. */
static snow_status join_labels(snow_comm *comm, snow_context *context,
                               label_scan *s) {
    int64_t known[2] = {s->labelled, (int64_t)s->label_count};
    SNOW_TRY(snow_comm_broadcast(comm, known, sizeof known, 0));
    snow_status status = SNOW_STATUS_OK;
    if (snow_comm_rank(comm) != 0)
        status = SNOW_RESERVE(context, s->labels, 0, known[1] + 1);
    SNOW_TRY(snow_comm_agree_status(comm, status));
    s->labelled = known[0];
    s->label_count = (size_t)known[1];
    return s->label_count
               ? snow_comm_broadcast(comm, s->labels,
                                     s->label_count * sizeof *s->labels, 0)
               : SNOW_STATUS_OK;
}

static snow_status join_scans(const snow_histogram *histogram, label_scan *s) {
    uint64_t counts[8] = {s->even, s->all,   s->next,   s->apart,
                          s->many, s->alike, s->unlike, s->counted};
    SNOW_TRY(snow_histogram_sum(histogram, counts, 8));
    s->even = counts[0];
    s->all = counts[1];
    s->next = counts[2];
    s->apart = counts[3];
    s->many = counts[4];
    s->alike = counts[5];
    s->unlike = counts[6];
    s->counted = counts[7];
    if (!s->compares && !s->many)
        SNOW_TRY(join_values(histogram->comm, s));
    return join_labels(histogram->comm, histogram->volume->context, s);
}

static snow_status pass(const snow_histogram *histogram, bool compares,
                        label_scan *s) {
    s->compares = compares;
    snow_status status = scan_slabs(histogram->volume, s);
    if (histogram->comm) {
        SNOW_TRY(snow_comm_agree_status(histogram->comm, status));
        status = join_scans(histogram, s);
    }
    return status;
}

static bool is_few(const label_scan *s) {
    return !s->many && s->count <= FEW &&
           (double)s->even >= EVEN * (double)s->all &&
           (s->count <= STEPS || (double)s->next < STEPPED * (double)s->apart);
}

/* The same of an overlay, and of two values. */
static bool is_mask(const snow_histogram *histogram, const snow_look *look,
                    const label_scan *s) {
    if (s->many || s->count > FEW || !(histogram->min >= 0))
        return false;
    return (look->overlay ? s->count <= OVERLAID
                          : s->count <= MASK && s->values[0] == 0) ||
           (look->overlay && s->unlike <= s->alike &&
            (!s->unlike || 2 * s->counted < s->unlike));
}

/* A single image: few greys are a drawing, and its sides no surface.  One row
 * is no image: the values of all steps of a movie are such a list. */
static bool is_flat(const snow_volume *volume) {
    snow_extent whole;
    snow_volume_find_extent(volume, &whole);
    return (whole.dims[0] == 1) + (whole.dims[1] == 1) + (whole.dims[2] == 1) ==
           1;
}

/* A file's labels are known after a pass. */
static snow_status scan(const snow_histogram *histogram, bool asked,
                        label_scan *s) {
    const snow_volume *volume = histogram->volume;
    const bool counted = histogram->counts != NULL;
    snow_extent whole;
    snow_volume_find_extent(volume, &whole);
    s->background = fmax(histogram->min, 0);
    memset(s->seen, 0xff, sizeof s->seen);
    if (counted) {
        /* The values of types of 8 and 16 bits, which are counted. */
        for (int n = 0; n < SNOW_DIGITS && !s->many; n++) {
            double value;
            if (snow_stored_values_nth(histogram, n, &value))
                add_value(s, value);
        }
    } else
        SNOW_TRY(pass(histogram, false, s));
    s->step = whole.dims[0] * whole.dims[1] * whole.dims[2] / COMPARED + 1;
    if (!s->many && s->count <= FEW)
        return pass(histogram, true, s);
    s->step = INT64_MAX;
    if (counted &&
        (asked || volume->labelled || volume->stream || histogram->comm))
        return pass(histogram, true, s);
    return SNOW_STATUS_OK;
}

/* --- how they look -------------------------------------------------------- */

static snow_label label_of(const label_scan *s, size_t n) {
    snow_label label = {.value = s->values[n], .color = {-1, 0, 0, -1}};
    for (size_t i = 0; i < s->label_count; i++)
        if (s->labels[i].value == label.value)
            label = s->labels[i];
    if (label.color[0] < 0) {
        /* By the golden angle: neighbours differ, and few are alike. */
        double turns = label.value * 0.61803398874989485 + 0.5;
        double hue = 6 * (turns - floor(turns));
        double least = fmod(fabs(label.value), 3) == 0 ? 0.35 : 0.15;
        for (int c = 0; c < 3; c++) {
            double way = fmod(hue + 6 - 2 * c, 6);
            double share = fmin(fmax(2 - fmin(way, 6 - way), 0), 1);
            label.color[c] = least + (0.92 - least) * share;
        }
    }
    if (label.color[3] < 0)
        label.color[3] = 1;
    /* The background. */
    size_t zero = place_of(s->values, s->count, 0);
    bool with_zero = zero < s->count && s->values[zero] == 0;
    if (label.value == 0 || (n == 0 && !s->label_count && !with_zero))
        label.color[3] = 0;
    return label;
}

/* The opacity that is asked for; what is hidden stays so unless it is named. */
static double asked_opacity(const snow_look *look, const snow_label *label) {
    const snow_opacity_point *points = look->opacities;
    size_t n = 0;
    while (n < look->opacity_count && points[n].value <= label->value)
        n++;
    if (n > 0 && points[n - 1].value == label->value)
        return points[n - 1].opacity;
    if (label->color[3] == 0 || !look->opacity_count)
        return label->color[3];
    if (n == 0 || n == look->opacity_count)
        return points[n - (n > 0)].opacity;
    double share = (label->value - points[n - 1].value) /
                   (points[n].value - points[n - 1].value);
    return points[n - 1].opacity +
           share * (points[n].opacity - points[n - 1].opacity);
}

/* Those of a list have its colours. */
static void set_colors(const snow_look *look, snow_label *labels,
                       size_t count) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];
    size_t listed =
        look->colormap ? snow_colormap_list(look->colormap, points) : 0;
    for (size_t n = 0; n < count; n++)
        for (size_t i = 0; i < listed; i++)
            if (points[i].value == labels[n].value) {
                labels[n].color[0] = points[i].red;
                labels[n].color[1] = points[i].green;
                labels[n].color[2] = points[i].blue;
            }
}

/* Steps half-way between labels. */
static void place_points(snow_transfer_builder *b) {
    const snow_label *labels = b->labels;
    for (size_t n = 0; n < 2 * b->label_count; n++) {
        size_t at = n / 2, beside = n % 2 ? at + 1 : at - 1;
        double value = labels[at].value + (n % 2 ? 0.5 : -0.5);
        if (beside < b->label_count)
            value = (labels[at].value + labels[beside].value) / 2;
        const double *color = labels[at].color;
        b->colors[n] = (snow_color_point){value, color[0], color[1], color[2]};
        b->opacities[n] = (snow_opacity_point){value, color[3]};
    }
    b->color_count = b->opacity_count = 2 * b->label_count;
    b->low = labels[0].value;
    b->high = labels[b->label_count - 1].value;
}

static const char *reason_of(const label_scan *s, const snow_look *look,
                             bool asked) {
    if (asked || s->labelled)
        return s->labelled ? "of the file" : "labels";
    if (look->overlay)
        return "few whole numbers; the look hot (--overlay-look) shows values";
    return is_few(s) ? "few whole numbers, in regions"
                     : "0 and one value; --preset linear shows values";
}

static snow_status build(snow_context *context, const label_scan *s,
                         const snow_look *look, bool asked, bool flat,
                         snow_transfer_builder *b) {
    SNOW_TRY(SNOW_RESERVE(context, b->labels, 0, s->count));
    b->label_count = s->count;
    for (size_t n = 0; n < s->count; n++) {
        b->labels[n] = label_of(s, n);
        b->labels[n].color[3] = asked_opacity(look, &b->labels[n]);
    }
    set_colors(look, b->labels, s->count);
    SNOW_TRY(snow_transfer_builder_reserve(context, 2 * s->count, 2 * s->count,
                                           0, b));
    place_points(b);
    b->name = "labels";
    b->preset = "labels";
    b->reason = reason_of(s, look, asked);
    b->unshaded = flat;
    return SNOW_STATUS_OK;
}

static snow_status fail_labels(const snow_volume *volume, const label_scan *s,
                               bool fractions) {
    if (s->many)
        return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                         "labels: the volume has more than %d values; take "
                         "another preset",
                         MOST);
    return snow_fail(volume->context, SNOW_STATUS_BAD_USAGE,
                     "labels: these are two whole numbers or more, and the "
                     "volume has %s; take another preset",
                     fractions ? "fractions" : "one value");
}

snow_status snow_transfer_builder_labels(const snow_histogram *histogram,
                                         const snow_look *look, bool asked,
                                         snow_transfer_builder *builder) {
    const snow_volume *volume = histogram->volume;
    snow_context *context = volume->context;
    const bool integers = volume->info.type < SNOW_TYPE_FLOAT32;
    const bool whole = integers || !histogram->fractions;
    if (!integers && !volume->info.whole && !asked && !look->overlay &&
        (!volume->labelled || histogram->comm))
        return SNOW_STATUS_OK;
    label_scan *s = snow_allocate_clear(context, sizeof *s);
    snow_status status = s ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    if (histogram->comm)
        status = snow_comm_agree_status(histogram->comm, status);
    if (status == SNOW_STATUS_OK && whole)
        status = scan(histogram, asked, s);
    if (status == SNOW_STATUS_OK) {
        bool can = whole && !s->many && s->count >= 2;
        bool measured =
            volume->info.estimate ||
            snow_are_hounsfield(&volume->info, histogram->min, histogram->max);
        bool found = is_few(s) || is_mask(histogram, look, s);
        bool flat = is_flat(volume);
        bool may = !measured && (look->overlay || !flat);
        if (can && (asked || s->labelled || (found && may)))
            status = build(context, s, look, asked, flat, builder);
        else if (asked)
            status = fail_labels(volume, s, !whole);
    }
    if (s)
        snow_release(context, s->labels);
    snow_release(context, s);
    return status;
}
