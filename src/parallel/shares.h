/* parallel/shares.h - the shares of a file that ranks read before it is known
 * which boxes they need. */
#ifndef SNOW_PARALLEL_SHARES_H
#define SNOW_PARALLEL_SHARES_H

#include "comm/comm.h"

/* Equal runs of slices, or, with more ranks than slices, of each slice's rows;
 * those of the last ranks may be empty.  Of a file that is packed in blocks
 * they are runs of whole blocks, each of which one rank unpacks, unless a share
 * would become more than SNOW_SHARE_MOST times an equal one. */
#define SNOW_SHARE_MOST 2
snow_box snow_share_of(const int64_t dims[3], const snow_file_blocks *blocks,
                       int rank, int ranks);

/* Collective.  Whether all say so. */
snow_status snow_share_agree(snow_comm *comm, bool here, bool *all);

#endif
