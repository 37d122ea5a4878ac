/* formats/cf/wrf.c - the grid of WRF (Skamarock et al. 2019, NCAR/TN-556+STR;
 * "WRF Users' Guide", list of fields), by names of dimensions and attributes of
 * the file:
 *
 *     DX, DY       metres between mass points; MAP_PROJ 6 of input: degrees
 *     Times        a date in 19 letters for each step
 *     PH + PHB     geopotential of the levels between mass points; / 9.81: m
 *     T, P, PH     perturbations
 */
#include "formats/cf/model.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What WRF divides geopotentials by (share/module_model_constants.F). */
#define GRAVITY 9.81

#define MINUTES "minutes since "

/* --- the time ------------------------------------------------------------- */

/* Days of the Gregorian calendar; years begin in March, so that the leap day
 * is the last. */
static int64_t days_of(int year, int month, int day) {
    const int64_t y = year - (month < 3), m = (month + 9) % 12;
    return y * 365 + y / 4 - y / 100 + y / 400 + (m * 306 + 5) / 10 + day;
}

/* Minutes of "2005-08-28_06:30:00", which has just these letters. */
static bool read_date(const char *text, double *minutes) {
    static const char form[] = "0000-00-00_00:00:00";
    static const int most[] = {9999, 12, 31, 23, 59, 59};
    int fields[6] = {0}, n = 0;
    for (size_t i = 0; i < sizeof form; i++) {
        const bool digit = text[i] >= '0' && text[i] <= '9';
        if (form[i] == '0' ? !digit : text[i] != form[i])
            return false;
        if (digit)
            fields[n] = 10 * fields[n] + text[i] - '0';
        else
            n++;
    }
    for (int i = 0; i < 6; i++)
        if (fields[i] > most[i] || (i < 3 && fields[i] < 1))
            return false;
    *minutes = 1440.0 * (double)days_of(fields[0], fields[1], fields[2]) +
               60 * fields[3] + fields[4] + fields[5] / 60.0;
    return true;
}

/* Counts from the beginning of the run, which all of its files name. */
static void take_time(const cf_file *file, snow_volume_info *info) {
    char letters[20], begin[20] = "1970-01-01_00:00:00";
    double now, first = 0;
    cf_attribute start;
    if (!isnan(info->time_value) || !*file->axis[3] ||
        !file->letters(file->user, "Times", info->time, letters))
        return;
    if (!read_date(letters, &now)) {
        snow_notify(file->context,
                    "Times of step %lld, \"%s\", is no date: when it is, is "
                    "not known",
                    (long long)info->time, letters);
        return;
    }
    if ((file->attribute(file->user, "SIMULATION_START_DATE", &start) ||
         file->attribute(file->user, "START_DATE", &start)) &&
        read_date(start.text, &first))
        memcpy(begin, start.text, sizeof begin);
    else
        read_date(begin, &first);
    info->time_value = now - first;
    begin[10] = ' ';
    snprintf(info->time_unit, sizeof info->time_unit, MINUTES "%s", begin);
}

/* --- heights -------------------------------------------------------------- */

/* Geopotentials of a box, of which there is one more along z than levels: PH
 * and PHB of the step, and PHB of the first step of the file. */
typedef struct heights {
    snow_volume *part[3];
    int64_t dims[3];
} heights;

static void close_heights(heights *h) {
    if (h->part[2] != h->part[1])
        snow_volume_close(h->part[2]);
    snow_volume_close(h->part[1]);
    snow_volume_close(h->part[0]);
}

/* Reads so many of them in the box x, y of the options. */
static snow_status open_heights(const cf_file *file, int parts,
                                const snow_volume_options *options,
                                heights *out) {
    static const char *const names[] = {"PH", "PHB", "PHB"};
    snow_volume_options own = *options;
    own.dataset = own.component = NULL;
    own.channel = 0;
    own.each_time = true; /* no notes of other steps */
    memset(own.crop[2], 0, sizeof own.crop[2]);
    *out = (heights){{NULL, NULL, NULL}, {0}};
    snow_status status = SNOW_STATUS_OK;
    for (int i = 0; i < parts && status == SNOW_STATUS_OK; i++) {
        snow_volume_info info = snow_volume_info_default("netcdf");
        own.time = i < 2 ? own.time : 0;
        if (i == 2 && !out->part[1]->info.time) {
            out->part[2] = out->part[1];
            break;
        }
        status = file->read(file->user, names[i], &own, &info, &out->part[i]);
        if (status == SNOW_STATUS_OK && i &&
            memcmp(out->dims, out->part[i]->info.dims, sizeof out->dims) != 0)
            status = snow_fail(file->context, SNOW_STATUS_BAD_INPUT,
                               "PH and PHB have different sizes");
        if (status == SNOW_STATUS_OK)
            memcpy(out->dims, out->part[i]->info.dims, sizeof out->dims);
    }
    return status;
}

