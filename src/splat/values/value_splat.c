/* splat/values/value_splat.c - tiles for each instruction set; see
 * value_splat.h. */
#include "splat/values/value_splat.h"

#include "classify/gradient_opacity.h"
#include "simd/rows.h"
#include "splat/values/value_room.h"

#include <string.h>

#define TEMPLATE "splat/values/tile.tmpl.h"
#include "simd/each_isa.h"

size_t snow_value_splat_bytes(const snow_value_splat *splat) {
    size_t bytes = snow_value_planes_bytes(splat) + sizeof(value_room) +
                   (size_t)splat->phases * 2 * sizeof(value_rows) +
                   (size_t)splat->sheet_count * sizeof(int32_t);
    return (bytes + 63) / 64 * 64;
}

#define EIGHT(level)                                                \
    {                                                               \
        {{tile_grey_##level, tile_grey_eye_##level},                \
         {tile_grey_lit_##level, tile_grey_lit_eye_##level}},       \
            {{tile_color_##level, tile_color_eye_##level},          \
             {tile_color_lit_##level, tile_color_lit_eye_##level}}, \
    }

snow_value_tile_fn *snow_value_tile_of(snow_isa isa, int channels, bool sloped,
                                       bool perspective) {
    static snow_value_tile_fn *const scalar[2][2][2] = EIGHT(scalar);
#if SNOW_HAS_AVX
    static snow_value_tile_fn *const avx2[2][2][2] = EIGHT(avx2);
    static snow_value_tile_fn *const avx512[2][2][2] = EIGHT(avx512);
    if (isa == SNOW_ISA_AVX512)
        return avx512[channels == 4][sloped][perspective];
    if (isa == SNOW_ISA_AVX2)
        return avx2[channels == 4][sloped][perspective];
#endif
    (void)isa;
    return scalar[channels == 4][sloped][perspective];
}
