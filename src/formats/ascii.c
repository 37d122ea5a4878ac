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

/* Writes the number that a word represents to `at`, which needs no alignment.
 * Returns false if it is not a value of the type: exactly for integers, by
 * range for floats. */
static bool store_number(snow_type type, const char *word, void *at) {
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
        if (!store_number(type, reader->word, at ? at : &unwanted))
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

/* --- grids of chemistry's programs ---------------------------------------- */

/* A number of C or of Fortran, whose exponents may begin with D, and have no
 * letter where they need three digits. */
static bool read_real(const char *word, double *out) {
    char text[64];
    size_t used = 0;
    if (snow_parse_double(word, out))
        return true;
    for (const char *at = word; *at && used < sizeof text - 2; at++) {
        const bool is_sign = *at == '+' || *at == '-';
        if (is_sign && used && isdigit((unsigned char)at[-1]) &&
            strlen(at) == 4)
            text[used++] = 'e';
        text[used++] = *at == 'D' || *at == 'd' ? 'e' : *at;
    }
    text[used] = 0;
    return used < sizeof text - 2 && snow_parse_double(text, out);
}

static uint64_t count_of(const snow_text_grid *grid) {
    return (uint64_t)(grid->values * grid->dims[0] * grid->dims[1] *
                      grid->dims[2]);
}

static snow_status fail_short(const word_reader *reader,
                              const snow_text_grid *grid, uint64_t got) {
    const uint64_t all = count_of(grid);
    return snow_fail(snow_source_context(reader->source), SNOW_STATUS_BAD_INPUT,
                     "%s: ends after %llu of %llu values, %llu are missing; it "
                     "is truncated, get or write it again",
                     snow_source_name(reader->source), (unsigned long long)got,
                     (unsigned long long)all, (unsigned long long)(all - got));
}

/* Bytes that the numbers have at least, a digit and a blank each; fails where
 * no file has so many. */
static snow_status least_bytes(snow_source *source, const snow_text_grid *grid,
                               uint64_t *out) {
    uint64_t all = 2 * (uint64_t)grid->values;
    bool fits = true;
    for (int i = 0; i < 3; i++)
        fits = fits && snow_mul_u64(all, (uint64_t)grid->dims[i], &all);
    *out = all - 1;
    if (fits && all <= (uint64_t)INT64_MAX)
        return SNOW_STATUS_OK;
    return snow_fail(snow_source_context(source), SNOW_STATUS_BAD_INPUT,
                     "has more values than any file; its sizes are wrong");
}

snow_status snow_skip_grid(snow_source *source, const snow_text_grid *grid) {
    word_reader reader = {.source = source};
    uint64_t least;
    SNOW_TRY(least_bytes(source, grid, &least));
    for (uint64_t i = 0; i < count_of(grid); i++) {
        bool got;
        SNOW_TRY(next_word(&reader, &got));
        if (!got)
            return fail_short(&reader, grid, i);
    }
    return drop_read(&reader);
}

/* Sizes are compared with the bytes that are there before memory is allocated:
 * where these are too few, the values are counted. */
static snow_status expect_grid(snow_source *source,
                               const snow_text_grid *grid) {
    const int64_t left = snow_source_remaining(source);
    uint64_t least;
    SNOW_TRY(least_bytes(source, grid, &least));
    if (left >= 0 && (uint64_t)left < least)
        return snow_skip_grid(source, grid);
    return snow_source_expect(source, least, "the values");
}

/* Stores a value at its voxel, and where an axis is closed at its end too, if
 * they are in the box. */
static void store_closed(const snow_text_grid *grid, const snow_region *box,
                         const int64_t at[3], double value, double *voxels) {
    for (int corner = 0; corner < 8; corner++) {
        int64_t place[3];
        bool inside = true;
        for (int i = 0; i < 3; i++) {
            const bool end = corner >> i & 1;
            inside = inside && (!end || (grid->closed && !at[i]));
            place[i] = (end ? grid->dims[i] : at[i]) - box->first[i];
            inside = inside && place[i] >= 0 && place[i] < box->count[i];
        }
        if (inside)
            voxels[(place[2] * box->count[1] + place[1]) * box->count[0] +
                   place[0]] = value;
        if (!grid->closed || (at[0] && at[1] && at[2]))
            return;
    }
}

static snow_status read_reals(word_reader *reader, const snow_text_grid *grid,
                              const snow_region *box, double *voxels) {
    snow_context *context = snow_source_context(reader->source);
    const uint64_t all = count_of(grid);
    int64_t at[3] = {0, 0, 0}, value = 0;
    for (uint64_t i = 0; i < all; i++) {
        double number;
        bool got;
        SNOW_TRY(next_word(reader, &got));
        if (!got)
            return fail_short(reader, grid, i);
        if (!read_real(reader->word, &number))
            return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                             "%s: its value %llu, \"%.40s\", is no number; "
                             "the file is damaged, write it again",
                             snow_source_name(reader->source),
                             (unsigned long long)i, reader->word);
        if (value == grid->value)
            store_closed(grid, box, at, number, voxels);
        if (++value < grid->values)
            continue;
        value = 0;
        for (int k = 0; k < 3; k++) {
            const int axis = grid->order[k];
            if (++at[axis] < grid->dims[axis])
                break;
            at[axis] = 0;
        }
    }
    /* The end of the last line is not extra data. */
    bool more;
    SNOW_TRY(skip_blanks(reader, &more));
    return drop_read(reader);
}

snow_status snow_read_grid(snow_source *source, const snow_text_grid *grid,
                           const snow_volume_options *options,
                           snow_volume_info *info, snow_volume **out) {
    snow_context *context = snow_source_context(source);
    word_reader reader = {.source = source};
    snow_region box;
    snow_volume *volume;
    info->type = SNOW_TYPE_FLOAT64;
    for (int i = 0; i < 3; i++)
        info->dims[i] = grid->dims[i] + grid->closed;
    SNOW_TRY(expect_grid(source, grid));
    SNOW_TRY(snow_region_lay_out(context, options, info, &box));
    if (!out)
        return SNOW_STATUS_OK;
    SNOW_TRY(snow_volume_new(context, info, &volume));
    return snow_volume_give(read_reals(&reader, grid, &box, volume->owned),
                            volume, out);
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
