/* volume/extremes.c - types of 8 and 16 bits: their smallest value, and the
 * extremes of native values. */
#include "volume/volume.h"

int32_t snow_type_lowest(snow_type type) {
    return type == SNOW_TYPE_INT8    ? INT8_MIN
           : type == SNOW_TYPE_INT16 ? INT16_MIN
                                     : 0;
}

/* As values of a type whose extremes vectors of any machine find: with the sign
 * bit turned over where `flip` has it. */
#define EXTREMES(name, type, vector, flip)                         \
    case SNOW_TYPE_##name: {                                       \
        const type *stored = (const type *)volume->voxels + first; \
        vector least = (vector)(stored[0] ^ (flip)), most = least; \
        for (size_t n = 0; n < count; n++) {                       \
            vector here = (vector)(stored[n] ^ (flip));            \
            least = here < least ? here : least;                   \
            most = here > most ? here : most;                      \
        }                                                          \
        *low = (type)(least ^ (flip));                             \
        *high = (type)(most ^ (flip));                             \
        return true;                                               \
    }

bool snow_volume_extremes(const snow_volume *volume, int64_t first,
                          size_t count, int32_t *low, int32_t *high) {
    switch (volume->info.type) {
        EXTREMES(INT8, int8_t, uint8_t, 0x80)
        EXTREMES(UINT8, uint8_t, uint8_t, 0)
        EXTREMES(INT16, int16_t, int16_t, 0)
        EXTREMES(UINT16, uint16_t, int16_t, 0x8000)
    default:
        return false;
    }
}
