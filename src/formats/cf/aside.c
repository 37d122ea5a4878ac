/* formats/cf/aside.c - variables that say where others lie (cf.h): bounds and
 * coordinates (CF 5.2 and 7.1) are arrays, too, but not what a file is of. */
#include "formats/cf.h"

#include <stdio.h>
#include <string.h>

bool snow_cf_is_aside(const cf_aside *aside, const char *path) {
    const char *slash = strrchr(path, '/');
    char word[72];
    const int length =
        snprintf(word, sizeof word, " %s ", slash ? slash + 1 : path);
    return (size_t)length < sizeof word && strstr(aside->names, word);
}

void snow_cf_aside_add(const char *attribute, const char *names,
                       cf_aside *aside) {
    size_t used = strlen(aside->names);
    if (strcmp(attribute, "bounds") != 0 &&
        strcmp(attribute, "coordinates") != 0)
        return;
    for (const char *at = names; *(at += strspn(at, " "));) {
        const int length = (int)strcspn(at, " ");
        char name[72];
        snprintf(name, sizeof name, "%.*s", length < 70 ? length : 0, at);
        at += length;
        if (*name && !snow_cf_is_aside(aside, name) &&
            used + strlen(name) + 3 < sizeof aside->names)
            used += (size_t)snprintf(aside->names + used,
                                     sizeof aside->names - used, " %s ", name);
    }
}
