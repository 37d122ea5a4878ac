/* simd/isa.c - finds the instruction sets of the machine, and chooses the
 * default for a picture. */
#include "simd/isa.h"

#include <snowglass/snowglass.h>

static const char *const names[] = {
    [SNOW_ISA_AUTO] = "auto", [SNOW_ISA_SCALAR] = "scalar",
    [SNOW_ISA_AVX2] = "avx2", [SNOW_ISA_AVX512] = "avx512",
    [SNOW_ISA_NEON] = "neon", [SNOW_ISA_WASM] = "wasm",
};

#define LEVELS (int)(sizeof names / sizeof names[0])

const char *snow_version(void) {
    return SNOW_VERSION;
}

const char *snow_isa_name(snow_isa isa) {
    return (int)isa < LEVELS ? names[isa] : NULL;
}

int snow_isa_from_name(const char *name) {
    for (int i = 0; i < LEVELS; i++)
        if (snow_same_name(name, names[i]))
            return i;
    return -1;
}

#if SNOW_HAS_AVX
static bool has_avx2(void) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
           __builtin_cpu_supports("popcnt") && __builtin_cpu_supports("bmi") &&
           __builtin_cpu_supports("bmi2");
}

static bool has_avx512(void) {
    return has_avx2() && __builtin_cpu_supports("avx512f") &&
           __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vbmi") &&
           __builtin_cpu_supports("avx512vbmi2");
}
#else
static bool has_avx2(void) {
    return false;
}

static bool has_avx512(void) {
    return false;
}
#endif

/* The instruction set that a machine always has beside scalar, or scalar. */
#if !SNOW_HAS_V128
#define V128 SNOW_ISA_SCALAR
#elif defined(__aarch64__)
#define V128 SNOW_ISA_NEON
#else
#define V128 SNOW_ISA_WASM
#endif

bool snow_isa_runs(snow_isa isa) {
    switch (isa) {
    case SNOW_ISA_AVX2:
        return has_avx2();
    case SNOW_ISA_AVX512:
        return has_avx512();
    case SNOW_ISA_NEON:
    case SNOW_ISA_WASM:
        return isa == V128;
    default:
        return true;
    }
}

snow_isa snow_isa_resolve(snow_isa isa) {
    if (isa != SNOW_ISA_AUTO)
        return isa;
    if (has_avx512())
        return SNOW_ISA_AVX512;
    if (has_avx2())
        return SNOW_ISA_AVX2;
    return V128;
}

const char *snow_isa_found(void) {
    if (has_avx512())
        return "scalar avx2 avx512";
    if (has_avx2())
        return "scalar avx2";
    return V128 == SNOW_ISA_NEON   ? "scalar neon"
           : V128 == SNOW_ISA_WASM ? "scalar wasm"
                                   : "scalar";
}

const char *snow_isa_used(void) {
    return snow_isa_name(snow_isa_resolve(SNOW_ISA_AUTO));
}
