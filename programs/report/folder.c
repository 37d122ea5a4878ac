/* folder.c - the structure of a folder: the metadata of Zarr's arrays and
 * groups, or one file of each format that is in it.  Names are not written. */
#define _XOPEN_SOURCE 700
#include "report/report.h"

#include <dirent.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define DEPTH 6
#define NODES 100 /* files of metadata that are written */

typedef struct count_of {
    FILE *out;
    size_t files, folders, nodes;
    unsigned long long bytes;
    bool zarr, dicom, tiff;
} count_of;

static const char *const metadata[] = {"zarr.json", ".zarray", ".zattrs",
                                       ".zgroup", ".zmetadata"};

static bool is_metadata(const char *name) {
    for (size_t i = 0; i < sizeof metadata / sizeof *metadata; i++)
        if (strcmp(name, metadata[i]) == 0)
            return true;
    return false;
}

static void put_metadata(count_of *t, const char *path, const char *name,
                         int depth) {
    json_error_t fault;
    json_t *json = json_load_file(path, JSON_ALLOW_NUL, &fault);
    json_t *shown = json ? technical_json(json) : NULL;
    char *text = shown ? json_dumps(shown, JSON_REAL_PRECISION(9)) : NULL;
    t->zarr = true;
    if (t->nodes++ < NODES && strcmp(name, ".zmetadata") != 0)
        fprintf(t->out, "%*s%s %s\n", 2 * depth, "", name,
                text ? text : "is no JSON");
    free(text);
    json_decref(shown);
    json_decref(json);
}

/* Chunks of Zarr are only counted; of other files the first of each format is
 * written. */
static void put_file(count_of *t, const char *path) {
    source from;
    if (t->zarr || (t->dicom && t->tiff) || !source_open(path, &from))
        return;
    if (!t->dicom)
        t->dicom = report_dicom(t->out, &from);
    else if (!t->tiff)
        t->tiff = report_tiff(t->out, &from);
    source_close(&from);
}

static void walk_folder(count_of *t, const char *path, int depth) {
    struct dirent **entries = NULL;
    int count = depth < DEPTH ? scandir(path, &entries, NULL, alphasort) : -1;
    for (int i = 0; i < count; i++) {
        const char *name = entries[i]->d_name;
        char inner[PATH_MAX];
        struct stat facts;
        if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0 &&
            snprintf(inner, sizeof inner, "%s/%s", path, name) < PATH_MAX &&
            lstat(inner, &facts) == 0) {
            if (S_ISDIR(facts.st_mode)) {
                t->folders++;
                walk_folder(t, inner, depth + 1);
            } else if (S_ISREG(facts.st_mode)) {
                t->files++;
                t->bytes += (unsigned long long)facts.st_size;
                if (is_metadata(name))
                    put_metadata(t, inner, name, depth);
                else
                    put_file(t, inner);
            }
        }
        free(entries[i]);
    }
    free(entries);
}

void report_folder(FILE *out, const char *path) {
    count_of t = {.out = out};
    walk_folder(&t, path, 0);
    fprintf(out, "folder of %zu files and %zu folders, %llu bytes\n", t.files,
            t.folders, t.bytes);
}
