/* channels.h - several channels of a file in one picture. */
#ifndef PICTURE_CHANNELS_H
#define PICTURE_CHANNELS_H

#include "options/options.h"

#include <snowglass/ranks.h>
#include <snowglass/snowglass.h>

/* The ground that voxels of own colours lie on, which is looked for once: above
 * 0 it is white, and the brightness from which on it is clear. */
typedef struct channels_ground {
    bool known;
    double white;
} channels_ground;

/* Those of a picture; the first one's volume and look may be the caller's. */
typedef struct channel_set {
    channel_list list; /* none: the volume is drawn alone */
    snow_volume *volumes[SNOW_CHANNELS_MAX];
    snow_transfer *looks[SNOW_CHANNELS_MAX];
    bool chosen; /* the list is; it holds for all steps */
    channels_ground ground;
} channel_set;

/* Those that the options name or, where they leave it open, the file shows.
 * `why`, unless NULL, says why several cannot be drawn: then those of the file
 * give way, with a note, to its first one, and those of the options are
 * refused.  So are those that a limit of memory cannot hold together.  Later
 * calls leave the set as it is.  Returns CONTINUE or an exit code. */
int channels_choose(const options *opts, const snow_volume_info *info,
                    const char *why, channel_set *out);

/* The note that the first one of a file is drawn alone, and why. */
void channels_note(const options *opts, const snow_volume_info *info,
                   const char *why);

/* Why the options of a picture of a volume exclude several; or NULL. */
const char *channels_hinder(const options *opts);

/* The look of one on its volume, or on that of which ranks (comm unless NULL)
 * have parts.  Where the list leaves a range open it becomes that of the look,
 * for what is printed. */
snow_status channels_look(snow_comm *comm, const options *opts,
                          const snow_volume_info *info, channel_pick *pick,
                          const snow_volume *volume, snow_transfer **out);

/* The data of one. */
snow_volume_options channels_data(const options *opts,
                                  const channel_pick *pick);

/* Opens all but the first that are not open, with looks unless they have some:
 * in memory or, where slabs or ranks share the first one, in their file. */
snow_status channels_open(const options *opts, snow_context *context,
                          const char *path, bool in_file, uint64_t slab_bytes,
                          channel_set *c);

/* Adds the light of their slices `index` to that of the first one, in its
 * place. */
snow_status channels_add_slices(const channel_set *c, snow_context *context,
                                int64_t index, const snow_view *view,
                                const snow_settings *settings,
                                snow_image **image);

/* "channels 0 DAPI blue 10..200, 1 GFP green 5..90". */
void channels_describe(const channel_set *c, char *out, size_t size);

void channels_close_volumes(channel_set *c);
void channels_close(channel_set *c);

#endif
