/* transfer/look.h - how a look becomes a transfer function: presets, colour
 * maps and the histogram, each as control points under construction. */
#ifndef SNOW_TRANSFER_LOOK_H
#define SNOW_TRANSFER_LOOK_H

#include "comm/comm.h"
#include "transfer/scale.h"
#include "transfer/transfer.h"
#include "volume/volume.h"

/* The most points of each kind that presets and automatic looks need. */
#define SNOW_TRANSFER_BUILDER_POINTS SNOW_COLORMAP_POINTS_MAX

/* A transfer function under construction, in data values.  There is memory for
 * SNOW_TRANSFER_BUILDER_POINTS points, or as many as the source has. */
typedef struct snow_transfer_builder {
    const char *name;     /* of the colours, for messages */
    const char *reason;   /* why these values, for messages */
    const char *preset;   /* that was chosen; NULL: none */
    const char *colormap; /* that gives the colours; NULL: they are there */
    char range_note[64];  /* how the range was chosen, for messages; or "" */
    double low, high;     /* the range of data values */
    bool unshaded;        /* for pictures without shading */
    bool slice;           /* one slice, which has no surfaces to shade */
    snow_scale scale;     /* on which points are joined */
    bool around_0;        /* half of the points stays at 0 */
    snow_color_point *colors;
    size_t color_count;
    snow_opacity_point *opacities;
    size_t opacity_count;
    snow_opacity_point *gradients;
    size_t gradient_count;
    void *block;        /* the memory of the points */
    snow_label *labels; /* whose colours these are; NULL: of no labels */
    size_t label_count;
} snow_transfer_builder;

/* Room for points. */
snow_status snow_transfer_builder_reserve(snow_context *context, size_t colors,
                                          size_t opacities, size_t gradients,
                                          snow_transfer_builder *builder);

/* How much of a volume's values has to be known, in rising order. */
typedef enum snow_histogram_need {
    SNOW_NEED_NOTHING, /* no voxel is read */
    SNOW_NEED_SIGN,    /* `min` where it is not below 0; else a value that is */
    SNOW_NEED_RANGE,   /* `finite` as 0 or not, `min` and `max` */
    SNOW_NEED_COUNTS   /* all */
} snow_histogram_need;

/* How often a volume's values occur: range, order statistics, histogram. */
typedef struct snow_histogram {
    snow_histogram_need need; /* what is known */
    const snow_volume *volume;
    snow_comm *comm;  /* the ranks whose parts are counted together; NULL: this
                         part alone */
    uint64_t *counts; /* of each native value of 8 and 16 bit types, from the
                         type's smallest on; NULL for other types */
    uint64_t finite;
    double min, max;     /* of finite data values; NaN if there are none */
    uint64_t at_min;     /* number of voxels with the smallest value */
    snow_volume *sample; /* for a volume that stays in its file: the voxels of a
                            sampled pass, as one row; NULL: it reads the file */
    snow_scale scale;  /* of the bins; logarithms ignore what is not above 0 */
    uint64_t dropped;  /* voxels that these ignore, where all are counted */
    bool fractions;    /* values of floats that are no whole numbers */
    bool masked;       /* a mask has left out voxels */
    bool clipped;      /* clip planes have */
    bool had_negative; /* values, before a mask or planes */
} snow_histogram;

/* Counts the voxels that a volume is responsible for.  With a communicator
 * (collective) counts those of all ranks' volumes, as if they were one; the
 * other functions do the same.  Errors: SNOW_STATUS_NO_MEMORY (on all ranks),
 * those of the transport.  Free with snow_histogram_free. */
snow_status snow_histogram_new(const snow_volume *volume, snow_comm *comm,
                               snow_scale scale, snow_histogram_need need,
                               snow_histogram *out);

void snow_histogram_free(snow_histogram *histogram);

#define SNOW_QUANTILES_MOST 4

/* All voxels, or a sample large enough that the plot of a histogram stays the
 * same: at least 2^24, spread over the volume. */
typedef enum snow_histogram_mode {
    SNOW_HISTOGRAM_EXACT,
    SNOW_HISTOGRAM_SAMPLED
} snow_histogram_mode;

/* The data value that is not exceeded by the share `fractions[n]` of the finite
 * voxels (an existing value, no interpolation), for up to SNOW_QUANTILES_MOST
 * shares of 0 to 1.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_quantiles(const snow_histogram *histogram,
                           snow_histogram_mode histogram_mode,
                           const double *fractions, size_t count, double *out);

/* Counts in `bins` equal bins of low..high; values outside are ignored.  low <
 * high.  `all` is the number of values, including those outside.  Errors: those
 * of the transport. */
snow_status snow_count_bins(const snow_histogram *histogram, double low,
                            double high, int bins, uint64_t *counts,
                            uint64_t *all);

/* The split of the histogram into background and object. */
typedef struct snow_histogram_split {
    bool constant;     /* fewer than two values: no split */
    double background; /* mean value below the threshold */
    double threshold;
    double object;     /* mean value above it */
    double top;        /* robust largest value */
    double faint;      /* where faint structure starts below the threshold */
    bool with_faint;   /* there is such structure, and it is sparse */
    bool fills_volume; /* the object fills the volume: no split */
    double low, high;  /* robust ends */
    bool narrowed;     /* by a window */
} snow_histogram_split;

/* Computes the split, of the values in a window where that is not NULL.
 * Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_histogram_split_at(const snow_histogram *histogram,
                                    const double *window,
                                    snow_histogram_split *out);

/* The automatic look, of which `look` says whether it may have any range.
 * Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_transfer_builder_automatic(const snow_histogram *histogram,
                                            const snow_look *look,
                                            snow_transfer_builder *builder);

/* The look of labels; the builder stays empty for a volume without labels,
 * unless it is asked for.  Opacities of the look are those of its labels.
 * Errors: SNOW_STATUS_NO_MEMORY, SNOW_STATUS_BAD_USAGE (too many labels,
 * fractions). */
