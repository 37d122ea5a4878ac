/* parallel/shares.h - the shares of a file that ranks read before it is known
 * which boxes they need. */
#ifndef SNOW_PARALLEL_SHARES_H
#define SNOW_PARALLEL_SHARES_H

#include "base/relay.h"
#include "comm/comm.h"

/* Equal runs of slices, or, with more ranks than slices, of each slice's rows;
 * those of the last ranks may be empty.  Of a file that is packed in blocks
 * they are runs of whole blocks, each of which one rank unpacks, unless a share
 * would become more than SNOW_SHARE_MOST times an equal one. */
#define SNOW_SHARE_MOST 2
snow_box snow_share_of(const int64_t dims[3], const snow_file_blocks *blocks,
                       int rank, int ranks);

/* How many ranks have one, which come first. */
int snow_share_readers(const int64_t dims[3], const snow_file_blocks *blocks,
                       int ranks);

/* Collective.  Whether all say so. */
snow_status snow_share_agree(snow_comm *comm, bool here, bool *all);

/* Reads a header, or a rank's share, with a relay. */
typedef snow_status snow_share_fn(void *user, snow_relay *relay);

/* Whether what is read can be unpacked in turn; as far as the header says. */
snow_status snow_share_is_packed(snow_context *context, snow_share_fn *read,
                                 void *user, bool *packed);

/* Collective.  The ranks unpack their shares one after another, each from where
 * the one before has come to; those from `readers` on have nothing of their
 * own, and read as they like.  Where a reader skips nothing, the ranks behind
 * read side by side.  Progress counts turns.  `path` is for warnings.  Errors:
 * of reading; not agreed on, and the ranks behind one that fails or is to stop
 * read nothing. */
snow_status snow_shares_in_turn(snow_comm *comm, int readers, const char *path,
                                snow_share_fn *read, void *user);

#endif
