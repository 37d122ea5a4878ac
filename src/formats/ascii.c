/* formats/ascii.c - voxels as decimal numbers in text: NRRD's encoding "ascii"
 * and MetaImage's BinaryData = False.
 *
 * Numbers are separated by white space, in NRRD also by commas.  A number that
 * does not fit the scalar type is refused, also "1e1" and "2.0" for integers;
 * none is rounded or clipped. */
#include "formats/ascii.h"
#include "formats/bytes/number.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Longer than the exact decimal form of most doubles; nobody writes longer
 * ones. */
#define WORD_BYTES 512

/* Half a step beyond the largest float: from here on rounding gives infinity,
 * while "3.4028235e38", the usual spelling of that float, is below. */
#define FLOAT_END 0x1.ffffffp127

/* A piece of the source's bytes, which stay in the source until they are
 * dropped: the next reader finds what follows the last number. */
typedef struct word_reader {
    snow_source *source;
    bool commas;
    char bytes[SNOW_PEEK_BYTES];
    size_t at, end;
    char word[WORD_BYTES];
} word_reader;

bool snow_next_word(const char **at, char *word, size_t size) {
    const char *from = *at + strspn(*at, " \t");
    size_t length = strcspn(from, " \t");
    if (!length || length >= size)
        return false;
    memcpy(word, from, length);
    word[length] = 0;
    *at = from + length;
    return true;
}

bool snow_has_word(const char *words, const char *word) {
    char one[64];
    while (snow_next_word(&words, one, sizeof one))
        if (!strcmp(one, word))
            return true;
    return false;
}

/* The full range of 64 bits; strtoull alone would accept "-1". */
static bool store_unsigned(const char *word, void *at) {
    char *end;
    errno = 0;
    unsigned long long value = strtoull(word, &end, 10);
    if (!isdigit((unsigned char)word[*word == '+']) || errno || *end)
        return false;
    const uint64_t stored = value;
    memcpy(at, &stored, sizeof stored);
    return true;
}

static bool store_real(snow_type type, const char *word, void *at) {
    double value;
    if (!snow_parse_double(word, &value))
        return false;
    if (type == SNOW_TYPE_FLOAT64) {
        memcpy(at, &value, sizeof value);
        return true;
    }
    /* Infinity may stand in the file, but a finite number must not become
     * infinite. */
    if (isfinite(value) && fabs(value) >= FLOAT_END)
        return false;
    const float narrow = (float)value;
    memcpy(at, &narrow, sizeof narrow);
    return true;
}

bool snow_store_number(snow_type type, const char *word, void *at) {
    int64_t value;
    if (type == SNOW_TYPE_UINT64)
        return store_unsigned(word, at);
    if (type == SNOW_TYPE_FLOAT32 || type == SNOW_TYPE_FLOAT64)
        return store_real(type, word, at);
    if (!type || !snow_parse_int64(word, &value))
        return false;
    const size_t size = snow_type_size(type);
    const bool has_sign = *snow_type_name(type) == 'i';
    const int64_t most = INT64_MAX >> (64 - 8 * size - !has_sign);
    if (value > most || value < (has_sign ? -most - 1 : 0))
        return false;
    snow_put_low((uint64_t)value, size, at);
    return true;
}

/* White space of the C library: NRRD's numbers may be arranged in any lines. */
static bool separates(const word_reader *reader, char c) {
    return isspace((unsigned char)c) || (c == ',' && reader->commas);
}

/* Removes the bytes that were read from the source. */
static snow_status drop_read(word_reader *reader) {
    SNOW_TRY(snow_source_skip(reader->source, reader->at, "the voxels"));
    reader->at = reader->end = 0;
    return SNOW_STATUS_OK;
}

/* Makes one more byte available, if there is one. */
static snow_status look_ahead(word_reader *reader) {
    if (reader->at < reader->end)
        return SNOW_STATUS_OK;
    SNOW_TRY(drop_read(reader));
    return snow_source_peek(reader->source, reader->bytes, sizeof reader->bytes,
                            &reader->end);
}

/* Skips to the next word; *got is false at the end. */
static snow_status skip_blanks(word_reader *reader, bool *got) {
    for (;; reader->at++) {
        SNOW_TRY(look_ahead(reader));
        *got = reader->at < reader->end;
        if (!*got || !separates(reader, reader->bytes[reader->at]))
            return SNOW_STATUS_OK;
    }
}

