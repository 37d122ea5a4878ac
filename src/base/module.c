/* base/module.c - finds and loads modules.
 *
 * libhdf5, libtiff and GDCM load fifty other libraries, which took most of the
 * time of a small picture before a byte was read. So their readers are in
 * modules. A module is linked with a copy of all that its reader calls (memory,
 * messages, sources). The library has no state, so two copies are as good as
 * one, and linking checks that the module is complete. The alternative, loading
 * libhdf5 itself and looking up its functions, needs a table of some fifty
 * functions and of types that its macros hide, reports a missing one only at
 * run time, and does not work for the C++ of GDCM.
 *
 * Modules are searched beside the object that contains this code, program or
 * shared library, wherever that was moved to. No other folder is searched, and
 * no path depends on the current folder:
 *
 *   FOLDER/libsnowglass.so    FOLDER/snowglass-0.1/libsnowglass-NAME.so
 *   PREFIX/bin/snowglass      PREFIX/lib/snowglass-0.1/libsnowglass-NAME.so
 *
 * The system's loader counts references, so there is no state here either: a
 * second request returns the same module. */
#ifndef _XOPEN_SOURCE
#define _XOPEN_SOURCE 700 /* realpath */
#endif
#include "base/module.h"

#if SNOW_LOADS

#include <dlfcn.h>
#include <errno.h>
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

/* A module, and the object beside which it is searched. */
typedef struct module_file {
    char self[PATH_MAX]; /* the program or library, without symbolic links */
    char name[64];       /* "libsnowglass-hdf5.so" */
    char folder[PATH_MAX];
    char path[PATH_MAX + 80];
    struct stat found;
} module_file;

/* In search order: beside a library or in a build folder, and for a program. */
static const char *const folders[] = {SNOW_MODULE_FOLDER, SNOW_MODULE_WAY};
#define FOLDER_COUNT (sizeof folders / sizeof *folders)

/* The file that this constant was mapped from. The loader knows it too, but by
 * the name it was given, relative to the working directory at that time. */
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

/* The name of one folder to search, without symbolic links, if it exists. */
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

/* On failure *file names the folder where the module should be, for a program
 * or library. */
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
    errno = 0;
    if (!find_self(file->self))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "needs %s, which is installed beside Snowglass, but "
                         "that folder cannot be determined; %s",
                         file->name,
                         errno == EMFILE || errno == ENFILE
                             ? "close other files, or allow more of them "
                               "(ulimit -n)"
                             : "mount /proc");
    if (!find_in_folders(file))
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "needs %s, which is not in %s; reinstall Snowglass "
                         "with all its files",
                         file->name, file->folder);
    return SNOW_STATUS_OK;
}

/* Returns whether only those who may change the program may change the file:
 * others must not be able to inject code. A group may have write access if it
 * is root's, or one that may write to the program too: that is usual in
 * folders of users with their own group (umask 002). */
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
        return SNOW_STATUS_OK;
    return snow_fail(
        context, SNOW_STATUS_BAD_INPUT,
        "needs %s, which other users could change: it and its folder must "
        "belong to the owner of %s and be writable by nobody else (chmod go-w)",
        file->path, file->self);
}

/* The loader maps a truncated file without an error, and the process crashes
 * when it touches the missing part. Tables at the end of an object, which the
 * loader does not read, give its original length. */
static bool is_whole(const module_file *file) {
#ifdef __linux__
    ElfW(Ehdr) head;
    int descriptor = open(file->path, O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        return true; /* dlopen reports the reason */
    ssize_t got = -1;
    do
        got = read(descriptor, &head, sizeof head);
    while (got < 0 && errno == EINTR);
    bool read_all = got == sizeof head;
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

/* The loader has its own lock, which ThreadSanitizer does not know: it would
 * report a race between one thread's writes there and another's reads. */
static pthread_mutex_t loading = PTHREAD_MUTEX_INITIALIZER;

/* All symbols are resolved now: later, a missing one would end the process. A
 * module is never closed, since its libraries register handlers for the end of
 * the process. */
static void *load(const char *path, const char **why) {
    pthread_mutex_lock(&loading);
    void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    void *parts = handle ? dlsym(handle, NAME_OF(SNOW_MODULE_SYMBOL)) : NULL;
    *why = parts ? NULL : dlerror(); /* of this thread, until its next call */
    pthread_mutex_unlock(&loading);
    return parts;
}

static snow_status open_module(snow_context *context, const module_file *file,
                               const snow_module **out) {
    const char *why;
    const snow_module *module = load(file->path, &why);
    if (!module)
        return snow_fail(context, SNOW_STATUS_BAD_INPUT,
                         "needs %s, which cannot be loaded (%s); install the "
                         "missing library, or reinstall Snowglass",
                         file->path, why ? why : "no reason given");
    if (strcmp(module->stamp, snow_module_stamp) != 0)
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "needs %s, which is of another build, %.64s instead of %s; install "
            "both from one build, and restart the program",
            file->path, module->stamp, snow_module_stamp);
    *out = module;
    return SNOW_STATUS_OK;
}

snow_status snow_module_load(snow_context *context, const char *name,
                             const snow_module **out) {
    module_file file;
    SNOW_TRY(find_module(context, name, &file));
    SNOW_TRY(check_owner(context, &file));
    if (!is_whole(&file))
        return snow_fail(
            context, SNOW_STATUS_BAD_INPUT,
            "needs %s, which is truncated or damaged; reinstall Snowglass",
            file.path);
    return open_module(context, &file, out);
}

bool snow_module_is_there(const char *name) {
    module_file file;
    name_module(name, &file);
    return find_self(file.self) && find_in_folders(&file);
}

#else /* all readers are linked in */

snow_status snow_module_load(snow_context *context, const char *name,
                             const snow_module **out) {
    (void)out;
    return snow_fail(context, SNOW_STATUS_FAILED,
                     "requires the module %s, but this build has no modules; "
                     "report this to Snowglass' authors",
                     name);
}

bool snow_module_is_there(const char *name) {
    (void)name;
    return true;
}

#endif
