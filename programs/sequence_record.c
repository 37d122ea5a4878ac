/* sequence_record.c - what frames were made with, written and compared.
 *
 * Settings are compared as text: the options as they were given, taken from the
 * one table, so that an option which is added there later is heeded here
 * without a word.  Left out are those that do not change a frame. */
#define _XOPEN_SOURCE 700
#include "sequence_record.h"
#include "launch.h"
#include "report.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FIRST_LINE "snowglass frames 1\n"
#define RECORD_MOST \
    (INT64_C(1) << 30) /* bytes; a million frames take a tenth */

static const char *const without_effect[] = {
    "output",  "overwrite", "resume",      "frames",  "fps",
    "threads", "progress",  "stats",       "verbose", "quiet",
    "memory",  "config",    "save-config", "timeout"};

static bool has_effect(const char *name) {
    for (size_t i = 0; i < sizeof without_effect / sizeof *without_effect; i++)
        if (strcmp(name, without_effect[i]) == 0)
            return false;
    return true;
}

/* Line ends in names would break lines apart, or forge them. */
static void print_clean(FILE *out, const char *text) {
    for (; *text; text++)
        fputc((unsigned char)*text < ' ' ? '?' : *text, out);
}

/* A file's bytes and the time of its last change, and where it is whatever the
 * working folder.  What is no file is named alone. */
static void print_identity(FILE *out, const char *path) {
    struct stat what;
    char real[PATH_MAX];
    if (stat(path, &what) == 0 && realpath(path, real))
        fprintf(out, "of %lld %lld.%09ld ", (long long)what.st_size,
                (long long)what.st_mtim.tv_sec, (long)what.st_mtim.tv_nsec);
    else
        snprintf(real, sizeof real, "%s", path);
    print_clean(out, real);
}

/* An option that names a file (a transfer function, a mask) counts as the file
 * that it is now. */
static void print_options(FILE *out, const options *asked) {
    for (size_t i = 0; option_table[i].name; i++) {
        const char *text = asked->told[i];
        struct stat what;
        if (!text || !has_effect(option_table[i].name))
            continue;
        fprintf(out, "--%s ", option_table[i].name);
        print_clean(out, text);
        if (stat(text, &what) == 0 && S_ISREG(what.st_mode)) {
            fprintf(out, " ");
            print_identity(out, text);
        }
        fprintf(out, "\n");
    }
}

/* AVX2 and AVX-512 give the same bits, others their own. */
static const char *kernels(const options *asked) {
    const char *isa = strcmp(asked->isa, "auto") ? asked->isa : snow_isa_used();
    if (asked->deterministic)
        return "deterministic";
    return strncmp(isa, "avx", 3) == 0 ? "vector" : isa;
}

static void print_shots(FILE *out, const shot_list *list) {
    if (list->together)
        fprintf(out, "look of %" PRId64 " steps\n", list->count);
    for (int64_t i = 0; i < list->count; i++) {
        const movie_shot *shot = &list->shots[i];
        fprintf(out, "frame %" PRId64 " azimuth %.17g time %" PRId64 " ", i,
                shot->azimuth, shot->time);
        print_identity(out, shot->path);
        fprintf(out, "\n");
    }
}

/* NULL without memory. */
static char *write_text(const options *asked, const shot_list *list) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fprintf(out, FIRST_LINE "version %s\nkernels %s\n", snow_version(),
            kernels(asked));
    if (launch_ranks() > 1 && !asked->deterministic)
        fprintf(out, "ranks %d\n", launch_ranks());
    print_options(out, asked);
    print_shots(out, list);
    bool good = !ferror(out);
    if (fclose(out) != 0 || !good) {
        free(text);
        return NULL;
    }
    return text;
}

/* All of a file, as text; NULL when it cannot be read. */
static char *read_text_of(int file) {
    struct stat what;
    if (fstat(file, &what) != 0 || what.st_size > RECORD_MOST)
        return NULL;
    size_t size = (size_t)what.st_size, got = 0;
    char *text = malloc(size + 1);
    while (text && got < size) {
        ssize_t some = pread(file, text + got, size - got, (off_t)got);
        if (some <= 0 && !(some < 0 && errno == EINTR))
            break;
        got += some > 0 ? (size_t)some : 0;
    }
    if (text)
        text[got] = '\0';
    return text;
}

/* The lock ends with the process, however that ends.  File systems that know no
 * locks are believed. */
static bool is_locked_by_others(int file) {
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    return fcntl(file, F_SETLK, &lock) != 0 &&
           (errno == EACCES || errno == EAGAIN);
}

