/* elsewhere.c - options that other programs have under another name, and what
 * is written for them here. */
#include "options/elsewhere.h"

#include <stddef.h>
#include <string.h>

/* Of PyVista, F3D, ParaView and niivue. */
static const struct {
    const char *theirs, *ours;
} rows[] = {
    {"clim", "is here --range LO,HI"},    {"cmap", "is here --colormap NAME"},
    {"fov", "is here --perspective FOV"}, {"lut", "is here --colormap NAME"},
    {"resolution", "is here --size WxH"},
};

const char *option_elsewhere(const char *name) {
    size_t length = strcspn(name, "=");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strlen(rows[i].theirs) == length &&
            strncmp(rows[i].theirs, name, length) == 0)
            return rows[i].ours;
    return NULL;
}
