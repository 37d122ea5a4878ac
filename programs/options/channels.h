/* channels.h - the list of --channel: which channels of the input, and how each
 * is shown. */
#ifndef OPTIONS_CHANNELS_H
#define OPTIONS_CHANNELS_H

#include "options/option_values.h"

typedef struct channel_pick {
    char name[40];     /* as given: a number or a name */
    int64_t index;     /* -1: not known yet */
    char color[32];    /* #rrggbb, or a colour map; "": the file's */
    range_value range; /* SNOW_RANGE_AUTO: the file's, or chosen */
    double opacity;    /* a factor on opacities */
    bool light;        /* emitted, of which noise is left out */
    double white;      /* the ground of the colours it is a part of; or 0 */
    bool absolute;     /* a direction: its absolute values */
} channel_pick;

typedef struct channel_list {
    channel_pick picks[SNOW_CHANNELS_MAX];
    int count;
    bool plain; /* one channel, of which nothing else is said */
} channel_list;

/* "0:magenta,GFP:#00ff00:100..2000:0.5"; else `wrong` is the end of the
 * sentence. */
bool channels_parse(const char *text, channel_list *out,
                    char wrong[WRONG_BYTES]);

/* Finds the numbers of names, in any case; false: *missing is unknown. */
bool channels_find(channel_list *list, const snow_volume_info *info,
                   const char **missing);

/* The list that is read back as these, whose numbers are known. */
void channels_text(const channel_list *list, char *out, size_t size);

/* Whether all are of emitted light, since the file says so or colours are
 * given. */
bool channels_are_light(const channel_list *list, const snow_volume_info *info);

/* All that the file shows; none where that is its first channel as it is. */
void channels_of_file(const snow_volume_info *info, channel_list *out);

/* Directions of vectors, as of diffusion: red is |x|, green |y|, blue |z|. */
void channels_of_directions(channel_list *out);

/* Names those without a colour: the file's, else this map unless it is NULL,
 * else a usual one.  Of light blue is paler: it is too dark to be seen. */
void channels_fill(channel_list *list, const snow_volume_info *info,
                   const char *colormap);

/* Red, green and blue of "#rrggbb". */
bool channels_rgb(const char *text, double rgb[3]);

#endif
