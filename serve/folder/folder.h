/* folder.h - the volumes of a folder, of which pages choose one.
 *
 *   walk.c     goes through the folder and those below it
 *   describe.c says of a file or a series what it is, by its header
 *   list.c     what was found; pages fetch it in pieces
 *   cover.c    small pictures, when pages ask for them
 *   choose.c   from an entry of the list to what is opened
 *   inside.c   whether that stays in the folder
 *
 * A thread of its own finds and draws, so that the picture never waits for it.
 * Pages say the number or the name of an entry, and no path. */
#ifndef FOLDER_H
#define FOLDER_H

#include "net/outbox.h"
#include "options/options.h"

#include <jansson.h>

typedef struct folder folder;

/* Whether the input is a folder of which one volume has to be chosen: none by
 * itself, or a DICOM folder of several series. */
bool folder_is_meant(const options *opts);

/* Refuses options that mean one volume.  Returns CONTINUE or an exit code. */
int folder_check(const options *opts);

/* The list of a folder, empty at first.  `opts` stay the caller's, and are
 * those of each volume.  NULL: no memory. */
folder *folder_new(const options *opts, outbox *box);
void folder_free(folder *f);

/* Begins to look.  False, with errno, where there is no thread. */
bool folder_start(folder *f);

/* A question of a page; whether it is about the list.  Any thread calls it. */
bool folder_hear(void *f, uint64_t client, const json_t *question);

/* --- by the thread that draws (opener in render.h) ---
 *
 * The entry that {"what": "open", "entry": 3} or {..., "name": "a/head.nii"}
 * means, as options and the recipe to begin with, which are the list's until
 * another one is opened.  Returns CONTINUE, or an exit code after it was said
 * what is wrong. */
int folder_choose(void *f, const json_t *question, const options **first,
                  const json_t **recipe);

/* Whether that could be opened. */
void folder_opened(void *f, bool good);

#endif