snow_status snow_transfer_builder_labels(const snow_histogram *histogram,
                                         const snow_look *look, bool asked,
                                         snow_transfer_builder *builder);

/* What differs in the automatic look of a dose, and of an overlay of values:
 * PET in SUV, statistics of both signs, or the colours of hot.  Errors: those
 * of snow_count_bins. */
snow_status snow_transfer_builder_overlay(const snow_histogram *histogram,
                                          const snow_look *look,
                                          snow_transfer_builder *builder);

/* Appends a point; its value is raised to that of the point before it, if
 * lower. */
void snow_transfer_builder_add_opacity(snow_transfer_builder *builder,
                                       double value, double opacity);

/* Builds from points; if they lack colours or opacities, the builder's stay.
 * Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_transfer_builder_points(const snow_look *points,
                                         const snow_histogram *histogram,
                                         snow_transfer_builder *builder);

/* The value at a share of low..high on the builder's scale; around 0, where
 * that is within, half of the shares are below 0 and half above. */
double snow_transfer_builder_place(const snow_transfer_builder *builder,
                                   double low, double high, double share);

/* Whether a volume is one slice, or a few large ones, which are drawn as one.
 */
bool snow_is_slice(const snow_volume *volume);

/* Whether values have fractions, where a field may be. */
bool snow_is_field(const snow_histogram *histogram);

/* Whether they are measures, all of which a slice shows: those of a field, or
 * with a unit. */
bool snow_are_measures(const snow_histogram *histogram);

/* Whether they are below 0, but for a few, and rise to a background.  Errors:
 * SNOW_STATUS_NO_MEMORY, those of the transport. */
snow_status snow_is_field_below_0(const snow_histogram *histogram,
                                  bool *is_below);

/* Whether a field has values of both signs around 0 that matter, as velocities
 * and charges have; *reach gets how far, but for a few. */
snow_status snow_is_signed_field(const snow_histogram *histogram,
                                 bool *is_signed, double *reach);

/* Whether floats with fractions, with robust ends, are those of a scan. Errors:
 * SNOW_STATUS_NO_MEMORY, those of the transport. */
snow_status snow_is_scan(const snow_histogram *histogram, double low,
                         double high, bool is_signed, bool *is_scan);

/* Rounds all values to what a line reports. */
void snow_transfer_builder_round(snow_transfer_builder *builder);

/* Smallest to largest finite value, separated if they are equal; above 0 on a
 * logarithmic scale. */
void snow_full_range(const snow_histogram *histogram, double *low,
                     double *high);

/* Returns whether a look is the preset of labels; and whether it leaves all to
 * the volume, but opacities perhaps, and gradients'. */
bool snow_look_is_of_labels(const snow_look *look);
bool snow_look_is_free(const snow_look *look);

/* Returns whether it gives neither a range nor a scale. */
bool snow_look_is_unranged(const snow_look *look);

/* Returns whether labels can have what it asks for: opacities, those of
 * gradients, and a list of colours. */
bool snow_look_suits_labels(const snow_look *look);

/* The slopes that a look may have on a volume (transfer.h); NULL: on one that
 * has no labels. */
int snow_look_slopes(const snow_look *look, const snow_volume_info *info);

/* From the end of the background to the brightest value of the object. */
snow_status snow_object_range(const snow_histogram *histogram, double *low,
                              double *high);

/* The window of the file, unless it has none, or none for these values; *is:
 * it has.  Else all values of low..high but a few far off, of slices up to 1 %,
 * of CT from -1024 on; of the smallest values of CT those of lungs.  Both leave
 * a note.
 * Errors: those of snow_count_bins. */
snow_status snow_window_of(const snow_histogram *histogram,
                           snow_transfer_builder *builder, double *low,
                           double *high, bool *is);
snow_status snow_robust_range(const snow_histogram *histogram, snow_range range,
                              double *low, double *high,
                              snow_transfer_builder *builder);

/* Slices of a PET; a picture that was made of them has one. */
bool snow_is_pet(const snow_volume_info *info);

/* The same, but of the values above the noise of a background; of a PET from 0
 * to all but its highest. */
snow_status snow_signal_range(const snow_histogram *histogram, double *low,
                              double *high, snow_transfer_builder *builder);

/* The low end of a range; of CT at least -1024, since padding is lower. */
double snow_hounsfield_floor(const snow_histogram *histogram, double low);

/* "grey 72..213; opacity 0 at 72, 0.4 at 213 (from the histogram)", for
 * snow_transfer_describe. */
void snow_transfer_builder_describe(const snow_transfer_builder *builder,
                                    const snow_look *look,
                                    snow_transfer *transfer);

/* Where the symmetric logarithms of a look begin: as asked, or at about a
 * thousandth of the largest magnitude. */
void snow_transfer_builder_symlog(snow_histogram *histogram,
                                  const snow_look *look,
                                  snow_transfer_builder *builder);

/* Points of a list of colours at data values, of which there are at most
 * SNOW_COLORMAP_POINTS_MAX.  Their number; 0: the text is something else. */
size_t snow_colormap_list(const char *text, snow_color_point *points);

/* Replaces the colours by a map over low..high. */
void snow_transfer_builder_colormap(snow_transfer_builder *builder,
                                    const char *name, double low, double high);

/* "reversed": colours of whatever gives them, what is at t between the first
 * and the last of them at 1 - t. */
bool snow_colormap_is_reversed(const char *name);
void snow_transfer_builder_reverse(snow_transfer_builder *builder);

#endif
