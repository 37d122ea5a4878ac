/* messages.c - messages of the library, which names options of the tool, for
 * Python: crop=((0, 9), (0, 9), (0, 9)) for --crop 0:9,0:9,0:9. */
#include "core.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The argument that an option at `text` is; returns the option's length, 0
 * where there is none. */
static size_t read_option(const char *text, char name[32]) {
    size_t length = 0;
    if (strncmp(text, "--", 2) == 0)
        length = strspn(text + 2, "abcdefghijklmnopqrstuvwxyz-");
    if (length == 0 || length > 31)
        return 0;
    for (size_t n = 0; n < length; n++)
        name[n] = text[2 + n] == '-' ? '_' : text[2 + n];
    name[length] = '\0';
    return record_is_argument(name) ? length + 2 : 0;
}

/* Behind an option: whether its value follows, and not the sentence. */
static bool is_value(const char *text, bool begins) {
    return *text == ' ' && (begins || (text[1] >= '0' && text[1] <= '9') ||
                            (text[1] >= 'A' && text[1] <= 'Z'));
}

/* Whether the word behind it is its value. */
static bool is_word(const char *name) {
    return strcmp(name, "preset") == 0 || strcmp(name, "vertical") == 0;
}

/* Writes the word behind a blank as a text; returns what was read. */
static size_t write_word(const char *from, char **to) {
    const size_t length =
        *from == ' ' ? strspn(from + 1, "abcdefghijklmnopqrstuvwxyz-") : 0;
    if (!length || !strchr(" ,:;", from[length + 1]))
        return 0;
    *to += sprintf(*to, "'%.*s'", (int)length, from + 1);
    return length + 1;
}

/* Whether numbers are given as a tuple. */
static bool is_tuple(const char *name) {
    static const char *const names[] = {"dims",  "spacing", "crop",    "size",
                                        "range", "window",  "material"};
    size_t n = 0;
    while (n < sizeof names / sizeof *names && strcmp(names[n], name) != 0)
        n++;
    return n < sizeof names / sizeof *names;
}

/* Writes XxYxZ as (x, y, z), 64x64x32 as (64, 64, 32), 0,9 as (0, 9) and
 * 0:64,0:64,0:32 as ((0, 64), (0, 64), (0, 32)); returns what was read. */
static size_t write_tuple(const char *from, char **to) {
    const size_t length = strspn(from, "0123456789.e+-xXYZWH:,");
    /* What ends a sentence is not of the number. */
    const size_t end =
        length && strchr(".,:", from[length - 1]) ? length - 1 : length;
    const bool pairs = memchr(from, ':', end) != NULL;
    if (!memchr(from, 'x', end) && !memchr(from, ',', end) && !pairs)
        return 0;
    *to += sprintf(*to, pairs ? "((" : "(");
    for (size_t n = 0; n < end; n++)
        if (from[n] == ',' && pairs)
            *to += sprintf(*to, "), (");
        else if (strchr("x:,", from[n]))
            *to += sprintf(*to, ", ");
        else if (from[n] >= 'A' && from[n] <= 'Z')
            *(*to)++ = (char)(from[n] - 'A' + 'a');
        else
            *(*to)++ = from[n];
    *to += sprintf(*to, pairs ? "))" : ")");
    return end;
}

/* Writes a type as a text, where it follows `before`, which is written too;
 * returns what was read. */
static size_t write_type(const char *from, const char *before, char **to) {
    const size_t begin = strlen(before);
    char word[16];
    if (strncmp(from, before, begin) != 0)
        return 0;
    const size_t length = strcspn(from + begin, " ,;:");
    if (length >= sizeof word)
        return 0;
    memcpy(word, from + begin, length);
    word[length] = '\0';
    if (snow_type_from_name(word) == SNOW_TYPE_NONE)
        return 0;
    *to += sprintf(*to, "%s'%s'", before, word);
    return begin + length;
}

/* Writes types, one or as in "int32, uint32 or float32"; returns what was
 * read. */
static size_t write_types(const char *from, char **to) {
    const size_t blank = *from == ' ';
    size_t next = write_type(from + blank, "", to);
    size_t length = next ? blank : 0;
    while (next) {
        length += next;
        next = write_type(from + length, ", ", to);
        if (!next)
            next = write_type(from + length, " or ", to);
    }
    return length;
}

PyObject *message_text(const char *message) {
    static const char overwriting[] = "allow overwriting (-y)";
    /* "," becomes "), (", the longest of what is put in for its length */
    char *copy = malloc(4 * strlen(message) + 1), *to = copy, name[32];
    if (!copy)
        return PyErr_NoMemory();
    for (const char *from = message; *from;) {
        const bool begins =
            from == message || (from >= message + 2 && from[-2] == ':');
        size_t length = from == message || strchr(" (", from[-1])
                            ? read_option(from, name)
                            : 0;
        if (!length &&
            strncmp(from, overwriting, sizeof overwriting - 1) == 0) {
            to += sprintf(to, "give overwrite=True");
            from += sizeof overwriting - 1;
            continue;
        }
        if (!length) {
            *to++ = *from++;
            continue;
        }
        from += length;
        /* a list or a sentence behind it explains its name */
        to += sprintf(
            to,
            strncmp(from, " (", 2) == 0 || *from == ':' ? "%s" : "%s=", name);
        if (strcmp(name, "allow_gaps") == 0)
            to += sprintf(to, "True");
        const size_t word = is_word(name) ? write_word(from, &to) : 0;
        from += word ? word : is_value(from, begins);
        if (is_tuple(name))
            from += write_tuple(from, &to);
        else if (strcmp(name, "type") == 0)
            from += write_types(from, &to);
    }
    *to = '\0';
    PyObject *text = text_of(copy);
    free(copy);
    return text;
}
