/* transfer/colormap.c - colour maps as control points.
 *
 * Each map is piecewise linear between the points below, which were fitted to
 * the published table so that no channel differs by more than 1/255 at any of
 * its entries.  Sources:
 *   viridis, inferno, magma, plasma  S. van der Walt, N. Smith, E. Firing 2015
 *                                    (matplotlib; CC0)
 *   cividis    J. Nunez, C. Anderton, R. Renslow 2018 (matplotlib's table; CC0)
 *   turbo      A. Mikhailov 2019 (Apache 2.0)
 *   cool-warm  K. Moreland, "Diverging color maps for scientific
 *              visualization", ISVC 2009: computed by its formula from
 *              (59, 76, 192) to (180, 4, 38)
 *   hot        black over red and yellow to white, as matplotlib's
 *   RdBu       C. Brewer's eleven colours, joined (matplotlib)
 *   seismic, bwr  blue over white to red, as matplotlib's
 *   red, green, blue, cyan, magenta, yellow  from black, of channels
 *   light-grey, dim-grey  parts of grey, of looks made from the histogram
 *   tab10      ten colours for categories, Tableau's of 2016 (matplotlib)
 * A new map needs a table here and a line in `maps`.  With an index that is
 * larger by their number it is reversed, and its name ends in _r.  A list of
 * colours at data values is a name too, and "reversed" are the look's own
 * colours the other way round. */
#include "transfer/look.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A colour at `at` / 510 of the map (entry n of 256 is at 2 n). */
typedef struct map_point {
    uint16_t at;
    uint32_t rgb; /* 0xRRGGBB */
} map_point;

#define MAP_END 510

static const map_point grey[] = {{0, 0x000000}, {510, 0xffffff}};
static const map_point dim_grey[] = {{0, 0x000000}, {510, 0xf7f7f7}};
static const map_point light_grey[] = {{0, 0xa6a6a6}, {510, 0xffffff}};

/* These are the maps of channels. */
static const map_point red[] = {{0, 0x000000}, {510, 0xff0000}};
static const map_point green[] = {{0, 0x000000}, {510, 0x00ff00}};
static const map_point blue[] = {{0, 0x000000}, {510, 0x0000ff}};
static const map_point cyan[] = {{0, 0x000000}, {510, 0x00ffff}};
static const map_point magenta[] = {{0, 0x000000}, {510, 0xff00ff}};
static const map_point yellow[] = {{0, 0x000000}, {510, 0xffff00}};

static const map_point hot[] = {
    {0, 0x0b0000}, {186, 0xff0000}, {380, 0xffff00}, {510, 0xffffff}};

static const map_point viridis[] = {
    {0, 0x440154},   {44, 0x492072},  {86, 0x443a84},  {144, 0x365b8d},
    {246, 0x228b8e}, {290, 0x1ea088}, {318, 0x27ad80}, {348, 0x3bba76},
    {390, 0x64cc5e}, {440, 0xa2da38}, {470, 0xcae01e}, {486, 0xdfe318},
    {500, 0xf1e51c}, {510, 0xfde725}};

static const map_point inferno[] = {
    {0, 0x000003},   {22, 0x050518},  {60, 0x1d0d45},  {82, 0x300a5d},
    {106, 0x450a6a}, {148, 0x67156f}, {200, 0x902469}, {258, 0xbe3754},
    {312, 0xe05436}, {354, 0xf3741c}, {388, 0xfa9107}, {400, 0xfb9d06},
    {416, 0xfcac10}, {448, 0xf8cb34}, {472, 0xf3e259}, {490, 0xf1f27d},
    {508, 0xfafda1}, {510, 0xfcffa4}};

static const map_point magma[] = {
    {0, 0x000003},   {26, 0x07061b},  {68, 0x1f124b},  {92, 0x321068},
    {114, 0x450f77}, {146, 0x5e1780}, {208, 0x8f2a81}, {264, 0xbd3978},
    {306, 0xde4968}, {342, 0xf2615c}, {372, 0xfa7d5d}, {406, 0xfd9d6b},
    {456, 0xfecb8e}, {510, 0xfcfdbf}};

static const map_point plasma[] = {
    {0, 0x0d0786},   {14, 0x20058f},  {60, 0x4a02a0},  {106, 0x6d00a9},
    {136, 0x8405a7}, {180, 0xa31c9b}, {256, 0xcc4777}, {338, 0xed7754},
    {404, 0xfca337}, {450, 0xfec626}, {482, 0xf8e024}, {502, 0xf2f127},
    {510, 0xf0f922}};

