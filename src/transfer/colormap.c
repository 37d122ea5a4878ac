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
 *   light-grey, dim-grey  parts of grey, of looks made from the histogram
 *   tab10      ten colours for categories, Tableau's of 2016 (matplotlib)
 * A new map needs a table here and a line in `maps`. */
#include "transfer/look.h"

/* A colour at `at` / 510 of the map (entry n of 256 is at 2 n). */
typedef struct map_point {
    uint16_t at;
    uint32_t rgb; /* 0xRRGGBB */
} map_point;

#define MAP_END 510

static const map_point grey[] = {{0, 0x000000}, {510, 0xffffff}};
static const map_point dim_grey[] = {{0, 0x000000}, {510, 0xf7f7f7}};
static const map_point light_grey[] = {{0, 0xa6a6a6}, {510, 0xffffff}};

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

/* Ten equal steps without interpolation. */
static const map_point category[] = {
    {0, 0x1f77b4},   {51, 0x1f77b4},  {51, 0xff7f0e},  {102, 0xff7f0e},
    {102, 0x2ca02c}, {153, 0x2ca02c}, {153, 0xd62728}, {204, 0xd62728},
    {204, 0x9467bd}, {255, 0x9467bd}, {255, 0x8c564b}, {306, 0x8c564b},
    {306, 0xe377c2}, {357, 0xe377c2}, {357, 0x7f7f7f}, {408, 0x7f7f7f},
    {408, 0xbcbd22}, {459, 0xbcbd22}, {459, 0x17becf}, {510, 0x17becf}};

#define MAP(name, points) \
    { name, points, sizeof points / sizeof *points }

static const struct {
    const char *name;
    const map_point *points;
    size_t count;
} maps[] = {
    MAP("grey", grey),
    MAP("viridis", viridis),
    MAP("inferno", inferno),
    MAP("cool-warm", cool_warm),
    MAP("turbo", turbo),
    MAP("magma", magma),
    MAP("plasma", plasma),
    MAP("cividis", cividis),
    MAP("hot", hot),
    MAP("tab10", category),
    MAP("light-grey", light_grey),
    MAP("dim-grey", dim_grey),
};

static const size_t map_count = sizeof maps / sizeof *maps;

const char *snow_colormap_name(size_t index) {
    return index < map_count ? maps[index].name : NULL;
}

int snow_colormap_from_name(const char *name) {
    if (snow_same_name(name, "gray"))
        name = "grey";
    if (snow_same_name(name, "light-gray"))
        name = "light-grey";
    for (size_t i = 0; i < map_count; i++)
        if (snow_same_name(name, maps[i].name))
            return (int)i;
    return -1;
}

size_t snow_colormap_points(size_t index, snow_color_point *points,
                            size_t room) {
    if (index >= map_count)
        return 0;
    size_t count = maps[index].count < room ? maps[index].count : room;
    for (size_t i = 0; i < count; i++) {
        const map_point *p = maps[index].points + i;
        points[i] = (snow_color_point){
            p->at / (double)MAP_END, (p->rgb >> 16) / 255.0,
            (p->rgb >> 8 & 255) / 255.0, (p->rgb & 255) / 255.0};
    }
    return count;
}

void snow_transfer_builder_colormap(snow_transfer_builder *builder,
                                    int colormap, double low, double high) {
    builder->name = maps[colormap].name;
    builder->color_count = snow_colormap_points(
        (size_t)colormap, builder->colors, SNOW_TRANSFER_BUILDER_POINTS);
    for (size_t i = 0; i < builder->color_count; i++)
        builder->colors[i].value =
            snow_between_on(builder->log, low, high, builder->colors[i].value);
}
