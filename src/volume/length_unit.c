/* volume/length_unit.c - units of length as files name them
 * (length_unit.h).
 *
 * The SI's symbols and names, American, British and in the plural; the signs
 * for micro and angstrom as UTF-8, Latin-1 or escaped, as ImageJ and XML have
 * them. */
#include "volume/length_unit.h"

#include <stdio.h>
#include <string.h>

/* The longest name, "micrometres", and as much again. */
#define KEY_BYTES 24

/* Other spellings of a letter: the two of the micro sign, and those of the
 * angstrom. */
static const struct {
    const char *spelling;
    char letter;
} letters[] = {
    {"\xc2\xb5", 'u'}, {"\xce\xbc", 'u'}, {"\\u00b5", 'u'},
    {"\\u03bc", 'u'},  {"&#181;", 'u'},   {"&#xb5;", 'u'},
    {"\xc3\x85", 'a'}, {"\xc3\xa5", 'a'}, {"\xe2\x84\xab", 'a'},
    {"\\u00c5", 'a'},  {"\xc3\xb6", 'o'}, {"\xb5", 'u'},
    {"\xc5", 'a'},
};

/* Picometres are whole numbers, so that ratios of units are rounded once. */
static const struct {
    const char *symbol, *name;
    double picometres;
} units[] = {
    {"angstrom", "a", 1e2},     {"pm", "picometer", 1},
    {"nm", "nanometer", 1e3},   {"um", "micrometer", 1e6},
    {"um", "micron", 1e6},      {"mm", "millimeter", 1e9},
    {"cm", "centimeter", 1e10}, {"m", "meter", 1e12},
    {"km", "kilometer", 1e15},  {"in", "inch", 2.54e10},
    {"in", "inche", 2.54e10},
};

static char lower(char letter) {
    return letter >= 'A' && letter <= 'Z' ? (char)(letter + 32) : letter;
}

/* Returns the bytes of a spelling with which a text begins; 0: none. */
static size_t find_spelling(const char *text, char *letter) {
    for (size_t i = 0; i < sizeof letters / sizeof *letters; i++) {
        const char *spelling = letters[i].spelling;
        size_t n = 0;
        while (spelling[n] && lower(text[n]) == spelling[n])
            n++;
        if (!spelling[n]) {
            *letter = letters[i].letter;
            return n;
        }
    }
    return 0;
}

/* Small letters without blanks around them, "meter" for "metre", and no s of
 * the plural. */
static bool make_key(const char *text, char key[KEY_BYTES]) {
    size_t used = 0;
    text += strspn(text, " \t\"");
    while (*text && used < KEY_BYTES - 1) {
        char letter = lower(*text);
        const size_t bytes = find_spelling(text, &letter);
        key[used++] = letter;
        text += bytes ? bytes : 1;
    }
    while (used && strchr(" \t\r\n\"", key[used - 1]))
        used--;
    if (used > 3 && key[used - 1] == 's')
        used--;
    key[used] = 0;
    if (used > 4 && !strcmp(key + used - 2, "re"))
        memcpy(key + used - 2, "er", 2);
    return !*text;
}

double snow_unit_length(const char *text, char name[16]) {
    char key[KEY_BYTES];
    if (!text || !make_key(text, key))
        return 0;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (!strcmp(key, units[i].symbol) || !strcmp(key, units[i].name)) {
            if (name)
                memcpy(name, units[i].symbol, strlen(units[i].symbol) + 1);
            return units[i].picometres;
        }
    return 0;
}

void snow_length_join(snow_context *context, const char *const texts[3],
                      double factors[3], char unit[16]) {
    double lengths[3] = {0}, first = 0;
    *unit = 0;
    for (int i = 0; i < 3; i++) {
        factors[i] = 1;
        lengths[i] = texts[i] ? snow_unit_length(texts[i], NULL) : 0;
        if (lengths[i] > 0 && !(first > 0))
            first = snow_unit_length(texts[i], unit);
    }
    for (int i = 0; i < 3; i++) {
        if (lengths[i] > 0)
            factors[i] = lengths[i] / first;
        else if (first > 0 && texts[i])
            snow_notify(context,
                        "the unit of %c, \"%.20s\", is not known; its lengths "
                        "are taken to be in %s; --spacing sets others",
                        "xyz"[i], texts[i], unit);
        else if (!*unit && texts[i])
            snprintf(unit, 16, "%.15s", texts[i]);
    }
}
