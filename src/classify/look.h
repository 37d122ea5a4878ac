/* classify/look.h - how a look becomes a transfer function: presets, colour
 * maps and the histogram's say, each drafted as control points. */
#ifndef SNOW_LOOK_H
#define SNOW_LOOK_H

#include "classify/transfer.h"
#include "comm/comm.h"
#include "volume/volume.h"

/* What drafts of our own need at most of each kind. */
#define SNOW_DRAFT_POINTS SNOW_COLORMAP_POINTS

/* A transfer function in the making, in data values.  The points have room for
 * SNOW_DRAFT_POINTS, or as many as are drafted from. */
typedef struct snow_draft {
    const char *name;   /* of the colours, for people */
    const char *reason; /* why these values, for people */
    double low, high;   /* the data values that it is spread over */
    bool flat;          /* for pictures without shading */
    bool log;           /* spread, and to be joined, by logarithms */
    snow_color_point *colors;
    size_t color_count;
    snow_opacity_point *opacities;
    size_t opacity_count;
    snow_opacity_point *gradients;
    size_t gradient_count;
    void *block; /* that they lie in */
} snow_draft;

/* How often a volume's values occur: range, order statistics, histogram. */
typedef struct snow_census {
    const snow_volume *volume;
    snow_comm *comm;  /* the ranks whose parts are counted together; NULL: the
                         part of this one alone */
    uint64_t *counts; /* of each native value of 8 and 16 bit types, from the
                         type's smallest on; NULL for other types */
    uint64_t finite;
    double min, max;     /* of finite data values; NaN when there is none */
    uint64_t at_min;     /* how many have the smallest value */
    snow_volume *sample; /* of a volume that stays in its file: what a sampled
                            pass reads, as one row; NULL: it reads the file */
    bool log; /* values that are not above 0 are left out, and histograms
             have bins that are equal in the logarithm */
} snow_census;

/* Counts the voxels that a volume answers for; with a communicator, which is
 * collective, those of all its ranks' volumes, as if they were one; so does all
 * that is asked of the census later.  Errors: SNOW_NO_MEMORY (on all ranks),
 * those of the transport.  Free with snow_census_free. */
snow_status snow_census_new(const snow_volume *volume, snow_comm *comm,
                            bool log, snow_census *out);

void snow_census_free(snow_census *census);

#define SNOW_QUANTILES_MOST 4

/* All voxels, or so many that the picture of a histogram stays the same: at
 * least 2^24, spread over the volume. */
typedef enum snow_effort { SNOW_EXACT, SNOW_SAMPLED } snow_effort;

/* The data value that is not exceeded by the share `fractions[n]` of the finite
 * voxels (an existing value, no interpolation), for up to SNOW_QUANTILES_MOST
 * shares of 0 to 1.  Errors: SNOW_NO_MEMORY. */
snow_status snow_quantiles(const snow_census *census, snow_effort effort,
                           const double *fractions, size_t count, double *out);

/* A histogram in `bins` equal bins of low..high; what lies outside is left
 * out.  low < high.  `all` is how many values there were, outside included.
 * Errors: those of the transport. */
snow_status snow_count_bins(const snow_census *census, double low, double high,
                            int bins, uint64_t *counts, uint64_t *all);

/* Where the histogram parts background from object. */
typedef struct snow_parting {
    bool constant;     /* fewer than two values: nothing to part */
    double background; /* mean value below the threshold */
    double threshold;
    double object;   /* mean value above it */
    double top;      /* robust largest value */
    double faint;    /* where faint structure starts below the threshold */
    bool with_faint; /* there is such structure, and it is sparse */
    bool solid;      /* the object fills the volume: there is nothing to part */
    double low, high; /* robust ends */
} snow_parting;

/* Reads the histogram.  Errors: SNOW_NO_MEMORY. */
snow_status snow_part_histogram(const snow_census *census, snow_parting *out);

/* The look without any wish.  Errors: SNOW_NO_MEMORY. */
snow_status snow_draft_automatic(const snow_census *census, snow_draft *draft);

/* The draft of points; where they lack colours or opacities, those that the
 * draft has stay.  Errors: SNOW_NO_MEMORY. */
snow_status snow_draft_points(const snow_points *points,
                              const snow_census *census, snow_draft *draft);

/* Smallest to largest finite value, made apart when they are one; on a
 * logarithmic scale above 0. */
void snow_full_range(const snow_census *census, double *low, double *high);

/* snow_transfer_make for the whole of which the volumes of a communicator's
 * ranks are parts; NULL: for one volume.  Collective, errors agreed on. */
snow_status snow_transfer_make_among(snow_comm *comm, const snow_volume *volume,
                                     const snow_look *look,
                                     snow_transfer **out);

/* Whether what it asks for, NULL included, has a gradient opacity; of a preset
 * that there is not, or none. */
bool snow_look_fades(const snow_look *look);

/* Replaces a draft's colours by a map over low..high. */
void snow_draft_colormap(snow_draft *draft, int colormap, double low,
                         double high);

/* low + share * (high - low), for any finite ends: high itself from share 1 on,
 * and never falling as share grows, whatever the rounding. */
double snow_between(double low, double high, double share);

/* The same, on a logarithmic scale where `log` says so (0 < low < high), and
 * back: which share of the way a value is. */
double snow_between_on(bool log, double low, double high, double share);
double snow_share_on(bool log, double low, double high, double value);

#endif
