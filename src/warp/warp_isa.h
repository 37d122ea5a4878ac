/* warp/warp_isa.h - the line functions for one instruction set: bilinear and
 * Catmull-Rom, for 2 and 4 channels. Include simd/select.h first. A run of
 * pixels must fill the vectors, so Catmull-Rom's short runs use instruction
 * sets with shorter vectors (warp/warp.c).  So do bilinear pixels, whose time
 * goes into loads of 16 bytes: longer vectors were not faster. */
#define WARP_CHANNELS 4
#define WARP_BEFORE 1
#define WARP_NAME(part) NAME(cubic4##part)
#include "warp/cubic.tmpl.h"
#include "warp/lines.tmpl.h"
#if LANES <= 8
#define WARP_CHANNELS 2
#define WARP_BEFORE 0
#define WARP_NAME(part) NAME(linear2##part)
#include "warp/linear.tmpl.h"
#include "warp/lines.tmpl.h"
#define WARP_CHANNELS 4
#define WARP_BEFORE 0
#define WARP_NAME(part) NAME(linear4##part)
#include "warp/linear.tmpl.h"
#include "warp/lines.tmpl.h"
#define WARP_CHANNELS 2
#define WARP_BEFORE 1
#define WARP_NAME(part) NAME(cubic2##part)
#include "warp/cubic.tmpl.h"
#include "warp/lines.tmpl.h"
#endif
