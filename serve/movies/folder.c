/* folder.c - implements folder.h.  A folder is locked while its program lives:
 * one that is not, and is no longer new, is what a killed program has left. */
#define _GNU_SOURCE
#include "movies/folder.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define NAME "snowglass-movie-"
#define NEW_SECONDS 60
#define OPEN_MOST 8

const char *folder_parent(void) {
    const char *given = getenv("TMPDIR");
    return given && *given ? given : "/tmp";
}

static int remove_one(const char *path, const struct stat *what, int kind,
                      struct FTW *where) {
    (void)what;
    (void)kind;
    (void)where;
    remove(path);
    return 0;
}

static void remove_all(const char *path) {
    nftw(path, remove_one, OPEN_MOST, FTW_DEPTH | FTW_PHYS);
}

static int lock_folder(const char *path) {
    const int lock =
        open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock >= 0 && flock(lock, LOCK_EX | LOCK_NB) == 0)
        return lock;
    if (lock >= 0)
        close(lock);
    return -1;
}

/* In a folder of its own no other user can have put anything. */
static void sweep(const char *path) {
    struct stat what;
    if (lstat(path, &what) != 0 || !S_ISDIR(what.st_mode) ||
        what.st_uid != geteuid() || (what.st_mode & 0777) != 0700 ||
        what.st_mtime + NEW_SECONDS > time(NULL))
        return;
    const int lock = lock_folder(path);
    if (lock < 0)
        return;
    remove_all(path);
    close(lock);
}

static void sweep_all(void) {
    const struct dirent *entry;
    DIR *parent = opendir(folder_parent());
    while (parent && (entry = readdir(parent))) {
        char path[PATH_MAX];
        const int length = snprintf(path, sizeof path, "%s/%s", folder_parent(),
                                    entry->d_name);
        if (strncmp(entry->d_name, NAME, strlen(NAME)) == 0 &&
            (size_t)length < sizeof path)
            sweep(path);
    }
    if (parent)
        closedir(parent);
}

int folder_make(private_folder *out) {
    sweep_all();
    const int length = snprintf(out->path, sizeof out->path,
                                "%s/" NAME "XXXXXX", folder_parent());
    if (length < 0 || (size_t)length >= sizeof out->path)
        errno = ENAMETOOLONG;
    else if (mkdtemp(out->path)) { /* of mode 0700 */
        out->lock = lock_folder(out->path);
        return 0;
    }
    out->path[0] = 0;
    return errno;
}

/* What a program that has just been ended still wrote may come in between. */
void folder_remove(private_folder *f) {
    struct stat what;
    for (int i = 0; *f->path && i < 10 && lstat(f->path, &what) == 0; i++) {
        if (i)
            usleep(20000);
        remove_all(f->path);
    }
    if (*f->path && f->lock >= 0)
        close(f->lock);
    f->path[0] = 0;
}
