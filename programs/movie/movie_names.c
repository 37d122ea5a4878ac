/* movie_names.c - patterns of numbered names, parsed strictly.  A pattern never
 * reaches printf, so its other characters can do no harm. */
#include "movie/movie_names.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/* The most digits that a pattern can require and a number can have. */
#define DIGITS_MOST 9
#define NUMBER_LONGEST 18

bool names_are_meant(const char *path) {
    return strchr(path, '%') != NULL;
}

/* Whether a letter ends a number: T is that of openPMD. */
static bool is_number(char letter) {
    return letter == 'd' || letter == 'T';
}

/* Parses what follows a %: "d", "0Nd", or the same with T.  Returns its length,
 * 0 for anything else. */
static size_t read_number(const char *text, int *digits) {
    if (is_number(text[0])) {
        *digits = 0;
        return 1;
    }
    if (text[0] != '0' || text[1] < '1' || text[1] > '0' + DIGITS_MOST ||
        !is_number(text[2]))
        return 0;
    *digits = text[1] - '0';
    return 3;
}

const char *names_read(const char *path, frame_names *out) {
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0;
    size_t used = 0;
    bool found = false;
    *out = (frame_names){.digits = 0};
    if (folder >= sizeof out->folder || strlen(path + folder) > NAME_MAX)
        return "is too long a name; use a shorter one";
    memcpy(out->folder, path, folder);
    if (memchr(path, '%', folder))
        return "has a % in a folder's name; number the files, not the folders";
    char *part = out->before;
    for (const char *at = path + folder; *at; at++) {
        size_t length = 0;
        if (at[0] == '%' && at[1] == '%') {
            at++;
        } else if (at[0] == '%') {
            length = read_number(at + 1, &out->digits);
            if (!length)
                return "has a % without a number; write %d, or %04d for four "
                       "digits, and %% for a percent sign";
            if (found)
                return "has two numbers; write one %04d";
            found = true;
            out->any = at[1] == 'T';
            out->iterations = at[length] == 'T';
            part = out->after;
            used = 0;
            at += length;
            continue;
        }
        part[used++] = *at;
    }
    return found ? NULL : "has no number; write %04d in its place";
}

bool names_path(const frame_names *names, int64_t index, char *out,
                size_t size) {
    int length = snprintf(out, size, "%s%s%0*" PRId64 "%s", names->folder,
                          names->before, names->digits, index, names->after);
    return length >= 0 && (size_t)length < size;
}

bool names_in_set(const char *set, int64_t index, char *out, size_t size) {
    size_t used = 0;
    for (; *set; set++) {
        int digits;
        size_t length = *set == '%' ? read_number(set + 1, &digits) : 0;
        if (*set == '%' && !length)
            return false;
        int more = length ? snprintf(out + used, size - used, "%0*" PRId64,
                                     digits, index)
                          : snprintf(out + used, size - used, "%c", *set);
        if (more < 0 || (size_t)more >= size - used)
            return false;
        used += (size_t)more;
        set += length;
    }
    return true;
}

/* A number has only one spelling, with zeros only up to the pattern's width, so
 * two files never stand for one frame. */
int64_t names_index(const frame_names *names, const char *file) {
    size_t before = strlen(names->before), after = strlen(names->after);
    size_t length = strlen(file);
    size_t least = names->digits ? (size_t)names->digits : 1;
    if (length < before + least + after ||
        strncmp(file, names->before, before) != 0 ||
        strcmp(file + length - after, names->after) != 0)
        return -1;
    const char *number = file + before;
    size_t digits = length - before - after;
    int64_t index = 0;
    if (digits > NUMBER_LONGEST || (digits > least && number[0] == '0'))
        return -1;
    for (size_t i = 0; i < digits; i++) {
        if (!isdigit((unsigned char)number[i]))
            return -1;
        index = 10 * index + (number[i] - '0');
    }
    return index;
}

void names_widen(frame_names *names, const char *file) {
    const size_t before = strlen(names->before);
    if (!names->any || strncmp(file, names->before, before) != 0)
        return;
    const size_t digits = strspn(file + before, "0123456789");
    if (digits > 0 && digits <= NUMBER_LONGEST &&
        strcmp(file + before + digits, names->after) == 0)
        names->digits = (int)digits;
}

const char *names_folder(const frame_names *names) {
    return names->folder[0] ? names->folder : ".";
}
