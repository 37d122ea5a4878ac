/* bench/speed/speed_ways.c - the ways to make a picture that are compared, as
 * data: a new one is a line here. */
#include "speed.h"

#include <stdio.h>
#include <string.h>

/* Bounds: what scatters the exact sum may differ from it by rounding only.
 * Shear-warp and raycast are held against rays in high quality: nearer where
 * the look is translucent, and the finer the lattice or the step.  A table of
 * footprints moves each by up to 1/32 of a pixel, which single pixels of the
 * aneurism show by 0.052. */
#define EXACT {{60, 60}, {60, 60}}, 1e-3
#define DRAFT {{24, 20}, {24, 20}}, 1
#define NORMAL {{26, 22}, {26, 22}}, 1
#define HIGH {{32, 28}, {32, 28}}, 1
#define TABLE {{48, 48}, {48, 48}}, 0.08
#define COARSE {{45, 40}, {36, 34}}, 1
#define FINE {{50, 45}, {40, 38}}, 1

#define CUBIC SNOW_KERNEL_BSPLINE, 4
#define TENT SNOW_KERNEL_TENT, 2
#define WAY(method, encoding, quality)                     \
    SNOW_METHOD_##method, false, SNOW_ENCODING_##encoding, \
        SNOW_QUALITY_##quality
#define BY_TABLE \
    SNOW_METHOD_ORIGINAL, true, SNOW_ENCODING_AUTO, SNOW_QUALITY_NORMAL

/* clang-format off */
const speed_way speed_ways[] = {
    {"original", WAY(ORIGINAL, AUTO, NORMAL), CUBIC, EXACT, "original"},
    {"original-table", BY_TABLE, CUBIC, TABLE, "original, by a table"},
    {"tested", WAY(TESTED, AUTO, NORMAL), CUBIC, EXACT, "tested"},
    {"footprint crs", WAY(FOOTPRINT, CRS, NORMAL), CUBIC, EXACT,
     "footprint, CRS"},
    {"footprint bitmap", WAY(FOOTPRINT, BITMAP, NORMAL), CUBIC, EXACT,
     "footprint, bit-map"},
    {"footprint rle", WAY(FOOTPRINT, RLE, NORMAL), CUBIC, EXACT,
     "footprint, RLE"},
    {"shear-warp normal", WAY(SHEAR_WARP, AUTO, NORMAL), TENT, NORMAL,
     "shear-warp, normal"},
    {"shear-warp normal crs", WAY(SHEAR_WARP, CRS, NORMAL), TENT, NORMAL, NULL},
    {"shear-warp normal bitmap", WAY(SHEAR_WARP, BITMAP, NORMAL), TENT, NORMAL,
     NULL},
    {"shear-warp normal rle", WAY(SHEAR_WARP, RLE, NORMAL), TENT, NORMAL, NULL},
    {"shear-warp high", WAY(SHEAR_WARP, AUTO, HIGH), TENT, HIGH, NULL},
    {"original", WAY(ORIGINAL, AUTO, NORMAL), TENT, EXACT, NULL},
    {"original-table", BY_TABLE, TENT, TABLE, NULL},
    {"tested", WAY(TESTED, AUTO, NORMAL), TENT, EXACT, NULL},
    {"shear-warp draft", WAY(SHEAR_WARP, AUTO, DRAFT), TENT, DRAFT,
     "shear-warp, draft"},
    {"raycast draft", WAY(RAYCAST, AUTO, DRAFT), TENT, COARSE, NULL},
    {"raycast normal", WAY(RAYCAST, AUTO, NORMAL), TENT, FINE, NULL},
};
/* clang-format on */

#define WAYS (int)(sizeof speed_ways / sizeof speed_ways[0])

const int speed_way_count = WAYS;

_Static_assert(WAYS <= SPEED_WAYS_MOST, "a session has room for all ways");

bool speed_is_baseline(const speed_way *way) {
    return way->method == SNOW_METHOD_ORIGINAL ||
           way->method == SNOW_METHOD_TESTED;
}

/* No method of the library. */
#define ORIGINAL_TABLE 31

/* --- the words of --only -------------------------------------------------- */

