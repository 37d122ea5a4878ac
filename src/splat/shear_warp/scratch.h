/* splat/shear_warp/scratch.h - what a worker works on, for the templates of
 * this folder. */
#ifndef SNOW_SPLAT_SHEAR_WARP_SCRATCH_H
#define SNOW_SPLAT_SHEAR_WARP_SCRATCH_H

#include "splat/shear_warp/smooth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TARGET_ALSO SNOW_UNWATCHED

/* Constants that are handed on make each kind of tile's loops short.  That is a
 * lot of code: with sanitizers it would take minutes to compile, and a page
 * seconds to load. */
#ifdef VALUE_INLINE /* by the file */
#elif defined(SNOW_SANITIZED) || defined(__wasm__)
#define VALUE_INLINE static __attribute__((unused))
#else
#define VALUE_INLINE static inline __attribute__((always_inline))
#endif

/* What is small, and is called for each row of a tile: there too. */
#if defined(__wasm__) && !defined(SNOW_SANITIZED)
#define VALUE_LEAF static inline __attribute__((always_inline, unused))
#else
#define VALUE_LEAF VALUE_INLINE
#endif

/* Loops over the samples or rows of slabs.  In WebAssembly they are functions
 * of their own: V8, the compiler of Node and Chromium, keeps the variables of
 * huge functions on the stack. */
#if defined(__wasm__) && !defined(SNOW_SANITIZED)
#define VALUE_STAGE static __attribute__((noinline, unused))
#else
#define VALUE_STAGE VALUE_INLINE
#endif

/* Long functions that are called once for a slab or a phase of it: a copy in
 * each kind of tile would gain nothing, and take the compiler three times as
 * long. */
#define VALUE_ONCE static __attribute__((noinline, unused))

/* WebAssembly has no instruction that asks the cache for memory. */
#if defined(__wasm__)
#define VALUE_ASKS 0
#else
#define VALUE_ASKS 1
#endif

/* Rows of a resampled slice's tile: one more on each side, for gradients. */
#define RESAMPLED_ROWS (SNOW_VALUE_ROWS + 2)

/* Phases that are coloured together. */
#define TOGETHER 4

/* A phase of a resampled slice.  Row r of the tile is values[r + 1]. */
typedef struct value_rows {
    int16_t before[32]; /* lanes -1 are read */
    int16_t values[RESAMPLED_ROWS][32];
    int16_t behind[32];
    int16_t across[SNOW_VALUE_ROWS][32]; /* differences along P */
    uint64_t has;                        /* rows of values, from row -1 on */
    uint32_t has_across;
    int resampled; /* that the rows are of */
    bool holes;    /* its voxels, or those beside it along P, have some */
} value_rows;

/* Where the neighbours of a phase's samples are, one voxel on along u, one
 * back, and the same along v: row r of each is at at[n] + 32 r. */
typedef struct value_beside {
    const int16_t *at[4];
    bool holes; /* some may have none */
} value_beside;

/* The samples of a slab, packed. */
#define QUEUE (TOGETHER * SNOW_VALUE_ROWS * SNOW_VALUE_COLUMNS + 64)
typedef struct value_queue {
    int16_t front[QUEUE], back[QUEUE];
    int16_t slopes[6][QUEUE]; /* u, v, p: of the front, of the back */
    int16_t (*border)[QUEUE]; /* [6]: the same of the border of holes, where
                                 samples are lit by it (leans) */
    int16_t from[QUEUE], part[QUEUE]; /* of a slab that is cut, of 32768 */
    int16_t color[4][QUEUE];
    int16_t place[QUEUE]; /* of the opacity in the slab, of 32768 */
    int16_t light[QUEUE], white[QUEUE]; /* factors of the colour, of white */
    int16_t ray[2][QUEUE]; /* perspective: phases from the tile's first cell */
    /* Perspective: what the differences of both resampled slices along u and v
     * lack. */
    int16_t stretch[2][2];
} value_queue;

/* The part of a slab that is inside, for each lane or row, of 32767. */
typedef struct value_cut {
    int16_t from[32], to[32];
    uint32_t some;  /* lanes or rows that have any */
    uint32_t parts; /* and those of them that are not whole */
    bool cuts;
} value_cut;

/* The same for clip planes, for each sample. */
typedef struct value_clip {
    int16_t from[SNOW_VALUE_ROWS][32], to[SNOW_VALUE_ROWS][32];
    uint32_t some[SNOW_VALUE_ROWS];
    bool cuts;
    double front[4], back[4]; /* of snow_value_clip */
    bool flat;                /* a cut face is near */
} value_clip;

