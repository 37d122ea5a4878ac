/* bench/speed/speed_print.c - the figures of `bench speed`, as text and as
 * JSON.
 *
 * Shares of this machine's bounds are lower estimates, for they count only
 * what a frame cannot do without:
 *
 *   bytes   EA + IA + PA read once; of original and tested all voxels
 *   FLOPs   2 (a multiply and an add) x channels x voxels x
 *             footprint, original, tested: K K p, for p pixels to a voxel's
 *               face as the view shows it: each pixel of a footprint once
 *             sheared: K (g + g g), for g intermediate pixels to a voxel's
 *               side: g filtered along the row, then g g across rows, K taps
 *               each; twice that for high, which has twice the slices
 *
 * Weights, composition, shading and the warp are not counted, and what early
 * termination leaves out is counted as if it were done. */
#include "speed.h"

#include <math.h>
#include <stdio.h>

#ifndef SNOW_BUILD_FLAGS
#define SNOW_BUILD_FLAGS "unknown flags"
#endif

#define PI 3.14159265358979323846

/* Image pixels to the face of a voxel: its area as the camera sees it over
 * that of a pixel (snowglass/view.h gives the pitch).  For upright grids only,
 * as all volumes here are. */
static double pixels_per_voxel(const speed_case *job, int axis) {
    const snow_volume_info *info = snow_volume_get_info(job->volume->volume);
    double square = 0, face = 1;
    double azimuth = 30 * PI / 180, elevation = 20 * PI / 180;
    double back[3] = {sin(azimuth) * cos(elevation), sin(elevation),
                      cos(azimuth) * cos(elevation)};
    for (int i = 0; i < 3; i++) {
        double length = (double)info->dims[i] * info->spacing[i];
        square += length * length;
        face *= i == axis ? 1 : info->spacing[i];
    }
    double pitch = sqrt(square) / job->side; /* 2R over the side */
    return face * back[axis] / (pitch * pitch);
}

static double flops_of(const speed_case *job, const speed_row *row,
                       const speed_result *result) {
    double k = row->way->footprint, taps;
    if (row->way->method == SNOW_METHOD_RAYCAST)
        return 0; /* not known: values are interpolated, not splatted */
    if (row->way->method == SNOW_METHOD_SHEAR_WARP) {
        double g = row->way->quality == SNOW_QUALITY_DRAFT ? 1 : 2;
        double slices = row->way->quality == SNOW_QUALITY_HIGH ? 2 : 1;
        taps = slices * k * (g + g * g);
    } else {
        taps = k * k * pixels_per_voxel(job, row->stats.slice_axis);
    }
    const double voxels = row->way->method == SNOW_METHOD_ORIGINAL
                              ? (double)row->stats.voxels
                              : (double)result->interesting;
    return 2 * (job->color ? 4 : 2) * voxels * taps;
}

static double encoded_bytes(const speed_row *row) {
    return (double)(row->stats.ea_bytes + row->stats.ia_bytes +
                    row->stats.pa_bytes);
}

/* Figures that follow from those measured; NaN where there is none. */
typedef struct figures {
    double per_second, read_share, flop_share, bytes_per_voxel;
    double encode_rate; /* bytes of the volume in a second */
    double against_original, against_table, against_tested;
    double cpu_against_original; /* in processor time, of all threads */
} figures;

/* The row of a baseline with the same kernel; NULL when not measured. */
static const speed_row *baseline(const speed_result *result,
                                 const speed_row *row, snow_method method,
                                 bool tabled) {
    for (int i = 0; i < result->count; i++) {
        const speed_row *other = &result->rows[i];
        if (other->way->method == method && other->way->tabled == tabled &&
            other->way->kernel == row->way->kernel)
            return other;
    }
    return NULL;
}

static double ratio(const speed_row *base, const speed_row *row) {
    return base ? base->median / row->median : NAN;
}

