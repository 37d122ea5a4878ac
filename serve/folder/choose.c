/* choose.c - from an entry of the list to what is opened, and whether a folder
 * has to have a list at all; see folder.h. */
#include "commands/commands.h"
#include "commands/first.h"
#include "commands/info_list.h"
#include "folder/inside.h"
#include "folder/own.h"
#include "options/config.h"
#include "recipe_file.h"
#include "run/log.h"
#include "run/paths.h"
#include "run/start.h"
#include "series/series.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- whether there is a list ---------------------------------------------- */

static bool holds_folders(const char *path) {
    const struct dirent *entry;
    char below[PATH_MAX];
    bool found = false;
    DIR *stream = opendir(path);
    while (stream && !found && (entry = readdir(stream)))
        found = entry->d_name[0] != '.' &&
                snprintf(below, sizeof below, "%s/%s", path, entry->d_name) <
                    PATH_MAX &&
                is_folder(below);
    if (stream)
        closedir(stream);
    return found;
}

/* Series of which one has to be chosen, also where the largest is damaged. */
static bool has_choice(const options *opts, const char *path) {
    snow_context *context = NULL;
    snow_volume_options data = data_options(opts);
    snow_volume_info info = {.size = sizeof info};
    snow_status status;
    if (snow_context_new(NULL, &context) != SNOW_STATUS_OK)
        return false;
    bool several = describe_count(context, path, &data, &info, &status) > 1;
    if (status != SNOW_STATUS_OK) {
        data.series = "1";
        several = snow_volume_inspect(context, path, &data, &info) ==
                      SNOW_STATUS_OK ||
                  holds_folders(path);
    }
    snow_context_free(context);
    return several;
}

bool folder_is_meant(const options *opts) {
    const char *path = opts->operand_count == 1 ? opts->operands[0] : "-";
    if (opts->live || opts->series || opts->dataset || opts->type ||
        opts->dims[0] || opts->endian || opts->offset || !is_folder(path))
        return false;
    return info_is_list(opts) || has_choice(opts, path);
}

int folder_check(const options *opts) {
    static const char *const names[] = {"mask", "overlay", "labels", "channel"};
    if (process_ranks() > 1)
        return fail_usage("%s: holds several volumes, and many ranks show one; "
                          "name it, or give --series N",
                          opts->operands[0]);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (options_given(opts, names[i]))
            return fail_usage("--%s: is of one volume, and %s holds several; "
                              "name one of them",
                              names[i], opts->operands[0]);
    return CONTINUE;
}

/* --- what a page has chosen ----------------------------------------------- */

static void free_opened(opened *o) {
    if (!o)
        return;
    json_decref(o->recipe);
    if (o->owns_look)
        look_unload(&o->opts);
    free(o);
}

/* The number of the entry that a question means; -1: there is none. */
static int64_t find_entry(folder *f, const json_t *question) {
    const json_t *entry = json_object_get(question, "entry");
    const char *name = json_string_value(json_object_get(question, "name"));
    const char *series = json_string_value(json_object_get(question, "series"));
    int64_t found = -1;
    pthread_mutex_lock(&f->lock);
    if (json_is_integer(entry) && json_integer_value(entry) >= 0 &&
        json_integer_value(entry) < (json_int_t)f->count)
        found = json_integer_value(entry);
    for (size_t i = 0; name && !entry && found < 0 && i < f->count; i++)
        if (strcmp(f->entries[i].name, name) == 0 &&
            strcmp(f->entries[i].series, series ? series : "") == 0)
            found = (int64_t)i;
    pthread_mutex_unlock(&f->lock);
    return found;
}

/* Of a path that may name a data set in its file. */
static int check_inside(const folder *f, const char *path, const char *name) {
    char file[PATH_MAX], where[NAME_MAX + 1];
    file_of_input(path, file, sizeof file);
    if (inside_root(f->real, file, where))
        return CONTINUE;
    if (is_there(file))
        return fail_usage("%s: %s leads out of the folder that was given, or "
                          "cannot be looked at; name it to open it",
                          name, where);
    return fail_usage("%s: %s is not there any more; start the viewer again "
                      "for a new list",
                      name, where);
}

/* The files that a recipe names, as far as pictures need them. */
static int take_recipe(const folder *f, const char *path, const char *name,
                       opened *o) {
    static const char *const files[] = {"input", "tf", "mask", "label-table",
                                        "overlay"};
    static const char *const unwanted[] = {"output", "depth", "size", "verb",
                                           "quality"};
    json_t *tree = describe_recipe_tree(path);
    const char *input = json_string_value(json_object_get(tree, "input"));
    int done =
        input ? CONTINUE
              : fail_usage("%s: is no recipe any more; choose another", name);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *file = json_string_value(json_object_get(tree, files[i]));
        if (file && done == CONTINUE)
            done = check_inside(f, file, name);
    }
    if (done == CONTINUE)
        snprintf(o->path, sizeof o->path, "%s", input);
    for (size_t i = 0; i < sizeof unwanted / sizeof *unwanted; i++)
        json_object_del(tree, unwanted[i]);
    json_object_del(tree, "input");
    if (done == CONTINUE)
        done = config_take_tree(&o->opts, verb_of(VERB_SERVE), tree);
    json_decref(tree);
    if (done != CONTINUE)
        return done;
    o->opts.loaded = NULL; /* of the command line, which owns it */
    o->opts.tf_context = NULL;
    o->owns_look = true;
    return look_load(&o->opts);
}

