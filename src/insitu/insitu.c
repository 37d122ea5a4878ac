/* insitu/insitu.c - the setters: data and pictures of a simulation.
 *
 * Nothing here speaks to other ranks but snow_insitu_begin, which makes a
 * setter's failure on one rank the failure of all: a program may then check its
 * collective calls alone. */
#include "insitu/internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

snow_status snow_insitu_new(snow_comm *comm, snow_insitu **out) {
    snow_context *context = snow_comm_context(comm);
    snow_insitu *insitu = snow_context_allocate(context, sizeof *insitu);
    snow_status status = SNOW_STATUS_NO_MEMORY;
    if (insitu) {
        *insitu = (snow_insitu){0};
        insitu->comm = comm;
        insitu->context = context;
        insitu->whole = insitu->says = snow_insitu_empty_grid();
        insitu->says.time_value = NAN;
        insitu->seen[0] = insitu->seen[1] = NAN;
        snow_settings_init(&insitu->settings);
        snow_ranks_options_init(&insitu->how);
        snow_image_options_init(&insitu->form);
        snow_look_init(&insitu->look.look);
        status = snow_voxels_new(comm, &insitu->voxels);
    }
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK)
        *out = insitu;
    else
        snow_insitu_free(insitu);
    return status;
}

void snow_insitu_own_comm(snow_insitu *insitu, bool with_context) {
    insitu->owns_comm = true;
    insitu->owns_context = with_context;
}

void snow_insitu_forget(snow_insitu *insitu) {
    snow_context *context = insitu->context;
    snow_volume_close(insitu->volume);
    snow_frame_free(insitu->frame);
    snow_voxels_clear(insitu->voxels);
    snow_context_release(context, insitu->dense);
    snow_context_release(context, insitu->levels.sent.values);
    snow_context_release(context, insitu->levels.received.values);
    insitu->levels.sent.values = insitu->levels.received.values = NULL;
    insitu->volume = NULL;
    insitu->frame = NULL;
    insitu->dense = NULL;
    insitu->layout.planned = insitu->taken = false;
}

/* What pictures took, beside the simulation. */
static void report_cost(snow_insitu *insitu) {
    const double all = insitu->between + insitu->within;
    const double percent = 100 * insitu->within / all;
    if (insitu->pictures > 1 && all > 0 && insitu->limit_seconds == 0)
        snow_insitu_report(insitu,
                           "%lld pictures took %.*f %% of the time, %.3g s "
                           "beside %.3g s between two of them",
                           (long long)insitu->pictures, percent < 10, percent,
                           insitu->within / (double)(insitu->pictures - 1),
                           insitu->between / (double)(insitu->pictures - 1));
}

void snow_insitu_free(snow_insitu *insitu) {
    if (!insitu)
        return;
    snow_comm *comm = insitu->comm;
    snow_context *context = insitu->context;
    bool owns_comm = insitu->owns_comm;
    bool owns_context = insitu->owns_context;
    report_cost(insitu);
    if (insitu->voxels)
        snow_insitu_forget(insitu);
    snow_transfer_free(insitu->transfer);
    snow_voxels_free(insitu->voxels);
    snow_context_release(context, insitu->boxes);
    snow_context_release(context, insitu->held);
    snow_context_release(context, insitu->moved);
    snow_context_release(context, insitu->levels.bricks);
    snow_context_release(context, insitu->levels.pieces);
    snow_context_release(context, insitu->levels.sent.blocks);
    snow_context_release(context, insitu->levels.received.blocks);
    snow_context_release(context, insitu->levels.places);
    snow_context_release(context, insitu->levels.moved);
    snow_context_release(context, insitu->bricks);
    snow_insitu_free_look(context, &insitu->look);
    snow_insitu_set_refresh(insitu, NULL, NULL);
    snow_context_release(context, insitu->pattern);
    snow_context_release(context, insitu);
    if (owns_comm)
        snow_comm_free(comm);
    if (owns_context)
        snow_context_free(context);
}

