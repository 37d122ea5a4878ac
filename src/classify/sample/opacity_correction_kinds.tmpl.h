/* classify/sample/opacity_correction_kinds.tmpl.h - codes to samples, each with
 * its own exponent: plain or shaded, with a gradient opacity or without.
 * Include simd/select.h first, and define:
 *
 *   RAY_CODE      C type of a code: uint8_t or uint16_t
 *   RAY_EXPAND    V(expand8) or V(expand16), for the code
 *   RAY_CHANNELS  floats of a sample: 2 or 4
 *   RAY_NAME(kind)  name of the function of a kind
 *
 * All are undefined at the end. */
#define RAY_SHADED 0
#define RAY_GRADIENT_OPACITY 0
#define RAY_KIND plain
#include "classify/sample/opacity_correction.tmpl.h"
#define RAY_SHADED 0
#define RAY_GRADIENT_OPACITY 1
#define RAY_KIND plain_faded
#include "classify/sample/opacity_correction.tmpl.h"
#define RAY_SHADED 1
#define RAY_GRADIENT_OPACITY 0
#define RAY_KIND shaded
#include "classify/sample/opacity_correction.tmpl.h"
#define RAY_SHADED 1
#define RAY_GRADIENT_OPACITY 1
#define RAY_KIND shaded_faded
#include "classify/sample/opacity_correction.tmpl.h"

#undef RAY_CODE
#undef RAY_EXPAND
#undef RAY_CHANNELS
#undef RAY_NAME
