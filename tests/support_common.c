/* tests/support_common.c - contexts, data paths, random numbers. */
#include "support.h"

#include <unistd.h>

snow_context *support_context(void) {
    snow_context *context = NULL;
    if (snow_context_new(NULL, &context) != SNOW_OK)
        fail_msg("no context");
    return context;
}

const char *support_data(const char *relative) {
    static char path[4096];
    snprintf(path, sizeof path, "%s/%s", SNOW_DATA, relative);
    return access(path, R_OK) == 0 ? path : NULL;
}

uint64_t support_random(uint64_t *state) {
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return *state * UINT64_C(0x2545F4914F6CDD1D);
}

double support_uniform(uint64_t *state) {
    return (double)(support_random(state) >> 11) * 0x1p-53;
}
