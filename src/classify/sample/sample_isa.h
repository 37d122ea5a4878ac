/* classify/sample/sample_isa.h - the sample functions of one instruction set.
 * Include simd/select.h first. */
#include "classify/sample/gradient_opacity.tmpl.h"

#define SAMPLE_CODE uint8_t
#define SAMPLE_WIDEN V(widen8)
#define SAMPLE_CHANNELS 2
#define SAMPLE_NAME(kind) NAME(sample_byte2_##kind)
#include "classify/sample/sample.tmpl.h"
#define SAMPLE_CODE uint8_t
#define SAMPLE_WIDEN V(widen8)
#define SAMPLE_CHANNELS 4
#define SAMPLE_NAME(kind) NAME(sample_byte4_##kind)
#include "classify/sample/sample.tmpl.h"
#define SAMPLE_CODE uint16_t
#define SAMPLE_WIDEN V(widen16)
#define SAMPLE_CHANNELS 2
#define SAMPLE_NAME(kind) NAME(sample_word2_##kind)
#include "classify/sample/sample.tmpl.h"
#define SAMPLE_CODE uint16_t
#define SAMPLE_WIDEN V(widen16)
#define SAMPLE_CHANNELS 4
#define SAMPLE_NAME(kind) NAME(sample_word4_##kind)
#include "classify/sample/sample.tmpl.h"

static const snow_sample_table NAME(samples) = {
    {{NAME(sample_byte2_plain), NAME(sample_byte2_shaded),
      NAME(sample_byte2_faded_plain), NAME(sample_byte2_faded_shaded)},
     {NAME(sample_byte4_plain), NAME(sample_byte4_shaded),
      NAME(sample_byte4_faded_plain), NAME(sample_byte4_faded_shaded)}},
    {{NAME(sample_word2_plain), NAME(sample_word2_shaded),
      NAME(sample_word2_faded_plain), NAME(sample_word2_faded_shaded)},
     {NAME(sample_word4_plain), NAME(sample_word4_shaded),
      NAME(sample_word4_faded_plain), NAME(sample_word4_faded_shaded)}},
};