const char *snow_insitu_message(const snow_insitu *insitu) {
    return insitu->message;
}

snow_comm *snow_insitu_comm(const snow_insitu *insitu) {
    return insitu->comm;
}

void snow_insitu_set_warning(snow_insitu *insitu, snow_warning_fn *warning,
                             void *user) {
    insitu->warning = warning;
    insitu->warning_user = user;
}

void snow_insitu_report(snow_insitu *insitu, const char *format, ...) {
    char text[SNOW_INSITU_MESSAGE];
    if (!insitu->warning || snow_comm_rank(insitu->comm) != 0)
        return;
    va_list arguments;
    va_start(arguments, format);
    snow_text_vprint(text, sizeof text, format, arguments);
    va_end(arguments);
    insitu->warning(insitu->warning_user, text);
}

/* --- errors --------------------------------------------------------------- */

static void keep_message(snow_insitu *insitu) {
    snprintf(insitu->message, sizeof insitu->message, "%s",
             snow_context_message(insitu->context));
}

/* Of a setter: the first failure is the one that is passed on. */
snow_status snow_insitu_set_error(snow_insitu *insitu, snow_status status) {
    if (status == SNOW_STATUS_OK || insitu->given != SNOW_STATUS_OK)
        return status;
    insitu->given = status;
    keep_message(insitu);
    return status;
}

snow_status snow_insitu_set_recipe_status(snow_insitu *insitu,
                                          snow_status status) {
    insitu->recipe = status;
    snprintf(insitu->recipe_message, sizeof insitu->recipe_message, "%s",
             status == SNOW_STATUS_OK ? ""
                                      : snow_context_message(insitu->context));
    if (status != SNOW_STATUS_OK && insitu->given == SNOW_STATUS_OK)
        keep_message(insitu);
    return status;
}

void snow_insitu_set_refresh(snow_insitu *insitu, snow_refresh_fn *refresh,
                             void *user) {
    if (insitu->refresh)
        insitu->refresh(NULL, insitu->refresh_user);
    insitu->refresh = refresh;
    insitu->refresh_user = user;
}

void snow_insitu_refresh(snow_insitu *insitu) {
    snow_status status = SNOW_STATUS_OK;
    if (insitu->refresh)
        status = insitu->refresh(insitu, insitu->refresh_user);
    insitu->given = SNOW_STATUS_OK; /* what its setters refuse is a warning */
    if (status != SNOW_STATUS_OK)
        snow_insitu_report(insitu, "%s; pictures stay as they were",
                           snow_context_message(insitu->context));
}

snow_status snow_insitu_refuse(snow_insitu *insitu, const char *format, ...) {
    char text[SNOW_INSITU_MESSAGE];
    va_list arguments;
    va_start(arguments, format);
    snow_text_vprint(text, sizeof text, format, arguments);
    va_end(arguments);
    return snow_insitu_set_error(
        insitu,
        snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE, "%s", text));
}

snow_status snow_insitu_begin(snow_insitu *insitu) {
    snow_status given = insitu->given;
    const char *message = insitu->message;
    insitu->given = SNOW_STATUS_OK;
    if (insitu->recipe != SNOW_STATUS_OK) { /* others may follow from it */
        given = insitu->recipe;
        message = insitu->recipe_message;
    }
    if (given != SNOW_STATUS_OK)
        snow_context_fail(insitu->context, given, "%s", message);
    return snow_comm_agree_status(insitu->comm, given);
}

snow_status snow_insitu_end(snow_insitu *insitu, snow_status status) {
    if (status != SNOW_STATUS_OK)
        keep_message(insitu);
    return status;
}

/* --- the picture ---------------------------------------------------------- */

snow_view snow_insitu_view(const snow_insitu *insitu) {
    snow_view view = insitu->view;
    if (!insitu->has_view)
        snow_view_init(&view);
    if (insitu->strip > 0)
        view.strip = insitu->strip;
    return view;
}
