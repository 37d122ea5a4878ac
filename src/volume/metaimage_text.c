/* volume/metaimage_text.c - voxels written as decimal numbers between blanks
 * (BinaryData = False). */
#include "volume/metaimage.h"

#include <ctype.h>
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define WORD_BYTES 64

/* X(NAME, C type, first value beyond the range below, above): what a double
 * must lie between to be one of the type's whole numbers. */
#define NARROW_MAP(X)                           \
    X(INT8, int8_t, -129, 128)                  \
    X(UINT8, uint8_t, -1, 256)                  \
    X(INT16, int16_t, -32769, 32768)            \
    X(UINT16, uint16_t, -1, 65536)              \
    X(INT32, int32_t, -0x1.00000002p31, 0x1p31) \
    X(UINT32, uint32_t, -1, 0x1p32)

/* Whole numbers of 64 bits do not pass through a double. */
static bool store_wide(const char *word, snow_type type, void *at) {
    char *end;
    errno = 0;
    if (type == SNOW_INT64) {
        int64_t value;
        if (!snow_parse_int64(word, &value))
            return false;
        memcpy(at, &value, sizeof value);
        return true;
    }
    unsigned long long value = strtoull(word, &end, 10);
    if (errno || *end || end == word || *word == '-')
        return false;
    const uint64_t stored = value;
    memcpy(at, &stored, sizeof stored);
    return true;
}

static bool store_word(const char *word, snow_type type, void *at) {
    double value;
    if (type == SNOW_INT64 || type == SNOW_UINT64)
        return store_wide(word, type, at);
    if (!snow_parse_double(word, &value))
        return false;
    switch (type) {
#define STORE(name, c_type, below, above)                               \
    case SNOW_##name: {                                                 \
        if (!(value > below && value < above) || floor(value) != value) \
            return false;                                               \
        c_type stored = (c_type)value;                                  \
        memcpy(at, &stored, sizeof stored);                             \
        return true;                                                    \
    }
        NARROW_MAP(STORE)
#undef STORE
    case SNOW_FLOAT32: {
        if (isfinite(value) && fabs(value) > FLT_MAX)
            return false;
        float stored = (float)value;
        memcpy(at, &stored, sizeof stored);
        return true;
    }
    default:
        memcpy(at, &value, sizeof value);
        return true;
    }
}

snow_status metaimage_skip_blanks(snow_source *source) {
    unsigned char bytes[WORD_BYTES];
    size_t got, start;
    do {
        SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
        for (start = 0; start < got && isspace(bytes[start]);)
            start++;
        SNOW_TRY(snow_source_skip(source, start, "the voxels"));
    } while (got && start == got);
    return SNOW_OK;
}

/* Takes the next word; empty at the end of the data. */
static snow_status next_word(snow_source *source, char word[WORD_BYTES]) {
    unsigned char bytes[WORD_BYTES];
    size_t got, length = 0;
    SNOW_TRY(metaimage_skip_blanks(source));
    SNOW_TRY(snow_source_peek(source, bytes, sizeof bytes, &got));
    while (length < got && !isspace(bytes[length]))
        length++;
    if (length == WORD_BYTES)
        return snow_fail(snow_source_context(source), SNOW_BAD_INPUT,
                         "the voxels contain a word of more than %d letters, "
                         "which is no number; check BinaryData",
                         WORD_BYTES - 1);
    for (size_t i = 0; i < length; i++) /* a NUL would end the number */
        word[i] = bytes[i] ? (char)bytes[i] : '?';
    word[length] = 0;
    return snow_source_skip(source, length, "the voxels");
}

snow_status metaimage_read_text(snow_source *source, snow_type type, void *out,
                                uint64_t count) {
    snow_context *context = snow_source_context(source);
    unsigned char dropped[8], *at = out;
    for (uint64_t i = 0; i < count; i++) {
        char word[WORD_BYTES];
        SNOW_TRY(next_word(source, word));
        if (!*word)
            return snow_fail(context, SNOW_BAD_INPUT,
                             "ends %llu numbers too early in the voxels; the "
                             "file is cut, or its sizes are wrong",
                             (unsigned long long)(count - i));
        if (!store_word(word, type,
                        at ? at + i * snow_type_size(type) : dropped))
            return snow_fail(context, SNOW_BAD_INPUT,
                             "voxel %llu is \"%s\", which is no %s; check "
                             "ElementType and the data",
                             (unsigned long long)i, word, snow_type_name(type));
    }
    return SNOW_OK;
}
