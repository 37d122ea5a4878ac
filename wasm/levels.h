/* levels.h - which level of a pyramid is fetched from a server. */
#ifndef WASM_LEVELS_H
#define WASM_LEVELS_H

#include <snowglass/snowglass.h>

/* What was found of an image of OME-Zarr. */
typedef struct level_choice {
    char dataset[512]; /* the level's path; "": the finest one will do */
    int level, levels; /* its number; how many there are; 0: it is no image */
    double bytes, left; /* of the voxels in all channels: of the finest one, of
                           this one */
} level_choice;

/* Looks for the finest level with at most so many bytes of voxels, else for the
 * coarsest; reads metadata alone.  What cannot be read is no image: opening
 * says why. */
level_choice level_choose(const char *path, double most);

#endif
