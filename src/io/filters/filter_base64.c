/* io/filters/filter_base64.c - the filter stage that decodes base64 (RFC 4648,
 * section 4), in which XML files store binary data.
 *
 * Four characters encode three bytes, fewer before padding. Encoded parts may
 * follow one another, each with its own padding: their bytes are joined. The
 * data end before the first character that is neither base64 nor blank. */
#include "io/filters/filter.h"

/* Classes of characters other than the six-bit values. */
enum { BLANK = 64, PADDING = 65, FOREIGN = 66 };

typedef struct base64_filter {
    snow_filter_stage filter;
    uint32_t bits; /* of the characters of an incomplete group */
    int letters;   /* number of these characters */
    int padding;   /* '=' still missing in the group */
    bool ended;
    unsigned char made[3]; /* of a group, not yet returned */
    int first, count;
} base64_filter;

static unsigned meaning(unsigned char letter) {
    if (letter >= 'A' && letter <= 'Z')
        return letter - (unsigned)'A';
    if (letter >= 'a' && letter <= 'z')
        return letter - (unsigned)'a' + 26;
    if (letter >= '0' && letter <= '9')
        return letter - (unsigned)'0' + 52;
    switch (letter) {
    case '+':
        return 62;
    case '/':
        return 63;
    case ' ':
    case '\t':
    case '\r':
    case '\n':
        return BLANK;
    case '=':
        return PADDING;
    default:
        return FOREIGN;
    }
}

/* Decodes a group of `letters` characters, its bits left-aligned in 24 bits, to
 * bytes. */
static void finish_group(base64_filter *reader, int letters) {
    for (int i = 0; i < 3; i++)
        reader->made[i] = (unsigned char)(reader->bits >> (16 - 8 * i));
    reader->first = 0;
    reader->count = letters - 1;
    reader->bits = 0;
    reader->letters = 0;
}

static snow_status fail_group(const base64_filter *reader) {
    return snow_fail(reader->filter.context, SNOW_STATUS_BAD_INPUT,
                     "%s: its base64 text is truncated or damaged; fetch or "
                     "write the file again",
                     reader->filter.name);
}

/* Consumes one character below; false at the first that is not base64. */
static snow_status take_letter(base64_filter *reader, unsigned char letter) {
    unsigned value = meaning(letter);
    if (value == BLANK)
        return SNOW_STATUS_OK;
    if (value == PADDING) {
        if (!reader->padding) {
            if (reader->letters < 2)
                return fail_group(reader);
            reader->padding = 4 - reader->letters;
            reader->bits <<= 6 * reader->padding;
            finish_group(reader, 4 - reader->padding);
        }
        reader->padding--;
        return SNOW_STATUS_OK;
    }
    if (value == FOREIGN || reader->padding) {
        reader->ended = true;
        return reader->letters || reader->padding ? fail_group(reader)
                                                  : SNOW_STATUS_OK;
    }
    reader->bits = reader->bits << 6 | value;
    if (++reader->letters == 4)
        finish_group(reader, 4);
    return SNOW_STATUS_OK;
}

/* Consumes characters until a group is complete or the text ends. */
static snow_status next_group(base64_filter *reader) {
    snow_filter_stage *below = reader->filter.below;
    while (!reader->ended && !reader->count) {
        SNOW_TRY(snow_filter_stage_fill(below, 1));
        if (below->begin == below->end) {
            reader->ended = true;
            return reader->letters || reader->padding ? fail_group(reader)
                                                      : SNOW_STATUS_OK;
        }
        SNOW_TRY(take_letter(reader, below->buffer[below->begin]));
        if (!reader->ended)
            snow_filter_stage_drop(below, 1);
    }
    return SNOW_STATUS_OK;
}

/* Decodes complete buffered groups, without checking special cases. */
static size_t take_plain(snow_filter_stage *below, unsigned char *bytes,
                         size_t size) {
    size_t made = 0;
    const unsigned char *at = below->buffer + below->begin;
    const unsigned char *end = below->buffer + below->end;
    for (; size - made >= 3 && end - at >= 4; at += 4, made += 3) {
        unsigned a = meaning(at[0]), b = meaning(at[1]);
        unsigned c = meaning(at[2]), d = meaning(at[3]);
        if ((a | b | c | d) > 63)
            break;
        uint32_t bits = a << 18 | b << 12 | c << 6 | d;
        bytes[made] = (unsigned char)(bits >> 16);
        bytes[made + 1] = (unsigned char)(bits >> 8);
        bytes[made + 2] = (unsigned char)bits;
    }
    snow_filter_stage_drop(below, made / 3 * 4);
    return made;
}

static snow_status pull_base64(snow_filter_stage *filter, void *bytes,
                               size_t size, size_t *got) {
    base64_filter *reader = (base64_filter *)filter;
    unsigned char *to = bytes;
    size_t done = 0;
    while (done < size) {
        while (reader->count && done < size) {
            to[done++] = reader->made[reader->first++];
            reader->count--;
        }
        if (!reader->letters && !reader->padding && !reader->ended)
            done += take_plain(filter->below, to + done, size - done);
        if (done < size && !reader->count)
            SNOW_TRY(next_group(reader));
        if (!reader->count && reader->ended)
            break;
    }
    *got = done;
    return SNOW_STATUS_OK;
}

/* Three bytes for each four characters, and the rest of a group. */
static uint64_t limit_base64(const snow_filter_stage *filter) {
    uint64_t limit = snow_filter_stage_limit(filter->below);
    if (limit == UINT64_MAX)
        return limit;
    return limit / 4 * 3 + 6 + (filter->end - filter->begin);
}

snow_status snow_filter_stage_open_base64(snow_filter_stage *below,
                                          snow_filter_stage **out) {
    base64_filter *reader = snow_filter_stage_over(below, sizeof *reader);
    if (!reader)
        return SNOW_STATUS_NO_MEMORY;
    reader->filter.pull = pull_base64;
    reader->filter.limit = limit_base64;
    *out = &reader->filter;
    return SNOW_STATUS_OK;
}