/* Reads the next word into reader->word.  In XML a tag ends it; no number
 * contains its letter. */
static snow_status next_word(word_reader *reader, bool *got) {
    size_t used = 0;
    SNOW_TRY(skip_blanks(reader, got));
    for (;; reader->at++) {
        SNOW_TRY(look_ahead(reader));
        if (reader->at == reader->end ||
            separates(reader, reader->bytes[reader->at]) ||
            (used && reader->bytes[reader->at] == '<'))
            break;
        if (used == WORD_BYTES - 1) {
            reader->word[used - 1] = '?'; /* too long to be a number */
            break;
        }
        char c = reader->bytes[reader->at];
        reader->word[used++] = c ? c : '?'; /* a NUL would end the number */
    }
    reader->word[used] = 0;
    return SNOW_STATUS_OK;
}

/* The destination of the number at byte `at` of the array, NULL if it is
 * outside the box; advances `run`, the first run that does not end before
 * it. */
static void *place_of(const snow_region *region, uint64_t at, int64_t *run,
                      unsigned char *voxels) {
    uint64_t begin = 0, end = 0;
    for (; *run < snow_region_runs(region); ++*run) {
        snow_region_run(region, *run, &begin, &end);
        if (at < end)
            break;
    }
    if (at < begin || at >= end)
        return NULL;
    return voxels + (uint64_t)*run * (end - begin) + (at - begin);
}

/* Numbers outside the box must be valid too: an error there means that those
 * inside are not in their place. */
static snow_status read_words(word_reader *reader, snow_type type,
                              const snow_file_part *part,
                              unsigned char *voxels) {
    snow_context *context = snow_source_context(reader->source);
    const char *name = snow_source_name(reader->source);
    uint64_t size = part->region->value;
    uint64_t all = (part->end - part->begin) / size;
    int64_t run = snow_region_run_at(part->region, part->begin);
    bool got;
    for (uint64_t i = 0; i < all; i++) {
        uint64_t unwanted; /* space for one value of any type */
        void *at = place_of(part->region, part->begin + i * size, &run, voxels);
        SNOW_TRY(next_word(reader, &got));
        if (!got)
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "%s: ends after %llu of %llu numbers; the file is "
                             "truncated, or its sizes are wrong",
                             name, (unsigned long long)i,
                             (unsigned long long)all);
        if (!snow_store_number(type, reader->word, at ? at : &unwanted))
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "%s: its number %llu, \"%.40s\", is not a valid "
                             "%s; correct it or the type",
                             name, (unsigned long long)i, reader->word,
                             snow_type_name(type));
    }
    /* The end of the last line is not extra data. */
    SNOW_TRY(skip_blanks(reader, &got));
    return drop_read(reader);
}

/* The reader is on the stack: about 5 KB, and nothing to free. */
snow_status snow_read_numbers(snow_source *source, snow_type type, bool commas,
                              const snow_file_part *part, void *voxels) {
    word_reader reader = {.source = source, .commas = commas};
    return read_words(&reader, type, part, voxels);
}

/* Splits off the next word; 0 at the end, -1 for one that is too long. */
static int split_word(const char **at, const char *between, char word[64]) {
    char apart[16] = " \t\r\n";
    strncat(apart, between, 8);
    *at += strspn(*at, apart);
    const size_t length = strcspn(*at, apart);
    if (length >= 64)
        return -1;
    memcpy(word, *at, length);
    word[length] = 0;
    *at += length;
    return length > 0;
}

int snow_text_reals(const char *text, const char *between, double *out,
                    int most) {
    char word[64];
    int count = 0, found;
    while ((found = split_word(&text, between, word)) > 0)
        if (count == most || !snow_parse_double(word, &out[count++]))
            return -1;
    return found < 0 ? -1 : count;
}

int snow_text_integers(const char *text, const char *between, int64_t *out,
                       int most) {
    char word[64];
    int count = 0, found;
    while ((found = split_word(&text, between, word)) > 0)
        if (count == most || !snow_parse_int64(word, &out[count++]))
            return -1;
    return found < 0 ? -1 : count;
}