static const map_point cividis[] = {
    {0, 0x00224d},   {40, 0x003070},  {46, 0x013170},  {58, 0x15366f},
    {90, 0x2f416c},  {174, 0x5a5e6d}, {268, 0x828079}, {346, 0xa89e74},
    {420, 0xcebc63}, {472, 0xebd44c}, {502, 0xfde235}, {506, 0xfde534},
    {510, 0xfee838}};

static const map_point turbo[] = {
    {0, 0x30123c},   {18, 0x3a2c7a},  {34, 0x4043a7},  {50, 0x4558cc},
    {68, 0x4670e9},  {86, 0x4687fc},  {102, 0x3e9bff}, {120, 0x2fb2f4},
    {144, 0x1ccdd8}, {162, 0x17debf}, {176, 0x1ee8b0}, {192, 0x32f297},
    {214, 0x59fc72}, {240, 0x8cff4b}, {256, 0xa4fc3b}, {274, 0xbbf534},
    {302, 0xdee136}, {332, 0xf7c33b}, {360, 0xffa230}, {388, 0xfa771e},
    {420, 0xe94b0c}, {450, 0xcf2d04}, {482, 0xa71401}, {510, 0x7b0403}};

static const map_point cool_warm[] = {
    {0, 0x3b4cc0},   {46, 0x5673e1},  {94, 0x7699f7},  {138, 0x94b6ff},
    {182, 0xb3ccfc}, {227, 0xcddaec}, {259, 0xdfdcda}, {300, 0xf1cebb},
    {348, 0xf8b395}, {393, 0xf39272}, {443, 0xe0644e}, {484, 0xc73734},
    {502, 0xba1b2a}, {508, 0xb50b27}, {510, 0xb40426}};

static const map_point rdbu[] = {
    {0, 0x67001f},   {51, 0xb2182b},  {102, 0xd6604d}, {153, 0xf4a582},
    {204, 0xfddbc7}, {255, 0xf7f7f7}, {306, 0xd1e5f0}, {357, 0x92c5de},
    {408, 0x4393c3}, {459, 0x2166ac}, {510, 0x053061}};

static const map_point seismic[] = {
    {0, 0x00004d},   {127, 0x0000fe}, {128, 0x0101ff}, {255, 0xffffff},
    {382, 0xff0101}, {383, 0xfe0000}, {510, 0x800000}};

static const map_point bwr[] = {
    {0, 0x0000ff}, {255, 0xffffff}, {510, 0xff0000}};

/* Ten equal steps without interpolation. */
static const map_point category[] = {
    {0, 0x1f77b4},   {51, 0x1f77b4},  {51, 0xff7f0e},  {102, 0xff7f0e},
    {102, 0x2ca02c}, {153, 0x2ca02c}, {153, 0xd62728}, {204, 0xd62728},
    {204, 0x9467bd}, {255, 0x9467bd}, {255, 0x8c564b}, {306, 0x8c564b},
    {306, 0xe377c2}, {357, 0xe377c2}, {357, 0x7f7f7f}, {408, 0x7f7f7f},
    {408, 0xbcbd22}, {459, 0xbcbd22}, {459, 0x17becf}, {510, 0x17becf}};

#define MAP(name, points) \
    { {name, name "_r"}, points, sizeof points / sizeof *points }

static const struct {
    const char *names[2]; /* and reversed */
    const map_point *points;
    size_t count;
} maps[] = {
    MAP("grey", grey),         MAP("viridis", viridis),
    MAP("inferno", inferno),   MAP("cool-warm", cool_warm),
    MAP("turbo", turbo),       MAP("magma", magma),
    MAP("plasma", plasma),     MAP("cividis", cividis),
    MAP("hot", hot),           MAP("RdBu", rdbu),
    MAP("seismic", seismic),   MAP("bwr", bwr),
    MAP("tab10", category),    MAP("light-grey", light_grey),
    MAP("dim-grey", dim_grey), MAP("red", red),
    MAP("green", green),       MAP("blue", blue),
    MAP("cyan", cyan),         MAP("magenta", magenta),
    MAP("yellow", yellow),
};

static const size_t map_count = sizeof maps / sizeof *maps;

const char *snow_colormap_name(size_t index) {
    return index < map_count ? maps[index].names[0] : NULL;
}

