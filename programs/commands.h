/* commands.h - the verbs, and what several of them share.  Each verb answers
 * an exit code. */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "options.h"

int cmd_render(const options *asked);
int cmd_turntable(const options *asked);
int cmd_movie(const options *asked);
int cmd_info(const options *asked);
int cmd_phantom(const options *asked);
int cmd_convert(const options *asked);
int cmd_compare(const options *asked);
int cmd_doctor(const options *asked);
int cmd_tf(const options *asked);

/* What an input is called when it is spoken of: its path, or "standard input"
 * for "-". */
const char *name_of_input(const char *path);

/* What the options say of an input, and of its look, which points into them. */
snow_volume_options data_options(const options *asked);
snow_look look_options(const options *asked);

/* Opens the volume that the options name: a file, phantom:NAME, or "-" for
 * standard input.  Answers GO_ON or an exit code. */
int open_input(snow_context *context, const options *asked, const char *path,
               snow_volume **out);

/* Reads the file of --tf, if that is there, into the options; and frees it.
 * Answers GO_ON or an exit code. */
int look_load(options *asked);
void look_unload(options *asked);

/* Writes a volume to the output that the options name, and says so.  Answers an
 * exit code. */
int save_volume(snow_context *context, const options *asked,
                const snow_volume *volume);

/* Refuses look options that contradict each other: asked before a volume is
 * read.  Answers GO_ON or an exit code. */
int check_look(const options *asked);

/* The transfer function that the options ask for.  Answers GO_ON or an exit
 * code. */
int open_look(snow_context *context, const options *asked,
              const snow_volume *volume, snow_transfer **out);

/* The settings that the options ask for, but for the opacity's length, which
 * depends on the volume's unit. */
void fill_settings(const options *asked, snow_settings *out);

/* The settings and the view that the options ask for.  Answer GO_ON or an exit
 * code. */
int make_settings(const options *asked, const snow_volume_info *info,
                  snow_settings *out);
int make_view(snow_context *context, const options *asked,
              const snow_volume_info *info, snow_view *out);

/* Refuses --depth of a mode that has none.  Answers GO_ON or an exit code. */
int check_depth_mode(const options *asked);

/* How the options ask for a picture's file. */
snow_image_options picture_form(const options *asked);

/* Refuses settings that contradict each other, before a volume is read.
 * Answers GO_ON or an exit code. */
int check_settings(const options *asked);

/* "raw 256x256x110 uint8, spacing 1x1x1 mm". */
void describe_volume(const snow_volume_info *info, char *out, size_t size);

#endif
