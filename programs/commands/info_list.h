/* info_list.h - what info prints about several inputs, or a folder of volumes:
 * one line for each. */
#ifndef INFO_LIST_H
#define INFO_LIST_H

#include "options/options.h"

/* Whether the operands make a list: several, or a folder that is no volume but
 * holds some. */
bool info_is_list(const options *opts);

/* Lists what can be read from the headers.  Returns an exit code: that of the
 * first input that cannot be read; what a folder holds besides volumes does not
 * count. */
int info_list(const options *opts);

#endif