static figures figures_of(const speed_machine *machine, const speed_case *job,
                          const speed_result *result, const speed_row *row) {
    double seconds = 1e-3 * row->median;
    figures out = {.per_second = (double)result->interesting / seconds,
                   .read_share = NAN,
                   .flop_share = NAN,
                   .bytes_per_voxel = NAN,
                   .encode_rate = NAN,
                   .against_table = ratio(
                       baseline(result, row, SNOW_METHOD_ORIGINAL, true), row),
                   .against_tested = ratio(
                       baseline(result, row, SNOW_METHOD_TESTED, false), row)};
    const speed_row *original =
        baseline(result, row, SNOW_METHOD_ORIGINAL, false);
    out.against_original = ratio(original, row);
    out.cpu_against_original = original ? original->cpu / row->cpu : NAN;
    for (int i = 0; i < machine->count; i++) {
        const machine_power *power = &machine->power[i];
        if (power->threads != row->threads)
            continue;
        /* All volumes are of 8 bits, so that voxels are bytes. */
        const double bytes = speed_is_baseline(row->way)
                                 ? (double)row->stats.voxels
                                 : encoded_bytes(row);
        out.read_share = bytes / seconds / power->read_bytes;
        out.flop_share = flops_of(job, row, result) / seconds / power->flops;
    }
    if (!speed_is_baseline(row->way) && row->stats.interesting > 0)
        out.bytes_per_voxel =
            encoded_bytes(row) / (double)row->stats.interesting;
    if (row->encode > 0)
        out.encode_rate = (double)row->stats.voxels / (1e-3 * row->encode);
    return out;
}

/* --- threads -------------------------------------------------------------- */

static const int predicted[] = {8, 16, 64};

/* How many times as fast as one thread so many are at least, if each takes the
 * next item when it has none (Graham 1966): no batch ends later than it would
 * with its work divided evenly and its longest item begun then.  NaN where one
 * thread takes the picture as one item, as by footprint. */
static double predict(const speed_row *one, int threads) {
    const double share = 1.0 / threads, work = one->least - one->serial;
    return one->serial < 0 || one->longest > work / 2
               ? NAN
               : one->least /
                     (one->serial + work * share + one->longest * (1 - share));
}

/* The same as it was measured. */
static double against_one(const speed_result *result, const speed_row *row) {
    for (int i = 0; i < result->count; i++)
        if (result->rows[i].way == row->way && result->rows[i].threads == 1)
            return result->rows[i].median / row->median;
    return NAN;
}

/* --- text ----------------------------------------------------------------- */

/* A number, or a dash in its width. */
static void print_cell(int width, int digits, double value) {
    if (isfinite(value) && value >= 0)
        printf(" %*.*f", width, digits, value);
    else
        printf(" %*s", width, "-");
}

void speed_print_machine(const speed_machine *machine) {
    printf("machine: %s, %d processors; %s\n", machine_processor(),
           snow_processors(), machine_compiler());
    printf("flags: %s; isa %s of %s; load average %.2f\n", SNOW_BUILD_FLAGS,
           snow_isa_used(), snow_isa_found(), machine_load());
    for (int i = 0; i < machine->count; i++)
        printf("%d thread%s: reads %.1f GB/s, %.0f GFLOP/s (%s)\n",
               machine->power[i].threads,
               machine->power[i].threads == 1 ? "" : "s",
               1e-9 * machine->power[i].read_bytes,
               1e-9 * machine->power[i].flops, machine_vectors());
    printf("\nmilliseconds of a frame while the view turns; read, flop: share "
           "of this machine's\nrates; enc: classification and encoding for a "
           "new threshold; orig, table,\ntested: how many times faster than "
           "original, original-table and tested splatting with\nthe same "
           "kernel on one thread\n");
    fflush(stdout);
}

