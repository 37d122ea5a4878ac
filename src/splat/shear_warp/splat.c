/* splat/shear_warp/splat.c - which tiles draw a picture; see splat.h.
 * Those of each instruction set take a while to compile, and have files of
 * their own: splat/shear_warp/splat_scalar.c, _avx2.c, _avx512.c and _v128.c.
 */
#include "splat/shear_warp/splat.h"

#include "splat/shear_warp/scratch.h"

#if defined(SNOW_ONE_ISA) /* wasm/ */
#define OF_ISA(isa, name) ((void)(isa), name##_v128)
#elif SNOW_HAS_V128
#define OF_ISA(isa, name) \
    ((isa) > SNOW_ISA_AVX512 ? name##_v128 : SNOW_OF_ISA(isa, name))
#else
#define OF_ISA SNOW_OF_ISA
#endif

size_t snow_value_splat_bytes(const snow_value_splat *splat) {
    size_t bytes = snow_value_planes_bytes(splat) + sizeof(value_scratch) +
                   (size_t)splat->phases * 2 * sizeof(value_rows) +
                   (splat->borders ? BORDERS * QUEUE * sizeof(int16_t) : 0) +
                   (size_t)splat->resampled_count * sizeof(int32_t);
    return (bytes + 63) / 64 * 64;
}

snow_value_tile_fn *snow_value_tile_of(snow_isa isa, int channels, bool sloped,
                                       bool perspective) {
    int colors = channels == 4;
    return OF_ISA(isa, snow_value_tiles)[colors][sloped][perspective];
}

snow_value_tile_fn *snow_value_projection_of(snow_isa isa,
                                             snow_value_reduction reduction,
                                             bool perspective) {
    const unsigned of = reduction - SNOW_VALUE_LARGEST;
    return OF_ISA(isa, snow_value_projections)[of][perspective];
}
