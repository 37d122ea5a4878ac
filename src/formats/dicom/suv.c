/* formats/dicom/suv.c - the units of PET and of doses (PS3.3, C.8.9 and
 * C.8.8.3).
 *
 *   SUVbw = C weight / D,  D = dose 2^(-(t - t0) / half life)
 *
 * C in Bq/ml, weight in g, dose in Bq at t0.  All slices of a series are
 * corrected for decay to one time, t, which the files do not name: it is the
 * series' time, unless that is of a later processing, as the pseudo code of
 * QIBA (Standardized Uptake Value) has it.  The slice's own time would be
 * another in each bed of a whole body. */
#include "formats/dicom/dicom.h"

#include <math.h>
#include <string.h>

#define DAY 86400.0
#define MOST_HALF_LIVES 12

/* Longest text that counts: a date, time, fraction and zone have 26. */
#define MOST_TEXT 64

/* Place of an element of the file itself, and of the radiopharmaceutical. */
#define OWN(tag) ((dicom_place){0, 0, tag})
#define DRUG(tag) ((dicom_place){0, 0x00540016, tag})

/* --- times ---------------------------------------------------------------- */

/* Takes a number of so many digits, behind a mark that may be missing. */
static bool take(const char **at, char mark, int digits, int most, int *out) {
    const char *text = *at + (mark && **at == mark);
    int value = 0;
    for (; digits; digits--, text++) {
        if (*text < '0' || *text > '9')
            return false;
        value = 10 * value + (*text - '0');
    }
    if (value > most)
        return false;
    *at = text;
    *out = value;
    return true;
}

/* Seconds since 1970 of "20240131", or "2024.01.31" as before 1993. */
static bool take_date(const char **at, double *out) {
    int year, month, day;
    if (!take(at, 0, 4, 9999, &year) || !take(at, '.', 2, 12, &month) ||
        !take(at, '.', 2, 31, &day) || !month || !day)
        return false;
    /* Years begin in March: then a leap day is the last. */
    year -= month < 3;
    const int of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    *out = DAY *
           (365 * year + year / 4 - year / 100 + year / 400 + of_year - 719468);
    return true;
}

/* Seconds of "1403", "140359.5", or "14:03:59" as before 1993. */
static bool take_time(const char **at, double *out) {
    int hours, minutes = 0, seconds = 0;
    if (!take(at, 0, 2, 23, &hours))
        return false;
    if (take(at, ':', 2, 59, &minutes))
        take(at, ':', 2, 60, &seconds);
    *out = 3600.0 * hours + 60.0 * minutes + seconds;
    double part = 0.1;
    for (*at += **at == '.'; **at >= '0' && **at <= '9'; (*at)++, part /= 10)
        *out += part * (**at - '0');
    return true;
}

/* Seconds east of Greenwich of "+0130"; NaN for other text. */
static double zone_of(const char *text) {
    const char *at = text + 1;
    int hours, minutes;
    if ((*text != '+' && *text != '-') || !take(&at, 0, 2, 14, &hours) ||
        !take(&at, 0, 2, 59, &minutes))
        return NAN;
    return (*text == '-' ? -60.0 : 60.0) * (60 * hours + minutes);
}

static void text_at(dicom_reader *reader, dicom_place place, char *out) {
    out[snow_dicom_value(reader, place, out, MOST_TEXT - 1)] = 0;
    const size_t blanks = strspn(out, " ");
    memmove(out, out + blanks, strlen(out + blanks) + 1);
    for (size_t end = strlen(out); end && out[end - 1] == ' ';)
        out[--end] = 0;
}

static double number_at(dicom_reader *reader, dicom_place place) {
    char text[MOST_TEXT];
    double value;
    text_at(reader, place, text);
    return snow_parse_double(text, &value) && isfinite(value) ? value : 0;
}

/* Seconds since 1970 of a date with its time, in the file's zone.  A zone
 * counts only where that of the other times is known.  NaN: there is none. */
static double moment_at(dicom_reader *reader, dicom_place place) {
    char text[MOST_TEXT], own[MOST_TEXT];
    const char *at = text;
    double day, time;
    text_at(reader, place, text);
    text_at(reader, OWN(0x00080201), own);
    if (!take_date(&at, &day) || !take_time(&at, &time))
        return NAN;
    const double shift = zone_of(own) - zone_of(at);
    return day + time + (isnan(shift) ? 0 : shift);
}

/* The same of two elements.  Without a date it is the day 0. */
static double time_at(dicom_reader *reader, uint32_t date, uint32_t time) {
    char text[MOST_TEXT];
    const char *at = text;
    double day = 0, seconds;
    text_at(reader, OWN(date), text);
    if (!take_date(&at, &day))
        day = 0;
    text_at(reader, OWN(time), text);
    at = text;
    return take_time(&at, &seconds) ? day + seconds : NAN;
}

static double series_time(dicom_reader *reader) {
    return time_at(reader, 0x00080021, 0x00080031);
}