static void print_row(const speed_machine *machine, const speed_case *job,
                      const speed_result *result, const speed_row *row) {
    figures f = figures_of(machine, job, result, row);
    printf("%-24s %-7s %d %3d", row->way->name,
           snow_kernel_name(row->way->kernel), row->way->footprint,
           row->threads);
    print_cell(8, 2, row->median);
    print_cell(8, 2, row->least);
    print_cell(8, 2, row->cpu);
    print_cell(6, 1, 1e3 / row->median);
    print_cell(7, 1, 1e-6 * f.per_second);
    print_cell(5, 1, 100 * f.read_share);
    print_cell(5, 1, 100 * f.flop_share);
    print_cell(6, 2, f.bytes_per_voxel);
    print_cell(7, 2, row->encode);
    print_cell(5, 2, 1e-9 * f.encode_rate);
    print_cell(6, 1, f.against_original);
    print_cell(6, 1, f.against_table);
    print_cell(6, 1, f.against_tested);
    if (row->psnr < 0)
        printf(" %6s", "equal");
    else
        print_cell(6, 1, row->psnr);
    printf(" %8.1g %3d%s\n", row->largest, row->frames,
           row->encoded_frames ? " e" : "");
}

/* What more threads would do of each way, and what those measured did. */
static void print_threads(const speed_result *result) {
    printf("threads                  serial%%  longest    8   16   64  "
           "measured\n");
    for (int i = 0; i < result->count; i++) {
        const speed_row *one = &result->rows[i];
        if (one->threads != 1 || speed_is_baseline(one->way))
            continue;
        printf("%-24s", one->way->name);
        print_cell(7, 1, 100 * one->serial / one->least);
        print_cell(8, 3, one->longest);
        for (int n = 0; n < 3; n++)
            print_cell(4, 1, predict(one, predicted[n]));
        for (int k = 0; k < result->count; k++)
            if (result->rows[k].way == one->way && k != i)
                printf("  %d: %.2f", result->rows[k].threads,
                       against_one(result, &result->rows[k]));
        printf("\n");
    }
}

/* Flushed: a case takes seconds to minutes, and who waits wants to see. */
static void print_text(const speed_machine *machine, const speed_case *job,
                       const speed_result *result) {
    const snow_volume_info *info = snow_volume_get_info(job->volume->volume);
    printf("\n%s %lldx%lldx%lld (%s), %s %s %s, %dx%d, threshold %g: sparse "
           "%.1f %%, %.3f Mvoxel interesting; load %.2f, others %.2f "
           "processors\n",
           job->volume->name, (long long)info->dims[0],
           (long long)info->dims[1], (long long)info->dims[2],
           job->volume->source,
           job->look == SPEED_OPAQUE ? "opaque" : "translucent",
           job->color ? "rgba" : "grey",
           job->shade == SNOW_SHADE_PHONG ? "phong" : "unshaded", job->side,
           job->side, job->threshold, 100 * result->sparse_ratio,
           1e-6 * (double)result->interesting, result->load, result->others);
    printf("way                      kernel  K thr   median      min      cpu  "
           "fr/s Mvox/s read%% flop%% B/vox  enc ms  GB/s   orig  table tested "
           "  PSNR "
           " largest  n\n");
    for (int i = 0; i < result->count; i++)
        print_row(machine, job, result, &result->rows[i]);
    print_threads(result);
    fflush(stdout);
}

/* --- JSON ----------------------------------------------------------------- */

/* null where there is no figure: JSON has no NaN. */
static json_t *number(double value) {
    return isfinite(value) && value >= 0 ? json_real(value) : json_null();
}

json_t *speed_machine_json(const speed_machine *machine) {
    json_t *json = bench_machine();
    json_t *power = json_array();
    json_object_del(json, "threads"); /* that of the tables: always 1 */
    json_object_set_new(json, "processors", json_integer(snow_processors()));
    json_object_set_new(json, "flags", json_string(SNOW_BUILD_FLAGS));
    json_object_set_new(json, "isa_found", json_string(snow_isa_found()));
    json_object_set_new(json, "load_average", number(machine_load()));
    json_object_set_new(json, "vectors", json_string(machine_vectors()));
    for (int i = 0; i < machine->count; i++)
        json_array_append_new(
            power,
            json_pack("{s:i, s:f, s:f}", "threads", machine->power[i].threads,
                      "read_gb_per_s", 1e-9 * machine->power[i].read_bytes,
                      "gflop_per_s", 1e-9 * machine->power[i].flops));
    json_object_set_new(json, "power", power);
    return json;
}

