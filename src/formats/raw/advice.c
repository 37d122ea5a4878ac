/* formats/raw/advice.c - what a raw file of the wrong size may be: dims and
 * types that hold just its bytes, and what its name suggests.
 *
 * Archives name such files in many ways: head_256x256x113_uint8.raw,
 * foo_512_512_300_16bit.raw.  Only the first is clear enough to be read so
 * without being asked (raw.c); here both are suggestions. */
#include "formats/raw/raw.h"
#include "io/folder.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* The most dims that are listed; more confuse. */
#define MOST_LISTED 4

/* The bytes of a header of an unknown format. */
#define LEAST_HEADER 16
#define MOST_HEADER 4096

typedef struct advice {
    uint64_t bytes;
    char *out;
    size_t used, listed;
    int64_t last[3]; /* the dims that were listed last */
} advice;

static void add(advice *a, const char *format, ...) SNOW_PRINTF(2, 3);
static void add(advice *a, const char *format, ...) {
    va_list arguments;
    size_t room = RAW_ADVICE_BYTES - a->used;
    va_start(arguments, format);
    int length = vsnprintf(a->out + a->used, room, format, arguments);
    va_end(arguments);
    if (length > 0)
        a->used += (size_t)length < room ? (size_t)length : room - 1;
}

/* The usual types of a size in bytes. */
static const char *types_of(uint64_t size) {
    switch (size) {
    case 1:
        return "uint8 or int8";
    case 2:
        return "uint16 or int16";
    case 4:
        return "float32, int32 or uint32";
    case 8:
        return "float64";
    default:
        return NULL;
    }
}

/* The product, 0 if it is too large. */
static uint64_t product(const int64_t dims[3]) {
    uint64_t count = 1;
    for (int i = 0; i < 3; i++)
        if (!snow_mul_u64(count, (uint64_t)dims[i], &count))
            return 0;
    return count;
}

static void add_dims(advice *a, const int64_t dims[3]) {
    add(a, "%lldx%lldx%lld", (long long)dims[0], (long long)dims[1],
        (long long)dims[2]);
}

/* Lists dims and type if they hold the bytes exactly; types are the usual ones
 * of the size if `type` is not given. */
static void list(advice *a, const int64_t dims[3], uint64_t size,
                 snow_type type) {
    uint64_t count = product(dims), all;
    const char *types = type ? snow_type_name(type) : types_of(size);
    if (!count || !types || !snow_mul_u64(count, size, &all) ||
        all != a->bytes || a->listed == MOST_LISTED ||
        memcmp(dims, a->last, sizeof a->last) == 0)
        return;
    memcpy(a->last, dims, sizeof a->last);
    add(a, a->listed++ ? ", " : "; what fits: ");
    add_dims(a, dims);
    add(a, " %s", types);
}

/* --- what fits ------------------------------------------------------------ */

/* The dims with another type, and with another number of slices. */
static void list_by_dims(advice *a, const int64_t dims[3], snow_type type) {
    uint64_t count = product(dims), slice;
    if (count && a->bytes % count == 0)
        list(a, dims, a->bytes / count, SNOW_TYPE_NONE);
    int64_t other[3] = {dims[0], dims[1], 1};
    slice = product(other) * (type ? snow_type_size(type) : 0);
    if (!slice || a->bytes % slice || a->bytes / slice > INT64_MAX)
        return;
    other[2] = (int64_t)(a->bytes / slice);
    list(a, other, snow_type_size(type), type);
}

static void list_cube(advice *a, uint64_t size, snow_type type) {
    int64_t side = (int64_t)(cbrt((double)(a->bytes / size)) + 0.5);
    const int64_t dims[3] = {side, side, side};
    list(a, dims, size, type);
}

/* Stacks of square slices of usual sides, not much longer than wide. */
static void list_squares(advice *a, uint64_t size, snow_type type) {
    for (uint64_t side = 64; side <= 1024; side *= 2) {
        uint64_t slice = side * side * size, slices = a->bytes / slice;
        const int64_t dims[3] = {(int64_t)side, (int64_t)side, (int64_t)slices};
        if (slices >= side / 8 && slices < side)
            list(a, dims, size, type);
    }
}

/* Squares or cubes of the type, or of any. */
static void list_guesses(advice *a, bool squares, snow_type type) {
    for (uint64_t size = 1; size <= 8; size *= 2) {
        if (type && snow_type_size(type) != size)
            continue;
        if (squares)
            list_squares(a, size, type);
        else
            list_cube(a, size, type);
    }
}

