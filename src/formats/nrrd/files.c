/* formats/nrrd/files.c - the field "data file" in its three forms:
 *
 *   data file: head.raw
 *   data file: slice_%03d.raw 1 113 1 [2]     numbers from, to, step
 *   data file: LIST [2]                       a name on each following line
 *
 * The last number, the subdimension, is the number of axes in one file, by
 * default one less than all.  The bytes of a file are always contiguous in the
 * whole array, so only the number of files has to be checked. */
#include "formats/nrrd/nrrd.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The value is shortened in messages: a name may be as long as a line. */
static snow_status fail_data_file(snow_context *context, const nrrd_text *text,
                                  const char *wrong) {
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "the header's field \"data file: %.60s\" %s; correct it",
                     snow_nrrd_value(text, NRRD_DATA_FILE), wrong);
}

/* The conversion "%03d" (or u, i) in a pattern: its position and length, or
 * NULL if there is none or more than one. */
static const char *find_conversion(const char *pattern, size_t length,
                                   size_t *conversion_length) {
    const char *found = NULL, *end = pattern + length;
    for (const char *at = pattern; at < end; at++) {
        if (*at != '%')
            continue;
        const char *digit = at + 1;
        while (digit < end && isdigit((unsigned char)*digit))
            digit++;
        /* No number has more than two digits of width. */
        if (digit == end || !strchr("diu", *digit) || digit - at > 3 || found)
            return NULL;
        found = at;
        *conversion_length = (size_t)(digit - at) + 1;
        at = digit;
    }
    return found;
}

/* Parses "pattern first last step [subdimension]"; returns false for a plain
 * name. */
static bool parse_pattern(const char *value, int64_t numbers[4], int *count,
                          nrrd_files *out) {
    size_t length = strcspn(value, " \t"), unused;
    if (!find_conversion(value, length, &unused))
        return false;
    out->name = value;
    out->name_bytes = length;
    const char *at = value + length;
    for (*count = 0; *count < 4; (*count)++) {
        char word[24];
        at += strspn(at, " \t");
        size_t word_length = strcspn(at, " \t");
        if (!word_length)
            break;
        if (word_length >= sizeof word)
            return false;
        memcpy(word, at, word_length);
        word[word_length] = 0;
        if (!snow_parse_int64(word, &numbers[*count]))
            return false;
        at += word_length;
    }
    return *count >= 3 && !at[strspn(at, " \t")];
}

/* The number of values from first to last; 0 if the step does not lead
 * there. */
static uint64_t count_steps(int64_t first, int64_t last, int64_t step) {
    if (step > 0 && first <= last)
        return ((uint64_t)last - (uint64_t)first) / (uint64_t)step + 1;
    if (step < 0 && first >= last)
        return ((uint64_t)first - (uint64_t)last) / (0 - (uint64_t)step) + 1;
    return 0;
}

/* Each file spans the first `subdimension` axes, or, if that is all of them, a
 * slab of the last axis. */
static bool count_fits(const nrrd_header *header, int64_t subdimension,
                       uint64_t count) {
    int dimension = header->dimension;
    uint64_t pieces = 1;
    if (!count || subdimension < 1 || subdimension > dimension)
        return false;
    if (subdimension == dimension)
        return (uint64_t)header->axes[dimension - 1].size % count == 0;
    for (int i = (int)subdimension; i < dimension; i++)
        if (!snow_mul_u64(pieces, (uint64_t)header->axes[i].size, &pieces))
            return false;
    return pieces == count;
}

/* Tries a list, a pattern, a name, in this order: a file may be called "LIST"
 * only with a folder before it. */
snow_status snow_nrrd_find_files(snow_context *context, const nrrd_text *text,
                                 const nrrd_header *header, nrrd_files *out) {
    const char *value = snow_nrrd_value(text, NRRD_DATA_FILE);
    int64_t numbers[4], subdimension = header->dimension - 1;
    int count;
    *out = (nrrd_files){.place = NRRD_ATTACHED, .count = 1};
    if (!value)
        return SNOW_STATUS_OK;
    bool list = !strncmp(value, "LIST", 4) &&
                (!value[4] || isspace((unsigned char)value[4]));
    if (list) {
        out->place = NRRD_LIST;
        out->count = text->listed;
        out->name = text->block + text->list;
        if (value[4] && !snow_parse_int64(value + 4, &subdimension))
            return fail_data_file(context, text,
                                  "has no subdimension behind LIST");
    } else if (parse_pattern(value, numbers, &count, out)) {
        out->place = NRRD_PATTERN;
        out->first = numbers[0];
        out->step = numbers[2];
        out->count = count_steps(numbers[0], numbers[1], numbers[2]);
        if (count == 4)
            subdimension = numbers[3];
    } else {
        out->place = NRRD_SINGLE;
        out->name = value;
        return SNOW_STATUS_OK;
    }
    if (!count_fits(header, subdimension, out->count))
        return fail_data_file(context, text,
                              "gives a number of files that does not fit the "
                              "sizes");
    return SNOW_STATUS_OK;
}

/* The header's pattern is never used as a printf format: the name is assembled
 * here. */
snow_status snow_nrrd_file_name(snow_context *context, const nrrd_files *files,
                                uint64_t index, const char **at, char *name,
                                size_t size) {
    const char *from = files->name;
    int length;
    if (files->place == NRRD_PATTERN) {
        size_t number_length = 0;
        const char *number =
            find_conversion(from, files->name_bytes, &number_length);
        int before = (int)(number - from);
        int after = (int)(files->name_bytes - number_length) - before;
        int width = (int)strtol(number + 1, NULL, 10);
        /* The count was checked: first + index * step is in the range. */
        int64_t value =
            (int64_t)((uint64_t)files->first + index * (uint64_t)files->step);
        length = snprintf(name, size, "%.*s%0*lld%.*s", before, from, width,
                          (long long)value, after, number + number_length);
        /* A width without a leading 0 pads with blanks. */
        if (number[1] != '0' && width > 1 && length > 0)
            length = snprintf(name, size, "%.*s%*lld%.*s", before, from, width,
                              (long long)value, after, number + number_length);
    } else {
        if (files->place == NRRD_LIST && *at)
            from = *at + strlen(*at) + 1;
        *at = from;
        length = snprintf(name, size, "%s", from);
    }
    if (length < 0 || (size_t)length >= size)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "the name of data file %llu is too long; correct the "
                         "header",
                         (unsigned long long)index);
    return SNOW_STATUS_OK;
}