/* What a slab of a phase needs, found before its turn. */
typedef struct value_slab {
    uint32_t active[SNOW_VALUE_ROWS]; /* samples that can be seen */
    uint32_t rows;                    /* with such samples */
    value_cut cut[2];                 /* along u and v */
    value_clip clip;
} value_slab;

/* Slabs are looked at so many turns ahead, for their voxels to be in the cache
 * when they are drawn. */
#define AHEAD 2
#define AHEAD_RING 4

typedef struct value_phase {
    uint32_t open[SNOW_VALUE_ROWS]; /* pixels that something shines through */
    uint32_t alive;                 /* rows with such pixels */
    /* Perspective: of its rays, phases from the tile's first cell. */
    int16_t columns[32], line, lines; /* along u; along v, and to the next */
} value_phase;

/* Rows of voxels of a resampled slice that the cache was asked for, from row -1
 * on. */
typedef struct value_asked {
    int resampled;
    uint64_t rows;
} value_asked;
#define ASKED_RING 8
/* Perspective: the cells of a resampled slice under a phase. */
typedef struct value_cells {
    uint32_t cells[SNOW_VALUE_RUNS][SNOW_VALUE_ROWS];
    bool any[SNOW_VALUE_RUNS]; /* else there are none */
    int resampled;
} value_cells;

/* Laid out in a worker's memory behind the planes. */
typedef struct value_scratch {
    value_queue queue;
    value_slab slab[AHEAD_RING][TOGETHER]; /* [number in the list % ring] */
    value_phase phase[SNOW_VALUE_PHASES];
    value_asked asked[ASKED_RING];
    value_cells cells[SNOW_VALUE_PHASES][2]; /* [resampled & 1] */
    float slope[2][2];    /* perspective: snow_value_rays' of the tile */
    value_rows rows[][2]; /* [phase][resampled & 1] */
} value_scratch;

/* Draws phases `first` .. `end` - 1 of slab `n`; whether it has anything. */
typedef bool value_slab_fn(const snow_value_splat *splat, int n, int first,
                           int end, const int tile[2], snow_value_plane *planes,
                           value_scratch *scratch, value_slab *slabs);

/* Behind the rows: the borders of a queue, of some pictures; the slabs of a
 * tile that may be seen. */
#define BORDERS 6
static inline int16_t (*value_borders(const snow_value_splat *splat,
                                      value_scratch *room))[QUEUE] {
    return (int16_t(*)[QUEUE])(void *)&room->rows[splat->phases];
}

static inline int32_t *value_slabs(const snow_value_splat *splat,
                                   value_scratch *scratch) {
    return (int32_t *)(void *)(value_borders(splat, scratch) +
                               (splat->borders ? BORDERS : 0));
}

/* --- places --------------------------------------------------------------- */

/* Lane 0 of a tile along u; row 0 along v: cells. */
static inline int64_t value_tile_column(const snow_value_splat *splat, int x) {
    return splat->first[0] + (int64_t)x * SNOW_VALUE_COLUMNS - 1;
}

static inline int64_t value_tile_row(const snow_value_splat *splat, int y) {
    return splat->first[1] + (int64_t)y * SNOW_VALUE_ROWS;
}

/* The phase `by` samples on along an axis, and how many cells on it is. */
static inline int value_phase_beside(const snow_value_rays *rays, int phase,
                                     int axis, int by, int *cells) {
    int at = rays->cell[phase][axis] + by, count = rays->cells[axis];
    *cells = at < 0 ? -1 : at >= count;
    return phase +
           (by - *cells * count) * (axis == 0 ? rays->middles : rays->line);
}

/* The lanes of a phase of a tile along an axis of a resampled slice. */
static inline const snow_value_lanes *
value_lanes_of(const snow_value_rays *rays, int resampled, int phase, int axis,
               int tile) {
    size_t at = (size_t)resampled * (size_t)rays->phases[axis] +
                rays->spot[phase][axis];
    return rays->lanes[axis] + at * (size_t)rays->tiles[axis] + tile;
}

/* How far a lane is beyond the voxel below it. */
static inline double value_lane_part(const snow_value_lanes *lanes, double step,
                                     int n) {
    double part = lanes->start - floor(lanes->start) + n * step - lanes->at[n];
    return fmin(fmax(part, 0), 1 - 1e-12);
}

/* Whether a tile's window of a resampled slice meets the voxels and their
 * margins. */
static inline bool value_meets(const snow_value_store *s, int64_t column,
                               int64_t row) {
    return column > -32 - s->margin && column < s->columns + s->margin &&
           row > -32 - s->margin && row < s->rows + s->margin;
}

