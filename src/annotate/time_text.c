/* annotate/time_text.c - the time of a step for people: a number with its unit,
 * or the date that a unit such as "hours since 1990-01-01" counts from, in the
 * calendars of the Climate and Forecast conventions. */
#include "base/base.h"

#include <snowglass/extend.h>
#include <snowglass/overlay.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef enum calendar {
    CALENDAR_UNKNOWN,
    CALENDAR_GREGORIAN, /* Julian before 1582-10-15 */
    CALENDAR_PROLEPTIC, /* Gregorian always */
    CALENDAR_JULIAN,
    CALENDAR_NO_LEAP,
    CALENDAR_ALL_LEAP,
    CALENDAR_360
} calendar;

typedef struct moment {
    int64_t year;
    int month, day, hour, minute, second;
} moment;

/* Days from 0000-03-01 to the first Gregorian day, in both calendars. */
#define FIRST_GREGORIAN 578041
#define JULIAN_AHEAD 2

static calendar calendar_of(const char *name) {
    static const struct {
        const char *name;
        calendar is;
    } names[] = {{"", CALENDAR_GREGORIAN},
                 {"standard", CALENDAR_GREGORIAN},
                 {"gregorian", CALENDAR_GREGORIAN},
                 {"proleptic_gregorian", CALENDAR_PROLEPTIC},
                 {"julian", CALENDAR_JULIAN},
                 {"noleap", CALENDAR_NO_LEAP},
                 {"365_day", CALENDAR_NO_LEAP},
                 {"all_leap", CALENDAR_ALL_LEAP},
                 {"366_day", CALENDAR_ALL_LEAP},
                 {"360_day", CALENDAR_360},
                 {"360", CALENDAR_360},
                 {"thirty_day_months", CALENDAR_360}}; /* FMS */
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (snow_same_name(name, names[i].name))
            return names[i].is;
    return CALENDAR_UNKNOWN;
}

/* Leap days before a year that begins in March, of calendars that have some in
 * some years only. */
static int64_t leap_days(int64_t year, bool julian) {
    int64_t fours = (int64_t)floor((double)year / 4);
    if (julian)
        return fours;
    return fours - (int64_t)floor((double)year / 100) +
           (int64_t)floor((double)year / 400);
}

/* The number of a day; those of one calendar count on. */
static int64_t number_of(calendar c, const moment *m) {
    int64_t year = m->year - (m->month < 3);
    int month = (m->month + 9) % 12;
    /* Days before the first of a month, of years that begin in March so that a
     * leap day is the last. */
    const int days_before = (153 * month + 2) / 5;
    int64_t day = days_before + m->day - 1;
    switch (c) {
    case CALENDAR_360:
        return m->year * 360 + (m->month - 1) * 30 + m->day - 1;
    case CALENDAR_NO_LEAP:
        return year * 365 + day;
    case CALENDAR_ALL_LEAP:
        return year * 366 + day;
    case CALENDAR_GREGORIAN: {
        int64_t number = year * 365 + leap_days(year, false) + day;
        return number >= FIRST_GREGORIAN
                   ? number
                   : year * 365 + leap_days(year, true) + day - JULIAN_AHEAD;
    }
    default:
        return year * 365 + leap_days(year, c == CALENDAR_JULIAN) + day;
    }
}

/* The day of a number, by looking for its month. */
static void date_of(calendar c, int64_t number, moment *m) {
    m->year = (int64_t)floor((double)number / 366) - 1;
    if (number < 0 || c == CALENDAR_360)
        m->year = (int64_t)floor((double)number / 360) - 1;
    m->month = m->day = 1;
    for (moment next = *m; next.year++, number_of(c, &next) <= number;)
        *m = next;
    for (moment next = *m; next.month < 12;) {
        next.month++;
        if (number_of(c, &next) > number)
            break;
        *m = next;
    }
    for (moment next = *m; next.day++, next.day <= 31;)
        if (number_of(c, &next) <= number)
            *m = next;
}

