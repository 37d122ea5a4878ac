/* files/ranks_open.c - snow_ranks_open: the ranks of parallel/open.c over the
 * readers of formats/, neither of which knows the other. */
#include "parallel/part.h"

static snow_status open_file(snow_context *context, const char *path,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out) {
    snow_volume_info_init(info);
    if (!out)
        return snow_volume_inspect(context, path, options, info);
    SNOW_TRY(snow_volume_open(context, path, options, out));
    *info = *snow_volume_get_info(*out);
    return SNOW_STATUS_OK;
}

snow_status snow_ranks_open(snow_comm *comm, const char *path,
                            const snow_volume_options *options,
                            const snow_look *look, const snow_view *view,
                            const snow_settings *settings,
                            const snow_ranks_options *how, snow_volume **volume,
                            snow_transfer **transfer) {
    return snow_ranks_open_by(open_file, snow_format_name, comm, path, options,
                              look, view, settings, how, volume, transfer);
}
