/* renamed.c - the table of old spellings, which the release drops, and of those
 * of other programs. */
#include "options/renamed.h"

#include <stddef.h>
#include <string.h>

#define NOW "is now "
#define HERE "is here "

static const struct {
    const char *old, *now;
} rows[] = {
    {"ambient", NOW "--material A,D,S,N"},
    {"axes", NOW "--box axes"},
    {"clim", HERE "--range LO,HI"},
    {"cmap", HERE "--colormap NAME"},
    {"diffuse", NOW "--material A,D,S,N"},
    {"footprint", NOW "--kernel NAME:N"},
    {"fov", HERE "--perspective FOV"},
    {"legend-title", NOW "--legend=TITLE"},
    {"level", NOW "--window W,L"},
    {"log", NOW "--scale log"},
    {"lut", HERE "--colormap NAME"},
    {"opacity-unit", NOW "--config '{\"opacity-unit\": \"mm\"}'"},
    {"outline", NOW "--box outline"},
    {"overlay-colormap", NOW "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"overlay-opacity", NOW "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"overlay-preset", NOW "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"overlay-range", NOW "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"port", NOW "--listen :PORT"},
    {"radix", NOW "--combine radix:K"},
    {"resolution", HERE "--size WxH"},
    {"scale-bar", NOW "--legend scale"},
    {"shift", NOW "--range LO,HI"},
    {"shininess", NOW "--material A,D,S,N"},
    {"socket", NOW "--listen unix:PATH"},
    {"specular", NOW "--material A,D,S,N"},
    {"symlog", NOW "--scale symlog[:X]"},
    {"time-format", NOW "--annotate time=FORMAT"},
    {"time-label", NOW "--annotate step"},
    {"unit", NOW "--legend=\"TITLE (UNIT)\""},
};

const char *renamed_option(const char *name) {
    size_t length = strcspn(name, "=");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strlen(rows[i].old) == length &&
            strncmp(rows[i].old, name, length) == 0)
            return rows[i].now;
    return NULL;
}
