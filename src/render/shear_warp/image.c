/* render/shear_warp/image.c - the image on the lattice: its memory, which is
 * kept from picture to picture, and what others see of it. */
#include "base/clear.h"
#include "render/shear_warp/layers.h"

#include <string.h>

/* A side of the blocks of a quincunx, pixels. */
#define BLOCK 16

bool snow_value_shows(const snow_value_path *path) {
    bool values = snow_value_has_values(path);
    for (int n = 0; n < path->layer_count; n++)
        values |= snow_value_has_values(path->layers[n]);
    return !path->lattice.empty && values;
}

/* Blocks along a side of a quincunx. */
static int blocks_of(const snow_value_lattice *l) {
    return l->width / BLOCK + 1;
}

/* --- memory --------------------------------------------------------------- */

/* The grid of a picture: the one before, if its tiles have room there. */
static bool keep_grid(const snow_value_path *path,
                      const snow_value_params *params, int layers,
                      snow_value_grid *grid) {
    const snow_value_lattice *l = &path->lattice;
    const snow_value_grid *has = &path->image->grid;
    const int spare = params->shared || params->volume->stream ? 0 : 2;
    *grid = (snow_value_grid){
        .cells = {l->cells[0], l->cells[1]},
        .tiles = {(int)((l->voxels[0] + SNOW_VALUE_COLUMNS - 1) /
                        SNOW_VALUE_COLUMNS),
                  (int)((l->voxels[1] + SNOW_VALUE_ROWS - 1) /
                        SNOW_VALUE_ROWS)},
        .channels = params->channels,
        .layers = layers,
        .quincunx = l->quincunx,
        .shared = params->shared};
    bool keep =
        !params->shared && /* the exchange has put lines of others there */
        has->channels == grid->channels && has->quincunx == grid->quincunx &&
        has->cells[0] == grid->cells[0] && has->cells[1] == grid->cells[1] &&
        has->layers == grid->layers && !has->shared;
    for (int axis = 0; axis < 2; axis++)
        keep = keep && has->tiles[axis] >= grid->tiles[axis] &&
               has->tiles[axis] <= 2 * grid->tiles[axis] + 4;
    for (int axis = 0; axis < 2; axis++)
        grid->tiles[axis] = keep ? has->tiles[axis] : grid->tiles[axis] + spare;
    return keep;
}

/* The plane of all tiles; that of a quincunx becomes the image. */
static void size_plane(snow_value_lattice *l, const snow_value_grid *grid,
                       snow_value_image *image) {
    size_t width =
        (size_t)grid->tiles[0] * SNOW_VALUE_COLUMNS * (size_t)l->cells[0];
    size_t height =
        (size_t)grid->tiles[1] * SNOW_VALUE_ROWS * (size_t)l->cells[1];
    if (l->quincunx) { /* cell (0, 0) is at the left, half way down */
        snow_value_lattice_move(l, 1, (double)height - l->top);
        l->top = (int)height;
        width = height = width + height + 1;
        l->width = l->height = (int)width;
    }
    if (l->quincunx && grid->shared) /* whole blocks are cleared */
        width = (size_t)blocks_of(l) * BLOCK;
    image->stride = width * (size_t)grid->channels;
    image->layer_floats = image->stride * (height + 1);
    image->lattice = *l;
}

