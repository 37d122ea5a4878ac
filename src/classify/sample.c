/* classify/sample.c - the four tables-to-samples loops (model, points 3, 4 and
 * 6): colour = min(1, c * factor + white) times opacity. */
#include "classify/sample.h"
#include "simd/vec_scalar.h"

#include <string.h>

#define SAMPLE_CODE uint8_t
#define SAMPLE_CHANNELS 2
#define SAMPLE_NAME(kind) sample_byte2_##kind
#include "classify/sample.tmpl.h"
#define SAMPLE_CODE uint8_t
#define SAMPLE_CHANNELS 4
#define SAMPLE_NAME(kind) sample_byte4_##kind
#include "classify/sample.tmpl.h"
#define SAMPLE_CODE uint16_t
#define SAMPLE_CHANNELS 2
#define SAMPLE_NAME(kind) sample_word2_##kind
#include "classify/sample.tmpl.h"
#define SAMPLE_CODE uint16_t
#define SAMPLE_CHANNELS 4
#define SAMPLE_NAME(kind) sample_word4_##kind
#include "classify/sample.tmpl.h"

snow_sample_fn *snow_sample_of(int code_bytes, int channels, bool shaded) {
    static snow_sample_fn *const functions[2][2][2] = {
        {{sample_byte2_plain, sample_byte2_shaded},
         {sample_byte4_plain, sample_byte4_shaded}},
        {{sample_word2_plain, sample_word2_shaded},
         {sample_word4_plain, sample_word4_shaded}},
    };
    return functions[code_bytes == 2][channels == 4][shaded];
}
