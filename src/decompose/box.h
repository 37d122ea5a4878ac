/* decompose/box.h - boxes of voxels of a grid. */
#ifndef SNOW_BOX_H
#define SNOW_BOX_H

#include <snowglass/extend.h>

#endif
