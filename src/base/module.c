/* base/module.c - finds and loads modules.
 *
 * libhdf5, libtiff and GDCM bring fifty other libraries: most of what a small
 * picture took, before a byte was read.  So their readers lie in modules.
 * A module is linked with a copy of all that its reader calls (memory,
 * messages, sources): the library keeps no state, so that two copies of it are
 * as good as one, and whatever a reader needs is found when the module is made.
 * The other way, to load libhdf5 itself and look its functions up, takes a
 * table of some fifty functions and of types that its macros hide, tells of a
 * missing one when it is run, and is of no use for the C++ of GDCM.
 *
 * Modules are looked for beside the object that this code is part of, program
 * or shared library, wherever that was moved to; nowhere else, and never by a
 * path that depends on the current folder:
 *
 *   FOLDER/libsnowglass.so    FOLDER/snowglass-0.1/libsnowglass-NAME.so
 *   PREFIX/bin/snowglass      PREFIX/lib/snowglass-0.1/libsnowglass-NAME.so
 *
 * The system's loader counts who has what, so that there is no state here
 * either: who asks twice gets the same. */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700 /* realpath */
#endif
#include "base/module.h"

#if SNOW_LOADS

#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#ifdef __linux__
#include <fcntl.h>
#include <link.h>
#endif

#define TEXT_OF(name) #name
#define NAME_OF(name) TEXT_OF(name)

/* A module and what it is looked for beside. */
typedef struct module_file {
    char self[PATH_MAX]; /* the program or library, without symbolic links */
    char name[64];       /* "libsnowglass-hdf5.so" */
    char folder[PATH_MAX];
    char path[PATH_MAX + 80];
    struct stat found;
} module_file;

/* In the order of looking: of a library or a build folder, and of a program. */
static const char *const folders[] = {SNOW_MODULE_FOLDER, SNOW_MODULE_WAY};
#define FOLDER_COUNT (sizeof folders / sizeof *folders)

/* The file that this constant was mapped from.  The loader knows it too, but by
 * the name that it was given: relative to where the process was then. */
static bool find_self(char out[PATH_MAX]) {
    static const char here = 0;
#ifdef __linux__
    char line[PATH_MAX + 128];
    bool found = false;
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps && !found && fgets(line, sizeof line, maps)) {
        unsigned long long first, end, place = (uintptr_t)&here;
        int path = 0;
        sscanf(line, "%llx-%llx %*s %*s %*s %*s %n", &first, &end, &path);
        line[strcspn(line, "\n")] = '\0';
        found = path && first <= place && place < end && line[path] == '/' &&
                realpath(line + path, out);
    }
    if (maps)
        fclose(maps);
    return found;
#else
    Dl_info info;
    return dladdr(&here, &info) && *info.dli_fname == '/' &&
           realpath(info.dli_fname, out);
#endif
}

/* One folder to look in; without symbolic links, where it is there. */
static void name_folder(module_file *file, size_t index) {
    char folder[PATH_MAX], real[PATH_MAX];
    int length = (int)(strrchr(file->self, '/') - file->self);
    int size = snprintf(folder, sizeof folder, "%.*s/%s", length, file->self,
                        folders[index]);
    bool fits = size > 0 && (size_t)size < sizeof folder;
    const char *name = fits ? folder : folders[index];
    strcpy(file->folder, fits && realpath(folder, real) ? real : name);
    snprintf(file->path, sizeof file->path, "%s/%s", file->folder, file->name);
}

/* Else *file names the folder where it should be, of a program or library. */
static bool find_in_folders(module_file *file) {
    for (size_t i = 0; i < FOLDER_COUNT; i++) {
        name_folder(file, i);
        if (*file->folder == '/' && stat(file->path, &file->found) == 0)
            return true;
    }
    name_folder(file, strstr(strrchr(file->self, '/'), ".so") ? 0 : 1);
    return false;
}

static void name_module(const char *name, module_file *file) {
    memset(file, 0, sizeof *file);
    snprintf(file->name, sizeof file->name, "libsnowglass-%s.so", name);
}

static snow_status find_module(snow_context *context, const char *name,
                               module_file *file) {
    name_module(name, file);
    if (!find_self(file->self))
        return snow_fail(context, SNOW_BAD_INPUT,
                         "needs %s, which lies beside Snowglass, but where "
                         "that is cannot be told; mount /proc",
                         file->name);
    if (!find_in_folders(file))
        return snow_fail(context, SNOW_BAD_INPUT,
                         "needs %s, which is not in %s; install Snowglass "
                         "again, with all its files",
                         file->name, file->folder);
    return SNOW_OK;
}

