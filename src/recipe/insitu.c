/* recipe/insitu.c - recipes for running simulations: applied, and read again
 * when their file changes. */
#include "recipe/keys.h"

#include <snowglass/extend.h>
#include <snowglass/look_file.h>

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#define PATH_BYTES 4096

/* A recipe's file, as it was read last. */
typedef struct watched {
    snow_context *context;
    struct stat was;
    bool formed; /* it has said how files are written */
    char path[PATH_BYTES];
} watched;

/* --- applying --------------------------------------------------------------
 */

/* What a recipe comes to; all of it is known before any is applied. */
typedef struct picture {
    snow_look look;
    snow_view view;
    snow_settings settings;
    snow_look_file *tf;
    bool formed; /* it says, or said, how files are written */
} picture;

/* What would be another picture of a file, and cannot be made here. */
static snow_status check_foreign(snow_context *context,
                                 const snow_recipe *recipe) {
    static const int64_t whole[3][2];
    const snow_volume_options *data = &recipe->data;
    const char *foreign = recipe->depth      ? "depth"
                          : recipe->axis     ? "axis"
                          : recipe->measure  ? "measure"
                          : recipe->overlay  ? "overlay"
                          : recipe->channels ? "channel"
                          : recipe->steps    ? "time"
                          : memcmp(data->crop, whole, sizeof whole) != 0
                              ? "crop"
                          : data->mask        ? "mask"
                          : data->labels      ? "labels"
                          : data->label_table ? "label-table"
                          : data->levels      ? "levels"
                          : data->suv         ? "suv"
                          : data->vertical    ? "vertical"
                          : data->z_scale > 0 ? "z-scale"
                                              : NULL;
    return foreign ? snow_context_fail(context, SNOW_STATUS_BAD_USAGE,
                                       "\"%s\" is for pictures of files; "
                                       "remove it from a recipe for a "
                                       "simulation",
                                       foreign)
                   : SNOW_STATUS_OK;
}

static snow_status make_picture(snow_context *context,
                                const snow_recipe *recipe, picture *p) {
    snow_view usual;
    snow_look_init(&p->look);
    snow_view_init(&usual);
    snow_view_init(&p->view);
    snow_settings_init(&p->settings);
    snow_status status = check_foreign(context, recipe);
    if (status == SNOW_STATUS_OK)
        status = snow_recipe_get_look(context, recipe, &p->look);
    if (status == SNOW_STATUS_OK && recipe->tf)
        status = snow_look_load(context, recipe->tf, &p->tf);
    if (status == SNOW_STATUS_OK && p->tf)
        p->look.base = snow_look_file_look(p->tf);
    if (status == SNOW_STATUS_OK)
        status = snow_recipe_get_view(context, recipe, &usual, &p->view);
    if (status == SNOW_STATUS_OK)
        status = snow_recipe_get_settings(context, recipe, "", &p->settings);
    if (status == SNOW_STATUS_OK && p->tf && p->look.base->per_mm &&
        !recipe->opacity_per_voxel)
        p->settings.opacity_length = 1; /* a millimetre, the unit in situ */
    return status;
}

/* The title of a bar, "name (unit)", as its parts, each "" where it has none.
 */
static void split_title(const char *title, char name[128], char unit[128]) {
    const size_t length = strlen(title);
    const char *open = strrchr(title, '(');
    *unit = 0;
    if (!open || title[length - 1] != ')')
        open = title + length;
    else
        snprintf(unit, 128, "%.*s", (int)(title + length - open - 2), open + 1);
    while (open > title && open[-1] == ' ')
        open--;
    snprintf(name, 128, "%.*s", (int)(open - title), title);
}

/* The planes of a recipe are its first ones. */
static size_t count_planes(const double planes[SNOW_CLIPS_MAX][4]) {
    size_t count = 0;
    while (count < SNOW_CLIPS_MAX &&
           (planes[count][0] != 0 || planes[count][1] != 0 ||
            planes[count][2] != 0))
        count++;
    return count;
}

