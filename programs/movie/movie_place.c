/* movie_place.c - names of frames, of unfinished frames, and of the folder that
 * holds the frames of a movie:
 *
 *   f_%04d.png                      spin.mp4
 *     f_0007.png                      spin.mp4.frames/000007.png
 *     .unfinished-f_0007.png          spin.mp4.frames/.unfinished-000007.png
 *     .f_%04d.png.frames              spin.mp4.frames/record
 *                                     spin.mp4.frames/movie.mp4, ffmpeg.log */
#include "movie/movie_place.h"
#include "commands/commands.h"
#include "picture/outputs.h"
#include "run/log.h"
#include "run/paths.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define ASIDE ".unfinished-"

/* The suffix of a movie's frames: what the encoder reads, or what an animated
 * WebP is made from. */
static const char *frames_suffix(const movie_place *place) {
    return place->format->arguments ? ".png" : ".webp";
}

/* The library marks unfinished files with this and six letters. */
#define LIBRARY_MARK ".snow-"
#define LIBRARY_LETTERS 6

/* Returns false if `size` bytes do not hold both parts. */
static bool join(char *out, size_t size, const char *a, const char *b) {
    int length = snprintf(out, size, "%s%s", a, b);
    return length >= 0 && (size_t)length < size;
}

static int fail_length(const char *output) {
    return fail_usage("%s: the name is too long; use a shorter one", output);
}

/* All files of a movie are in one folder beside it. */
static int read_movie(movie_place *out) {
    char frames[PATH_MAX], name[32], numbers[32];
    if (names_are_meant(out->output))
        return fail_usage("%s: a movie is one file; remove the %%",
                          out->output);
    snprintf(name, sizeof name, "movie%s", out->format->suffix);
    snprintf(numbers, sizeof numbers, "%%06d%s", frames_suffix(out));
    if (!join(out->folder, sizeof out->folder, out->output, ".frames/") ||
        !join(frames, sizeof frames, out->folder, numbers) ||
        !join(out->movie, sizeof out->movie, out->folder, name) ||
        !join(out->log, sizeof out->log, out->folder, "ffmpeg.log") ||
        !join(out->record, sizeof out->record, out->folder, "record"))
        return fail_length(out->output);
    const char *fault = names_read(frames, &out->names);
    return fault ? fail_usage("%s: %s", out->output, fault) : CONTINUE;
}

static int read_pattern(movie_place *out) {
    if (!names_are_meant(out->output))
        return fail_usage(
            "%s: cannot hold many frames; use a name that ends in .mp4, .webm, "
            ".gif or .webp, or number them, as in f_%%04d.png",
            out->output);
    const char *fault = names_read(out->output, &out->names);
    if (fault)
        return fail_usage("%s: %s", out->output, fault);
    const char *name = out->output + folder_length(out->output);
    int length = snprintf(out->record, sizeof out->record, "%s.%s.frames",
                          out->names.folder, name);
    return length > 0 && (size_t)length < sizeof out->record
               ? CONTINUE
               : fail_length(out->output);
}

int place_read(const char *output, movie_place *out) {
    int done = check_no_folder(output);
    if (done != CONTINUE)
        return done;
    *out = (movie_place){.output = output,
                         .format = movie_format_of(output),
                         .streams = strcmp(output, "-") == 0};
    if (out->streams)
        return CONTINUE;
    return out->format ? read_movie(out) : read_pattern(out);
}

bool place_frame(const movie_place *place, int64_t index, char *out,
                 size_t size) {
    return names_path(&place->names, index, out, size);
}

bool place_aside(const movie_place *place, int64_t index, char *out,
                 size_t size) {
    char frame[PATH_MAX];
    if (!place_frame(place, index, frame, sizeof frame))
        return false;
    int length = snprintf(out, size, "%s" ASIDE "%s", place->names.folder,
                          frame + strlen(place->names.folder));
    return length >= 0 && (size_t)length < size;
}

static int check_frame(snow_context *context, const char *path,
                       const options *opts) {
    snow_image_options form = picture_form(opts, NULL);
    form.overwrite = true;
    return check_status(context,
                        snow_image_check(context, path, (int)opts->size[0],
                                         (int)opts->size[1], &form));
}

/* The library knows which names it can write, and where.  A later check looks
 * for frames that exist already. */