/* Seconds of a unit of time; 0 for others. */
static double seconds_in(const char *unit, size_t length) {
    static const struct {
        const char *letters;
        double seconds;
    } units[] = {{"second", 1},  {"sec", 1},       {"s", 1},
                 {"minute", 60}, {"min", 60},      {"hour", 3600},
                 {"hr", 3600},   {"h", 3600},      {"day", 86400},
                 {"d", 86400},   {"week", 604800}, {"millisecond", 1e-3},
                 {"msec", 1e-3}, {"ms", 1e-3},     {"us", 1e-6},
                 {"ns", 1e-9},   {"ps", 1e-12},    {"fs", 1e-15}};
    for (size_t i = 0; i < sizeof units / sizeof *units; i++) {
        size_t own = strlen(units[i].letters);
        bool plural = length == own + 1 && unit[own] == 's';
        if ((length == own || plural) && !strncmp(unit, units[i].letters, own))
            return units[i].seconds;
    }
    return 0;
}

/* Seconds that a clock is before that of Greenwich: "+05:30", "-0600", "-6"
 * behind the time of "2000-01-01 00:00:00 -6". */
static double zone_of(const char *date) {
    const char *time = strpbrk(date, " T_");
    const char *sign = time ? strpbrk(time, "+-") : NULL;
    int hours = 0, minutes = 0;
    if (!sign || sscanf(sign + 1, "%2d%*[:]%2d", &hours, &minutes) < 1)
        return 0;
    if (!minutes && strspn(sign + 1, "0123456789") == 4)
        sscanf(sign + 3, "%2d", &minutes);
    return (*sign == '-' ? -60.0 : 60.0) * (60 * hours + minutes);
}

/* Reads "2000-01-31 12:00:00", of which the time may lack: its day, and the
 * seconds of Greenwich since that began. */
static bool read_date(const char *text, moment *out, double *seconds) {
    long long year;
    double second = 0;
    *out = (moment){0};
    const int found =
        snow_text_scan(text, "%lld-%d-%d%*[ T_]%d:%d:%lf", &year, &out->month,
                       &out->day, &out->hour, &out->minute, &second);
    if (found < 3 || out->month < 1 || out->month > 12 || llabs(year) > 1000000)
        return false;
    out->year = year;
    *seconds = out->hour * 3600.0 + out->minute * 60.0 + second - zone_of(text);
    return true;
}

/* The date and the unit in seconds of "hours since 1990-01-01"; false for a
 * unit without a date. */
static bool read_unit(const snow_volume_info *info, moment *out,
                      double *seconds, double *unit) {
    const char *since = strstr(info->time_unit, " since ");
    if (!since || calendar_of(info->calendar) == CALENDAR_UNKNOWN)
        return false;
    *unit = seconds_in(info->time_unit, (size_t)(since - info->time_unit));
    return *unit > 0 && read_date(since + 7, out, seconds);
}

/* The moment that a time means; false for a unit without a date. */
static bool find_moment(const snow_volume_info *info, moment *out) {
    const calendar c = calendar_of(info->calendar);
    double seconds, unit;
    if (!read_unit(info, out, &seconds, &unit))
        return false;
    seconds += info->time_value * unit;
    double days = floor((seconds + 0.5) / 86400);
    int rest = (int)floor(seconds + 0.5 - days * 86400);
    if (!(fabs(days) < 1e9))
        return false;
    date_of(c, number_of(c, out) + (int64_t)days, out);
    out->hour = rest / 3600;
    out->minute = rest / 60 % 60;
    out->second = rest % 60;
    return true;
}

/* --- formats -------------------------------------------------------------- */

/* "%Y-%m-%d %H:%M:%S", in any order; false where another letter stands. */
static bool format_moment(const moment *m, const char *format, char *out,
                          size_t capacity) {
    size_t used = 0;
    for (const char *p = format; *p; p++) {
        char part[24] = {*p, 0};
        if (*p == '%') {
            const char *letters = "mdHMS", *at = strchr(letters, *++p);
            const int numbers[] = {m->month, m->day, m->hour, m->minute,
                                   m->second};
            if (!*p || (!at && *p != 'Y' && *p != '%'))
                return false;
            if (*p == 'Y')
                snprintf(part, sizeof part, "%04lld", (long long)m->year);
            else if (at)
                snprintf(part, sizeof part, "%02d", numbers[at - letters]);
        }
        used += (size_t)snprintf(out + used, capacity - used, "%s", part);
        if (used >= capacity)
            return false;
    }
    return true;
}

/* The one conversion of a number in a format; NULL where there is another. */
static const char *find_number(const char *format, size_t *length) {
    const char *found = NULL;
    for (const char *p = format; (p = strchr(p, '%')) != NULL; p++) {
        size_t n = 1 + strspn(p + 1, "+- 0123456789.");
        if (p[1] == '%') {
            p++;
            continue;
        }
        if (found || n > 12 || !p[n] || !strchr("efgEG", p[n]))
            return NULL;
        found = p;
        *length = n + 1;
    }
    return found;
}

