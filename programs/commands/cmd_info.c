/* cmd_info.c - the verb info: geometry, type, statistics and histogram of a
 * volume, and the share of voxels that a threshold leaves out. */
#include "commands/commands.h"
#include "commands/first.h"
#include "commands/info_list.h"
#include "commands/info_volume.h"
#include "commands/world.h"
#include "run/log.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define ROWS 16  /* bins of the histogram as text: half a screen */
#define BINS 256 /* bins of the histogram as JSON */
#define BAR 40   /* columns of the longest bar */

/* The thresholds of the paper; --threshold replaces them by one. */
static const double paper_thresholds[] = {0, 10, 30};

/* A volume and all that is printed about it. */
typedef struct facts {
    const options *opts;
    const snow_volume *volume;
    const snow_volume_info *info;
    const snow_transfer *transfer;
    snow_volume_statistics measures;
    double thresholds[3], ratios[3];
    size_t threshold_count;
    const char *patient; /* NULL: not requested, or not in the file */
} facts;

/* Everything is computed before the first line is printed, so that a failure
 * prints nothing. */
static snow_status gather_facts(facts *f) {
    const options *opts = f->opts;
    f->info = snow_volume_get_info(f->volume);
    f->thresholds[0] = opts->threshold;
    f->threshold_count = 1;
    if (opts->threshold < 0) {
        memcpy(f->thresholds, paper_thresholds, sizeof paper_thresholds);
        f->threshold_count = 3;
    }
    snow_volume_statistics_init(&f->measures);
    snow_status status = snow_volume_get_statistics(f->volume, &f->measures);
    for (size_t i = 0; i < f->threshold_count && status == SNOW_STATUS_OK; i++)
        status = snow_transfer_sparse_ratio(f->transfer, f->volume,
                                            f->thresholds[i], &f->ratios[i]);
    return status;
}

/* --- text ----------------------------------------------------------------- */

/* Names of a file, as messages print them: their control characters could forge
 * lines. */
static void print_name(const char *name) {
    for (; *name; name++)
        putchar((unsigned char)*name < ' ' || *name == 127 ? '?' : *name);
}

/* How many values the vectors of a file have, and which of them these are;
 * their names. */
static void print_components(const facts *f) {
    const options *opts = f->opts;
    const snow_volume_info *info = f->info;
    const bool named = *info->channel[0].name && info->channels < 2;
    char which[80];
    if (info->components < 2)
        return;
    if (info->magnitude)
        snprintf(which, sizeof which, "the magnitude");
    else if (named)
        snprintf(which, sizeof which, "component ");
    else if (opts->component)
        snprintf(which, sizeof which, "component %.20s", opts->component);
    else
        snprintf(which, sizeof which, "component %" PRId64, opts->channel);
    printf("%-14s%" PRId64 " (these values: %s", "components", info->components,
           which);
    print_name(named ? info->quantity : "");
    printf(")\n");
    for (int n = 0; named && n < SNOW_CHANNELS_MAX && n < info->components;
         n++) {
        printf("%-14s%d  ", "", n);
        print_name(info->channel[n].name);
        printf("\n");
    }
    if (named && info->components > SNOW_CHANNELS_MAX)
        printf("%-14s...\n", "");
}

/* The number of the channel that was read. */
static int64_t channel_of(const options *opts) {
    static const char letters[] = "xyzw";
    const char *given = opts->component;
    const char *letter =
        given && *given && !given[1] ? strchr(letters, *given) : NULL;
    if (letter)
        return letter - letters;
    return given ? strtoll(given, NULL, 10) : opts->channel;
}

static unsigned byte_of(double share) {
    return (unsigned)(255 * share + 0.5);
}

/* Those that a file shows together, and which one these are. */
static void print_channels(const facts *f) {
    const snow_volume_info *info = f->info;
    if (info->channels < 2)
        return;
    printf("%-14s%" PRId64 " (these values: channel %" PRId64 ")\n", "channels",
           info->channels, channel_of(f->opts));
    for (int n = 0; n < SNOW_CHANNELS_MAX && n < info->channels; n++) {
        const snow_channel *one = &info->channel[n];
        printf("%-14s%d", "", n);
        if (*one->name)
            printf("  ");
        print_name(one->name);
        if (one->color[0] >= 0)
            printf("  #%02x%02x%02x", byte_of(one->color[0]),
                   byte_of(one->color[1]), byte_of(one->color[2]));
        if (one->window[0] < one->window[1])
            printf("  %g .. %g", one->window[0], one->window[1]);
        printf("%s\n", one->shown ? "" : "  (not shown)");
    }
}

