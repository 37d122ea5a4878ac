/* base/relay.c - see relay.h. */
#include "base/relay.h"

void snow_relay_warn(snow_context *context, const char *name, bool foreign,
                     uint64_t left) {
    if (foreign)
        snow_notify(context,
                    "%s: bytes after the end of the compressed data are "
                    "ignored",
                    name);
    if (left)
        snow_notify(context,
                    "%s: %llu byte%s after the data ignored; check the sizes "
                    "and the type",
                    name, (unsigned long long)left, left == 1 ? "" : "s");
}
