/* formats/nrrd/unpack.c - the encodings of NRRD's binary data: gzip, bzip2, and
 * hex, two digits for each byte with blanks anywhere. */
#include "formats/bytes/bzip2.h"
#include "formats/nrrd/nrrd.h"
#include "io/filters/filters.h"

#include <ctype.h>
#include <string.h>

typedef struct hex_filter {
    snow_filter_stage filter;
    int digits;    /* of a byte, so far */
    unsigned byte; /* their value */
} hex_filter;

static snow_status fail_hex(const hex_filter *hex, const char *what) {
    return snow_fail(hex->filter.context, SNOW_STATUS_BAD_INPUT,
                     "%s: its hexadecimal data %s; fetch or write it again",
                     hex->filter.name, what);
}

static snow_status pull_hex(snow_filter_stage *filter, void *bytes, size_t size,
                            size_t *got) {
    static const char digits[] = "0123456789abcdef";
    hex_filter *hex = (hex_filter *)filter;
    snow_filter_stage *below = filter->below;
    for (*got = 0; *got < size;) {
        SNOW_TRY(snow_filter_stage_fill(below, 1));
        if (below->begin == below->end)
            return hex->digits ? fail_hex(hex, "end within a byte")
                               : SNOW_STATUS_OK;
        const int letter = tolower(below->buffer[below->begin]);
        const char *digit = letter ? strchr(digits, letter) : NULL;
        if (!digit && !isspace(letter))
            return fail_hex(hex, "have a letter that is no digit");
        snow_filter_stage_drop(below, 1);
        if (!digit)
            continue;
        hex->byte = hex->byte << 4 | (unsigned)(digit - digits);
        if (++hex->digits == 2) {
            ((unsigned char *)bytes)[(*got)++] = (unsigned char)hex->byte;
            hex->digits = 0;
        }
    }
    return SNOW_STATUS_OK;
}

static uint64_t limit_hex(const snow_filter_stage *filter) {
    return snow_filter_stage_limit(filter->below) / 2 +
           (filter->end - filter->begin) + 1;
}

static snow_status open_hex(snow_filter_stage *below, snow_filter_stage **out) {
    hex_filter *hex = snow_filter_stage_allocate(below->context, sizeof *hex);
    if (!hex)
        return SNOW_STATUS_NO_MEMORY;
    hex->filter.name = below->name;
    hex->filter.below = below;
    hex->filter.pull = pull_hex;
    hex->filter.limit = limit_hex;
    hex->filter.size = -1;
    *out = &hex->filter;
    return SNOW_STATUS_OK;
}

snow_status snow_nrrd_unpack(snow_source *source, nrrd_encoding encoding) {
    switch (encoding) {
    case NRRD_GZIP:
        return snow_source_unpack(source);
    case NRRD_BZIP2:
        return snow_source_unpack_bzip2(source);
    case NRRD_HEX:
        return snow_source_unpack_by(source, open_hex);
    case NRRD_RAW:
    case NRRD_ASCII:
        break;
    }
    return SNOW_STATUS_OK;
}
