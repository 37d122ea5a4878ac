/* tests/support/common.c - contexts, data paths, random numbers,
 * lengths of sweeps. */
#include "support/support.h"

#include <unistd.h>

snow_context *support_context(void) {
    snow_context *context = NULL;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
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

static bool is_short(void) {
    const char *tier = getenv("SNOW_TIER");
    if (!tier || !*tier || strcmp(tier, "short") == 0)
        return true;
    if (strcmp(tier, "long") != 0 && strcmp(tier, "release") != 0)
        fail_msg("SNOW_TIER is '%s': short, long or release", tier);
    return false;
}

size_t support_stride(size_t stride) {
    return is_short() ? stride : 1;
}

size_t support_start(size_t outer, size_t stride) {
    return outer % support_stride(stride);
}

int64_t support_sweep(int64_t full, int64_t brief) {
    return is_short() ? brief : full;
}

bool support_is_release(void) {
    const char *tier = getenv("SNOW_TIER");
    return tier && strcmp(tier, "release") == 0;
}

uint64_t support_seed(void) {
    const char *seed = getenv("SNOW_SEED");
    return seed ? strtoull(seed, NULL, 10) : 0;
}