/* Height of a column at one of the levels between mass points. */
static double height_at(const heights *h, int part, int64_t column, int64_t z) {
    const snow_volume *v = h->part[part];
    const double stored =
        snow_volume_native(v, z * h->dims[0] * h->dims[1] + column);
    return (v->info.slope * stored + v->info.intercept) / GRAVITY;
}

/* The same at a mass point. */
static double mass_height(const heights *h, int part, int64_t column,
                          int64_t z) {
    return (height_at(h, part, column, z) + height_at(h, part, column, z + 1)) /
           2;
}

/* The mean heights of mass points on each level, and `base`, those of PHB in
 * the first step; the most by which one is away from the mean, and the lowest
 * and highest of all by that PHB. */
static void measure(const heights *h, double *mean, double *base, double *away,
                    double ends[2]) {
    const int64_t columns = h->dims[0] * h->dims[1];
    *away = 0;
    ends[0] = INFINITY;
    ends[1] = -INFINITY;
    for (int64_t z = 0; z + 1 < h->dims[2]; z++) {
        double sums[2] = {0, 0}, least = INFINITY, most = -INFINITY;
        for (int64_t i = 0; i < columns; i++) {
            const double all =
                             mass_height(h, 0, i, z) + mass_height(h, 1, i, z),
                         first = mass_height(h, 2, i, z);
            sums[0] += all;
            sums[1] += first;
            least = fmin(least, all);
            most = fmax(most, all);
            ends[0] = fmin(ends[0], first);
            ends[1] = fmax(ends[1], first);
        }
        mean[z] = sums[0] / (double)columns;
        base[z] = sums[1] / (double)columns;
        *away = fmax(*away, fmax(most - mean[z], mean[z] - least));
    }
}

/* The grid is made of rounded heights, since those of PHB change a little
 * between steps and files where nests feed back, and a series has one grid. */
static void round_heights(double *base, int64_t count, double ends[2]) {
    double step = INFINITY;
    for (int64_t i = 1; i < count; i++)
        step = fmin(step, fabs(base[i] - base[i - 1]));
    if (!(step > 0) || !isfinite(step))
        return;
    const double unit = pow(10, floor(log10(step) - 0.5));
    for (int64_t i = 0; i < count; i++)
        base[i] = unit * floor(base[i] / unit + 0.5);
    ends[0] = unit * floor(ends[0] / unit);
    ends[1] = unit * ceil(ends[1] / unit);
}

/* Even heights for columns: as many as resampled levels have. */
static void plan_columns(const cf_axis *levels, const double ends[2],
                         snow_volume_info *info, cf_axis *z, cf_model *out) {
    double step = fabs(levels->step);
    for (int64_t i = 1; i < info->dims[2]; i++)
        step = fmin(step,
                    fabs(levels->coordinates[i] - levels->coordinates[i - 1]));
    const double most = 8 * (double)info->dims[2],
                 wanted = ceil((ends[1] - ends[0]) / step) + 1;
    const int64_t count = (int64_t)fmin(fmax(wanted, 2), most);
    out->levels = info->dims[2];
    out->low = ends[0];
    out->step = (ends[1] - ends[0]) / (double)(count - 1);
    *z = (cf_axis){.given = true,
                   .even = true,
                   .first = out->low,
                   .step = out->step,
                   .unit = "m"};
    info->dims[2] = count;
}

/* Places the levels; `rows` has room for two numbers of each. */
static void place_levels(const cf_file *file, const heights *h, double *rows,
                         const snow_volume_options *options,
                         snow_volume_info *info, cf_axis *z, cf_model *out) {
    const int64_t count = info->dims[2];
    double ends[2], away;
    cf_attributes says;
    cf_axis levels;
    snow_cf_attributes_begin(&says);
    memcpy(says.units, "m", 2);
    measure(h, rows + count, rows, &away, ends);
    round_heights(rows, count, ends);
    snow_cf_measure(rows, count, &says, &levels);
    if (!levels.uneven && !levels.even)
        return;
    if (options->vertical && !strcmp(options->vertical, "height") &&
        ends[1] > ends[0]) {
        plan_columns(&levels, ends, info, z, out);
        return;
    }
    *z = levels;
    if (snow_uneven_fits(rows + count, count))
        z->moved = rows + count;
    if (away >= 0.5)
        snow_notify(
            file->context,
            "levels lie at their mean heights, from which columns depart "
            "by up to %.0f m; --vertical height shows each column's own",
            away);
}

