/* warp/levels.h - the line functions of one level: bilinear and Catmull-Rom, of
 * 2 and 4 channels.  simd/select.h's words are in force; a run of pixels must
 * fill the vectors of the level, so that Catmull-Rom's short runs are left to
 * levels with shorter ones (warp/warp.c). */
#define WARP_CHANNELS 2
#define WARP_BEFORE 0
#define WARP_TWINS V(twins2)
#define WARP_REPEAT V(repeat2)
#define WARP_NAME(part) NAME(linear2##part)
#include "warp/linear.tmpl.h"
#include "warp/lines.tmpl.h"
#define WARP_CHANNELS 4
#define WARP_BEFORE 0
#define WARP_TWINS V(twins4)
#define WARP_REPEAT V(repeat4)
#define WARP_NAME(part) NAME(linear4##part)
#include "warp/linear.tmpl.h"
#include "warp/lines.tmpl.h"
#define WARP_CHANNELS 4
#define WARP_BEFORE 1
#define WARP_FOLD V(fold4)
#define WARP_NAME(part) NAME(cubic4##part)
#include "warp/cubic.tmpl.h"
#include "warp/lines.tmpl.h"
#if LANES <= 8
#define WARP_CHANNELS 2
#define WARP_BEFORE 1
#define WARP_FOLD V(fold2)
#define WARP_NAME(part) NAME(cubic2##part)
#include "warp/cubic.tmpl.h"
#include "warp/lines.tmpl.h"
#endif
