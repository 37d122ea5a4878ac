/* formats/zarr/blosc.c - chunks that are compressed by Blosc 1.
 *
 * libblosc validates a buffer before decompression.  It depends on other
 * libraries, including a C++ one, so a module contains it (base/module.h). */
#include "formats/features.h"
#include "formats/zarr/zarr.h"

#if SNOW_HAVE_BLOSC && !SNOW_LOADS

#include <blosc.h>
#include <string.h>

/* A build of the library may lack a compressor, and would print about it. */
static bool has_packer(const char *library) {
    static const char *const names[][2] = {
        {BLOSC_BLOSCLZ_LIBNAME, BLOSC_BLOSCLZ_COMPNAME},
        {BLOSC_LZ4_LIBNAME, BLOSC_LZ4_COMPNAME},
        {BLOSC_SNAPPY_LIBNAME, BLOSC_SNAPPY_COMPNAME},
        {BLOSC_ZLIB_LIBNAME, BLOSC_ZLIB_COMPNAME},
        {BLOSC_ZSTD_LIBNAME, BLOSC_ZSTD_COMPNAME}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(library, names[i][0]))
            return blosc_compname_to_compcode(names[i][1]) >= 0;
    return false;
}

snow_status snow_zarr_blosc_expect(snow_context *context, const char *name,
                                   const unsigned char *packed, size_t size,
                                   uint64_t bytes) {
    size_t given;
    if (size < BLOSC_MIN_HEADER_LENGTH ||
        blosc_cbuffer_validate(packed, size, &given))
        return snow_zarr_fail_damaged(
            context, name,
            "has a header that is not Blosc's, or of another file");
    if (given != bytes)
        return snow_zarr_fail_size(context, name, given, bytes);
    const char *library = blosc_cbuffer_complib(packed);
    if (library && has_packer(library))
        return SNOW_STATUS_OK;
    return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                     "%s: is compressed by %.20s within Blosc, which this "
                     "libblosc lacks; copy the array with lz4 or zstd",
                     name, library ? library : "something");
}

snow_status snow_zarr_blosc_unpack(snow_context *context, const char *name,
                                   const unsigned char *packed,
                                   unsigned char *out, uint64_t bytes) {
    int got = blosc_decompress_ctx(packed, out, (size_t)bytes, 1);
    if (got >= 0 && (uint64_t)got == bytes)
        return SNOW_STATUS_OK;
    return snow_zarr_fail_damaged(context, name,
                                  "cannot be decompressed by Blosc");
}

#elif SNOW_LOADS && SNOW_HAVE_BLOSC

snow_status snow_zarr_blosc_expect(snow_context *context, const char *name,
                                   const unsigned char *packed, size_t size,
                                   uint64_t bytes) {
    const snow_module *module;
    SNOW_TRY(snow_module_load(context, "blosc", &module));
    return module->expect_blosc(context, name, packed, size, bytes);
}

snow_status snow_zarr_blosc_unpack(snow_context *context, const char *name,
                                   const unsigned char *packed,
                                   unsigned char *out, uint64_t bytes) {
    const snow_module *module;
    SNOW_TRY(snow_module_load(context, "blosc", &module));
    return module->unpack_blosc(context, name, packed, out, bytes);
}

#else

snow_status snow_zarr_blosc_expect(snow_context *context, const char *name,
                                   const unsigned char *packed, size_t size,
                                   uint64_t bytes) {
    (void)name, (void)packed, (void)size, (void)bytes;
    return snow_fail_unbuilt(context, "Blosc", "libblosc-dev");
}

snow_status snow_zarr_blosc_unpack(snow_context *context, const char *name,
                                   const unsigned char *packed,
                                   unsigned char *out, uint64_t bytes) {
    (void)packed, (void)out;
    return snow_zarr_blosc_expect(context, name, packed, 0, bytes);
}

#endif
