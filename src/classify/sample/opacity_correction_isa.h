/* classify/sample/opacity_correction_isa.h - the sample functions of
 * perspective for one instruction set. Include simd/select.h first. */
#include "classify/sample/gradient_opacity.tmpl.h"

/* The extra step expands the macro RAY_KIND first. */
#define RAY_JOINED(name, kind) NAME(ray_##name##_##kind)
#define RAY_KIND_OF(name, kind) RAY_JOINED(name, kind)

#define RAY_CODE uint8_t
#define RAY_EXPAND V(expand8)
#define RAY_CHANNELS 2
#define RAY_NAME(kind) RAY_KIND_OF(byte2, kind)
#include "classify/sample/opacity_correction_kinds.tmpl.h"
#define RAY_CODE uint8_t
#define RAY_EXPAND V(expand8)
#define RAY_CHANNELS 4
#define RAY_NAME(kind) RAY_KIND_OF(byte4, kind)
#include "classify/sample/opacity_correction_kinds.tmpl.h"
#define RAY_CODE uint16_t
#define RAY_EXPAND V(expand16)
#define RAY_CHANNELS 2
#define RAY_NAME(kind) RAY_KIND_OF(word2, kind)
#include "classify/sample/opacity_correction_kinds.tmpl.h"
#define RAY_CODE uint16_t
#define RAY_EXPAND V(expand16)
#define RAY_CHANNELS 4
#define RAY_NAME(kind) RAY_KIND_OF(word4, kind)
#include "classify/sample/opacity_correction_kinds.tmpl.h"

#define RAY_PAIR(name) \
    { NAME(ray_##name), NAME(ray_##name##_faded) }
static const ray_table NAME(ray_samples) = {
    {{RAY_PAIR(byte2_plain), RAY_PAIR(byte2_shaded)},
     {RAY_PAIR(byte4_plain), RAY_PAIR(byte4_shaded)}},
    {{RAY_PAIR(word2_plain), RAY_PAIR(word2_shaded)},
     {RAY_PAIR(word4_plain), RAY_PAIR(word4_shaded)}},
};
#undef RAY_PAIR
#undef RAY_KIND_OF
#undef RAY_JOINED