/* Whether the recipe says how files are written; a record without texts of its
 * own is the caller's, who has filled it. */
static bool has_form(const snow_recipe *recipe) {
    static const char *const keys[] = {"background", "bits", "overwrite",
                                       "sync"};
    bool has = recipe->output || !recipe->owned;
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        has = has || json_object_get(recipe->owned, keys[i]);
    return has;
}

static snow_status set_picture(const snow_recipe *recipe, const picture *p,
                               snow_insitu *insitu) {
    const char *step = recipe->annotate;
    const bool timed = step && strncasecmp(step, "time", 4) == 0;
    char name[128] = "", unit[128] = "";
    if (recipe->legend_title)
        split_title(recipe->legend_title, name, unit);
    const snow_insitu_annotations annotations = {
        .size = sizeof annotations,
        .title = recipe->title,
        .quantity = name,
        .unit = unit,
        .time_format = !timed           ? ""
                       : step[4] == '=' ? step + 5
                                        : NULL,
        .legend = recipe->legend,
        .scale_bar = recipe->scale_bar,
        .step = step != NULL,
        .outline = recipe->box != NULL,
        .axes = recipe->box && strcasecmp(recipe->box, "axes") == 0};
    const snow_insitu_limits limits = {.size = sizeof limits,
                                       .seconds = recipe->limit_seconds,
                                       .bytes = (uint64_t)recipe->limit_bytes};
    const bool limited = limits.seconds > 0 || limits.bytes > 0;
    const snow_insitu_settings settings = {
        .size = sizeof settings,
        .output = recipe->output,
        .image = p->formed ? &recipe->image : NULL,
        .look = &p->look,
        .view = &p->view,
        .picture = &p->settings,
        .shaded = json_object_get(recipe->owned, "shade") != NULL,
        .clip = recipe->data.clip[0],
        .clip_count = count_planes(recipe->data.clip),
        .annotations = &annotations,
        .limits = limited ? &limits : NULL,
        .sync = recipe->sync};
    return snow_insitu_set(insitu, &settings);
}

snow_status snow_recipe_apply(const snow_recipe *recipe, snow_insitu *insitu) {
    picture p = {.formed = has_form(recipe)};
    snow_status status =
        make_picture(snow_comm_context(snow_insitu_comm(insitu)), recipe, &p);
    if (status == SNOW_STATUS_OK)
        status = set_picture(recipe, &p, insitu);
    snow_look_file_free(p.tf);
    return snow_insitu_set_recipe_status(insitu, status);
}

snow_status snow_recipe_apply_text(snow_insitu *insitu, const char *text) {
    snow_recipe recipe;
    snow_context *context = snow_comm_context(snow_insitu_comm(insitu));
    snow_recipe_init(&recipe);
    snow_status status =
        snow_recipe_parse(context, "the recipe", text, strlen(text), &recipe);
    if (status != SNOW_STATUS_OK)
        return snow_insitu_set_recipe_status(insitu, status);
    status = snow_recipe_apply(&recipe, insitu);
    snow_recipe_clear(&recipe);
    return status;
}

/* --- reading again ---------------------------------------------------------
 */

/* On the first rank: whether the file is another than it was. */
static bool has_changed(watched *w) {
    struct stat now;
    if (stat(w->path, &now) || !S_ISREG(now.st_mode))
        return false;
    bool same = now.st_mtim.tv_sec == w->was.st_mtim.tv_sec &&
                now.st_mtim.tv_nsec == w->was.st_mtim.tv_nsec &&
                now.st_size == w->was.st_size && now.st_ino == w->was.st_ino;
    w->was = now;
    return !same;
}

/* Collective.  The first rank's text on all; nothing where that is empty. */
static snow_status share_text(snow_comm *comm, char **text, size_t *bytes) {
    int64_t count = (int64_t)*bytes;
    snow_status status = snow_comm_broadcast(comm, &count, sizeof count, 0);
    *bytes = (size_t)count;
    if (status != SNOW_STATUS_OK || !count)
        return status;
    if (!*text)
        *text = snow_context_allocate(snow_comm_context(comm), *bytes);
    status = snow_comm_agree_status(comm, *text ? SNOW_STATUS_OK
                                                : SNOW_STATUS_NO_MEMORY);
    return status == SNOW_STATUS_OK
               ? snow_comm_broadcast(comm, *text, *bytes, 0)
               : status;
}

