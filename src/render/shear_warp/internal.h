/* render/shear_warp/internal.h - what shear-warp keeps between pictures. */
#ifndef SNOW_RENDER_SHEAR_WARP_INTERNAL_H
#define SNOW_RENDER_SHEAR_WARP_INTERNAL_H

#include "composite/over.h"
#include "render/shear_warp/shear_warp.h"
#include "render/shear_warp/warping.h"

/* What the encoding is of. */
typedef struct snow_value_key {
    uint64_t generation; /* of the volume; 0: of none */
    int slice_axis;
    snow_value_scale14 scale;
    bool labels, cubic;
    snow_encoding encoding; /* as asked for */
} snow_value_key;

/* An encoding that is kept, and what it is of. */
typedef struct snow_value_encoding {
    snow_value_store store;
    snow_value_key key;
    int64_t interesting; /* voxels; below 0: to be counted */
} snow_value_encoding;

/* A slab of a file: its record without voxels, and their encoding, which is in
 * the path while it is drawn. */
typedef struct snow_value_kept_slab {
    snow_volume *slab;
    snow_value_encoding kept;
} snow_value_kept_slab;

/* Encodings along other slice axes than that in the path (axes.c). */
typedef struct snow_value_axes {
    snow_value_encoding kept[3];
    /* Right, up and back of the picture before, and the generation of its
     * volume; 0: there was none. */
    double camera[3][3];
    uint64_t camera_of;
} snow_value_axes;

typedef struct snow_value_kept_slabs {
    snow_value_kept_slab *slabs;
    int count;
    uint64_t of;    /* the generation of the volume in its file; 0: none */
    int slice_axis; /* and of the encodings */
    int64_t slices, ghosts; /* of a slab */
} snow_value_kept_slabs;

/* How tiles lie in the plane.  As long as that stays, only the tiles that were
 * drawn have to be cleared. */
typedef struct snow_value_grid {
    int cells[2], tiles[2]; /* the latter may be more than a picture has */
    int channels, layers;
    bool quincunx, shared;
} snow_value_grid;

/* A mode: what becomes of the slabs of a ray.  Those that make no colours have
 * pixels (value, weight), and NULL where over needs nothing. */
typedef struct snow_value_operator {
    snow_mode mode;
    snow_value_reduction reduction;
    /* Which quantized values the pictures do not need, of all data values;
     * NULL: of the look's those that are invisible. */
    void (*hides)(snow_value_path *path, const snow_value_look *look,
                  const snow_settings *settings);
    /* A row of a phase of a tile as pixels of the picture's channels. */
    void (*read)(const snow_value_splat *splat, const void *planes, int phase,
                 int row, float *out);
    /* Lays pixels of a part behind those of others; NULL: tiles resume. */
    snow_composite_fn *combine;
    /* Makes pixels of all parts (number of 0 to 1, 1), or (0, 0). */
    void (*finish)(const snow_value_path *path, float *pixels, int count);
} snow_value_operator;

/* A tile, and how long it took in the picture before. */
typedef struct snow_value_turn {
    int32_t tile;
    float seconds;
} snow_value_turn;

/* The image on the lattice. */
typedef struct snow_value_image {
    const snow_value_path *path;
    snow_value_lattice lattice; /* of its picture */
    float *plane;               /* layer by layer */
    size_t stride;              /* floats of a line of it */
    size_t layer_floats;
    snow_group_node nodes[SNOW_NODES_MOST]; /* of the layers, deterministic */
    snow_value_grid grid;            /* of it; no tiles: anything is there */
    unsigned char *drawn;            /* its tiles */
    unsigned char *current;          /* those that this picture has made */
    unsigned char *blocks;           /* its blocks, of a quincunx */
    snow_value_turn *turns;          /* its tiles, as threads take them, ... */
    size_t turn_count;               /* ... and as many more */
    snow_shear_warp_warping warping; /* of that */
    /* What means read: the same, or an image halved. */
    snow_shear_warp_warping shown;
    float *halved; /* the image made smaller */
} snow_value_image;