snow_status snow_value_reserve_image(snow_value_path *path,
                                     const snow_value_params *params) {
    snow_value_grid grid;
    if (params->aside)
        path->image = &path->images[path->image == path->images];
    snow_value_image *image = path->image;
    /* How many layers; -1: these slices are not whole groups. */
    int layers = !params->settings->deterministic
                     ? 1
                     : snow_group_nodes(params->placement->slices, params->slab,
                                        path->image->nodes);
    if (layers < 0)
        return snow_fail(path->context, SNOW_STATUS_BAD_USAGE,
                         "parts of a deterministic picture must begin and end "
                         "at multiples of %d groups of slices",
                         SNOW_GROUPS);
    bool keep = keep_grid(path, params, layers, &grid);
    size_t planes = layers > 1 ? (size_t)layers : 1;
    size_plane(&path->lattice, &grid, image);
    image->grid.tiles[0] = 0; /* until it is cleared */
    const size_t bytes = image->layer_floats * sizeof *image->plane;
    SNOW_TRY(snow_reserve(path->context, &image->plane, 0, planes, bytes));
    size_t tiles = (size_t)grid.tiles[0] * (size_t)grid.tiles[1] * planes;
    SNOW_TRY(
        SNOW_RESERVE(path->context, image->drawn, keep ? tiles : 0, tiles));
    SNOW_TRY(
        SNOW_RESERVE(path->context, image->current, keep ? tiles : 0, tiles));
    if (!keep || !params->more)
        memset(image->current, 0, tiles);
    /* What is shared is cleared where it is asked for. */
    if (!keep && !grid.shared)
        SNOW_TRY(snow_clear(path->context, image->plane, planes * bytes));
    if (!keep)
        memset(image->drawn, 0, tiles);
    image->grid = grid;
    return SNOW_STATUS_OK;
}

/* --- blocks of a quincunx ------------------------------------------------- */

/* The tiles along an axis that have samples low .. high, of so many a tile;
 * whether some of these samples are in none. */
static bool tiles_of(int low, int high, int samples, int tiles, int range[2]) {
    const int first = low < 0 ? 0 : low / samples;
    const int last = high < 0 ? -1 : high / samples;
    range[0] = first < tiles ? first : tiles;
    range[1] = last < tiles ? last : tiles - 1;
    return low < 0 || last >= tiles;
}

typedef enum block_state { UNTOUCHED, TOUCHED, COVERED } block_state;

/* Whether none, some or all pixels of the block from pixel (a, b) on are of
 * tiles that a layer has drawn.  Pixel (a, b) is sample ((a + b - top) / 2, (a
 * - b + top) / 2) of the lattice. */
static block_state state_of(const snow_value_image *image,
                            const unsigned char *drawn, int a, int b) {
    const snow_value_lattice *l = &image->lattice;
    const snow_value_grid *grid = &image->grid;
    const int sum = a + b - l->top, difference = a - b + l->top;
    int x[2], y[2];
    bool any = false, all = true;
    all &= !tiles_of((sum - 1) / 2 - 1, (sum + 2 * BLOCK) / 2 + 1,
                     l->cells[0] * SNOW_VALUE_COLUMNS, grid->tiles[0], x);
    all &= !tiles_of((difference - BLOCK) / 2 - 1, (difference + BLOCK) / 2 + 1,
                     l->cells[1] * SNOW_VALUE_ROWS, grid->tiles[1], y);
    for (int row = y[0]; row <= y[1]; row++)
        for (int column = x[0]; column <= x[1]; column++) {
            const bool is = drawn[row * grid->tiles[0] + column];
            any |= is;
            all &= is;
        }
    return !any ? UNTOUCHED : all ? COVERED : TOUCHED;
}

/* Where the pixels of a block are among the tiles, of all layers alike: pixel
 * (x, y) of it is in column columns[x + y] and line lines[x - y + BLOCK - 1] of
 * tiles; -1: beyond all. */
typedef struct block_tiles {
    int columns[2 * BLOCK - 1], lines[2 * BLOCK - 1];
} block_tiles;

static int tile_of(int twice, int samples, int tiles) {
    const int tile = twice / 2 / samples;
    return twice < 0 || tile >= tiles ? -1 : tile;
}

