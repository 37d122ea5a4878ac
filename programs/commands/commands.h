/* commands.h - the functions of the verbs, and helpers that several verbs
 * share.  Each verb returns an exit code. */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "options/options.h"

#include <stdio.h>

int cmd_render(const options *opts);
int cmd_turntable(const options *opts);
int cmd_movie(const options *opts);
int cmd_slice(const options *opts);
int cmd_info(const options *opts);
int cmd_phantom(const options *opts);
int cmd_convert(const options *opts);
int cmd_compare(const options *opts);
int cmd_doctor(const options *opts);
int cmd_report(const options *opts);
int cmd_export(const options *opts);
int cmd_tf(const options *opts);

/* What doctor --json prints. */
void doctor_write(FILE *out);

/* The first of its two operands is the output. */
void export_take(options *opts);

/* The name of an input in messages: its path, or "standard input" for "-". */
const char *name_of_input(const char *path);

/* The options that describe an input, as the library takes them; the look's
 * texts stay those of the options. */
snow_volume_options data_options(const options *opts);
snow_look look_options(const options *opts);

/* Of projections and slices. */
snow_range automatic_range(const options *opts);

/* Opens the input volume: a file, phantom:NAME, or "-" for standard input.
 * Returns CONTINUE or an exit code. */
int open_input(snow_context *context, const options *opts, const char *path,
               snow_volume **out);

/* Reports the fault of the input's header, if it has one, before that of an
 * output, since a user mends the input first; the second function reads it only
 * if one of `outputs`, which may be NULL, stands in the way.  Return CONTINUE
 * or an exit code. */
int check_input(const options *opts);
int check_input_first(const options *opts, const char *const *outputs,
                      size_t count);

/* Finds the numbers of the channels that --channel names; a list is for
 * pictures.  Returns CONTINUE or an exit code. */
int settle_channels(options *opts, bool pictures);

/* Loads the file of --tf, if there is one, into the options; the second
 * function frees it.  Returns CONTINUE or an exit code. */
int look_load(options *opts);
void look_unload(options *opts);

/* Writes a volume to the output file and reports it.  Returns an exit code. */
int save_volume(snow_context *context, const options *opts,
                const snow_volume *volume);

/* Refuses look options that contradict each other, before a volume is read.
 * Returns CONTINUE or an exit code. */
int check_look(const options *opts);

/* Fills the settings from the options, except the opacity length, which depends
 * on the volume's unit. */
void fill_settings(const options *opts, snow_settings *out);

/* Make the settings and the view that the options request.  Return CONTINUE or
 * an exit code. */
int make_settings(const options *opts, const snow_volume_info *info,
                  snow_settings *out);
int make_view(snow_context *context, const options *opts,
              const snow_volume_info *info, snow_view *out);

/* Makes the transfer function that the options request.  Returns CONTINUE or an
 * exit code. */
int open_look(snow_context *context, const options *opts,
              const snow_volume *volume, snow_transfer **out);

/* Refuses --depth in modes without depth.  Returns CONTINUE or an exit code. */
int check_depth_mode(const options *opts);

/* The form of the picture file that the options request; the look is NULL where
 * it is not known yet. */
snow_image_options picture_form(const options *opts,
                                const snow_transfer *transfer);

/* Refuses settings that contradict each other, before a volume is read.
 * Returns CONTINUE or an exit code. */
int check_settings(const options *opts);

/* Refuses --stats in the file of --output.  Returns CONTINUE or an exit code.
 */
int check_stats_apart(const options *opts);

/* Refuses options of one picture that contradict each other, and outputs that
 * cannot be written, before anything is read.  Return CONTINUE or an exit
 * code. */
int check_picture(const options *opts);
int check_picture_paths(snow_context *context, const options *opts);

/* "raw 256x256x110 uint8, spacing 1x1x1 mm". */
void describe_volume(const snow_volume_info *info, char *out, size_t size);

#endif
