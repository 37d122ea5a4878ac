/* volume/nrrd_numbers.c - voxels as numbers in text, the encoding "ascii".
 *
 * Numbers stand apart by white space or commas.  One that does not fit the
 * scalar type is refused; none is rounded or clipped. */
#include "volume/nrrd.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Longer than the exact decimal form of most doubles; nobody writes longer
 * ones. */
#define WORD_BYTES 512

typedef struct word_reader {
    snow_source *source;
    char bytes[SNOW_PEEK_BYTES];
    size_t at, end;
    char word[WORD_BYTES];
} word_reader;

static bool separates(char c) {
    return isspace((unsigned char)c) || c == ',';
}

/* Makes sure of one more byte, if there is one. */
static snow_status look_ahead(word_reader *reader) {
    if (reader->at < reader->end)
        return SNOW_OK;
    reader->at = 0;
    return snow_source_read(reader->source, reader->bytes, sizeof reader->bytes,
                            &reader->end);
}

/* Takes white space up to the next word; *got is false at the end. */
static snow_status skip_blanks(word_reader *reader, bool *got) {
    for (;; reader->at++) {
        SNOW_TRY(look_ahead(reader));
        *got = reader->at < reader->end;
        if (!*got || !separates(reader->bytes[reader->at]))
            return SNOW_OK;
    }
}

/* Takes the next word into reader->word. */
static snow_status next_word(word_reader *reader, bool *got) {
    size_t used = 0;
    SNOW_TRY(skip_blanks(reader, got));
    for (;; reader->at++) {
        SNOW_TRY(look_ahead(reader));
        if (reader->at == reader->end || separates(reader->bytes[reader->at]))
            break;
        if (used == WORD_BYTES - 1) {
            reader->word[used - 1] = '?'; /* too long: no number any more */
            break;
        }
        char c = reader->bytes[reader->at];
        reader->word[used++] = c ? c : '?'; /* a NUL would end the number */
    }
    reader->word[used] = 0;
    return SNOW_OK;
}

/* The full range of 64 bits; strtoull by itself would take "-1". */
static bool store_unsigned(const char *word, uint64_t *to) {
    char *end;
    errno = 0;
    unsigned long long value = strtoull(word, &end, 10);
    if (!isdigit((unsigned char)*word) || errno || *end)
        return false;
    *to = value;
    return true;
}

/* Stored first and compared after: what does not survive the type was out of
 * its range. */
static bool store_integer(snow_type type, const char *word, void *voxels,
                          uint64_t index) {
    int64_t value;
    if (type == SNOW_UINT64)
        return store_unsigned(word, (uint64_t *)voxels + index);
    if (!snow_parse_int64(word, &value))
        return false;
    switch (type) {
#define STORE(name, c_type, text)                  \
    case SNOW_##name:                              \
        ((c_type *)voxels)[index] = (c_type)value; \
        return (int64_t)((c_type *)voxels)[index] == value;
        STORE(INT8, int8_t, )
        STORE(UINT8, uint8_t, )
        STORE(INT16, int16_t, )
        STORE(UINT16, uint16_t, )
        STORE(INT32, int32_t, )
        STORE(UINT32, uint32_t, )
        STORE(INT64, int64_t, )
#undef STORE
    default:
        return false;
    }
}

/* Writes the number to voxels[index]; false when it is none of the type. */
static bool store(snow_type type, const char *word, void *voxels,
                  uint64_t index) {
    double value;
    if (type != SNOW_FLOAT32 && type != SNOW_FLOAT64)
        return store_integer(type, word, voxels, index);
    if (!snow_parse_double(word, &value))
        return false;
    if (type == SNOW_FLOAT32 && isfinite(value) && fabs(value) > FLT_MAX)
        return false;
    if (type == SNOW_FLOAT32)
        ((float *)voxels)[index] = (float)value;
    else
        ((double *)voxels)[index] = value;
    return true;
}

static snow_status read_words(word_reader *reader, snow_type type,
                              const nrrd_window *window, void *voxels) {
    snow_context *context = snow_source_context(reader->source);
    size_t size = snow_type_size(type);
    uint64_t all = window->all / size, skip = window->skip / size;
    uint64_t count = window->count / size;
    bool got;
    for (uint64_t i = 0; i < all; i++) {
        SNOW_TRY(next_word(reader, &got));
        if (!got)
            return snow_fail(context, SNOW_BAD_INPUT,
                             "%s: ends after %llu of %llu numbers; the file is "
                             "cut, or its sizes are wrong",
                             snow_source_name(reader->source),
                             (unsigned long long)i, (unsigned long long)all);
        if (i >= skip && i - skip < count &&
            !store(type, reader->word, voxels, i - skip))
            return snow_fail(
                context, SNOW_BAD_INPUT,
                "%s: its number %llu, \"%.40s\", is no %s; correct "
                "it or the type",
                snow_source_name(reader->source), (unsigned long long)i,
                reader->word, snow_type_name(type));
    }
    SNOW_TRY(skip_blanks(reader, &got));
    if (got)
        snow_notify(context,
                    "%s: text after the last number is ignored; check the "
                    "sizes",
                    snow_source_name(reader->source));
    return SNOW_OK;
}

snow_status snow_nrrd_read_numbers(snow_source *source, snow_type type,
                                   const nrrd_window *window, void *voxels) {
    word_reader reader = {.source = source};
    return read_words(&reader, type, window, voxels);
}