/* The steps, and the physical time of this one. */
static void print_times(const facts *f) {
    const snow_volume_info *info = f->info;
    if (info->times > 1)
        printf("%-14s%" PRId64 " (these values: step %" PRId64 ")\n", "times",
               info->times, info->time);
    char date[128] = "";
    if (strstr(info->time_unit, " since "))
        snow_time_text(info, "%Y-%m-%d %H:%M:%S", date, sizeof date);
    if (!isnan(info->time_value))
        printf("%-14s%.10g%s%s%s%s%s%s%s\n", "time", info->time_value,
               *info->time_unit ? " " : "", info->time_unit, *date ? ": " : "",
               date, *info->calendar ? " (" : "", info->calendar,
               *info->calendar ? " calendar)" : "");
}

/* The geometry of the file; scale and time steps only if they matter. */
static void print_geometry(const facts *f) {
    const snow_volume_info own = world_in_units(f->info), *info = &own;
    char letters[4], units[64];
    world_units(info, units, sizeof units);
    printf("%-14s%s\n", "format", info->format);
    printf("%-14s%" PRId64 " x %" PRId64 " x %" PRId64 " (%" PRId64
           " voxels)\n",
           "dims", info->dims[0], info->dims[1], info->dims[2],
           f->measures.voxels);
    printf("%-14s%s\n", "type", snow_type_name(info->type));
    const bool both = *info->quantity && *info->value_unit;
    if (*info->quantity || *info->value_unit)
        printf("%-14s%s%s%s%s\n", "quantity", info->quantity, both ? " (" : "",
               info->value_unit, both ? ")" : "");
    printf("%-14s%g x %g x %g%s\n", "spacing", info->spacing[0],
           info->spacing[1], info->spacing[2], units);
    if (info->medical) {
        info_axis_letters(info, letters);
        printf("%-14s%s (the sides that x, y and z point to)\n", "axes",
               letters);
    }
    for (int i = 0; i < 3; i++)
        printf("%-14s%12g %12g %12g %12g\n", i ? "" : "matrix",
               info->matrix[i][0], info->matrix[i][1], info->matrix[i][2],
               info->matrix[i][3]);
    print_times(f);
    print_components(f);
    print_channels(f);
    if (info->slope < 1 || info->slope > 1 || info->intercept < 0 ||
        info->intercept > 0)
        printf("%-14svalue = %g * stored + %g\n", "scale", info->slope,
               info->intercept);
    if (*info->storage)
        printf("%-14s%s\n", "storage", info->storage);
    if (*info->modality)
        printf("%-14s%s\n", "modality", info->modality);
    if (*info->description)
        printf("%-14s%s\n", *info->modality ? "series" : "long name",
               info->description);
    if (info->window[0] < info->window[1])
        printf("%-14s%g at level %g (%g .. %g)\n", "window",
               info->window[1] - info->window[0],
               (info->window[0] + info->window[1]) / 2, info->window[0],
               info->window[1]);
    if (f->opts->patient)
        printf("%-14s%s\n", "patient", f->patient ? f->patient : "no name");
}

/* The look and the sparse ratios are those that render would use with the same
 * options, so that info can be tried first. */
static void print_values(const facts *f) {
    const snow_volume_statistics *m = &f->measures;
    printf("%-14s%" PRId64 " of %" PRId64 " voxels\n", "finite", m->finite,
           m->voxels);
    if (m->finite > 0)
        printf("%-14s%g .. %g, mean %g%s\n", "values", m->min, m->max,
               m->sum / (double)m->finite,
               f->info->hounsfield ? " (Hounsfield units)" : "");
    printf("%-14s%s\n", "look", snow_transfer_description(f->transfer));
    if (strcmp(f->opts->mode, "over") != 0)
        printf("%-14s%s\n", "mode", f->opts->mode);
    const snow_label *label;
    for (size_t i = 0; (label = snow_transfer_label(f->transfer, i)); i++)
        printf("%-14s%.10g  #%02x%02x%02x  %s%s\n", i ? "" : "labels",
               label->value, byte_of(label->color[0]), byte_of(label->color[1]),
               byte_of(label->color[2]), label->name,
               label->color[3] > 0 ? "" : " (not shown)");
    for (size_t i = 0; i < f->threshold_count; i++)
        printf("%-14s%5.1f %% at threshold %g\n", i ? "" : "sparse ratio",
               100 * f->ratios[i], f->thresholds[i]);
}

/* Returns false if there are no values to count. */
static bool count_values(const facts *f, size_t bins, uint64_t *counts) {
    return f->measures.finite > 0 && f->measures.min < f->measures.max &&
           snow_volume_histogram(f->volume, f->measures.min, f->measures.max,
                                 bins, counts) == SNOW_STATUS_OK;
}

/* Bars grow with the logarithm: there may be a hundred times more air than
 * anything else. */
