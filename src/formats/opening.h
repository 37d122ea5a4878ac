/* formats/opening.h - what formats.c strings together to open a volume. */
#ifndef SNOW_FORMATS_OPENING_H
#define SNOW_FORMATS_OPENING_H

#include "formats/format.h"
#include "volume/stream.h"

/* What a file is that is recognised but not supported, and what to do with it,
 * as the end of a message: "is a tar archive; unpack it ...".  NULL for an
 * unknown file.  `bytes` are its first ones. */
const char *snow_stranger(const unsigned char *bytes, size_t size);

/* The same for an unstructured grid in a NetCDF file, which would pass for its
 * arrays; and the refusal of a folder that is one file of another program. */
const char *snow_mesh_in_netcdf(const unsigned char *bytes, size_t size);
snow_status snow_refuse_folder(snow_context *context, const char *path);

/* Makes a volume from the files that a folder or a pattern names, in their
 * order, one slice each; like a format's `read`.  Messages need not begin with
 * the path. Errors: SNOW_STATUS_BAD_INPUT (no files, files that differ or are
 * not numbered without a gap, errors in one of them), SNOW_STATUS_BAD_USAGE,
 * SNOW_STATUS_NO_MEMORY. */
snow_status snow_stack_read(snow_context *context, const char *path,
                            const snow_volume_options *options,
                            snow_format_finder *find, snow_volume_info *info,
                            snow_volume **out);

/* Errors: SNOW_STATUS_BAD_USAGE for a component that does not exist, unless
 * they are named, or beside a channel. */
snow_status snow_component_check(snow_context *context, bool named,
                                 const snow_volume_options *options);

/* Reads one component of a volume: that which the options name. */
typedef snow_status snow_component_fn(void *user,
                                      const snow_volume_options *options,
                                      snow_volume_info *info,
                                      snow_volume **out);

/* Reads a volume and, if its reader asks for the magnitude
 * (snow_volume_pick_component), its other components too.  `once` means that
 * the input cannot be read again: then the first component is taken, with a
 * note, or the explicit wish refused. */
snow_status snow_components_read(snow_context *context, snow_component_fn *read,
                                 void *user, bool once,
                                 const snow_volume_options *options,
                                 snow_volume_info *info, snow_volume **out);

/* Does what snow_volume_open does with options that name a mask, labels or
 * planes; where `out` is NULL, as snow_volume_inspect. `open` opens each of
 * the two files, and never gets such options. Headers of both are compared
 * before any voxel is read. Errors: also SNOW_STATUS_BAD_INPUT (another grid;
 * whatever is wrong with the mask), SNOW_STATUS_BAD_USAGE (labels without a
 * mask, or that are none). */
snow_status snow_masked_open(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_open_fn *open, snow_volume_info *info,
                             snow_volume **out);

/* Gives a volume the names and colours of a file.  Errors:
 * SNOW_STATUS_BAD_INPUT (no such file, or no table). */
snow_status snow_label_table_read(snow_context *context, const char *path,
                                  snow_volume *volume);

#endif
