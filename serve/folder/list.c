/* list.c - implements the list of folder.h: pages hear how long it is, and
 * fetch what they have not.
 *
 *   {"t": "folder", "name": "study", "count": 3, "done": true, "open": 1, ...}
 *   {"t": "ask", "what": "folder", "from": 2}
 *   {"t": "entries", "from": 2, "entries": [{"name": "a/head.nii", ...}]} */
#define _XOPEN_SOURCE 700
#include "answers/answers.h"
#include "folder/own.h"
#include "run/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

/* Entries of a message; seconds between two words about the list. */
#define PIECE 100
#define TELL_SECONDS 0.25

/* --- what is added -------------------------------------------------------- */

bool list_path(const folder *f, const char *name, char out[PATH_MAX]) {
    return snprintf(out, PATH_MAX, "%s%s%s",
                    strcmp(f->path, "/") ? f->path : "", *name ? "/" : "",
                    name) < PATH_MAX;
}

static void forget(folder_entry *e) {
    free(e->name);
    free(e->text);
    free(e->info);
    free(e->cover);
}

void list_forget(folder *f) {
    for (size_t i = 0; i < f->count; i++)
        forget(&f->entries[i]);
    free(f->entries);
}

/* Under the lock.  Where there is no memory the entry counts as one too many.
 */
static bool make_space(folder *f) {
    if (f->count >= ENTRIES_MOST)
        return false;
    if (f->count < f->capacity)
        return true;
    const size_t capacity = f->capacity ? 2 * f->capacity : 64;
    folder_entry *more = realloc(f->entries, capacity * sizeof *more);
    if (!more)
        return false;
    f->entries = more;
    f->capacity = capacity;
    return true;
}

void list_add(folder *f, const folder_entry *entry) {
    folder_entry own = *entry;
    const bool whole = own.name && (own.kind != ENTRY_VOLUME || own.info);
    pthread_mutex_lock(&f->lock);
    const bool added = whole && make_space(f);
    if (added)
        f->entries[f->count++] = own;
    f->faults += added && own.kind == ENTRY_FAULT;
    f->beyond += !added;
    pthread_mutex_unlock(&f->lock);
    if (!added)
        forget(&own);
    list_tell(f, false);
}

/* Without the path of the folder, which is nobody's business, and the name,
 * which stands beside it. */
static char *shorten(const folder *f, const char *name, const char *why) {
    char *text = strdup(why), prefix[PATH_MAX + 1];
    snprintf(prefix, sizeof prefix, "%s/", f->path);
    const size_t length = strlen(prefix);
    for (char *at = text; at && (at = strstr(at, prefix));)
        memmove(at, at + length, strlen(at + length) + 1);
    const size_t own = strlen(name);
    if (text && strncmp(text, name, own) == 0 &&
        strncmp(text + own, ": ", 2) == 0)
        memmove(text, text + own + 2, strlen(text + own + 2) + 1);
    return text;
}

void list_add_fault(folder *f, const char *name, const char *why) {
    const folder_entry made = {.kind = ENTRY_FAULT,
                               .name = strdup(name),
                               .text = shorten(f, name, why)};
    list_add(f, &made);
}

void list_count_out(folder *f) {
    pthread_mutex_lock(&f->lock);
    f->left_out++;
    pthread_mutex_unlock(&f->lock);
    list_tell(f, false);
}

/* --- what pages hear ------------------------------------------------------ */

/* A byte that is no part of UTF-8 becomes '?'. */
json_t *list_text(const char *text) {
    json_t *made = json_string(text);
    char *copy = made ? NULL : strdup(text);
    for (char *at = copy; at && *at; at++)
        if ((unsigned char)*at >= 0x80)
            *at = '?';
    if (copy)
        made = json_string(copy);
    free(copy);
    return made ? made : json_string("");
}

static const char *base_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

void list_tell(folder *f, bool now) {
    const double time = seconds_now();
    pthread_mutex_lock(&f->lock);
    const bool due = now || time - f->told >= TELL_SECONDS;
    json_t *tree = NULL;
    if (due) {
        f->told = time;
        tree = json_pack(
            "{s:s, s:o, s:I, s:I, s:I, s:I, s:b, s:o}", "t", "folder", "name",
            list_text(base_of(f->real)), "count", (json_int_t)f->count,
            "others", (json_int_t)f->left_out, "beyond", (json_int_t)f->beyond,
            "faults", (json_int_t)f->faults, "done", (int)f->done, "open",
            f->open < 0 ? json_null() : json_integer(f->open));
    }
    pthread_mutex_unlock(&f->lock);
    if (tree)
        answer_put(f->box, 0, MESSAGE_FOLDER, tree);
}