static void print_histogram(const facts *f) {
    uint64_t counts[ROWS], most = 1;
    if (!count_values(f, ROWS, counts))
        return;
    for (size_t i = 0; i < ROWS; i++)
        most = counts[i] > most ? counts[i] : most;
    double step = (f->measures.max - f->measures.min) / ROWS;
    printf("histogram     from         voxels  (bars: logarithmic)\n");
    for (size_t i = 0; i < ROWS; i++) {
        char bar[BAR + 1];
        double share = log1p((double)counts[i]) / log1p((double)most);
        size_t length = (size_t)(BAR * share);
        memset(bar, '#', length);
        bar[length] = '\0';
        printf("%18.6g %14" PRIu64 "%s%s\n", f->measures.min + (double)i * step,
               counts[i], length ? "  " : "", bar);
    }
}

/* --- JSON ----------------------------------------------------------------- */

/* min and max are null if no voxel is finite. */
static void set_values(json_t *object, const snow_volume_statistics *m) {
    json_object_set_new(object, "voxels", json_integer(m->voxels));
    json_object_set_new(object, "finite", json_integer(m->finite));
    json_object_set_new(object, "min", json_number(m->min));
    json_object_set_new(object, "max", json_number(m->max));
    json_object_set_new(object, "sum", json_number(m->sum));
    json_object_set_new(object, "wsum", json_number(m->wsum));
}

/* Null if all values are equal or none is finite: the bins would have no
 * width. */
static json_t *histogram_json(const facts *f) {
    uint64_t counts[BINS];
    if (!count_values(f, BINS, counts))
        return json_null();
    json_t *list = json_array();
    for (size_t i = 0; i < BINS; i++)
        json_array_append_new(list, json_integer((json_int_t)counts[i]));
    json_t *object = json_object();
    json_object_set_new(object, "low", json_number(f->measures.min));
    json_object_set_new(object, "high", json_number(f->measures.max));
    json_object_set_new(object, "counts", list);
    return object;
}

/* Ratios are 0 to 1 here and percent in the text. */
static json_t *sparse_json(const facts *f) {
    json_t *list = json_array();
    for (size_t i = 0; i < f->threshold_count; i++) {
        json_t *row = json_object();
        json_object_set_new(row, "threshold", json_number(f->thresholds[i]));
        json_object_set_new(row, "ratio", json_number(f->ratios[i]));
        json_array_append_new(list, row);
    }
    return list;
}

static json_t *labels_json(const facts *f) {
    json_t *list = json_array();
    const snow_label *label;
    for (size_t i = 0; (label = snow_transfer_label(f->transfer, i)); i++) {
        json_t *row = json_object();
        json_object_set_new(row, "value", json_number(label->value));
        json_object_set_new(row, "name", json_string(label->name));
        json_object_set_new(row, "color", json_vector(label->color, 3));
        json_object_set_new(row, "opacity", json_number(label->color[3]));
        json_array_append_new(list, row);
    }
    return list;
}

static int report_json(const facts *f) {
    json_t *object = json_object();
    info_set_geometry(object, f->info);
    if (f->patient)
        json_object_set_new(object, "patient", json_string(f->patient));
    set_values(object, &f->measures);
    json_object_set_new(object, "mode", json_string(f->opts->mode));
    json_object_set_new(object, "look",
                        json_string(snow_transfer_description(f->transfer)));
    json_object_set_new(object, "labels", labels_json(f));
    json_object_set_new(object, "sparse_ratio", sparse_json(f));
    json_object_set_new(object, "histogram", histogram_json(f));
    return print_json(object);
}

static int report_text(const facts *f) {
    print_geometry(f);
    print_values(f);
    print_histogram(f);
    return finish_stdout();
}

/* No picture is made, but the look and the sparse ratio are those of the first
 * picture. */
int cmd_info(const options *given) {
    static options seen; /* large */
    const options *opts = &seen;
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    snow_transfer *transfer = NULL;
    seen = *given;
    if (opts->operand_count == 0)
        return fail_usage("info: an operand is missing; give snowglass info "
                          "INPUT...");
    int done = check_look(opts);
    if (done == CONTINUE && info_is_list(opts))
        return info_list(opts);
    if (done == CONTINUE)
        done = open_context(opts, &context);
    if (done == CONTINUE)
        done = info_open(context, opts, opts->operands[0], NULL, &volume);
    if (done == CONTINUE)
        first_take(&seen, snow_volume_get_info(volume));
    if (done == CONTINUE)
        done = open_look(context, opts, volume, &transfer);
    if (done == CONTINUE) {
        facts f = {.opts = opts, .volume = volume, .transfer = transfer};
        if (opts->patient && *snow_volume_patient(volume))
            f.patient = snow_volume_patient(volume);
        snow_status status = gather_facts(&f);
        if (status != SNOW_STATUS_OK)
            done = fail_status(context, status);
        else
            done = opts->json ? report_json(&f) : report_text(&f);
    }
    snow_transfer_free(transfer);
    snow_volume_close(volume);
    snow_context_free(context);
    return done;
}