static bool begins(const char *text, const char *word) {
    return strncmp(text, word, strlen(word)) == 0;
}

static size_t line_length(const char *text) {
    size_t length = strcspn(text, "\n");
    return length + (text[length] == '\n');
}

/* Walks along both texts, as far as the lines before the first frame agree.
 * True when all of them do. */
static bool agree_on_settings(const char **old, const char **now) {
    while (**old && **now && !begins(*now, "frame ")) {
        size_t length = line_length(*old);
        if (length != line_length(*now) || strncmp(*old, *now, length) != 0)
            return false;
        *old += length;
        *now += length;
    }
    return begins(*old, "frame ") && begins(*now, "frame ");
}

/* Goes on along the frames, which are made each by itself: one that is not kept
 * may have changed (a step that was broken is put right), and there may be more
 * than there were.  `changed` tells whether anything has. */
static bool agree_on_frames(const char **old, const char **now,
                            const bool *kept, bool *changed) {
    for (; begins(*old, "frame ") && **now; kept++) {
        size_t length = line_length(*old), other = line_length(*now);
        bool same = length == other && strncmp(*old, *now, length) == 0;
        if (!same && *kept)
            return false;
        *changed |= !same;
        *old += length;
        *now += other;
    }
    *changed |= begins(*old, "frame ") || **now;
    return true;
}

/* Marks the frames of the "done" lines that still have their bytes.  A line
 * that was cut is the last one, and does not count. */
static void mark_kept(const char *done, const sequence_place *place,
                      int64_t count, frame_record *out) {
    char path[PATH_MAX], end;
    int64_t index, bytes;
    struct stat what;
    while (sscanf(done, "done %" SCNd64 " %" SCNd64 "%c", &index, &bytes,
                  &end) == 3 &&
           end == '\n') {
        done += line_length(done);
        if (index < 0 || index == INT64_MAX)
            continue;
        if (index >= out->done)
            out->done = index + 1;
        if (index < count && !out->kept[index] &&
            place_frame(place, index, path, sizeof path) &&
            stat(path, &what) == 0 && S_ISREG(what.st_mode) &&
            what.st_size == bytes) {
            out->kept[index] = true;
            out->keeps++;
        }
    }
}

/* Both lines, cut to what a message holds. */
static int fail_other(const sequence_place *place, const char *old,
                      const char *now) {
    bool old_ended = !*old || begins(old, "done ");
    int was = (int)strcspn(old, "\n"), is = (int)strcspn(now, "\n");
    return fail_output(
        "%s: its frames were made with other settings ('%.*s' then, '%.*s' "
        "now); give the same, or --overwrite without --resume to begin anew",
        place->output,
        old_ended   ? 7
        : was > 300 ? 300
                    : was,
        old_ended ? "nothing" : old, *now ? (is > 300 ? 300 : is) : 7,
        *now ? now : "nothing");
}

/* Of frames without a record of ours, or with one that shall not be resumed. */
static int check_strangers(const options *asked, const sequence_place *place,
                           bool recorded) {
    char path[PATH_MAX];
    int64_t first = place_first(place, 0);
    if (first < 0 || asked->overwrite ||
        !place_frame(place, first, path, sizeof path))
        return GO_ON;
    if (asked->resume)
        return fail_output("%s: exists, and nothing beside it says what it was "
                           "made with; give --overwrite without --resume to "
                           "begin anew, or another name",
                           path);
    return fail_output("%s: exists; give %s--overwrite to begin anew, or "
                       "another name",
                       path, recorded ? "--resume to go on, " : "");
}

/* Whether what lies there can be gone on with; then marks the frames that are
 * kept.  Where not, `old` and `now` are left at the first lines that differ. */
static bool fits(const shot_list *list, const sequence_place *place,
                 const char **old, const char **now, const char *done,
                 frame_record *out) {
    bool changed = false;
    mark_kept(done, place, list->count, out);
    if (!agree_on_settings(old, now) ||
        !agree_on_frames(old, now, out->kept, &changed))
        return false;
    if (out->done > list->count || (changed && list->together && out->keeps))
        return false;
    out->anew = changed;
    return true;
}

