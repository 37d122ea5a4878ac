/* walk.c - goes through a folder and those below it; see folder.h.
 *
 * Each folder is looked at as `snowglass info FOLDER` does: its DICOM files are
 * series, its pictures with numbers a volume, and others volumes of their
 * own. */
#define _XOPEN_SOURCE 700
#include "folder/inside.h"
#include "folder/own.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* PATIENT/STUDY/SERIES/..., and no more. */
#define LEVELS_MOST 8

typedef enum found {
    FOUND_NOTHING, /* hidden, or no file */
    FOUND_FOLDER,
    FOUND_PLAIN,
    FOUND_DICOM,
    FOUND_PICTURE, /* which may be a slice */
    FOUND_RECIPE
} found;

/* What a folder has of each. */
typedef struct contents {
    struct dirent **entries;
    found *kinds;
    int count;
    bool dicom, pictures, array; /* of Zarr, or a plotfile */
} contents;

static bool ends_as(const char *name, const char *const *ends) {
    const char *dot = strrchr(name, '.');
    for (; dot && *ends; ends++)
        if (strcasecmp(dot, *ends) == 0)
            return true;
    return false;
}

/* The mark of DICOM (PS3.10, 7.1). */
static bool has_mark(const char *path) {
    char head[132];
    FILE *file = fopen(path, "rb");
    const bool has = file && fread(head, 1, sizeof head, file) == sizeof head &&
                     memcmp(head + 128, "DICM", 4) == 0;
    if (file)
        fclose(file);
    return has;
}

static found kind_of_file(const char *path, const char *name) {
    static const char *const dicom[] = {".dcm", ".dicom", ".ima", NULL};
    static const char *const pictures[] = {".png", ".jpg",  ".jpeg",
                                           ".tif", ".tiff", NULL};
    static const char *const recipes[] = {".json", NULL};
    if (strcasecmp(name, "DICOMDIR") == 0)
        return FOUND_NOTHING; /* an index of others */
    return ends_as(name, recipes)                   ? FOUND_RECIPE
           : ends_as(name, pictures)                ? FOUND_PICTURE
           : ends_as(name, dicom) || has_mark(path) ? FOUND_DICOM
                                                    : FOUND_PLAIN;
}

/* Links to folders are not followed, as what is in the folder is found where it
 * lies; a file that a link leads out to stays closed. */
static found kind_of(folder *f, const char *name, const char *path) {
    char where[NAME_MAX + 1];
    struct stat itself, what;
    if (lstat(path, &itself) != 0)
        return FOUND_NOTHING;
    const bool link = S_ISLNK(itself.st_mode);
    if (S_ISDIR(itself.st_mode))
        return FOUND_FOLDER;
    if (link && stat(path, &what) == 0 && S_ISDIR(what.st_mode))
        return FOUND_NOTHING;
    if (link && !inside_root(f->real, path, where)) {
        list_add_fault(f, name,
                       "is a link that leads out of the folder that was given, "
                       "or nowhere; name its file to open it");
        return FOUND_NOTHING;
    }
    if (!S_ISREG((link ? what : itself).st_mode))
        return FOUND_NOTHING; /* a pipe keeps who opens it waiting */
    const char *slash = strrchr(name, '/');
    return kind_of_file(path, slash ? slash + 1 : name);
}

static int is_seen(const struct dirent *entry) {
    return strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
}

static bool join(const char *within, const char *name, char out[PATH_MAX]) {
    return snprintf(out, PATH_MAX, "%s%s%s", within, *within ? "/" : "", name) <
           PATH_MAX;
}

/* False where a name is too long. */
static bool look_at(folder *f, const char *within, contents *c, int n) {
    static const char *const arrays[] = {".zarray", ".zgroup", "zarr.json",
                                         "Header", NULL};
    const char *own = c->entries[n]->d_name;
    char name[PATH_MAX], path[PATH_MAX];
    for (size_t i = 0; arrays[i]; i++)
        c->array |= strcmp(own, arrays[i]) == 0;
    if (*own == '.' || !join(within, own, name) || !list_path(f, name, path))
        return *own == '.';
    c->kinds[n] = kind_of(f, name, path);
    c->dicom |= c->kinds[n] == FOUND_DICOM;
    c->pictures |= c->kinds[n] == FOUND_PICTURE;
    return true;
}