static const struct {
    const char *word;
    speed_kind kind;
    int value;
} words[] = {
    {"translucent", SPEED_LOOK, SPEED_TRANSLUCENT},
    {"opaque", SPEED_LOOK, SPEED_OPAQUE},
    {"grey", SPEED_COLOR, false},
    {"rgba", SPEED_COLOR, true},
    {"unshaded", SPEED_SHADE, SNOW_SHADE_NONE},
    {"phong", SPEED_SHADE, SNOW_SHADE_PHONG},
    {"original", SPEED_METHOD, SNOW_METHOD_ORIGINAL},
    {"original-table", SPEED_METHOD, ORIGINAL_TABLE},
    {"tested", SPEED_METHOD, SNOW_METHOD_TESTED},
    {"footprint", SPEED_METHOD, SNOW_METHOD_FOOTPRINT},
    {"shear-warp", SPEED_METHOD, SNOW_METHOD_SHEAR_WARP},
    {"raycast", SPEED_METHOD, SNOW_METHOD_RAYCAST},
    {"auto", SPEED_ENCODING, SNOW_ENCODING_AUTO},
    {"crs", SPEED_ENCODING, SNOW_ENCODING_CRS},
    {"bitmap", SPEED_ENCODING, SNOW_ENCODING_BITMAP},
    {"rle", SPEED_ENCODING, SNOW_ENCODING_RLE},
    {"draft", SPEED_QUALITY, SNOW_QUALITY_DRAFT},
    {"normal", SPEED_QUALITY, SNOW_QUALITY_NORMAL},
    {"high", SPEED_QUALITY, SNOW_QUALITY_HIGH},
    {"bspline", SPEED_KERNEL, SNOW_KERNEL_BSPLINE},
    {"tent", SPEED_KERNEL, SNOW_KERNEL_TENT},
};

#define WORDS (sizeof words / sizeof words[0])

static bool take_word(const char *word, size_t length, speed_filter *out) {
    for (size_t i = 0; i < WORDS; i++)
        if (strlen(words[i].word) == length &&
            strncmp(words[i].word, word, length) == 0) {
            out->taken[words[i].kind] |= 1u << words[i].value;
            return true;
        }
    fprintf(stderr, "snowglass: bench: --only knows no '%.*s'; choose from:",
            (int)length, word);
    for (size_t i = 0; i < WORDS; i++)
        fprintf(stderr, " %s", words[i].word);
    fprintf(stderr, "\n");
    return false;
}

bool speed_filter_read(const char *text, speed_filter *out) {
    *out = (speed_filter){{0}};
    while (text) {
        size_t length = strcspn(text, ",");
        if (!take_word(text, length, out))
            return false;
        text = text[length] ? text + length + 1 : NULL;
    }
    return true;
}

bool speed_filter_takes(const speed_filter *filter, speed_kind kind,
                        int value) {
    unsigned taken = filter->taken[kind];
    return !taken || taken >> value & 1;
}

/* Raycast is slow, and measured where it is asked for.
 * A kind that a way does not have (the quality of a footprint) restricts it
 * not. */
static bool passes(const speed_filter *filter, bool sweep,
                   const speed_way *way) {
    bool qualities = way->method == SNOW_METHOD_SHEAR_WARP ||
                     way->method == SNOW_METHOD_RAYCAST;
    if (sweep && !way->charted)
        return false;
    const bool named = filter->taken[SPEED_METHOD] >> way->method & 1;
    if (way->method == SNOW_METHOD_RAYCAST && !named)
        return false;
    return speed_filter_takes(filter, SPEED_METHOD,
                              way->tabled ? ORIGINAL_TABLE
                                          : (int)way->method) &&
           speed_filter_takes(filter, SPEED_KERNEL, (int)way->kernel) &&
           (speed_is_baseline(way) ||
            speed_filter_takes(filter, SPEED_ENCODING, (int)way->encoding)) &&
           (!qualities ||
            speed_filter_takes(filter, SPEED_QUALITY, (int)way->quality));
}

bool speed_way_taken(const speed_filter *filter, bool sweep, int index) {
    const speed_way *way = &speed_ways[index];
    bool others = false, kin = false;
    if (!passes(filter, sweep, way))
        return false;
    for (int i = 0; i < WAYS; i++) {
        const speed_way *other = &speed_ways[i];
        if (speed_is_baseline(other) || !passes(filter, sweep, other))
            continue;
        others = true;
        kin = kin || other->kernel == way->kernel;
    }
    return !speed_is_baseline(way) || kin || !others;
}
