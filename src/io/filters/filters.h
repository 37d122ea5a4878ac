/* io/filters/filters.h - encodings that some formats use for their data, and
 * declared sizes of data; extends io/source.h. */
#ifndef SNOW_IO_FILTERS_H
#define SNOW_IO_FILTERS_H

#include "io/filters/filter.h"
#include "io/source.h"

/* Declares that from here on the bytes are base64 text, up to the first
 * character that is not; all later calls return the decoded bytes. */
snow_status snow_source_unpack_base64(snow_source *source);

/* Declares that from here on the bytes are blocks of these sizes. The
 * sizes belong to the source on success. */
snow_status snow_source_unpack_blocks(snow_source *source,
                                      const snow_blocks *blocks);

/* Declares that from here on the bytes are in an encoding of which `open` adds
 * a stage (io/filters/filter.h), which owns the one below on success. */
typedef snow_status snow_open_stage_fn(snow_filter_stage *below,
                                       snow_filter_stage **out);
snow_status snow_source_unpack_by(snow_source *source,
                                  snow_open_stage_fn *open);

/* Declares that `size` more bytes follow, from a header, if the source does not
 * know: they are the remaining ones from here on. Rejected, as by
 * snow_source_expect, if there cannot be as many. */
snow_status snow_source_promise(snow_source *source, uint64_t size,
                                const char *what);

/* As snow_source_finish, for data that other data follow: verifies packed data
 * to their end, without a warning. */
snow_status snow_source_verify(snow_source *source);

#endif
