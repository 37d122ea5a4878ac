/* insitu/insitu.c - what a simulation tells of its data and of the pictures it
 * wants.
 *
 * Nothing here speaks to other ranks but snow_insitu_begin, which makes a
 * setter's failure on one rank the failure of all: a program may then check its
 * collective calls alone. */
#include "insitu/internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* The most bricks of a rank: more are a wrong number. */
#define BRICKS_MOST 1000000

static snow_volume_info empty_grid(void) {
    snow_volume_info info = {
        .size = sizeof info, .slope = 1, .format = "memory", .times = 1};
    return info;
}

snow_status snow_insitu_new(snow_comm *comm, snow_insitu **out) {
    snow_context *context = snow_comm_context(comm);
    snow_insitu *insitu = snow_context_allocate(context, sizeof *insitu);
    snow_status status = SNOW_STATUS_NO_MEMORY;
    if (insitu) {
        *insitu = (snow_insitu){0};
        insitu->comm = comm;
        insitu->context = context;
        insitu->whole = empty_grid();
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
    insitu->volume = NULL;
    insitu->frame = NULL;
    insitu->dense = NULL;
    insitu->dense_bytes = 0;
    insitu->layout.planned = insitu->taken = false;
}

void snow_insitu_free(snow_insitu *insitu) {
    if (!insitu)
        return;
    snow_comm *comm = insitu->comm;
    snow_context *context = insitu->context;
    bool owns_comm = insitu->owns_comm;
    bool owns_context = insitu->owns_context;
    if (insitu->voxels)
        snow_insitu_forget(insitu);
    snow_transfer_free(insitu->transfer);
    snow_voxels_free(insitu->voxels);
    snow_context_release(context, insitu->boxes);
    snow_context_release(context, insitu->held);
    snow_context_release(context, insitu->moved);
    snow_context_release(context, insitu->bricks);
    snow_insitu_free_look(context, &insitu->look);
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

void snow_insitu_set_warning(snow_insitu *insitu, snow_warning_fn *notice,
                             void *user) {
    insitu->notice = notice;
    insitu->notice_user = user;
}

void snow_insitu_report(snow_insitu *insitu, const char *format, ...) {
    char text[SNOW_INSITU_MESSAGE];
    if (!insitu->notice || snow_comm_rank(insitu->comm) != 0)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    insitu->notice(insitu->notice_user, text);
}

/* --- errors --------------------------------------------------------------- */

static void keep_message(snow_insitu *insitu) {
    snprintf(insitu->message, sizeof insitu->message, "%s",
             snow_context_message(insitu->context));
}

/* Of a setter: the first failure is the one that is passed on. */
snow_status snow_insitu_answer(snow_insitu *insitu, snow_status status) {
    if (status == SNOW_STATUS_OK || insitu->given != SNOW_STATUS_OK)
        return status;
    insitu->given = status;
    keep_message(insitu);
    return status;
}

snow_status snow_insitu_set_error(snow_insitu *insitu, snow_status status) {
    return snow_insitu_answer(insitu, status);
}

snow_status snow_insitu_refuse(snow_insitu *insitu, const char *format, ...) {
    char text[SNOW_INSITU_MESSAGE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return snow_insitu_answer(
        insitu,
        snow_context_fail(insitu->context, SNOW_STATUS_BAD_USAGE, "%s", text));
}

snow_status snow_insitu_reserve(snow_insitu *insitu, void *block_pointer,
                                size_t *room, size_t keep, size_t bytes) {
    void *old;
    if (bytes <= *room)
        return SNOW_STATUS_OK;
    size_t wanted = *room + *room / 2 > bytes ? *room + *room / 2 : bytes;
    void *grown = snow_context_allocate(insitu->context, wanted);
    if (!grown)
        return SNOW_STATUS_NO_MEMORY;
    memcpy(&old, block_pointer, sizeof old);
    if (keep)
        memcpy(grown, old, keep);
    snow_context_release(insitu->context, old);
    memcpy(block_pointer, &grown, sizeof grown);
    *room = wanted;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_begin(snow_insitu *insitu) {
    snow_status given = insitu->given;
    insitu->given = SNOW_STATUS_OK;
    if (given != SNOW_STATUS_OK)
        snow_context_fail(insitu->context, given, "%s", insitu->message);
    return snow_comm_agree_status(insitu->comm, given);
}

snow_status snow_insitu_end(snow_insitu *insitu, snow_status status) {
    if (status != SNOW_STATUS_OK)
        keep_message(insitu);
    return status;
}

/* --- the data ------------------------------------------------------------- */

/* Along the axes of the world: the matrix has the spacing on its diagonal. */
static void place_grid(snow_volume_info *info, const double *origin,
                       const double *spacing) {
    for (int i = 0; i < 3; i++) {
        info->spacing[i] = spacing ? spacing[i] : 1;
        info->matrix[i][i] = info->spacing[i];
        info->matrix[i][3] = origin ? origin[i] : 0;
    }
    info->matrix[3][3] = 1;
}

/* By the rules for all volumes, whose voxels nobody looks at here. */
static snow_status check_grid(snow_context *context,
                              const snow_volume_info *info) {
    snow_volume *volume = NULL;
    snow_status status = snow_volume_wrap(context, info, info, &volume);
    snow_volume_close(volume);
    return status;
}

snow_status snow_insitu_set_grid(snow_insitu *insitu, const int64_t dims[3],
                                 const double origin[3],
                                 const double spacing[3]) {
    snow_volume_info info = empty_grid();
    memcpy(info.dims, dims, sizeof info.dims);
    place_grid(&info, origin, spacing);
    info.type = SNOW_TYPE_UINT8; /* any, for the check */
    for (int i = 0; i < 3; i++)
        if (!(info.spacing[i] > 0))
            return snow_insitu_refuse(insitu,
                                      "a spacing of %g is none; give a length "
                                      "above 0",
                                      info.spacing[i]);
    INSITU_TRY(snow_insitu_answer(insitu, check_grid(insitu->context, &info)));
    insitu->whole = info;
    insitu->brick_count = 0;
    insitu->changed = true;
    return SNOW_STATUS_OK;
}

/* Makes room for brick `id`; those between are empty. */
static snow_status reserve_bricks(snow_insitu *insitu, int id) {
    size_t size = sizeof *insitu->bricks;
    size_t had = (size_t)insitu->brick_count, count = (size_t)id + 1;
    if (count <= had)
        return SNOW_STATUS_OK;
    INSITU_TRY(snow_insitu_reserve(insitu, &insitu->bricks,
                                   &insitu->brick_bytes, had * size,
                                   count * size));
    memset(insitu->bricks + had, 0, (count - had) * size);
    insitu->brick_count = (int)count;
    return SNOW_STATUS_OK;
}

static snow_status check_brick(snow_insitu *insitu, int id,
                               const int64_t first[3], const int64_t count[3],
                               const snow_halo *halo) {
    const int64_t *dims = insitu->whole.dims;
    if (!dims[0])
        return snow_insitu_refuse(insitu,
                                  "there is no grid to put a brick into; call "
                                  "snow_insitu_set_grid first");
    if (id < 0 || id >= BRICKS_MOST)
        return snow_insitu_refuse(
            insitu, "%d is no number of a brick; count from 0", id);
    for (int i = 0; i < 3; i++) {
        if (count[i] < 0 || first[i] < 0 || count[i] > dims[i] ||
            first[i] > dims[i] - count[i])
            return snow_insitu_refuse(
                insitu,
                "brick %d has voxels %lld to %lld along axis %d, but "
                "the grid ends at %lld; correct first and count",
                id, (long long)first[i], (long long)(first[i] + count[i] - 1),
                i, (long long)(dims[i] - 1));
        if (halo->low[i] < 0 || halo->high[i] < 0 || halo->low[i] > INT32_MAX ||
            halo->high[i] > INT32_MAX)
            return snow_insitu_refuse(
                insitu,
                "brick %d has a halo below 0, or of billions; give "
                "the ghost voxels that lie around it",
                id);
    }
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_brick(snow_insitu *insitu, int id,
                                  const int64_t first[3],
                                  const int64_t count[3],
                                  const snow_halo *halo) {
    static const snow_halo none;
    if (!halo)
        halo = &none;
    INSITU_TRY(check_brick(insitu, id, first, count, halo));
    INSITU_TRY(snow_insitu_answer(insitu, reserve_bricks(insitu, id)));
    snow_insitu_brick *brick = &insitu->bricks[id];
    *brick = (snow_insitu_brick){.halo = *halo};
    bool none_left = !count[0] || !count[1] || !count[2];
    for (int i = 0; i < 3 && !none_left; i++) {
        brick->box.first[i] = first[i];
        brick->box.count[i] = count[i];
    }
    insitu->changed = true;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_voxels(snow_insitu *insitu, int id, snow_type type,
                                   const void *voxels,
                                   const int64_t stride[3]) {
    if (id < 0 || id >= insitu->brick_count ||
        !snow_box_voxels(&insitu->bricks[id].box))
        return snow_insitu_refuse(insitu,
                                  "there is no brick %d; call "
                                  "snow_insitu_set_brick first",
                                  id);
    if (!voxels || !snow_type_size(type))
        return snow_insitu_refuse(
            insitu, "brick %d has no voxels or no type; give both", id);
    snow_insitu_brick *brick = &insitu->bricks[id];
    int64_t step = 1;
    for (int i = 0; i < 3; i++) {
        brick->stride[i] = stride ? stride[i] : step;
        step *= brick->halo.low[i] + brick->box.count[i] + brick->halo.high[i];
    }
    brick->type = type;
    brick->voxels = voxels;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_distribution(snow_insitu *insitu,
                                         snow_ghosts ghosts,
                                         snow_balance balance) {
    if ((int)ghosts < 0 || ghosts > SNOW_GHOSTS_NONE || (int)balance < 0 ||
        balance > SNOW_BALANCE_REPARTITION)
        return snow_insitu_refuse(
            insitu, "ghosts %d or balance %d is none of its values",
            (int)ghosts, (int)balance);
    insitu->ghosts = ghosts;
    insitu->balance = balance;
    insitu->changed = true;
    return SNOW_STATUS_OK;
}

/* --- the picture ---------------------------------------------------------- */

snow_status snow_insitu_set_view(snow_insitu *insitu, const snow_view *given) {
    snow_view view;
    INSITU_TRY(snow_insitu_answer(
        insitu, SNOW_RECORD_READ(insitu->context, snow_view, given, &view)));
    if (view.width < 1 || view.height < 1)
        return snow_insitu_refuse(
            insitu,
            "a picture of %dx%d pixels is none; set width "
            "and height of the view",
            view.width, view.height);
    insitu->view = view;
    insitu->has_view = true;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_settings(snow_insitu *insitu,
                                     const snow_settings *settings) {
    snow_settings known;
    INSITU_TRY(snow_insitu_answer(
        insitu,
        SNOW_RECORD_READ(insitu->context, snow_settings, settings, &known)));
    insitu->settings = known;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_ranks(snow_insitu *insitu,
                                  const snow_ranks_options *how) {
    snow_ranks_options known;
    INSITU_TRY(snow_insitu_answer(
        insitu,
        SNOW_RECORD_READ(insitu->context, snow_ranks_options, how, &known)));
    insitu->how = known;
    return SNOW_STATUS_OK;
}

/* The place of the step's number: "%d", or "%0Nd" with N up to 18; the only
 * sign of per cent.  NULL where the text is none such. */
static const char *find_number(const char *pattern, int *digits, size_t *end) {
    const char *at = strchr(pattern, '%');
    if (!at || strchr(at + 1, '%'))
        return NULL;
    const char *p = at + 1;
    *digits = 0;
    if (*p == '0')
        for (p++; *p >= '0' && *p <= '9' && *digits < 18; p++)
            *digits = 10 * *digits + (*p - '0');
    *end = (size_t)(p + 1 - pattern);
    return *p == 'd' && *digits <= 18 ? at : NULL;
}

snow_status snow_insitu_set_output(snow_insitu *insitu, const char *pattern,
                                   const snow_image_options *options) {
    snow_image_options form;
    int digits;
    size_t end, bytes = strlen(pattern) + 1;
    INSITU_TRY(snow_insitu_answer(
        insitu,
        SNOW_RECORD_READ(insitu->context, snow_image_options, options, &form)));
    if (!find_number(pattern, &digits, &end))
        return snow_insitu_refuse(
            insitu,
            "%.200s: a movie's path has one %%d or %%04d for "
            "the number of the step",
            pattern);
    char *copy = snow_context_allocate(insitu->context, bytes);
    if (!copy)
        return snow_insitu_answer(insitu, SNOW_STATUS_NO_MEMORY);
    memcpy(copy, pattern, bytes);
    snow_context_release(insitu->context, insitu->pattern);
    insitu->pattern = copy;
    insitu->form = form;
    return SNOW_STATUS_OK;
}

snow_status snow_insitu_set_annotations(snow_insitu *insitu, bool legend,
                                        bool step) {
    insitu->legend = legend;
    insitu->step_label = step;
    return SNOW_STATUS_OK;
}

bool snow_insitu_path(const snow_insitu *insitu, int64_t step, char *out,
                      size_t room) {
    int digits = 0;
    size_t end = 0;
    const char *pattern = insitu->pattern;
    const char *at = find_number(pattern, &digits, &end);
    if (!at)
        return false;
    int length = snprintf(out, room, "%.*s%0*lld%s", (int)(at - pattern),
                          pattern, digits, (long long)step, pattern + end);
    return length > 0 && (size_t)length < room;
}

snow_status snow_insitu_set_limits(snow_insitu *insitu, double seconds,
                                   uint64_t bytes) {
    if (!(seconds >= 0))
        return snow_insitu_refuse(
            insitu, "%g seconds are no limit; give 0 for none", seconds);
    insitu->limit_seconds = seconds;
    insitu->limit_bytes = bytes;
    insitu->lowering = SNOW_DEGRADATION_NONE;
    insitu->to_skip = 0;
    return SNOW_STATUS_OK;
}

snow_view snow_insitu_view(const snow_insitu *insitu) {
    if (insitu->has_view)
        return insitu->view;
    snow_view view;
    snow_view_init(&view);
    return view;
}