static snow_status take_heights(const cf_file *file,
                                const snow_volume_options *options,
                                snow_volume_info *info, cf_axis *z,
                                cf_model *out) {
    snow_context *context = file->context;
    snow_volume_options whole = *options;
    heights h;
    if (file->axes_of(file->user, "PH") < 3 ||
        file->axes_of(file->user, "PHB") < 3)
        return SNOW_STATUS_OK;
    memset(whole.crop, 0, sizeof whole.crop);
    snow_status status = open_heights(file, 3, &whole, &h);
    const bool fit = status == SNOW_STATUS_OK && info->dims[2] > 1 &&
                     h.dims[2] == info->dims[2] + 1;
    double *rows = fit ? snow_allocate_array(
                             context, 2 * (uint64_t)info->dims[2], sizeof *rows)
                       : NULL;
    if (fit && !rows)
        status = SNOW_STATUS_NO_MEMORY;
    if (rows) {
        place_levels(file, &h, rows, options, info, z, out);
        if (z->coordinates != rows)
            snow_release(context, rows);
    }
    close_heights(&h);
    return status == SNOW_STATUS_OK
               ? status
               : snow_fail_within(context, status, "the heights of its levels");
}

/* --- columns -------------------------------------------------------------- */

/* A column of `count` levels at heights that rise: linear between them, the
 * nearest to the ground and to the top, nothing beyond. */
static void fill_column(const cf_model *model, const double *at,
                        const double *values, double ground, double top,
                        int64_t first, int64_t count, int64_t stride,
                        float *out) {
    const int64_t last = model->levels - 1;
    int64_t k = 0;
    for (int64_t i = 0; i < count; i++) {
        const double z = model->low + model->step * (double)(first + i);
        while (k < last && at[k + 1] <= z)
            k++;
        const double up =
            k < last ? fmax(0, (z - at[k]) / (at[k + 1] - at[k])) : 0;
        double value = values[k];
        if (up > 0)
            value += (values[k + 1] - values[k]) * up;
        out[i * stride] = z >= ground && z <= top ? (float)value : NAN;
    }
}

static void fill_columns(const cf_model *model, const heights *h,
                         const snow_volume *from, int64_t first, double *rows,
                         snow_volume *to) {
    const int64_t *dims = to->info.dims, columns = dims[0] * dims[1];
    double *at = rows, *values = rows + model->levels;
    for (int64_t c = 0; c < columns; c++) {
        double low = height_at(h, 0, c, 0) + height_at(h, 1, c, 0), high = low;
        const double ground = low;
        for (int64_t k = 0; k < model->levels; k++, low = high) {
            high = height_at(h, 0, c, k + 1) + height_at(h, 1, c, k + 1);
            at[k] = (low + high) / 2;
            values[k] =
                from->info.slope * snow_volume_native(from, k * columns + c) +
                from->info.intercept;
        }
        fill_column(model, at, values, ground, high, first, dims[2], columns,
                    (float *)to->owned + c);
    }
}

static snow_status make_columns(const cf_model *model,
                                const snow_volume_options *options,
                                const snow_volume *from, int64_t first,
                                snow_volume *to) {
    heights h;
    double *rows = NULL;
    snow_status status = open_heights(model->file, 2, options, &h);
    if (status == SNOW_STATUS_OK &&
        (h.dims[0] != from->info.dims[0] || h.dims[1] != from->info.dims[1] ||
         h.dims[2] != model->levels + 1))
        status = snow_fail(to->context, SNOW_STATUS_BAD_INPUT,
                           "PH and its levels do not fit together");
    if (status == SNOW_STATUS_OK) {
        rows = snow_allocate_array(to->context, 2 * (uint64_t)model->levels,
                                   sizeof *rows);
        status = rows ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    }
    if (rows)
        fill_columns(model, &h, from, first, rows, to);
    snow_release(to->context, rows);
    close_heights(&h);
    return status;
}