static block_tiles tiles_under(const snow_value_image *image, int a, int b) {
    const snow_value_lattice *l = &image->lattice;
    const int *tiles = image->grid.tiles;
    block_tiles under;
    for (int n = 0; n < 2 * BLOCK - 1; n++) {
        under.columns[n] = tile_of(a + b - l->top + n,
                                   SNOW_VALUE_COLUMNS * l->cells[0], tiles[0]);
        under.lines[n] = tile_of(a - b + l->top + n - (BLOCK - 1),
                                 SNOW_VALUE_ROWS * l->cells[1], tiles[1]);
    }
    return under;
}

/* Clears the pixels of a block from (a, b) on that no drawn tile of a layer
 * has. */
static void clear_beside(const snow_value_image *image, size_t layer,
                         const unsigned char *drawn, int a, int b) {
    const block_tiles under = tiles_under(image, a, b);
    const int channels = image->grid.channels;
    const int left = image->lattice.height - b;
    float *line = image->plane + layer * image->layer_floats +
                  (size_t)b * image->stride + (size_t)a * (size_t)channels;
    for (int y = 0; y < BLOCK && y < left; y++, line += image->stride)
        for (int x = 0; x < BLOCK; x++) {
            const int column = under.columns[x + y];
            const int row = under.lines[x - y + BLOCK - 1];
            if (column < 0 || row < 0 ||
                !drawn[row * image->grid.tiles[0] + column])
                memset(line + x * channels, 0, (size_t)channels * sizeof *line);
        }
}

/* The blocks of all layers; of those that have pixels of drawn tiles all others
 * are cleared, where the image was not before. */
static void find_blocks(snow_value_image *image) {
    const int blocks = blocks_of(&image->lattice);
    const size_t layers =
        image->grid.layers > 1 ? (size_t)image->grid.layers : 1;
    unsigned char *block = image->blocks;
    for (size_t n = 0; n < layers; n++) {
        const unsigned char *drawn = image->drawn + n * snow_value_tiles(image);
        for (int b = 0; b < blocks; b++)
            for (int a = 0; a < blocks; a++) {
                const block_state state =
                    state_of(image, drawn, a * BLOCK, b * BLOCK);
                *block++ = state != UNTOUCHED;
                if (state == TOUCHED && image->grid.shared)
                    clear_beside(image, n, drawn, a * BLOCK, b * BLOCK);
            }
    }
}

/* --- the image ------------------------------------------------------------ */

/* The image as it is combined with others. */
static snow_status describe_plane(snow_context *context, snow_value_image *of,
                                  snow_shear_warp_image *image) {
    const snow_value_lattice *l = &of->lattice;
    const int blocks = blocks_of(l);
    *image =
        (snow_shear_warp_image){.width = l->width,
                                .height = l->height,
                                .channels = of->grid.channels,
                                .pixels = of->plane,
                                .stride = of->stride,
                                .drawn = of->drawn,
                                .tile_width = SNOW_VALUE_COLUMNS * l->cells[0],
                                .tile_height = SNOW_VALUE_ROWS * l->cells[1],
                                .tiles = of->grid.tiles[0],
                                .layers = of->grid.layers,
                                .layer_floats = of->layer_floats,
                                .layer_tiles = snow_value_tiles(of),
                                .warping = &of->warping};
    if (!l->quincunx)
        return SNOW_STATUS_OK;
    const size_t layers = of->grid.layers > 1 ? (size_t)of->grid.layers : 1;
    SNOW_TRY(SNOW_RESERVE(context, of->blocks, 0,
                          layers * (size_t)blocks * (size_t)blocks));
    image->drawn = of->blocks;
    image->tile_width = image->tile_height = BLOCK;
    image->tiles = blocks;
    image->layer_tiles = (size_t)(blocks * blocks);
    return SNOW_STATUS_OK;
}

snow_status snow_value_describe_image(snow_value_path *path,
                                      const snow_value_params *params,
                                      snow_shear_warp_image *out) {
    SNOW_TRY(describe_plane(path->context, path->image, out));
    return snow_value_place_show(path, params, out);
}

void snow_value_end_image(snow_value_image *image) {
    if (image->lattice.quincunx)
        find_blocks(image);
}