/* Lines of the picture, as pixels (a, b) of the image: (line . (1, a, b)) /
 * (depth . (1, a, b)) between low and high, where the depth is above 0. */
typedef struct snow_value_strip {
    bool whole; /* all lines */
    double line[3], depth[3], low, high;
    double border; /* pixels of the image that the warp reads around a place */
} snow_value_strip;

/* A part's image in the making. */
typedef struct snow_value_drawing {
    snow_value_path *path;
    snow_value_params params; /* volume and transfer function may be gone */
    snow_value_splat splat;   /* but for its resampled slices */
    snow_value_strip strip;   /* whose tiles are drawn */
    snow_value_tile_fn *tile;
    size_t scratch_bytes; /* of a worker */
} snow_value_drawing;

struct snow_value_path {
    snow_context *context;
    const snow_value_operator *op; /* of the picture */
    snow_value_lattice lattice;    /* of the picture */
    double reference, longest; /* world lengths: of an opacity, of any ray */
    snow_data_range range;     /* of the whole */
    snow_data_range measured; /* of the volume of this generation; 0: of none */
    uint64_t measured_of;
    snow_quantizer quantizer;
    snow_value_table table;
    snow_value_labels labels; /* of the volume of this generation */
    uint64_t labels_of;
    bool has_labels; /* the picture is of them */
    snow_value_encoding made;
    bool wavers; /* pictures of its key have shown more than the store had */
    snow_value_axes axes;
    snow_value_kept_slabs kept;
    snow_value_light light;
    snow_value_fade fade;
    snow_value_surface surface;
    snow_resampled_slice *resampled_slices;
    snow_value_place *places;
    snow_value_rays rays; /* perspective: instead of places */
    snow_value_spread *spreads;
    snow_value_lanes *lanes[2];
    double (*clips)[4];               /* clip planes by u, v and slice */
    snow_transfer curve;              /* its gradient opacity only, ... */
    snow_opacity_point *curve_points; /* ... which are copied */
    snow_value_image *image;          /* that is drawn: one of these */
    snow_value_image images[2];
    snow_value_drawing drawing; /* of that */
    snow_line_batch batch;      /* of its tiles */
    float *lines;               /* of the warp */
    char *scratch;
    snow_value_path *layers[SNOW_LAYERS_MAX]; /* of other volumes */
    int layer_count;                          /* of the picture */
    int group;      /* as a layer: those of one are mixed; the picture's is 0 */
    double white;   /* of colours that are mixed: their ground; or 0 */
    snow_clip clip; /* and what it has */
    snow_placement stored;
};

/* --- operators.c --- */

const snow_value_operator *snow_value_operator_of(snow_mode mode);

/* In perspective: the rays of the resampled slices, which are there.  Errors:
 * SNOW_STATUS_NO_MEMORY, SNOW_STATUS_STOPPED. */
snow_status snow_value_place_rays(snow_value_path *path,
                                  const snow_value_params *params);

/* --- shear_warp.c --- */

/* What an encoding for params is of. */
snow_value_key snow_value_key_of(const snow_value_path *path,
                                 const snow_value_params *params,
                                 uint64_t generation);

/* An order to encode, and what it points to.  `spare` leaves out fewer
 * quantized values, so that it serves views whose rays have another length.
 * Errors: SNOW_STATUS_NO_MEMORY. */
typedef struct snow_value_order {
    snow_value_store_params params;
    snow_transparent_interval intervals[SNOW_VALUE_RUNS];
    snow_value_stored_range seen[SNOW_VALUE_SEEN];
} snow_value_order;
snow_status snow_value_order_make(snow_value_path *path,
                                  const snow_value_params *params, bool spare,
                                  snow_value_order *out);

/* Returns whether an encoding, once it is whole, serves a part of a volume. */
bool snow_value_fits_key(const snow_value_path *path,
                         const snow_value_encoding *has,
                         const snow_value_params *params, uint64_t generation);

/* Returns whether it serves now. */
bool snow_value_serves(const snow_value_path *path,
                       const snow_value_encoding *has,
                       const snow_value_params *params, uint64_t generation);

/* --- axes.c --- */