/* A bit for each of 64 rows from `first` on that is one of 0 .. count - 1. */
static inline uint64_t value_rows_within(int64_t first, int64_t count) {
    const int64_t low = first < 0 ? -first : 0, end = count - first;
    if (low > 63 || end <= low)
        return 0;
    return (end > 63 ? ~UINT64_C(0) : (UINT64_C(1) << end) - 1) & ~UINT64_C(0)
                                                                      << low;
}

/* Asks the cache for 33 voxels from a column on of the rows of a slice that are
 * set, from row `first` on. */
static inline void value_ask_rows(const snow_value_store *s, int64_t slice,
                                  int64_t first, int64_t column,
                                  uint64_t rows) {
    const bool quantized = s->kind == SNOW_VALUE_QUANTIZED;
    const int64_t margin = quantized ? s->margin : 0;
    const int64_t *at = s->in_place ? NULL : snow_value_at(s, slice) + first;
    const size_t size = s->kind == SNOW_VALUE_BYTES ? 1 : 2;
    const unsigned char *voxels =
        (quantized ? (const unsigned char *)s->values : s->stored) +
        column * (int64_t)size;
    const size_t step = s->in_place ? (size_t)s->row_step * size : 0;
    if (s->in_place)
        voxels += (slice * s->slice_step + first * s->row_step) * (int64_t)size;
    rows &= value_rows_within(first + margin, s->rows + 2 * margin);
    for (; rows; rows &= rows - 1) {
        int bit = __builtin_ctzll(rows);
        const unsigned char *row =
            voxels + (at ? (size_t)at[bit] * size : (size_t)bit * step);
        __builtin_prefetch(row);
        if (((uintptr_t)row & 63) + 33 * size > 64)
            __builtin_prefetch(row + 32 * size);
    }
}

/* Words and shift of a window of 32 columns from `column` on. */
typedef struct value_window {
    size_t word, row; /* of the masks */
    int shift;
} value_window;

static inline value_window value_window_of(const snow_value_store *s,
                                           int64_t column, int64_t row) {
    size_t bit = (size_t)(column + s->margin + 32);
    return (value_window){bit / 32, (size_t)(row + s->margin + 32),
                          (int)(bit % 32)};
}

/* The slabs with cells that no interval hides, for some phases of a tile: the
 * indices of their front resampled slices, front to back.  They are
 * found as far as they are needed, since rays may end before the last. */
typedef struct value_list {
    const snow_value_splat *splat;
    int first, end; /* phases */
    const int *tile;
    int64_t begin[2]; /* cell of the masks that a place of 0 is in */
    int64_t last[2];  /* cell of the masks */
    int resampled;    /* the next one that is looked at */
    unsigned before;  /* intervals that do not hide it */
    int count;
    int32_t *slabs;
} value_list;

value_list value_list_begin(const snow_value_splat *splat, int first, int end,
                            const int tile[2], int32_t *slabs);

/* Finds so many of them, and up to eight more, or all. */
void value_list_find(value_list *list, int count);

/* Whether a window has cells with a hole, in all rows that gradients reach. */
static inline bool value_has_holes(const snow_value_store *s, int64_t slice,
                                   value_window w) {
    if (slice >= s->slices) /* of another part, which gradients need */
        return false;
    const uint64_t *coarse =
        s->coarse + snow_value_coarse_at(s, s->interval_count, w.word, slice);
    const size_t next = (size_t)s->slices * s->coarse_words;
    size_t first = (w.row - 1) / SNOW_VALUE_COARSE;
    size_t last = (w.row + SNOW_VALUE_ROWS) / SNOW_VALUE_COARSE;
    uint64_t any = 0;
    for (size_t n = first; n <= last; n++)
        any |= (coarse[n / 64] | coarse[n / 64 + next]) >> n % 64;
    return any & 1;
}

/* --- arithmetic ----------------------------------------------------------- */

static inline int value_saturate(int x) {
    return x < INT16_MIN ? INT16_MIN : x > INT16_MAX ? INT16_MAX : x;
}

static inline int value_between(int a, int b, int weight) {
    return a + ((value_saturate(b - a) * weight + 0x4000) >> 15);
}

/* Between two slices: half way, or from there toward one of them. */
static inline int value_toward(int a, int b, int toward) {
    return value_between((a + b + 1) >> 1, toward > 0 ? b : a, abs(toward));
}

/* --- labels --------------------------------------------------------------- */

/* Packs the visible samples of a phase of slab `n` from number `count` on, with
 * their colours and gradients. */
