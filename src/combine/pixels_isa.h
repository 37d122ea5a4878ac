/* combine/pixels_isa.h - the loops for one instruction set. Include
 * simd/select.h first. */
#define PIXELS_CHANNELS 2
#define PIXELS_COMPOSITE_OP(front, back) \
    V(add)(front, V(mul)(V(sub)(V(set1)(1), V(alpha2)(front)), back))
#define PIXELS_NAME(word) NAME(word##_over2)
#include "combine/pixels.tmpl.h"
#define PIXELS_CHANNELS 2
#define PIXELS_COMPOSITE_OP(front, back) V(max)(back, front)
#define PIXELS_NAME(word) NAME(word##_most2)
#include "combine/pixels.tmpl.h"
#define PIXELS_CHANNELS 2
#define PIXELS_COMPOSITE_OP(front, back) V(add)(front, back)
#define PIXELS_NAME(word) NAME(word##_sum2)
#include "combine/pixels.tmpl.h"
#define PIXELS_CHANNELS 4
#define PIXELS_COMPOSITE_OP(front, back) \
    V(add)(front, V(mul)(V(sub)(V(set1)(1), V(alpha4)(front)), back))
#define PIXELS_NAME(word) NAME(word##_over4)
#include "combine/pixels.tmpl.h"