/* A record without a frame that is done is as good as none. */
static int compare(const options *asked, const shot_list *list,
                   const sequence_place *place, const char *old_text,
                   frame_record *out) {
    const char *old = old_text, *now = out->text;
    const char *done = strstr(old_text, "\ndone ");
    done = done ? done + 1 : "";
    if (asked->resume && fits(list, place, &old, &now, done, out))
        return GO_ON;
    if (asked->resume && *done && !asked->overwrite)
        return fail_other(place, old, now);
    memset(out->kept, 0, (size_t)list->count * sizeof *out->kept);
    out->keeps = 0;
    mark_kept(done, place, 0, out); /* how many frames there were */
    if (asked->resume && !*done)
        return GO_ON;
    if (*done && !asked->overwrite && place->format)
        return fail_output("%s: an unfinished movie is in %s; give --resume to "
                           "go on or --overwrite to begin anew",
                           place->output, place->folder);
    return check_strangers(asked, place, true);
}

/* The record that lies there, opened and locked; -1 with GO_ON: none. */
static int open_file(const sequence_place *place, frame_record *out) {
    out->file = open(place->record, O_RDWR | O_APPEND | O_CLOEXEC);
    if (out->file < 0)
        return errno == ENOENT || errno == ENOTDIR
                   ? GO_ON
                   : fail_output("%s: %s; choose another name", place->record,
                                 strerror(errno));
    if (is_locked_by_others(out->file))
        return fail_output("%s: another run is making these frames; wait for "
                           "it, or choose another name",
                           place->output);
    return GO_ON;
}

int record_open(const options *asked, const shot_list *list,
                const sequence_place *place, frame_record *out) {
    *out = (frame_record){.file = -1, .anew = true};
    out->text = write_text(asked, list);
    out->kept = calloc((size_t)list->count, sizeof *out->kept);
    if (!out->text || !out->kept) {
        say("no memory for a list of %" PRId64 " frames; make fewer",
            list->count);
        return SNOW_NO_MEMORY;
    }
    int done = open_file(place, out);
    if (done != GO_ON)
        return done;
    char *old = out->file >= 0 ? read_text_of(out->file) : NULL;
    bool tells = old && *old; /* not of a run that was killed before it did */
    out->replaces = asked->overwrite || tells;
    done = tells ? compare(asked, list, place, old, out)
                 : check_strangers(asked, place, false);
    free(old);
    return done;
}

static int write_all(int file, const char *text, size_t size) {
    while (size) {
        ssize_t taken = write(file, text, size);
        if (taken < 0 && errno == EINTR)
            continue;
        if (taken <= 0)
            return taken < 0 ? errno : EIO;
        text += taken;
        size -= (size_t)taken;
    }
    return 0;
}

static int write_line(int file, int64_t index, int64_t bytes) {
    char line[64];
    int length = snprintf(line, sizeof line, "done %" PRId64 " %" PRId64 "\n",
                          index, bytes);
    return write_all(file, line, (size_t)length);
}

/* The "done" lines of frames that are kept, when the record is written anew. */
static int write_kept(const frame_record *record, const sequence_place *place,
                      int64_t count) {
    char path[PATH_MAX];
    struct stat what;
    for (int64_t i = 0; record->keeps && i < count; i++) {
        if (!record->kept[i] || !place_frame(place, i, path, sizeof path) ||
            stat(path, &what) != 0)
            continue;
        int number = write_line(record->file, i, (int64_t)what.st_size);
        if (number != 0)
            return number;
    }
    return 0;
}

int record_claim(frame_record *record, const sequence_place *place) {
    if (record->file >= 0)
        return 0;
    record->file =
        open(place->record, O_RDWR | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC,
             S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP | S_IROTH | S_IWOTH);
    if (record->file < 0)
        return errno;
    return is_locked_by_others(record->file) ? EAGAIN : 0;
}

/* Old frames go before the record that tells of them: should the end come in
 * between, nothing is left that it would not tell of.  Frames that nobody may
 * replace were not there when the run began, and are somebody's. */
int record_begin(frame_record *record, const sequence_place *place,
                 int64_t count) {
    if (!record->anew)
        return 0;
    if (!record->keeps && record->replaces)
        place_remove_frames(place, record->done > count ? record->done : count);
    int number = ftruncate(record->file, 0) == 0 ? 0 : errno;
    if (number == 0)
        number = write_all(record->file, record->text, strlen(record->text));
    if (number == 0)
        number = write_kept(record, place, count);
    if (number == 0 && fsync(record->file) != 0 && errno != EINVAL)
        number = errno;
    record->anew = number != 0;
    return number;
}

int record_add(frame_record *record, int64_t index, int64_t bytes) {
    return write_line(record->file, index, bytes);
}

void record_close(frame_record *record) {
    if (record->file >= 0)
        close(record->file);
    free(record->text);
    free(record->kept);
    *record = (frame_record){.file = -1};
}