/* Text with "%%" as one sign of per cent; false where it does not fit. */
static bool add_plain(const char *text, size_t length, char *out,
                      size_t capacity, size_t *used) {
    for (size_t n = 0; n < length; n++) {
        if (*used + 1 >= capacity)
            return false;
        out[(*used)++] = text[n];
        n += text[n] == '%';
    }
    out[*used] = 0;
    return true;
}

/* The time in the unit that stands behind the number in a format, as in
 * "%.0f fs", where that and the volume's are known ones. */
static double in_unit_of(const snow_volume_info *info, const char *behind) {
    behind += strspn(behind, " ");
    const double wanted =
        seconds_in(behind, strspn(behind, "abcdefghijklmnopqrstuvwxyz"));
    const double own =
        seconds_in(info->time_unit, strcspn(info->time_unit, " "));
    return wanted > 0 && own > 0 ? info->time_value * (own / wanted)
                                 : info->time_value;
}

static bool format_number(const snow_volume_info *info, const char *format,
                          char *out, size_t capacity) {
    size_t length = 0;
    char conversion[16];
    const char *at = find_number(format, &length);
    if (!at || !capacity)
        return false;
    memcpy(conversion, at, length);
    conversion[length] = 0;
    size_t used = 0;
    if (!add_plain(format, (size_t)(at - format), out, capacity, &used))
        return false;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    used += (size_t)snprintf(out + used, capacity - used, conversion,
                             in_unit_of(info, at + length));
#pragma GCC diagnostic pop
    return used < capacity &&
           add_plain(at + length, strlen(at + length), out, capacity, &used);
}

/* Whether a text is nothing but a date, with a time and a zone or without:
 * "2000-01-31", "-100-1-31 12:00", "2000-01-31T12:00:00.5+05:30". */
static bool is_date(const char *at) {
    static const char digits[] = "0123456789";
    for (int part = 0; part < 3; part++) {
        at += *at == '-';
        at += strspn(at, digits);
    }
    if (!*at)
        return true;
    if (!strchr(" T_", *at))
        return false;
    const size_t time = strspn(at + 1, "0123456789:.");
    at += 1 + time;
    at += strspn(at, " ");
    if (*at == '+' || *at == '-')
        return time && !at[1 + strspn(at + 1, "0123456789:")];
    return time && !at[*at == 'Z'];
}

bool snow_time_value(const snow_volume_info *given, const char *date,
                     double *out) {
    snow_volume_info info;
    moment begin, m, day;
    double seconds, wanted, unit;
    if (SNOW_RECORD_READ(NULL, snow_volume_info, given, &info) !=
            SNOW_STATUS_OK ||
        !read_unit(&info, &begin, &seconds, &unit) || !date || !is_date(date) ||
        !read_date(date, &m, &wanted))
        return false;
    const calendar c = calendar_of(info.calendar);
    const int64_t number = number_of(c, &m);
    date_of(c, number, &day);
    if (m.hour > 24 || m.minute > 59 || (m.hour == 24 && m.minute))
        return false;
    if (day.year != m.year || day.month != m.month || day.day != m.day)
        return false; /* such as February 30 */
    *out =
        ((double)(number - number_of(c, &begin)) * 86400 + wanted - seconds) /
        unit;
    return true;
}

bool snow_time_text(const snow_volume_info *given, const char *format,
                    char *out, size_t capacity) {
    snow_volume_info info;
    moment m;
    if (SNOW_RECORD_READ(NULL, snow_volume_info, given, &info) !=
            SNOW_STATUS_OK ||
        !isfinite(info.time_value))
        return false;
    bool dated = find_moment(&info, &m);
    if (format)
        return format_number(&info, format, out, capacity) ||
               (dated && format_moment(&m, format, out, capacity));
    if (dated)
        return format_moment(&m,
                             m.second ? "%Y-%m-%d %H:%M:%S" : "%Y-%m-%d %H:%M",
                             out, capacity);
    int length = snow_text_print(out, capacity, "%.6g%s%s", info.time_value,
                                 *info.time_unit ? " " : "", info.time_unit);
    return length >= 0 && (size_t)length < capacity;
}
