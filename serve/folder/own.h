/* own.h - the list as the files of this folder have it. */
#ifndef FOLDER_OWN_H
#define FOLDER_OWN_H

#include "folder/folder.h"

#include <limits.h>
#include <pthread.h>
#include <stdatomic.h>

typedef enum entry_kind {
    ENTRY_VOLUME,
    ENTRY_RECIPE,
    ENTRY_FAULT /* it cannot be opened, and `text` says why */
} entry_kind;

typedef struct folder_entry {
    entry_kind kind;
    char *name;      /* below the folder; of a recipe its file's */
    char *text;      /* of a recipe the volume's name; or NULL */
    char series[65]; /* DICOM, one of several: a UID or a number; or "" */
    char day[11];    /* of a DICOM study, "2026-11-30"; or "" */
    snow_volume_info *info; /* of a volume */
    uint64_t bytes;
    int64_t changed; /* seconds since 1970 */
    char *cover;     /* a data URL, "" where there is none; NULL: not made */
} folder_entry;

/* More than anybody looks through; those beyond are counted. */
#define ENTRIES_MOST 20000

/* Covers that wait, of all pages; and that are kept. */
#define COVERS_ASKED 128
#define COVERS_KEPT 1024

typedef struct cover_question {
    uint64_t client;
    size_t entry;
} cover_question;

/* A volume that is open, or about to be. */
typedef struct opened {
    folder_entry of; /* whose texts the options have */
    options opts;
    char path[PATH_MAX];
    char *operands[2];
    bool owns_look; /* the file of --tf that the options hold */
    json_t *recipe;
    size_t entry;
} opened;

struct folder {
    const options *base;
    outbox *box;
    char *path; /* as it was given, without a slash at its end */
    char real[PATH_MAX];
    snow_context *context; /* of the thread */
    pthread_t thread;
    bool runs;
    atomic_bool ended;
    double until; /* a cover is given up then; 0: no limit */

    pthread_mutex_t lock; /* of what follows */
    pthread_cond_t changed;
    folder_entry *entries;
    size_t count, capacity;
    size_t left_out, faults,
        beyond; /* no volumes; not to be opened; too many */
    bool done;
    double told;                        /* when pages last heard of it */
    cover_question asked[COVERS_ASKED]; /* a ring */
    int first, waiting;
    size_t kept[COVERS_KEPT]; /* entries that have covers: a ring */
    size_t covers;

    opened *now, *next; /* of the thread that draws */
    int64_t open;       /* the entry; -1: none */
};

/* --- list.c ---
 *
 * Adds an entry, whose texts are taken over; a fault with why. */
void list_add(folder *f, const folder_entry *entry);
void list_add_fault(folder *f, const char *name, const char *why);
void list_count_out(folder *f);

/* Tells pages how far the list is; not always, unless `now`. */
void list_tell(folder *f, bool now);

void list_forget(folder *f);

/* The path of a name below the folder; false where it is too long. */
bool list_path(const folder *f, const char *name, char out[PATH_MAX]);

/* A text of a file or of its name, as JSON has them. */
json_t *list_text(const char *text);

/* --- walk.c --- */
void walk_all(folder *f);

/* --- describe.c ---
 *
 * By the header.  Errors as snow_volume_inspect; the message is the context's.
 */
snow_status describe(folder *f, const char *path, const char *series,
                     snow_volume_info *info);

/* How many series of slices a DICOM folder has; 0: it is none, or cannot be
 * read, and *status says which.  With `info` of the largest. */
int64_t describe_count(snow_context *context, const char *path,
                       const snow_volume_options *data, snow_volume_info *info,
                       snow_status *status);

/* Adds a file, a DICOM folder's series, or a recipe.  True of a file that is
 * DICOM without saying so: its folder is to be added in its place. */
bool describe_file(folder *f, const char *name);
void describe_series(folder *f, const char *name);
void describe_recipe(folder *f, const char *name);

/* A volume that was described; `info` is copied.  `series` and `day`: or "". */
void describe_add(folder *f, const char *name, const char *series,
                  const char *day, const snow_volume_info *info);

/* The tree of a recipe in a file, with paths of the working folder, or NULL. */
json_t *describe_recipe_tree(const char *path);

/* --- days.c --- */
typedef struct day_of_series {
    int64_t number;
    char uid[65], day[11];
} day_of_series;

typedef struct days_of_folder {
    day_of_series *series; /* in the order of the reader */
    size_t count;
} days_of_folder;

void days_read(folder *f, const char *name, days_of_folder *out);
void days_free(days_of_folder *all);

/* Those of one of `count` series; NULL: they are not known. */
const day_of_series *days_find(const days_of_folder *all, size_t which,
                               size_t count);

/* --- cover.c ---
 *
 * Makes what pages ask for.  False at the end. */
bool cover_serve(folder *f);

/* Of a page; too many are forgotten. */
void cover_ask(folder *f, uint64_t client, size_t entry);

#endif
