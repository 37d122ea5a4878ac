/* tests/support/looks.c - what support_looks.h promises. */
#include "support/looks.h"

snow_volume *support_row(snow_context *context, snow_type type,
                         const void *values, int64_t n) {
    snow_volume_info info = {
        .size = sizeof info, .dims = {n, 1, 1}, .type = type};
    snow_volume *volume = NULL;
    if (snow_volume_wrap(context, &info, values, &volume) != SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(context));
    return volume;
}

snow_transfer *support_look(const snow_volume *volume, snow_look look) {
    snow_transfer *transfer = NULL;
    if (snow_transfer_new_for_volume(volume, &look, &transfer) !=
        SNOW_STATUS_OK)
        fail_msg("%s", snow_context_message(volume->context));
    return transfer;
}