static int check_pattern(snow_context *context, const movie_place *place,
                         const options *opts) {
    char aside[PATH_MAX];
    char frame[PATH_MAX];
    if (!place_aside(place, INT64_C(1000000000), aside, sizeof aside) ||
        !place_frame(place, 0, frame, sizeof frame))
        return fail_length(place->output);
    return check_frame(context, frame, opts);
}

/* A folder can be made where a file of the same name could be made, and the
 * check for a picture finds that out without leaving a file. */
static int check_movie(snow_context *context, const movie_place *place,
                       const options *opts) {
    struct stat what;
    char probe[PATH_MAX], name[32];
    if (lstat(place->output, &what) == 0) {
        if (!S_ISREG(what.st_mode) && !S_ISLNK(what.st_mode))
            return fail_output("%s: is not a regular file; name one",
                               place->output);
        if (!opts->overwrite)
            return fail_output("%s: exists; use --overwrite or another name",
                               place->output);
    }
    if (stat(place->folder, &what) == 0)
        return CONTINUE;
    snprintf(name, sizeof name, ".frames%s", frames_suffix(place));
    if (!join(probe, sizeof probe, place->output, name))
        return fail_length(place->output);
    return check_frame(context, probe, opts);
}

int place_check(snow_context *context, const movie_place *place,
                const options *opts) {
    if (place->streams)
        return CONTINUE;
    return place->format ? check_movie(context, place, opts)
                         : check_pattern(context, place, opts);
}

int64_t place_first(const movie_place *place, int64_t from) {
    int64_t first = -1;
    const struct dirent *entry;
    DIR *folder = opendir(names_folder(&place->names));
    if (!folder)
        return errno == ENOENT || errno == ENOTDIR ? -1 : from;
    while ((errno = 0, entry = readdir(folder))) {
        int64_t index = names_index(&place->names, entry->d_name);
        if (index >= from && (first < 0 || index < first))
            first = index;
    }
    if (errno)
        first = from;
    closedir(folder);
    return first;
}

/* Whether a name is ".unfinished-NAME", or "..unfinished-NAME.snow-abcdef"
 * while the library writes, with the NAME of a frame. */
static bool is_unfinished(const movie_place *place, const char *file) {
    char name[NAME_MAX + 1];
    size_t length = strlen(file), mark = strlen(ASIDE);
    size_t tail = strlen(LIBRARY_MARK) + LIBRARY_LETTERS;
    if (file[0] == '.' && file[1] == '.' && length > tail &&
        strncmp(file + length - tail, LIBRARY_MARK, strlen(LIBRARY_MARK)) ==
            0) {
        file++;
        length -= tail + 1;
    }
    if (length <= mark || length > NAME_MAX || strncmp(file, ASIDE, mark) != 0)
        return false;
    snprintf(name, sizeof name, "%.*s", (int)(length - mark), file + mark);
    return names_index(&place->names, name) >= 0;
}

/* Removes unfinished files of the folder, or the frames below a number. */
static void remove_those(const movie_place *place, bool unfinished,
                         int64_t below) {
    char path[PATH_MAX];
    const struct dirent *entry;
    DIR *folder = opendir(names_folder(&place->names));
    while (folder && (entry = readdir(folder))) {
        const int64_t index = names_index(&place->names, entry->d_name);
        if ((unfinished ? is_unfinished(place, entry->d_name)
                        : index >= 0 && index < below) &&
            join(path, sizeof path, place->names.folder, entry->d_name))
            unlink(path);
    }
    if (folder)
        closedir(folder);
}

void place_remove_frames(const movie_place *place, int64_t count) {
    remove_those(place, false, count);
}

void place_sweep(const movie_place *place) {
    remove_those(place, true, 0);
    if (place->format)
        unlink(place->movie);
}

int place_make_folder(const movie_place *place) {
    if (!place->format || mkdir(place->folder, 0777) == 0 || errno == EEXIST)
        return CONTINUE;
    return fail_output("%s: %s; %s", place->folder, strerror(errno),
                       place_remedy(errno));
}

/* Files of others stay, and then the folder stays too. */
void place_remove_folder(const movie_place *place) {
    if (!place->format)
        return;
    place_remove_frames(place, INT64_MAX);
    place_sweep(place);
    unlink(place->log);
    unlink(place->record);
    rmdir(place->folder);
}