/* The kept encoding along the axis of a picture to its place in the path; that
 * of another axis is kept instead.  Those of other volumes are given up, and
 * such as leave no room. */
void snow_value_change_axis(snow_value_path *path,
                            const snow_value_params *params);

/* After a picture that took so many seconds: the encoding along the next axis,
 * by so many bands that it is whole when the view, which goes on to turn, gets
 * there, or by what can be made in a tenth of the time, if that is more. */
void snow_value_prepare_axis(snow_value_path *path,
                             const snow_value_params *params, double seconds);

/* What is kept; false: nothing was. */
bool snow_value_forget_axes(snow_value_path *path);
uint64_t snow_value_axes_bytes(const snow_value_path *path);
uint64_t snow_value_axes_most(const snow_volume *volume);

/* --- kept.c --- */

/* Moves an encoding; what was at the other place is gone. */
void snow_value_move(snow_value_encoding *to, snow_value_encoding *from);

/* The encoding of a slab of a file to its place in the path, if it was kept. */
void snow_value_take_kept(snow_value_path *path, const snow_volume *slab);

/* Tiles of the grid. */
static inline size_t snow_value_tiles(const snow_value_image *image) {
    return (size_t)image->grid.tiles[0] * (size_t)image->grid.tiles[1];
}

/* --- image.c --- */

/* Returns whether there is anything to see; the same for all parts. */
bool snow_value_shows(const snow_value_path *path);

/* Room for a picture's image, which is cleared but for what it is known that
 * the next picture will write.  Errors: SNOW_STATUS_NO_MEMORY,
 * SNOW_STATUS_BAD_USAGE (slices that are not whole groups). */
snow_status snow_value_reserve_image(snow_value_path *path,
                                     const snow_value_params *params);

/* What is to be drawn, and how it is warped.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_describe_image(snow_value_path *path,
                                      const snow_value_params *params,
                                      snow_shear_warp_image *out);

/* When all of it is drawn. */
void snow_value_end_image(snow_value_image *image);

/* --- order.c --- */

/* The tiles in the order in which threads are to take them.  Errors:
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_order_tiles(snow_context *context,
                                   snow_value_image *image);

/* --- parts.c --- */

/* Moves the resampled slices of the whole to the voxels that a part has. */
void snow_value_move_slices(snow_value_path *path,
                            const snow_value_params *params);

/* The samples of a tile that are a part's, of those in its slab. */
void snow_value_own(const snow_value_params *params, snow_value_splat *splat);

/* The splat of the slabs between resampled slices that belong to some slices:
 * of the two slices beside it a slab is the nearer one's. */
snow_value_splat snow_value_splat_of(const snow_value_drawing *drawing,
                                     snow_slab slices);

/* Floats of a tile of a node, and of what its nodes are made of. */
size_t snow_value_node_floats(const snow_value_drawing *drawing);

/* Tile (x, y) of a node of the tree of groups: pixels [phase][row][column] of
 * `out`, each of the picture's channels; false: nothing is there, and anything
 * in `out`.  `room` is as the splat's. */
bool snow_value_node_tile(const snow_value_drawing *drawing,
                          snow_group_node node, int x, int y, void *scratch,
                          float *out);

/* --- lines.c --- */

/* The strip of lines[0] to lines[1] - 1, of a picture of so many. */
snow_value_strip snow_value_strip_of(const snow_value_lattice *lattice,
                                     const int lines[2], int height);

/* Returns whether a tile, from a column and row of the lattice's voxels on, is
 * needed for it. */
bool snow_value_strip_needs(const snow_value_strip *strip,
                            const snow_value_lattice *lattice, int64_t column,
                            int64_t row);

/* --- show.c --- */

/* How the image will be warped.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_value_place_show(snow_value_path *path,
                                  const snow_value_params *params,
                                  const snow_shear_warp_image *image);

/* The image to all of the picture.  Errors: SNOW_STATUS_NO_MEMORY,
 * SNOW_STATUS_STOPPED. */
snow_status snow_value_show(snow_value_path *path,
                            const snow_value_params *params, float *pixels);

#endif