static void list_fitting(advice *a, const snow_volume_options *options) {
    if (options->dims[0])
        list_by_dims(a, options->dims, options->type);
    else
        list_guesses(a, true, options->type);
    list_guesses(a, false, options->type);
}

/* More bytes than voxels by as many as a header has. */
static void add_header(advice *a, const snow_volume_options *options) {
    uint64_t all, count = options->dims[0] ? product(options->dims) : 0;
    if (!count || !options->type || options->offset ||
        !snow_mul_u64(count, snow_type_size(options->type), &all) ||
        a->bytes < all + LEAST_HEADER || a->bytes - all > MOST_HEADER)
        return;
    add(a, "; a header of %llu bytes would be skipped by --offset %llu",
        (unsigned long long)(a->bytes - all),
        (unsigned long long)(a->bytes - all));
}

/* --- the name ------------------------------------------------------------- */

/* What the words of a name say; 0 where they do not. */
typedef struct hint {
    int64_t dims[3];
    snow_type type;
    uint64_t size; /* bytes of a voxel, if the type is not given */
} hint;

/* A number of at most nine digits that is the whole word, else 0. */
static int64_t whole_number(const char *word, size_t length) {
    if (!length || length > 9 || strspn(word, "0123456789") != length)
        return 0;
    return strtoll(word, NULL, 10);
}

/* "16bit", "8bits". */
static uint64_t size_of_bits(const char *word, size_t length) {
    char *end;
    unsigned long bits =
        isdigit((unsigned char)*word) ? strtoul(word, &end, 10) : 0;
    if (!bits || bits > 64 || strncasecmp(end, "bit", 3) ||
        end + 3 > word + length)
        return 0;
    return bits <= 8 ? 1 : bits <= 16 ? 2 : bits <= 32 ? 4 : 8;
}

/* Three numbers in a row are dims. */
static void read_hint(const char *name, hint *out) {
    int64_t row[3] = {0};
    snow_endian unused;
    size_t numbers = 0;
    *out = (hint){.size = 0};
    for (const char *word = name; *word;) {
        size_t length = strcspn(word, RAW_BETWEEN);
        int64_t number = whole_number(word, length);
        row[numbers % 3] = number;
        numbers = number ? numbers + 1 : 0;
        if (!out->dims[0] && numbers == 3)
            memcpy(out->dims, row, sizeof row);
        if (!out->dims[0])
            snow_raw_parse_dims(word, length, out->dims);
        if (!out->type)
            snow_raw_parse_type(word, length, &out->type, &unused);
        if (!out->size)
            out->size = size_of_bits(word, length);
        word += length;
        word += strspn(word, RAW_BETWEEN);
    }
}

/* Whether the name says anything beyond what is known. */
static bool is_news(const hint *h, const snow_volume_options *options) {
    if (h->dims[0] && memcmp(h->dims, options->dims, sizeof h->dims) != 0)
        return true;
    if (h->type)
        return h->type != options->type;
    return h->size &&
           (!options->type || snow_type_size(options->type) != h->size);
}

/* Whether what the name says, and else what is known, holds the bytes. */
static bool hint_fits(const hint *h, uint64_t bytes,
                      const snow_volume_options *options) {
    uint64_t size = h->type ? snow_type_size(h->type) : h->size, all;
    const int64_t *dims = h->dims[0] ? h->dims : options->dims;
    if (!size && options->type)
        size = snow_type_size(options->type);
    return bytes && dims[0] && size &&
           snow_mul_u64(product(dims), size, &all) && all == bytes;
}

static void add_hint(advice *a, const hint *h, bool fits) {
    add(a, "; its name suggests");
    if (h->dims[0]) {
        add(a, " --dims ");
        add_dims(a, h->dims);
    }
    if (h->type)
        add(a, " --type %s", snow_type_name(h->type));
    else if (h->size)
        add(a, " --type %s", types_of(h->size));
    add(a, "%s", fits ? ", which fits" : "");
}

void snow_raw_advise(const char *name, uint64_t bytes,
                     const snow_volume_options *options,
                     char out[RAW_ADVICE_BYTES]) {
    advice a = {.bytes = bytes, .out = out};
    hint h;
    out[0] = 0;
    read_hint(snow_path_name(name), &h);
    bool news = is_news(&h, options);
    bool fits = news && hint_fits(&h, bytes, options);
    if (!fits) {
        list_fitting(&a, options);
        add_header(&a, options);
    }
    if (news)
        add_hint(&a, &h, fits);
}