static json_t *case_json(const speed_case *job, const speed_result *result) {
    const snow_volume_info *info = snow_volume_get_info(job->volume->volume);
    return json_pack(
        "{s:s, s:s, s:[I,I,I], s:s, s:s, s:s, s:i, s:f, s:f, s:I, s:o, s:o}",
        "volume", job->volume->name, "source", job->volume->source, "dims",
        (json_int_t)info->dims[0], (json_int_t)info->dims[1],
        (json_int_t)info->dims[2], "look",
        job->look == SPEED_OPAQUE ? "opaque" : "translucent", "colors",
        job->color ? "rgba" : "grey", "shade",
        job->shade == SNOW_SHADE_PHONG ? "phong" : "unshaded", "side",
        job->side, "threshold", job->threshold, "sparse_ratio",
        result->sparse_ratio, "interesting_voxels",
        (json_int_t)result->interesting, "load_average", number(result->load),
        "other_processors", number(result->others));
}

/* Encoding and quality are left out of ways that have none. */
static void add_way(json_t *json, const speed_row *row) {
    const speed_way *way = row->way;
    json_object_set_new(json, "way", json_string(way->name));
    json_object_set_new(json, "method",
                        json_string(bench_method_name(way->method)));
    if (!speed_is_baseline(way))
        json_object_set_new(
            json, "encoding",
            json_string(snow_encoding_name(row->stats.encoding)));
    if (way->method == SNOW_METHOD_SHEAR_WARP ||
        way->method == SNOW_METHOD_RAYCAST)
        json_object_set_new(json, "quality",
                            json_string(snow_quality_name(way->quality)));
    json_object_set_new(json, "kernel",
                        json_string(snow_kernel_name(way->kernel)));
    json_object_set_new(json, "footprint", json_integer(way->footprint));
    json_object_set_new(json, "threads", json_integer(row->threads));
    json_object_set_new(json, "isa",
                        json_string(snow_isa_name(row->stats.isa)));
}

/* "verified" is always true: a row that fails is not printed. */
static json_t *row_json(const speed_machine *machine, const speed_case *job,
                        const speed_result *result, const speed_row *row) {
    figures f = figures_of(machine, job, result, row);
    const struct {
        const char *key;
        double value;
    } values[] = {
        {"median_ms", row->median},
        {"min_ms", row->least},
        {"cpu_ms", row->cpu},
        {"frames_per_second", 1e3 / row->median},
        {"interesting_voxels_per_second", f.per_second},
        {"read_share", f.read_share},
        {"flop_share", f.flop_share},
        {"bytes_per_interesting_voxel", f.bytes_per_voxel},
        {"times_one_thread", against_one(result, row)},
        {"serial_ms", row->serial},
        {"longest_items_ms", row->longest},
        {"predicted_8_threads", predict(row, 8)},
        {"predicted_16_threads", predict(row, 16)},
        {"predicted_64_threads", predict(row, 64)},
        {"encode_ms", row->encode},
        {"encode_gb_per_s", 1e-9 * f.encode_rate},
        {"new_threshold_ms", row->new_threshold},
        {"times_original", f.against_original},
        {"times_original_table", f.against_table},
        {"times_tested", f.against_tested},
        {"cpu_times_original", f.cpu_against_original},
        {"psnr", row->psnr},
        {"largest_difference", row->largest},
    };
    json_t *json = case_json(job, result);
    add_way(json, row);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        json_object_set_new(json, values[i].key, number(values[i].value));
    json_object_set_new(json, "frames", json_integer(row->frames));
    json_object_set_new(json, "frames_encoded",
                        json_integer(row->encoded_frames));
    json_object_set_new(json, "verified", json_true());
    return json;
}

void speed_print_case(const speed_machine *machine, const speed_case *job,
                      const speed_result *result, json_t *list) {
    if (!list) {
        print_text(machine, job, result);
        return;
    }
    for (int i = 0; i < result->count; i++)
        json_array_append_new(list,
                              row_json(machine, job, result, &result->rows[i]));
}