/* Without a date it is the one nearest to the series' time. */
double snow_dicom_acquired(dicom_reader *reader) {
    double time = time_at(reader, 0x00080022, 0x00080032);
    if (isnan(time))
        return moment_at(reader, OWN(0x0008002a));
    const double series = series_time(reader);
    if (time >= DAY || isnan(series))
        return time;
    time += floor(series / DAY) * DAY;
    return time - DAY * round((time - series) / DAY);
}

/* --- PET ------------------------------------------------------------------ */

typedef enum suv { BY_WEIGHT, BY_LEAN_MASS, BY_SURFACE } suv;

/* A file of the series; what it lacks for SUV, once that is known. */
typedef struct scan {
    dicom_reader *reader;
    double earliest; /* when the first slice of the series was acquired */
    const char *lacks;
} scan;

/* A number that must be above 0. */
static double positive(scan *s, dicom_place place, const char *name) {
    const double value = number_at(s->reader, place);
    if (value > 0)
        return value;
    s->lacks = name;
    return NAN;
}

/* An element of a maker, whose name is that of a block, if it was not removed.
 */
static dicom_place private_at(dicom_reader *reader, const char *maker,
                              uint32_t tag) {
    char text[MOST_TEXT];
    for (uint32_t block = 0x10; block < 0x20; block++) {
        text_at(reader, OWN((tag & 0xffff0000) | block), text);
        if (!strcmp(text, maker) || (block == 0x10 && !*text))
            return OWN((tag & 0xffff00ff) | block << 8);
    }
    return OWN(0);
}

/* Whether a text of several values has one. */
static bool has_value(dicom_reader *reader, dicom_place place,
                      const char *value) {
    char text[MOST_TEXT * 4] = "\\", word[MOST_TEXT];
    const size_t length =
        snow_dicom_value(reader, place, text + 1, sizeof text - 3);
    text[1 + length] = 0;
    snow_text_print(word, sizeof word, "\\%s", value);
    for (const char *at = text; (at = strstr(at, word)); at++)
        if (strchr("\\ ", at[strlen(word)])) /* or the end */
            return true;
    return false;
}

/* When all slices had the activities that they show. */
static double corrected_to(scan *s) {
    double time =
        moment_at(s->reader, private_at(s->reader, "GEMS_PETD_01", 0x0009100d));
    if (!isnan(time))
        return time;
    time = series_time(s->reader);
    return isnan(time) || s->earliest < time ? s->earliest : time;
}

/* When the dose was measured, at most a day before, if only its time is known
 * or the other has no date. */
static double injected(scan *s, double then) {
    char text[MOST_TEXT];
    const char *at = text;
    double time = moment_at(s->reader, DRUG(0x00181078));
    if (!isnan(time) && then >= 2 * DAY)
        return time;
    text_at(s->reader, DRUG(0x00181072), text);
    if (!take_time(&at, &time))
        return NAN;
    time += floor(then / DAY) * DAY;
    return time > then ? time - DAY : time;
}

/* What is left of the dose: Bq. */
static double dose(scan *s) {
    char how[MOST_TEXT];
    const double all = positive(s, DRUG(0x00181074),
                                "RadionuclideTotalDose (0018,1074) above 0");
    text_at(s->reader, OWN(0x00541102), how);
    if (!strcmp(how, "ADMIN"))
        return all;
    const double half = positive(s, DRUG(0x00181075),
                                 "RadionuclideHalfLife (0018,1075) above 0");
    const double time = corrected_to(s);
    const double since = time - injected(s, time);
    if (strcmp(how, "START") != 0)
        s->lacks = "DecayCorrection (0054,1102) START or ADMIN";
    else if (isnan(time))
        s->lacks = "SeriesTime (0008,0031) or AcquisitionTime (0008,0032)";
    else if (isnan(since))
        s->lacks = "RadiopharmaceuticalStartDateTime (0018,1078) or "
                   "RadiopharmaceuticalStartTime (0018,1072)";
    else if (!(since >= 0 && since < MOST_HALF_LIVES * half) && half > 0)
        s->lacks = "a time of injection (RadiopharmaceuticalStartDateTime "
                   "(0018,1078) or RadiopharmaceuticalStartTime (0018,1072)) "
                   "0 to 12 half lives before the scan";
    return all * exp2(-since / half);
}

/* What the dose is spread over: g of weight, of lean mass (James), cm^2 of
 * surface (Du Bois). */
static double body(scan *s, suv unit) {
    const double weight =
        positive(s, OWN(0x00101030), "PatientWeight (0010,1030) above 0");
    if (unit == BY_WEIGHT)
        return 1000 * weight;
    const double height =
        100 * positive(s, OWN(0x00101020), "PatientSize (0010,1020) above 0");
    if (unit == BY_SURFACE)
        return 71.84 * pow(weight, 0.425) * pow(height, 0.725);
    const bool male = has_value(s->reader, OWN(0x00100040), "M");
    if (!male && !has_value(s->reader, OWN(0x00100040), "F"))
        s->lacks = "PatientSex (0010,0040) M or F";
    const double ratio = weight / height;
    const double lean =
        (male ? 1.10 : 1.07) * weight - (male ? 128 : 148) * ratio * ratio;
    if (lean <= 0)
        s->lacks = "PatientWeight and PatientSize of which a lean mass follows";
    return 1000 * lean;
}