/* "60:#000000,255:#ff8800", where values rise. */
size_t snow_colormap_list(const char *text, snow_color_point *points) {
    for (size_t count = 0; count < SNOW_COLORMAP_POINTS_MAX;) {
        const size_t length = strcspn(text, ":");
        char number[32], *end;
        double value;
        if (length >= sizeof number || strncmp(text + length, ":#", 2) != 0 ||
            strspn(text + length + 2, "0123456789abcdefABCDEF") != 6)
            return 0;
        memcpy(number, text, length);
        number[length] = 0;
        if (!snow_parse_double(number, &value) || !isfinite(value) ||
            (count && value < points[count - 1].value))
            return 0;
        const long rgb = strtol(text + length + 2, &end, 16);
        points[count++] = (snow_color_point){value, (double)(rgb >> 16) / 255,
                                             (double)(rgb >> 8 & 255) / 255,
                                             (double)(rgb & 255) / 255};
        if (!*end)
            return count;
        if (*end != ',')
            return 0;
        text = end + 1;
    }
    return 0;
}

bool snow_colormap_is_reversed(const char *name) {
    return snow_same_name(name, "reversed");
}

int snow_colormap_from_name(const char *name) {
    snow_color_point points[SNOW_COLORMAP_POINTS_MAX];

    static const char *const others[][2] = {
        {"gray", "grey"}, {"gray_r", "grey_r"}, {"light-gray", "light-grey"}};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (snow_same_name(name, others[i][0]))
            name = others[i][1];
    for (size_t i = 0; i < 2 * map_count; i++)
        if (snow_same_name(name, maps[i % map_count].names[i / map_count]))
            return (int)i;
    if (name && snow_colormap_is_reversed(name))
        return (int)(2 * map_count + 1);
    return name && snow_colormap_list(name, points) ? (int)(2 * map_count) : -1;
}

size_t snow_colormap_points(size_t index, snow_color_point *points,
                            size_t capacity) {
    if (index >= 2 * map_count)
        return 0;
    const bool reversed = index >= map_count;
    const size_t map = index % map_count, all = maps[map].count;
    const size_t count = all < capacity ? all : capacity;
    for (size_t i = 0; i < count; i++) {
        const map_point *p = maps[map].points + (reversed ? all - 1 - i : i);
        int at = reversed ? MAP_END - p->at : p->at;
        points[i] = (snow_color_point){
            at / (double)MAP_END, (p->rgb >> 16) / 255.0,
            (p->rgb >> 8 & 255) / 255.0, (p->rgb & 255) / 255.0};
    }
    return count;
}

/* The share of a value, as snow_transfer_builder_place takes it. */
static double share_of(const snow_transfer_builder *builder, double low,
                       double high, double value) {
    if (!builder->around_0 || !(low < 0) || !(high > 0))
        return snow_share_on(builder->scale, low, high, value);
    return value < 0 ? snow_share_on(builder->scale, low, 0, value) / 2
                     : 0.5 + snow_share_on(builder->scale, 0, high, value) / 2;
}

void snow_transfer_builder_reverse(snow_transfer_builder *builder) {
    snow_color_point *points = builder->colors;
    const size_t count = builder->color_count;
    const double low = points[0].value, high = points[count - 1].value;
    if (!(low < high))
        return;
    for (size_t i = 0; i < count / 2; i++) {
        const snow_color_point first = points[i];
        points[i] = points[count - 1 - i];
        points[count - 1 - i] = first;
    }
    for (size_t i = 0; i < count; i++)
        points[i].value = snow_transfer_builder_place(
            builder, low, high,
            1 - share_of(builder, low, high, points[i].value));
    builder->name = "reversed";
}

void snow_transfer_builder_colormap(snow_transfer_builder *builder,
                                    const char *name, double low, double high) {
    const size_t found = (size_t)snow_colormap_from_name(name);
    if (found == 2 * map_count) { /* where they are */
        builder->name = "own colours";
        builder->color_count = snow_colormap_list(name, builder->colors);
        builder->low = builder->colors[0].value;
        builder->high = builder->colors[builder->color_count - 1].value;
        return;
    }
    builder->name = maps[found % map_count].names[found / map_count];
    builder->color_count = snow_colormap_points(found, builder->colors,
                                                SNOW_TRANSFER_BUILDER_POINTS);
    for (size_t i = 0; i < builder->color_count; i++)
        builder->colors[i].value = snow_transfer_builder_place(
            builder, low, high, builder->colors[i].value);
}