/* Collective.  Of a recipe that is no good on any rank nothing is applied on
 * any; `reread` is what it says.  What an earlier one said of files, and this
 * one does not, holds no longer (`formed`). */
static snow_status take_text(snow_insitu *insitu, const char *path,
                             const char *text, size_t bytes, bool *reread,
                             bool *formed) {
    snow_comm *comm = snow_insitu_comm(insitu);
    snow_context *context = snow_comm_context(comm);
    picture p = {.tf = NULL};
    snow_recipe recipe;
    snow_recipe_init(&recipe);
    snow_status status = snow_recipe_parse(context, path, text, bytes, &recipe);
    if (status == SNOW_STATUS_OK)
        status = make_picture(context, &recipe, &p);
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK && recipe.output)
        status = snow_insitu_try_output(insitu, recipe.output);
    p.formed = *formed || has_form(&recipe);
    if (status == SNOW_STATUS_OK) {
        *formed = p.formed;
        status = snow_comm_agree_status(comm, set_picture(&recipe, &p, insitu));
    }
    *reread = recipe.reread;
    snow_look_file_free(p.tf);
    snow_recipe_clear(&recipe);
    return status;
}

/* Collective: the first rank looks, and sends what it reads. */
static snow_status read_again(snow_insitu *insitu, void *user) {
    watched *w = user;
    snow_context *context = w->context;
    if (!insitu) {
        snow_context_release(context, w);
        return SNOW_STATUS_OK;
    }
    snow_comm *comm = snow_insitu_comm(insitu);
    char *text = NULL;
    size_t bytes = 0;
    bool reread = true;
    if (snow_comm_rank(comm) == 0 && has_changed(w))
        recipe_read_file(context, w->path, &text, &bytes);
    snow_status status = share_text(comm, &text, &bytes);
    if (status == SNOW_STATUS_OK && bytes)
        status = take_text(insitu, w->path, text, bytes, &reread, &w->formed);
    if (status == SNOW_STATUS_OK && !reread)
        snow_insitu_set_refresh(insitu, NULL, NULL);
    snow_context_release(context, text);
    return status;
}

/* A file that changes after this is read again. */
static watched *begin_watch(snow_context *context, const char *path) {
    watched *w = snow_context_allocate(context, sizeof *w);
    if (!w)
        return NULL;
    *w = (watched){.context = context};
    snprintf(w->path, sizeof w->path, "%s", path);
    has_changed(w);
    return w;
}

snow_status snow_recipe_apply_file(snow_insitu *insitu, const char *path) {
    snow_comm *comm = snow_insitu_comm(insitu);
    snow_context *context = snow_comm_context(comm);
    char *text = NULL;
    size_t bytes = 0;
    bool reread = false;
    watched *w = begin_watch(context, path);
    snow_status status = w ? SNOW_STATUS_OK : SNOW_STATUS_NO_MEMORY;
    if (w && snow_comm_rank(comm) == 0)
        status = recipe_read_file(context, path, &text, &bytes);
    status = snow_comm_agree_status(comm, status);
    if (status == SNOW_STATUS_OK)
        status = share_text(comm, &text, &bytes);
    if (status == SNOW_STATUS_OK)
        status = take_text(insitu, path, text ? text : "", bytes, &reread,
                           &w->formed);
    if (status == SNOW_STATUS_OK)
        snow_insitu_set_refresh(insitu, reread ? read_again : NULL,
                                reread ? w : NULL);
    if (status != SNOW_STATUS_OK || !reread)
        snow_context_release(context, w);
    snow_context_release(context, text);
    return snow_insitu_set_recipe_status(insitu, status);
}