/* SUV, or Bq/ml, of a count; 0: not given. */
static double philips(scan *s, uint32_t tag) {
    return number_at(s->reader,
                     private_at(s->reader, "Philips PET Private Group", tag));
}

/* SUV of a data value; *unit is the one that is wanted, or else that of a file
 * that is of SUV. */
static double suv_of(scan *s, const char *units, bool automatic, suv *unit) {
    double factor;
    if (has_value(s->reader, OWN(0x00541000), "REPROJECTION") ||
        has_value(s->reader, OWN(0x00080008), "PROJECTION IMAGE") ||
        has_value(s->reader, OWN(0x00080008), "MIP"))
        s->lacks = "slices, which ImageType (0008,0008) or SeriesType "
                   "(0054,1000) says that these are not";
    if (!strcmp(units, "GML")) {
        char type[MOST_TEXT];
        text_at(s->reader, OWN(0x00541006), type);
        const suv own = !strncmp(type, "LBM", 3) ? BY_LEAN_MASS
                        : !strcmp(type, "BSA")   ? BY_SURFACE
                                                 : BY_WEIGHT;
        if (automatic || *unit == own) {
            *unit = own;
            return 1;
        }
        if (own != BY_WEIGHT)
            s->lacks = "SUVType (0054,1006) BW";
        return body(s, *unit) / body(s, BY_WEIGHT);
    }
    if (!has_value(s->reader, OWN(0x00280051), "ATTN"))
        s->lacks = "ATTN in CorrectedImage (0028,0051)";
    else if (!has_value(s->reader, OWN(0x00280051), "DECY"))
        s->lacks = "DECY in CorrectedImage (0028,0051)";
    if (!strcmp(units, "BQML"))
        return body(s, *unit) / dose(s);
    if (!strcmp(units, "CNTS") && (factor = philips(s, 0x70531000)) > 0)
        return *unit == BY_WEIGHT
                   ? factor
                   : factor * body(s, *unit) / body(s, BY_WEIGHT);
    if (!strcmp(units, "CNTS") && (factor = philips(s, 0x70531009)) > 0)
        return factor * body(s, *unit) / dose(s);
    s->lacks = "Units (0054,1001) BQML or GML, or CNTS with a factor of "
               "Philips' (7053,1000), (7053,1009)";
    return NAN;
}

static void set_pet(snow_context *context, scan *s, const char *wanted,
                    snow_volume_info *info) {
    static const char *const names[] = {"SUVbw", "SUVlbm", "SUVbsa"};
    suv unit = BY_WEIGHT;
    char units[MOST_TEXT];
    text_at(s->reader, OWN(0x00541001), units);
    const char *said = !strcmp(units, "BQML")   ? "Bq/ml"
                       : !strcmp(units, "CNTS") ? "counts"
                       : !strcmp(units, "GML")  ? "g/ml"
                                                : "";
    strcpy(info->value_unit, said);
    if (wanted && !strcmp(wanted, "none"))
        return;
    while (wanted && unit < BY_SURFACE && strcmp(names[unit] + 3, wanted) != 0)
        unit++;
    const double factor = suv_of(s, units, !wanted, &unit);
    if (!s->lacks && !(factor > 1e-30 && factor < 1e30))
        s->lacks = "numbers that a body and a dose can have";
    if (s->lacks) {
        snow_notify(context, "its values stay as stored%s%s: %s needs %s",
                    *said ? ", in " : "", said, names[unit], s->lacks);
        return;
    }
    strcpy(info->value_unit, names[unit]);
    info->slope *= factor;
    info->intercept *= factor;
    for (int i = 0; i < 2; i++)
        info->window[i] *= factor;
}

/* --- both ----------------------------------------------------------------- */

static double earliest_of(const dicom_input *input, const dicom_stack *stack) {
    const char *series = stack->frames->image->series;
    double out = NAN;
    for (size_t i = 0; i < stack->places * stack->times; i++)
        out = fmin(out, stack->frames[i].image->acquired);
    for (size_t i = 0; i < input->image_count; i++)
        if (!strcmp(input->images[i]->series, series))
            out = fmin(out, input->images[i]->acquired);
    return out;
}

snow_status snow_dicom_set_unit(const dicom_input *input,
                                const dicom_stack *stack, const char *wanted,
                                snow_volume_info *info) {
    const dicom_image *image = stack->frames->image;
    const bool pet = !strcmp(image->modality, "PT");
    dicom_reader reader;
    char unit[MOST_TEXT];
    if (!pet && strcmp(image->modality, "RTDOSE") != 0)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_dicom_open(input->context, image->path, input->store, NULL,
                             &reader));
    scan s = {.reader = &reader, .earliest = earliest_of(input, stack)};
    text_at(&reader, OWN(0x30040002), unit);
    if (pet)
        set_pet(input->context, &s, wanted, info);
    else if (!strcmp(unit, "GY"))
        strcpy(info->value_unit, "Gy");
    snow_dicom_close(&reader);
    return SNOW_STATUS_OK;
}
