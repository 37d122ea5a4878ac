/* base/source_codes.c - puts the layers of layer_base64.c and layer_blocks.c on
 * a source; the end of data that are followed by others. */
#include "base/source_codes.h"
#include "base/source_parts.h"

snow_status snow_source_unpack_base64(snow_source *source) {
    return snow_layer_open_base64(source->top, &source->top);
}

snow_status snow_source_unpack_blocks(snow_source *source,
                                      const snow_blocks *blocks) {
    return snow_layer_open_blocks(source->top, blocks, &source->top);
}

/* Only of base64 text, whose end nothing verifies: that of a file is a fact,
 * and a packed stream is read to its check sum. */
snow_status snow_source_promise(snow_source *source, uint64_t size,
                                const char *what) {
    snow_layer *top = source->top;
    SNOW_TRY(snow_source_expect(source, size, what));
    uint64_t end;
    if (top->size < 0 && top->limit && snow_add_u64(top->taken, size, &end) &&
        end <= (uint64_t)INT64_MAX)
        top->size = (int64_t)end;
    return SNOW_OK;
}

/* From the top down: an upper layer takes what it needs of the one below. */
snow_status snow_source_verify(snow_source *source) {
    for (snow_layer *layer = source->top; layer; layer = layer->below)
        while (layer->size < 0) {
            SNOW_TRY(snow_layer_fill(layer, 1));
            if (layer->begin == layer->end)
                break;
            snow_layer_drop(layer, layer->end - layer->begin);
        }
    return SNOW_OK;
}
