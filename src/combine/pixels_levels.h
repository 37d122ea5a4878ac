/* combine/pixels_levels.h - the loops of one level; simd/select.h's words are
 * in force. */
#define PIXELS_CHANNELS 2
#define PIXELS_SOME V(some2)
#define PIXELS_ALPHA V(alpha2)
#define PIXELS_GATHER V(gather2)
#define PIXELS_SCATTER V(scatter2)
#define PIXELS_NAME(word) NAME(word##_2)
#include "combine/pixels.tmpl.h"
#define PIXELS_CHANNELS 4
#define PIXELS_SOME V(some4)
#define PIXELS_ALPHA V(alpha4)
#define PIXELS_GATHER V(gather4)
#define PIXELS_SCATTER V(scatter4)
#define PIXELS_NAME(word) NAME(word##_4)
#include "combine/pixels.tmpl.h"
