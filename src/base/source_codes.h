/* base/source_codes.h - codes that some formats put their data in, and promises
 * of how much there is; beside base/source.h. */
#ifndef SNOW_SOURCE_CODES_H
#define SNOW_SOURCE_CODES_H

#include "base/layer.h"
#include "base/source.h"

/* Says that from here on the bytes are base64 text, up to the first letter that
 * is none of its; all later calls see what it stands for. */
snow_status snow_source_unpack_base64(snow_source *source);

/* Says that from here on the bytes are zlib streams of these sizes.  The sizes
 * belong to the source on success. */
snow_status snow_source_unpack_blocks(snow_source *source,
                                      const snow_blocks *blocks);

/* Says that `size` more bytes follow, as a header told where the source does
 * not know: they are the remaining ones from here on.  Refused, as by
 * snow_source_expect, when there cannot be so many. */
snow_status snow_source_promise(snow_source *source, uint64_t size,
                                const char *what);

/* As snow_source_finish, for data that other data follow: verifies what is
 * packed to its end and makes no remark. */
snow_status snow_source_verify(snow_source *source);

#endif
