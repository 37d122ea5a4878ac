/* simd/isa.c - which instruction sets the machine offers, and which one the
 * kernels of this build use.  Kernels per instruction set will lie beside
 * this file's vocabulary; today every kernel is plain C. */
#include <snowglass/snowglass.h>

const char *snow_version(void) {
    return SNOW_VERSION;
}

const char *snow_isa_found(void) {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw"))
        return "scalar sse2 avx2 avx512";
    if (__builtin_cpu_supports("avx2"))
        return "scalar sse2 avx2";
    return "scalar sse2";
#elif defined(__aarch64__)
    return "scalar neon";
#else
    return "scalar";
#endif
}

const char *snow_isa_used(void) {
    return "scalar";
}
