/* base/errors.c - what the system says of an error of stat, open or read, and
 * what to do; a page without a server says it for its files itself. */
#include "base/base.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

static const char *remedy(int number) {
    switch (number) {
    case ENOENT:
    case ENOTDIR:
    case EACCES:
    case EPERM:
        return "check the name and the permissions";
    case ELOOP:
        return "correct the links";
    case ENAMETOOLONG:
        return "choose a shorter name";
    case EMFILE:
    case ENFILE:
        return "close other files, or allow more of them (ulimit -n)";
    case ENOMEM:
        return "close other programs";
    default:
        return "check the disk";
    }
}

void snow_explain(int number, char *out, size_t size) {
    char why[128] = "";
    strerror_r(number, why, sizeof why);
    snprintf(out, size, "%s; %s", why, remedy(number));
}
