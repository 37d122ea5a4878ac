/* io/relayed.h - a source of one of several readers, who unpack a file, or one
 * beside it, in turn. */
#ifndef SNOW_IO_RELAYED_H
#define SNOW_IO_RELAYED_H

#include "base/relay.h"
#include "io/source.h"

/* Does what snow_source_open does; `relay` may be NULL. */
snow_status snow_source_open_relayed(snow_context *context, const char *path,
                                     snow_relay *relay, snow_source **out);

#endif