static bool read_contents(folder *f, const char *within, contents *out) {
    char path[PATH_MAX];
    contents c = {.count = -1};
    if (list_path(f, within, path))
        c.count = scandir(path, &c.entries, is_seen, alphasort);
    if (c.count < 0) {
        list_add_fault(f, *within ? within : ".", strerror(errno));
        return false;
    }
    c.kinds = calloc((size_t)c.count + 1, sizeof *c.kinds);
    for (int n = 0; n < c.count && c.kinds && !f->ended; n++)
        if (!look_at(f, within, &c, n))
            list_count_out(f);
    *out = c;
    return c.kinds != NULL;
}

static void free_contents(contents *c) {
    for (int n = 0; n < c->count; n++)
        free(c->entries[n]);
    free(c->entries);
    free(c->kinds);
}

/* Whether the folder is a volume itself, which is then added: an array, or the
 * slices in it, beside which there may be others. */
static bool add_folder(folder *f, const char *within, bool whole) {
    char path[PATH_MAX], where[NAME_MAX + 1];
    snow_volume_info info;
    if (!list_path(f, within, path) || !inside_root(f->real, path, where) ||
        describe(f, path, NULL, &info) != SNOW_STATUS_OK ||
        strcmp(info.format, "dicom") == 0)
        return false;
    const bool slices = strcmp(info.format, "png") == 0 ||
                        strcmp(info.format, "jpeg") == 0 ||
                        strcmp(info.format, "tiff") == 0;
    if (slices == whole)
        return false;
    describe_add(f, within, "", "", &info);
    return true;
}

/* "IM_0004", "1.2.840.4": a slice of an old series may be named so. */
static bool may_be_slice(const char *name) {
    const char *dot = strrchr(name, '.');
    return !dot || !dot[1 + strspn(dot + 1, "0123456789")];
}

/* Each slice of a series reads the headers of all others: once is enough. */
static void add_files(folder *f, const char *within, const contents *c,
                      bool stacked) {
    char name[PATH_MAX];
    bool dicom = false;
    for (int n = 0; n < c->count && cover_serve(f); n++) {
        const char *own = c->entries[n]->d_name;
        if (!join(within, own, name) ||
            (c->kinds[n] == FOUND_PLAIN && dicom && may_be_slice(own)))
            continue;
        if (strchr(name, '%') && c->kinds[n] == FOUND_PLAIN)
            list_add_fault(f, name,
                           "has a % in its name, which stands for numbers; "
                           "give it another");
        else if (c->kinds[n] == FOUND_RECIPE)
            describe_recipe(f, name);
        else if (c->kinds[n] == FOUND_PLAIN ||
                 (c->kinds[n] == FOUND_PICTURE && !stacked && !c->dicom)) {
            if (describe_file(f, name) && !dicom && !c->dicom) {
                describe_series(f, within);
                dicom = true;
            }
        }
    }
}

static void walk(folder *f, const char *within, int levels) {
    char name[PATH_MAX];
    contents c = {.count = 0};
    if (!read_contents(f, within, &c)) {
        free_contents(&c);
        return;
    }
    const bool array = c.array && add_folder(f, within, true);
    if (!array && c.dicom)
        describe_series(f, within);
    const bool stacked =
        !array && !c.dicom && c.pictures && add_folder(f, within, false);
    if (!array)
        add_files(f, within, &c, stacked);
    for (int n = 0; n < c.count && !array && levels < LEVELS_MOST; n++)
        if (c.kinds[n] == FOUND_FOLDER && cover_serve(f) &&
            join(within, c.entries[n]->d_name, name))
            walk(f, name, levels + 1);
    free_contents(&c);
}

void walk_all(folder *f) {
    walk(f, "", 0);
}