int snow_value_collect_labels(const snow_value_splat *splat, int n, int phase,
                              const int tile[2], float slope[2][2],
                              value_slab *slab, value_queue *queue, int count,
                              bool sloped);

/* --- holes ---------------------------------------------------------------- */

/* The weight of a voxel that is there. */
#define SNOW_VALUE_FULL 16384

/* Sums of values by weights to values, where less than all are there. */
void snow_value_weigh(int16_t values[32], const int16_t weights[32],
                      uint32_t lanes);

/* Differences of 32 quantized values' neighbours on both sides. */
void snow_value_slopes(const int16_t *before, const int16_t *here,
                       const int16_t *after, int16_t out[32]);

/* A row of resampled slice `resampled`, from voxel (column, row) on, and of
 * those beside it along P. */
typedef struct value_sides {
    const snow_value_splat *splat;
    int resampled;
    int64_t column, row;
    int16_t weights[2];            /* along u and v */
    const double *at;              /* the place, for kernel bspline */
    double step;                   /* perspective: of lanes along u */
    const snow_value_lanes *lanes; /* perspective: u's, instead */
    const int16_t *here, *before, *after;
} value_sides;

/* Differences along P of the lanes that have a hole near. */
void snow_value_bridge(const value_sides *sides, uint32_t lanes,
                       int16_t *across);

/* How the border of what is there leans, of the active samples of a phase of a
 * slab, from number `count` on; `holes`: a resampled slice has some near. */
void snow_value_lean(const value_sample *first, const value_slab *slab,
                     const bool holes[2], value_queue *queue, int count);

/* The alpha of `share` times the length; exact for the least alpha where the
 * table is faint. */
static inline float value_lengthen(const snow_value_table *table, float alpha,
                                   float share) {
    return table->faint ? -expm1f(share * log1pf(-alpha))
                        : 1 - powf(1 - alpha, share);
}

/* --- gradient opacity ----------------------------------------------------- */

/* The colours and alpha of 32 samples, by their gradients and the places of
 * their opacity between front and back, of 32768. */
void snow_value_fade_colors(const snow_value_fade *fade,
                            const snow_value_table *table,
                            int16_t slopes[3][32], const int16_t *front,
                            const int16_t *back, const int16_t places[32],
                            int16_t color[4][32]);

/* --- cuts ----------------------------------------------------------------- */

/* The parts of a slab within low .. high, for 32 lanes whose ends on both
 * resampled slices are at front[0] + n front[1] and back[0] + n back[1]. */
void snow_value_cut(const double front[2], const double back[2], double low,
                    double high, value_cut *out);

/* The parts of a slab within all clip planes, for a tile whose first sample is
 * at these places, u, v and slice, of both resampled slices; [3] is how far
 * lanes and rows are apart. */
void snow_value_clip(const snow_value_splat *splat, const double front[4],
                     const double back[4], value_clip *out);

/* The light of the samples of some phases of a slab gives way to that of cut
 * faces. */
void snow_value_flatten(const snow_value_splat *splat, const value_slab *slabs,
                        int phases, value_queue *queue);

/* Where 32 samples from `n` on meet a surface, of 32768 of a slab. */
void snow_value_meet(const snow_value_surface *surface,
                     const value_queue *queue, int n, bool cuts,
                     int16_t places[32]);

/* The samples of a tile that are the part's in slab `n`: lanes along u, or
 * rows. */
uint32_t snow_value_own_lanes(const snow_value_splat *splat, int n, int phase,
                              const int tile[2], int axis);

/* Alpha and colours of the samples of slabs that are cut. */
void snow_value_shorten(const snow_value_table *table, value_queue *queue,
                        int count, int channels);

/* --- instruction sets ----------------------------------------------------- */

/* By [whether there are four channels][gradients are wanted][perspective]. */
extern snow_value_tile_fn *const snow_value_tiles_scalar[2][2][2];
extern snow_value_tile_fn *const snow_value_tiles_avx2[2][2][2];
extern snow_value_tile_fn *const snow_value_tiles_avx512[2][2][2];
extern snow_value_tile_fn *const snow_value_tiles_v128[2][2][2];
/* By [reduction - SNOW_VALUE_LARGEST][perspective]. */
extern snow_value_tile_fn *const snow_value_projections_scalar[3][2];
extern snow_value_tile_fn *const snow_value_projections_avx2[3][2];
extern snow_value_tile_fn *const snow_value_projections_avx512[3][2];
extern snow_value_tile_fn *const snow_value_projections_v128[3][2];

#endif