static void set_info(json_t *tree, const snow_volume_info *info) {
    json_object_set_new(tree, "dims", json_sizes(info->dims, 3));
    json_object_set_new(tree, "type", json_string(snow_type_name(info->type)));
    json_object_set_new(tree, "format", json_string(info->format));
    json_object_set_new(tree, "times", json_integer(info->times));
    json_object_set_new(tree, "modality", list_text(info->modality));
    json_object_set_new(tree, "description", list_text(info->description));
}

static json_t *entry_tree(const folder_entry *e) {
    static const char *const kinds[] = {[ENTRY_VOLUME] = "volume",
                                        [ENTRY_RECIPE] = "recipe",
                                        [ENTRY_FAULT] = "fault"};
    json_t *tree = json_pack(
        "{s:s, s:o, s:o, s:s, s:I, s:I}", "kind", kinds[e->kind], "name",
        list_text(e->name), "series", list_text(e->series), "day", e->day,
        "bytes", (json_int_t)e->bytes, "changed", (json_int_t)e->changed);
    if (e->info)
        set_info(tree, e->info);
    if (e->text)
        json_object_set_new(tree, "text", list_text(e->text));
    return tree;
}

static void answer_entries(folder *f, uint64_t client, const json_t *from) {
    json_t *list = json_array();
    const json_int_t first = json_integer_value(from);
    pthread_mutex_lock(&f->lock);
    for (json_int_t n = first < 0 ? (json_int_t)f->count : first;
         n < (json_int_t)f->count && n < first + PIECE; n++)
        json_array_append_new(list, entry_tree(&f->entries[n]));
    pthread_mutex_unlock(&f->lock);
    answer_put(f->box, client, MESSAGE_PLAIN,
               json_pack("{s:s, s:I, s:o}", "t", "entries", "from", first,
                         "entries", list));
}

bool folder_hear(void *user, uint64_t client, const json_t *question) {
    folder *f = user;
    const char *what = json_string_value(json_object_get(question, "what"));
    const json_t *entry = json_object_get(question, "entry"),
                 *from = json_object_get(question, "from");
    const bool list = what && strcmp(what, "folder") == 0,
               cover = what && strcmp(what, "cover") == 0;
    pthread_mutex_lock(&f->lock);
    const json_int_t count = (json_int_t)f->count;
    pthread_mutex_unlock(&f->lock);
    if (list && json_is_integer(from))
        answer_entries(f, client, from);
    else if (cover && json_is_integer(entry) &&
             json_integer_value(entry) >= 0 &&
             json_integer_value(entry) < count)
        cover_ask(f, client, (size_t)json_integer_value(entry));
    else if (list || cover)
        answer_said(f->box, client,
                    "ask: the list has no such entry; load the page again");
    return list || cover;
}

/* --- the thread ----------------------------------------------------------- */

static bool stops(void *user, snow_stage stage, double fraction) {
    const folder *f = user;
    (void)stage;
    (void)fraction;
    return f->ended || (f->until > 0 && seconds_now() > f->until);
}

/* The picture goes before it: on Linux this is of the calling thread. */
static void *look(void *user) {
    folder *f = user;
    setpriority(PRIO_PROCESS, 0, 10);
    walk_all(f);
    pthread_mutex_lock(&f->lock);
    f->done = true;
    pthread_mutex_unlock(&f->lock);
    list_tell(f, true);
    while (cover_serve(f)) {
        pthread_mutex_lock(&f->lock);
        while (!f->ended && !f->waiting)
            pthread_cond_wait(&f->changed, &f->lock);
        pthread_mutex_unlock(&f->lock);
    }
    return NULL;
}

folder *folder_new(const options *opts, outbox *box) {
    folder *f = calloc(1, sizeof *f);
    if (!f)
        return NULL;
    pthread_mutex_init(&f->lock, NULL);
    pthread_cond_init(&f->changed, NULL);
    f->base = opts;
    f->box = box;
    f->open = -1;
    f->path = strdup(opts->operands[0]);
    for (size_t n = f->path ? strlen(f->path) : 0;
         n > 1 && f->path[n - 1] == '/'; n--)
        f->path[n - 1] = 0;
    if (!f->path || !realpath(f->path, f->real) ||
        snow_context_new(NULL, &f->context) != SNOW_STATUS_OK) {
        folder_free(f);
        return NULL;
    }
    snow_context_set_progress(f->context, stops, f);
    return f;
}

bool folder_start(folder *f) {
    list_tell(f, true);
    f->runs = pthread_create(&f->thread, NULL, look, f) == 0;
    return f->runs;
}