static bool is_same(const snow_volume_info *a, const snow_volume_info *b) {
    return memcmp(a->dims, b->dims, sizeof a->dims) == 0 &&
           memcmp(a->matrix, b->matrix, sizeof a->matrix) == 0 &&
           strcmp(a->modality, b->modality) == 0 &&
           strcmp(a->description, b->description) == 0;
}

/* The series that was listed, whatever the folder has got since; other files
 * may be another one under the same name. */
static int check_series(const folder_entry *e, const opened *o) {
    snow_context *context = NULL;
    const snow_volume_options data = data_options(&o->opts);
    snow_volume_options plain = {.size = sizeof plain,
                                 .series = data.series,
                                 .each_time = true,
                                 .each_channel = true,
                                 .allow_gaps = data.allow_gaps};
    snow_volume_info info = {.size = sizeof info};
    snow_status status = snow_context_new(NULL, &context);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_inspect(context, o->path,
                                     *e->series ? &plain : &data, &info);
    int done = check_status(context, status);
    snow_context_free(context);
    if (done == CONTINUE && *e->series && !is_same(&info, e->info))
        done = fail_usage("%s: has other series than when it was listed; start "
                          "the viewer again for a new list",
                          e->name);
    return done;
}

static int take_entry(const folder *f, const folder_entry *e, opened *o) {
    char path[PATH_MAX];
    if (e->kind == ENTRY_FAULT)
        return fail_usage("%s: %s", e->name, e->text);
    if (!list_path(f, e->name, path))
        return fail_usage("%s: the path is too long", e->name);
    int done = check_inside(f, path, e->name);
    if (done != CONTINUE)
        return done;
    if (e->kind == ENTRY_RECIPE)
        return take_recipe(f, path, e->name, o);
    memcpy(o->path, path, sizeof path);
    if (*e->series)
        done = options_take(&o->opts, verb_of(VERB_SERVE), "series", e->series);
    return done;
}

/* As for the input of the command line. */
static int settle(const folder_entry *e, opened *o) {
    options *opts = &o->opts;
    o->operands[0] = o->path;
    opts->operands = o->operands;
    opts->operand_count = 1;
    int done = check_series(e, o);
    if (done == CONTINUE)
        done = series_take(opts, verb_of(VERB_SERVE));
    if (done == CONTINUE)
        done = settle_channels(opts, true);
    if (done == CONTINUE)
        first_settle(opts);
    if (done == CONTINUE)
        done = layers_check(opts);
    if (done == CONTINUE)
        done = check_settings(opts);
    o->recipe = done == CONTINUE ? recipe_first(opts) : NULL;
    return done;
}

int folder_choose(void *user, const json_t *question, const options **first,
                  const json_t **recipe) {
    folder *f = user;
    const int64_t entry = find_entry(f, question);
    if (entry < 0)
        return fail_usage("open: the list has no such entry; load the page "
                          "again");
    opened *o = calloc(1, sizeof *o);
    if (!o)
        return fail_memory("out of memory for another volume; close other "
                           "programs");
    pthread_mutex_lock(&f->lock);
    o->of = f->entries[entry];
    pthread_mutex_unlock(&f->lock);
    o->opts = *f->base;
    o->entry = (size_t)entry;
    int done = take_entry(f, &o->of, o);
    if (done == CONTINUE)
        done = settle(&o->of, o);
    if (done != CONTINUE) {
        free_opened(o);
        return done;
    }
    f->next = o;
    *first = &o->opts;
    *recipe = o->recipe;
    return CONTINUE;
}

void folder_opened(void *user, bool good) {
    folder *f = user;
    free_opened(good ? f->now : f->next);
    if (good) {
        f->now = f->next;
        pthread_mutex_lock(&f->lock);
        f->open = (int64_t)f->now->entry;
        pthread_mutex_unlock(&f->lock);
    }
    f->next = NULL;
    list_tell(f, true);
}

void folder_free(folder *f) {
    if (!f)
        return;
    f->ended = true;
    pthread_mutex_lock(&f->lock);
    pthread_cond_signal(&f->changed);
    pthread_mutex_unlock(&f->lock);
    if (f->runs)
        pthread_join(f->thread, NULL);
    list_forget(f);
    free_opened(f->now);
    free_opened(f->next);
    snow_context_free(f->context);
    pthread_cond_destroy(&f->changed);
    pthread_mutex_destroy(&f->lock);
    free(f->path);
    free(f);
}