snow_status snow_model_columns(void *user, const snow_volume_options *options,
                               snow_volume_info *info, snow_volume **out) {
    const cf_reading *r = user;
    snow_volume_options own = *options;
    snow_volume_info native = *info;
    snow_volume *from = NULL, *to = NULL;
    snow_region box;
    info->type = SNOW_TYPE_FLOAT32;
    SNOW_TRY(snow_region_lay_out(r->context, options, info, &box));
    for (int i = 0; i < 3; i++) {
        own.crop[i][0] = i < 2 ? box.first[i] : 0;
        own.crop[i][1] = i < 2 ? box.first[i] + box.count[i] : r->model->levels;
    }
    native.dims[2] = r->model->levels;
    SNOW_TRY(r->read(r->user, &own, &native, out ? &from : NULL));
    info->slope = 1;
    info->intercept = 0;
    if (!out)
        return SNOW_STATUS_OK;
    snow_status status = snow_volume_new(r->context, info, &to);
    if (status == SNOW_STATUS_OK)
        status = make_columns(r->model, &own, from, box.first[2], to);
    snow_volume_close(from);
    return snow_volume_give(status, to, out);
}

/* --- the grid ------------------------------------------------------------- */

/* Whether a dimension is one of the model's, and lies between its points. */
static bool is_axis(const char *name, const char *usual, bool *staggered) {
    const size_t length = strlen(usual);
    *staggered = !strcmp(name + (strlen(name) < length ? 0 : length), "_stag");
    return !strncmp(name, usual, length) && (*staggered || !name[length]);
}

static void note_perturbation(const cf_file *file, const char *variable) {
    static const char *const table[][3] = {
        {"T", "300 K", "potential temperature"},
        {"THM", "300 K", "moist potential temperature"},
        {"P", "PB", "pressure"},
        {"PH", "PHB", "geopotential"}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (!strcmp(variable, table[i][0]))
            snow_notify(file->context,
                        "%s is a perturbation: + %s is the %s; it is shown as "
                        "it is stored",
                        variable, table[i][1], table[i][2]);
}

static void take_spacing(const cf_file *file, cf_axis axes[2]) {
    static const char *const names[] = {"DX", "DY"};
    cf_attribute d, kind;
    const bool flat = file->attribute(file->user, "MAP_PROJ", &kind) &&
                      kind.numbers[0].value == 6;
    for (int i = 0; i < 2; i++) {
        if (axes[i].given || !file->attribute(file->user, names[i], &d) ||
            !(d.numbers[0].value > 0) || !isfinite(d.numbers[0].value))
            continue;
        const double step = d.numbers[0].value;
        axes[i].given = axes[i].even = true;
        axes[i].first = 0;
        axes[i].step = step;
        /* The input of a global run has them in degrees. */
        snprintf(axes[i].unit, sizeof axes[i].unit, "%s",
                 flat && step < 10 ? "degrees" : "m");
    }
}

static snow_status take_wrf(const cf_file *file, const char *variable,
                            const snow_volume_options *options,
                            snow_volume_info *info, cf_axis axes[4],
                            cf_model *out) {
    static const char *const usual[] = {"west_east", "south_north",
                                        "bottom_top"};
    bool staggered[3], known[3];
    for (int i = 0; i < 3; i++)
        known[i] = is_axis(file->axis[i], usual[i], &staggered[i]);
    if (!known[0] || !known[1])
        return SNOW_STATUS_OK;
    out->file = file;
    for (int i = 0; i < 3; i++) {
        out->staggered[i] = known[i] && staggered[i] && info->dims[i] > 1;
        info->dims[i] -= out->staggered[i];
        if (out->staggered[i])
            snow_notify(file->context,
                        "%s lies between mass points along %c: means of two "
                        "neighbours are shown, which lie on them",
                        variable, "xyz"[i]);
    }
    take_spacing(file, axes);
    take_time(file, info);
    note_perturbation(file, variable);
    return known[2] && !axes[2].given
               ? take_heights(file, options, info, &axes[2], out)
               : SNOW_STATUS_OK;
}

/* Coordinates of two axes cannot place a box. */
static void note_curvilinear(const cf_file *file, const cf_attributes *says,
                             const cf_axis axes[4]) {
    const char *at = says->coordinates;
    bool found = false;
    char name[72];
    while (!found && *(at += strspn(at, " "))) {
        const int length = (int)strcspn(at, " ");
        snprintf(name, sizeof name, "%.*s", length < 71 ? length : 0, at);
        found = file->axes_of(file->user, name) >= 2;
        at += length;
    }
    if (found && !*axes[0].unit && !*axes[1].unit)
        snow_notify(file->context,
                    "x and y are counted in voxels: its coordinates (%.100s) "
                    "are curvilinear",
                    says->coordinates);
}

snow_status snow_model_take(const cf_file *file, const char *variable,
                            const cf_attributes *says,
                            const snow_volume_options *options,
                            snow_volume_info *info, cf_axis axes[4],
                            cf_model *out) {
    SNOW_TRY(take_wrf(file, variable, options, info, axes, out));
    if (!out->file)
        note_curvilinear(file, says, axes);
    return SNOW_STATUS_OK;
}
