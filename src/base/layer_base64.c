/* base/layer_base64.c - the layer that reads base64 (RFC 4648, section 4), as
 * XML files hold binary data.
 *
 * Four letters make three bytes, fewer before padding.  Encoded pieces may
 * follow one another, each with padding of its own: their bytes are joined.
 * The data end before the first letter that is neither base64's nor blank. */
#include "base/layer.h"

/* What letters stand for beside their six bits. */
enum { BLANK = 64, PADDING = 65, FOREIGN = 66 };

typedef struct base64_layer {
    snow_layer layer;
    uint32_t bits; /* of the letters of a started group */
    int letters;   /* how many */
    int padding;   /* '=' that must come to fill the group */
    bool ended;
    unsigned char made[3]; /* of a group, not yet handed out */
    int first, count;
} base64_layer;

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

/* Turns a group of `letters` letters, its bits at the left of 24, to bytes. */
static void finish_group(base64_layer *reader, int letters) {
    for (int i = 0; i < 3; i++)
        reader->made[i] = (unsigned char)(reader->bits >> (16 - 8 * i));
    reader->first = 0;
    reader->count = letters - 1;
    reader->bits = 0;
    reader->letters = 0;
}

static snow_status fail_group(const base64_layer *reader) {
    return snow_fail(reader->layer.context, SNOW_BAD_INPUT,
                     "%s: its base64 text is cut or damaged; fetch or write "
                     "the file again",
                     reader->layer.name);
}

/* Takes one letter below; false at the first that does not belong here. */
static snow_status take_letter(base64_layer *reader, unsigned char letter) {
    unsigned value = meaning(letter);
    if (value == BLANK)
        return SNOW_OK;
    if (value == PADDING) {
        if (!reader->padding) {
            if (reader->letters < 2)
                return fail_group(reader);
            reader->padding = 4 - reader->letters;
            reader->bits <<= 6 * reader->padding;
            finish_group(reader, 4 - reader->padding);
        }
        reader->padding--;
        return SNOW_OK;
    }
    if (value == FOREIGN || reader->padding) {
        reader->ended = true;
        return reader->letters || reader->padding ? fail_group(reader)
                                                  : SNOW_OK;
    }
    reader->bits = reader->bits << 6 | value;
    if (++reader->letters == 4)
        finish_group(reader, 4);
    return SNOW_OK;
}

/* Letters until a group is whole or the text ends. */
static snow_status next_group(base64_layer *reader) {
    snow_layer *below = reader->layer.below;
    while (!reader->ended && !reader->count) {
        SNOW_TRY(snow_layer_fill(below, 1));
        if (below->begin == below->end) {
            reader->ended = true;
            return reader->letters || reader->padding ? fail_group(reader)
                                                      : SNOW_OK;
        }
        SNOW_TRY(take_letter(reader, below->buffer[below->begin]));
        if (!reader->ended)
            snow_layer_drop(below, 1);
    }
    return SNOW_OK;
}

/* Whole groups of letters that are buffered, without a look at each case. */
static size_t take_plain(snow_layer *below, unsigned char *bytes, size_t size) {
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
    snow_layer_drop(below, made / 3 * 4);
    return made;
}

static snow_status pull_base64(snow_layer *layer, void *bytes, size_t size,
                               size_t *got) {
    base64_layer *reader = (base64_layer *)layer;
    unsigned char *to = bytes;
    size_t done = 0;
    while (done < size) {
        while (reader->count && done < size) {
            to[done++] = reader->made[reader->first++];
            reader->count--;
        }
        if (!reader->letters && !reader->padding && !reader->ended)
            done += take_plain(layer->below, to + done, size - done);
        if (done < size && !reader->count)
            SNOW_TRY(next_group(reader));
        if (!reader->count && reader->ended)
            break;
    }
    *got = done;
    return SNOW_OK;
}

/* Three bytes of four letters, and what a group has left. */
static uint64_t limit_base64(const snow_layer *layer) {
    uint64_t limit = snow_layer_limit(layer->below);
    if (limit == UINT64_MAX)
        return limit;
    return limit / 4 * 3 + 6 + (layer->end - layer->begin);
}

snow_status snow_layer_open_base64(snow_layer *below, snow_layer **out) {
    base64_layer *reader = snow_layer_allocate(below->context, sizeof *reader);
    if (!reader)
        return SNOW_NO_MEMORY;
    reader->layer.name = below->name;
    reader->layer.below = below;
    reader->layer.pull = pull_base64;
    reader->layer.limit = limit_base64;
    reader->layer.size = -1;
    *out = &reader->layer;
    return SNOW_OK;
}
