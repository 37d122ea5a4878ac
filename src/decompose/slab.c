/* decompose/slab.c - "the entire volume is partitioned into n most equal sized
 * slabs, where the i'th slab is assigned to the i'th processor" (section 4). */
#include "decompose/slab.h"

snow_slab snow_slab_equal(int64_t slices, int parts, int part) {
    int64_t size = slices / parts, larger = slices % parts;
    int64_t before = part < larger ? part : larger;
    return (snow_slab){part * size + before, size + (part < larger)};
}