/* Whether only those may change it who may change the program as well: what is
 * run must not be what anyone put there.  A group may write that is root's, or
 * the program's that may write there too: so it is in the folders of who works
 * with a group of his own (umask 002). */
static bool is_ours(const struct stat *file, const struct stat *self) {
    bool owned = file->st_uid == 0 || file->st_uid == geteuid() ||
                 file->st_uid == self->st_uid;
    bool shared = file->st_gid == 0 ||
                  (file->st_gid == self->st_gid && (self->st_mode & S_IWGRP));
    bool group = !(file->st_mode & S_IWGRP) || shared;
    bool others = !(file->st_mode & S_IWOTH) || (self->st_mode & S_IWOTH);
    return owned && group && others;
}

static snow_status check_owner(snow_context *context, const module_file *file) {
    struct stat self, folder;
    if (stat(file->self, &self) == 0 && stat(file->folder, &folder) == 0 &&
        is_ours(&folder, &self) && is_ours(&file->found, &self))
        return SNOW_OK;
    return snow_fail(context, SNOW_BAD_INPUT,
                     "needs %s, which others could change; let it and its "
                     "folder have the owner of %s, and nobody else write there "
                     "(chmod go-w)",
                     file->path, file->self);
}

/* The loader maps a cut file without a word, and the process ends where it
 * first touches what is missing.  Tables at the end of an object, which it does
 * not read, tell how long it was. */
static bool is_whole(const module_file *file) {
#ifdef __linux__
    ElfW(Ehdr) head;
    int descriptor = open(file->path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return true; /* dlopen will say why */
    bool read_all = read(descriptor, &head, sizeof head) == sizeof head;
    close(descriptor);
    return read_all && memcmp(head.e_ident, ELFMAG, SELFMAG) == 0 &&
           head.e_shoff < INT32_MAX &&
           file->found.st_size >=
               (off_t)head.e_shoff + (off_t)head.e_shnum * head.e_shentsize;
#else
    (void)file;
    return true;
#endif
}

/* The loader has a lock of its own, of which ThreadSanitizer does not know: it
 * would take what one thread writes there and another reads for a race. */
static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;

/* All symbols are looked up now: later, a missing one would end the process.
 * A module is never closed, since the libraries in it leave handlers for the
 * end of the process. */
static void *load(const char *path, const char **why) {
    pthread_mutex_lock(&loading);
    void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    void *parts = handle ? dlsym(handle, NAME_OF(SNOW_MODULE_SYMBOL)) : NULL;
    *why = parts ? NULL : dlerror(); /* of this thread, until it asks again */
    pthread_mutex_unlock(&loading);
    return parts;
}

static snow_status open_module(snow_context *context, const module_file *file,
                               const snow_module **out) {
    const char *why;
    const snow_module *module = load(file->path, &why);
    if (!module)
        return snow_fail(context, SNOW_BAD_INPUT,
                         "needs %s, which cannot be loaded (%s); install the "
                         "library that it lacks, or Snowglass again",
                         file->path, why ? why : "no reason told");
    if (strcmp(module->stamp, snow_module_stamp) != 0)
        return snow_fail(context, SNOW_BAD_INPUT,
                         "needs %s, which is of another build, %.64s where "
                         "this one is %s; install both from one, and start "
                         "the program again",
                         file->path, module->stamp, snow_module_stamp);
    *out = module;
    return SNOW_OK;
}

snow_status snow_module_load(snow_context *context, const char *name,
                             const snow_module **out) {
    module_file file;
    SNOW_TRY(find_module(context, name, &file));
    SNOW_TRY(check_owner(context, &file));
    if (!is_whole(&file))
        return snow_fail(context, SNOW_BAD_INPUT,
                         "needs %s, which is cut or damaged; install Snowglass "
                         "again",
                         file.path);
    return open_module(context, &file, out);
}

bool snow_module_is_there(const char *name) {
    module_file file;
    name_module(name, &file);
    return find_self(file.self) && find_in_folders(&file);
}

#else /* all readers are linked */

snow_status snow_module_load(snow_context *context, const char *name,
                             const snow_module **out) {
    (void)out;
    return snow_fail(context, SNOW_FAILED,
                     "asks for the module %s of a build that has none; tell "
                     "Snowglass' authors",
                     name);
}

bool snow_module_is_there(const char *name) {
    (void)name;
    return true;
}

#endif
