/* phantom/grid.c - where the voxels of a phantom lie, and their bytes. */
#include "phantom/phantom.h"

/* One product and one sum, so that all machines round alike. */
double snow_phantom_place(const snow_phantom_grid *grid, int axis,
                          int64_t index) {
    return grid->origin[axis] + grid->step[axis] * (double)index;
}

/* To the nearest, halves up; noise may reach past either end. */
uint8_t snow_phantom_byte(double value) {
    if (value <= 0)
        return 0;
    return value >= 255 ? 255 : (uint8_t)(value + 0.5);
}
