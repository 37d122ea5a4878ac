/* simd/isa.c - finds the instruction sets of the machine, and chooses the
 * default for a picture. */
#include "simd/isa.h"

#include <snowglass/snowglass.h>

static const char *const names[] = {
    [SNOW_ISA_AUTO] = "auto", [SNOW_ISA_SCALAR] = "scalar",
    [SNOW_ISA_AVX2] = "avx2", [SNOW_ISA_AVX512] = "avx512",
    [SNOW_ISA_SSE4] = "sse4", [SNOW_ISA_NEON] = "neon",
    [SNOW_ISA_WASM] = "wasm",
};

#define LEVELS (int)(sizeof names / sizeof names[0])

const char *snow_version(void) {
    return SNOW_VERSION;
}

const char *snow_isa_name(snow_isa isa) {
    const int value = (int)isa;
    return value >= 0 && value < LEVELS ? names[value] : NULL;
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

snow_isa snow_isa_same(void) {
#if !SNOW_HAS_V128
    return SNOW_ISA_SCALAR;
#elif SNOW_HAS_AVX
    return __builtin_cpu_supports("sse4.1") && __builtin_cpu_supports("popcnt")
               ? SNOW_ISA_SSE4
               : SNOW_ISA_SCALAR;
#elif defined(__aarch64__)
    return SNOW_ISA_NEON;
#else
    return SNOW_ISA_WASM;
#endif
}

bool snow_isa_runs(snow_isa isa) {
    switch (isa) {
    case SNOW_ISA_AVX2:
        return has_avx2();
    case SNOW_ISA_AVX512:
        return has_avx512();
    case SNOW_ISA_NEON:
    case SNOW_ISA_WASM:
    case SNOW_ISA_SSE4:
        return isa == snow_isa_same();
    default:
        return true;
    }
}

snow_isa snow_isa_resolve(snow_isa isa) {
    return isa != SNOW_ISA_AUTO ? isa
           : has_avx512()       ? SNOW_ISA_AVX512
           : has_avx2()         ? SNOW_ISA_AVX2
                                : snow_isa_same();
}

const char *snow_isa_found(void) {
    switch (snow_isa_resolve(SNOW_ISA_AUTO)) {
    case SNOW_ISA_AVX512:
        return "scalar sse4 avx2 avx512";
    case SNOW_ISA_AVX2:
        return "scalar sse4 avx2";
    case SNOW_ISA_SSE4:
        return "scalar sse4";
    case SNOW_ISA_NEON:
        return "scalar neon";
    case SNOW_ISA_WASM:
        return "scalar wasm";
    default:
        return "scalar";
    }
}

const char *snow_isa_used(void) {
    return snow_isa_name(snow_isa_resolve(SNOW_ISA_AUTO));
}
