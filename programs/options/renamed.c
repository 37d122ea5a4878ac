/* renamed.c - the table of old spellings, which the release drops. */
#include "options/renamed.h"

#include <stddef.h>
#include <string.h>

static const struct {
    const char *old, *now;
} rows[] = {
    {"axes", "--box axes"},
    {"ambient", "--material A,D,S,N"},
    {"diffuse", "--material A,D,S,N"},
    {"footprint", "--kernel NAME:N"},
    {"legend-title", "--legend=TITLE"},
    {"level", "--window W,L"},
    {"log", "--scale log"},
    {"opacity-unit", "--config '{\"opacity-unit\": \"mm\"}'"},
    {"outline", "--box outline"},
    {"overlay-colormap", "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"overlay-opacity", "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"overlay-preset", "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"overlay-range", "--overlay-look COLOURS[,RANGE[,OPACITY]]"},
    {"port", "--listen :PORT"},
    {"radix", "--combine radix:K"},
    {"scale-bar", "--legend scale"},
    {"shift", "--range LO,HI"},
    {"shininess", "--material A,D,S,N"},
    {"socket", "--listen unix:PATH"},
    {"specular", "--material A,D,S,N"},
    {"symlog", "--scale symlog[:X]"},
    {"time-format", "--annotate time=FORMAT"},
    {"time-label", "--annotate step"},
    {"unit", "--legend=\"TITLE (UNIT)\""},
};

const char *renamed_option(const char *name) {
    size_t length = strcspn(name, "=");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strlen(rows[i].old) == length &&
            strncmp(rows[i].old, name, length) == 0)
            return rows[i].now;
    return NULL;
}
