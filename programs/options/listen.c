/* listen.c - parses where the viewer listens.  An address of IPv6 has colons of
 * its own, and is in brackets before a port. */
#include "options/option_values.h"

#include <string.h>

static bool take_address(const char *text, size_t length, listen_value *out) {
    if (length >= sizeof out->address)
        return false;
    memcpy(out->address, text, length);
    out->address[length] = 0;
    return true;
}

static bool take_port(const char *text, listen_value *out) {
    uint64_t port;
    if (!value_count(text, &port) || port > 65535)
        return false;
    out->port = (int)port;
    return true;
}

bool value_listen(const char *text, listen_value *out) {
    listen_value made = {.port = 0};
    const char *colon = strrchr(text, ':'), *end = strchr(text, ']');
    const size_t length = strlen(text);
    bool good = length > 0;
    if (strncmp(text, "unix:", 5) == 0) {
        made.path = text + 5;
        good = *made.path != 0;
    } else if (*text == '[') {
        good = end && take_address(text + 1, (size_t)(end - text - 1), &made) &&
               (!end[1] || (end[1] == ':' && take_port(end + 2, &made)));
    } else if (colon && strchr(text, ':') == colon) {
        good = take_address(text, (size_t)(colon - text), &made) &&
               take_port(colon + 1, &made);
    } else { /* a number alone is no address */
        good = good && text[strspn(text, "0123456789")] &&
               take_address(text, length, &made);
    }
    if (good)
        *out = made;
    return good;
}
