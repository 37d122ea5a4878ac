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

/* Of so many scenes one is taken by the short tier, and this many by the long
 * one. */
#define LONG_SHARE 2

static bool is_short(void) {
    const char *tier = getenv("SNOW_TIER");
    if (!tier || !*tier || strcmp(tier, "short") == 0)
        return true;
    if (strcmp(tier, "long") != 0 && strcmp(tier, "release") != 0)
        fail_msg("SNOW_TIER is '%s': short, long or release", tier);
    return false;
}

bool support_is_sanitized(void) {
    return getenv("SNOW_SANITIZED") != NULL;
}

/* Sanitizers, under which scenes are slow, see a third of those, by chance: an
 * even step would have a divisor in common with what the number drives. */
static bool sanitizer_leaves_out(size_t scene) {
    uint64_t state = scene;
    return support_is_sanitized() && !support_is_release() &&
           (support_random(&state) + support_seed()) % 3 > 0;
}

bool support_takes(size_t scene, size_t one_of) {
    size_t share = is_short() ? 1 : LONG_SHARE;
    if (sanitizer_leaves_out(scene))
        return false;
    return support_is_release() ||
           (scene + share * support_seed()) % one_of < share;
}

bool support_takes_ranks(int ranks, int most) {
    return ranks < 5 || ranks == most || support_takes((size_t)ranks, 13);
}

uint64_t support_scene_random(uint64_t sweep, size_t scene) {
    uint64_t state = sweep * 65537 + scene + 1;
    for (int n = 0; n < 4; n++) /* small states are alike at first */
        (void)support_random(&state);
    return state;
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

uint64_t support_voxel_seed(void) {
    return support_is_release() ? support_seed() : 0;
}
