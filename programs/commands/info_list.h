/* info_list.h - what info prints about several inputs, or a folder of volumes:
 * one line for each. */
#ifndef INFO_LIST_H
#define INFO_LIST_H

#include "options/options.h"

#include <jansson.h>

/* Whether the operands make a list: several, or a folder that is no volume but
 * holds some. */
bool info_is_list(const options *opts);

/* Lists what can be read from the headers.  Returns an exit code: that of the
 * first input that cannot be read; what a folder holds besides volumes does not
 * count. */
int info_list(const options *opts);

/* Both in cmd_info.c: opens a volume, or with `out` NULL reads its header
 * alone, also that of a DICOM folder that other verbs open with --allow-gaps
 * only. Returns CONTINUE or an exit code. */
int info_open(snow_context *context, const options *opts, const char *path,
              snow_volume_info *info, snow_volume **out);

/* The geometry of a volume, for scripts. */
void info_set_geometry(json_t *object, const snow_volume_info *info);

#endif
