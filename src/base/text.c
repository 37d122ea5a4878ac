/* base/text.c - parses numbers and names in untrusted text. */
#include "base/base.h"

#include <ctype.h>
#include <errno.h>
#include <locale.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* True if only blanks follow. */
static bool at_end(const char *text) {
    while (isspace((unsigned char)*text))
        text++;
    return !*text;
}

bool snow_parse_int64(const char *text, int64_t *out) {
    char *end;
    errno = 0;
    long long value = strtoll(text, &end, 10);
    if (end == text || errno || !at_end(end))
        return false;
    *out = value;
    return true;
}

/* The calling program's locale may have a decimal comma; files, messages and
 * recipes have a point.  Only this thread's locale is replaced, for a moment.
 */
typedef struct locales {
    locale_t point, before;
} locales;

static locales use_point(void) {
    locales out = {.point = newlocale(LC_ALL_MASK, "C", (locale_t)0)};
    if (out.point)
        out.before = uselocale(out.point);
    return out;
}

static void use_former(const locales *all) {
    if (!all->point)
        return;
    uselocale(all->before);
    freelocale(all->point);
}

int snow_text_vprint(char *text, size_t capacity, const char *format,
                     va_list arguments) {
    const locales all = use_point();
    const int count = vsnprintf(text, capacity, format, arguments);
    use_former(&all);
    return count;
}

int snow_text_print(char *text, size_t capacity, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    const int count = snow_text_vprint(text, capacity, format, arguments);
    va_end(arguments);
    return count;
}

int snow_text_scan(const char *text, const char *format, ...) {
    const locales all = use_point();
    va_list arguments;
    va_start(arguments, format);
    const int count = vsscanf(text, format, arguments);
    va_end(arguments);
    use_former(&all);
    return count;
}

/* Hexadecimal numbers are rejected here: no format has them, but strtod accepts
 * them. */
bool snow_parse_double(const char *text, double *out) {
    char *end;
    const locales all = use_point();
    errno = 0;
    const double value = strtod(text, &end);
    /* 1e999 is not taken for infinity; a number too small for a double is 0. */
    const bool overflow = errno == ERANGE && (value > 1 || value < -1);
    use_former(&all);
    if (end == text || overflow || !at_end(end) || strpbrk(text, "xX"))
        return false;
    *out = value;
    return true;
}

bool snow_has_suffix(const char *text, const char *suffix) {
    size_t n = strlen(text), m = strlen(suffix);
    if (m > n)
        return false;
    for (size_t i = 0; i < m; i++)
        if (tolower((unsigned char)text[n - m + i]) !=
            tolower((unsigned char)suffix[i]))
            return false;
    return true;
}

/* The significant characters of a name: the leading sign, then all except
 * dashes and underscores. ASCII only, so that no locale changes the meaning of
 * a name. */
static int next_letter(const char *name, size_t *at) {
    while (*at > 0 && (name[*at] == '-' || name[*at] == '_'))
        ++*at;
    char letter = name[*at];
    *at += letter != '\0';
    return letter >= 'A' && letter <= 'Z' ? letter - 'A' + 'a' : letter;
}

bool snow_same_name(const char *a, const char *b) {
    size_t i = 0, j = 0;
    int left, right;
    if (!a || !b)
        return false;
    do {
        left = next_letter(a, &i);
        right = next_letter(b, &j);
    } while (left == right && left);
    return left == right;
}
