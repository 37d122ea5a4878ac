/* movie_record.c - writes and compares the record of what frames were made
 * with.
 *
 * Settings are compared as text: the options as they were given, from the
 * option table, so an option that is added there is covered here too.  Options
 * that do not change a frame are omitted. */
#define _XOPEN_SOURCE 700
#include "movie/movie_record.h"
#include "run/log.h"
#include "run/paths.h"
#include "run/start.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define FIRST_LINE "snowglass frames 1\n"
#define LOOK_LINE "look of "
#define RECORD_MOST                                                           \
    (INT64_C(1) << 30) /* bytes; the record of a million frames takes a tenth \
                        */

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

/* Line ends in names would split or forge lines. */
static void print_clean(FILE *out, const char *text) {
    for (; *text; text++)
        fputc((unsigned char)*text < ' ' ? '?' : *text, out);
}

/* A file's size, the time of its last change, and its absolute path.  Of an
 * input that is not a file only the name. */
static void print_identity(FILE *out, const char *path) {
    struct stat what;
    char real[PATH_MAX], file[PATH_MAX];
    file_of_input(path, file, sizeof file);
    const char *set = path + strlen(file); /* "": the file is all */
    if (stat(file, &what) == 0 && realpath(file, real))
        fprintf(out, "of %lld %lld.%09ld ", (long long)what.st_size,
                (long long)what.st_mtim.tv_sec, (long)what.st_mtim.tv_nsec);
    else
        snprintf(real, sizeof real, "%s", file);
    print_clean(out, real);
    print_clean(out, set);
}

/* An option that names a file (a transfer function, a mask) also records the
 * file's identity. */
static void print_options(FILE *out, const options *opts) {
    for (size_t i = 0; option_table[i].name; i++) {
        const char *text = opts->given[i];
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

/* AVX2 and AVX-512 give the same bits; other instruction sets differ. */
static const char *kernels(const options *opts) {
    const char *isa = strcmp(opts->isa, "auto") ? opts->isa : snow_isa_used();
    if (opts->deterministic)
        return "deterministic";
    return strncmp(isa, "avx", 3) == 0 ? "vector" : isa;
}

static void print_shots(FILE *out, const shot_list *list) {
    if (list->looked)
        fprintf(out, LOOK_LINE "%" PRId64 " steps\n", list->looked);
    for (int64_t i = 0; i < list->count; i++) {
        const movie_shot *shot = &list->shots[i];
        fprintf(out, "frame %" PRId64 " azimuth %.17g time %" PRId64 " ", i,
                shot->azimuth, shot->time);
        print_identity(out, shot->path);
        fprintf(out, "\n");
    }
}

/* NULL if out of memory. */
static char *write_text(const options *opts, const shot_list *list) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    fprintf(out, FIRST_LINE "version %s\nkernels %s\n", snow_version(),
            kernels(opts));
    if (process_ranks() > 1 && !opts->deterministic)
        fprintf(out, "ranks %d\n", process_ranks());
    print_options(out, opts);
    print_shots(out, list);
    bool good = !ferror(out);
    if (fclose(out) != 0 || !good) {
        free(text);
        return NULL;
    }
    return text;
}

/* The whole file as text; NULL if it cannot be read. */
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

/* The lock ends with the process.  On file systems without locks no other run
 * is assumed. */
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

/* Compares the lines before the first frame, advancing both texts.  Returns
 * true if they all agree. */
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

/* Whether two lines of a frame differ only in the size of its file, which has
 * grown, and the time of its last change. */
static bool has_grown(const char *old, const char *now) {
    const char *a = strstr(old, " of "), *b = strstr(now, " of ");
    size_t ends[2] = {strcspn(old, "\n"), strcspn(now, "\n")};
    long long sizes[2], times[2];
    int at[2];
    if (!a || !b || a > old + ends[0] || b > now + ends[1] ||
        a - old != b - now || strncmp(old, now, (size_t)(a - old)) != 0 ||
        sscanf(a, " of %lld %lld.%*d %n", &sizes[0], &times[0], &at[0]) != 2 ||
        sscanf(b, " of %lld %lld.%*d %n", &sizes[1], &times[1], &at[1]) != 2)
        return false;
    a += at[0];
    b += at[1];
    ends[0] -= (size_t)(a - old);
    ends[1] -= (size_t)(b - now);
    return sizes[1] > sizes[0] && ends[0] == ends[1] &&
           strncmp(a, b, ends[0]) == 0;
}

static int64_t count_frames(const char *text) {
    int64_t count = 0;
    for (; begins(text, "frame "); text += line_length(text))
        count++;
    return count;
}

/* Continues along the frames.  One that is not kept, and on which the look of
 * those kept does not depend, may have changed (a broken step was repaired),
 * and there may be more than before.  `changed` is set if anything has changed.
 */
static bool agree_on_frames(const char **old, const char **now,
                            const frame_record *record, int64_t looked,
                            bool *changed) {
    /* Steps were added to their file: those before are as they were. */
    const bool grows = count_frames(*now) > count_frames(*old);
    if (!record->keeps)
        looked = 0;
    for (int64_t i = 0; begins(*old, "frame ") && **now; i++) {
        size_t length = line_length(*old), other = line_length(*now);
        bool same = length == other && strncmp(*old, *now, length) == 0;
        if (!same && (i < looked || record->kept[i]) &&
            !(grows && has_grown(*old, *now)))
            return false;
        *changed |= !same;
        *old += length;
        *now += other;
    }
    *changed |= begins(*old, "frame ") || **now;
    return true;
}

/* Marks the frames of the "done" lines whose files still have the recorded
 * size. A truncated line is the last one, and is ignored. */
static void mark_kept(const char *done, const movie_place *place, int64_t count,
                      frame_record *out) {
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

/* Prints both lines, shortened to the size of a message. */
static int fail_other(const movie_place *place, const char *old,
                      const char *now) {
    bool old_ended = !*old || begins(old, "done ");
    int was = (int)strcspn(old, "\n"), is = (int)strcspn(now, "\n");
    return fail_output("%s: its frames were made with other settings ('%.*s' "
                       "then, '%.*s' now); use the same settings, or "
                       "--overwrite without --resume to start again",
                       place->output,
                       old_ended   ? 7
                       : was > 300 ? 300
                                   : was,
                       old_ended ? "nothing" : old,
                       *now ? (is > 300 ? 300 : is) : 7,
                       *now ? now : "nothing");
}

/* Checks frames that have no record, or a record that must not be resumed. */
static int check_other_files(const options *opts, const movie_place *place,
                             bool recorded) {
    char path[PATH_MAX];
    int64_t first = place_first(place, 0);
    if (first < 0 || opts->overwrite ||
        !place_frame(place, first, path, sizeof path))
        return CONTINUE;
    if (opts->resume)
        return fail_output(
            "%s: exists without a record of how it was made; use --overwrite "
            "without --resume to start again, or another name",
            path);
    return fail_output(
        "%s: exists; use %s--overwrite to start again, or another name", path,
        recorded ? "--resume to continue, " : "");
}

/* Whether the record allows to resume; if so, marks the frames that are
 * kept. Otherwise `old` and `now` point to the first lines that differ. */
static bool fits(const shot_list *list, const movie_place *place,
                 const char **old, const char **now, const char *done,
                 frame_record *out) {
    bool changed = false;
    mark_kept(done, place, list->count, out);
    if (!agree_on_settings(old, now) ||
        !agree_on_frames(old, now, out, list->looked, &changed))
        return false;
    if (out->done > list->count)
        return false;
    out->anew = changed;
    return true;
}

/* A record without finished frames counts as none. */
static int compare(const options *opts, const shot_list *list,
                   const movie_place *place, const char *old_text,
                   frame_record *out) {
    const char *old = old_text, *now = out->text;
    const char *done = strstr(old_text, "\ndone ");
    done = done ? done + 1 : "";
    if (opts->resume && fits(list, place, &old, &now, done, out))
        return CONTINUE;
    if (opts->resume && *done && !opts->overwrite)
        return fail_other(place, old, now);
    memset(out->kept, 0, (size_t)list->count * sizeof *out->kept);
    out->keeps = 0;
    mark_kept(done, place, 0, out); /* how many frames there were */
    if (opts->resume && !*done)
        return CONTINUE;
    if (*done && !opts->overwrite && place->format)
        return fail_output("%s: an unfinished movie is in %s; use --resume to "
                           "continue or --overwrite to start again",
                           place->output, place->folder);
    return check_other_files(opts, place, true);
}

/* Opens and locks an existing record; -1 with CONTINUE: there is none. */
static int open_file(const movie_place *place, frame_record *out) {
    out->file = open(place->record, O_RDWR | O_APPEND | O_CLOEXEC);
    if (out->file < 0)
        return errno == ENOENT || errno == ENOTDIR
                   ? CONTINUE
                   : fail_output("%s: %s; choose another name", place->record,
                                 strerror(errno));
    if (is_locked_by_others(out->file))
        return fail_output("%s: another run is making these frames; wait for "
                           "it, or choose another name",
                           place->output);
    return CONTINUE;
}

/* The look of frames that are there stays when others are added. */
static void keep_look(const char *old, shot_list *list) {
    const char *line = strstr(old, "\n" LOOK_LINE);
    int64_t looked;
    if (line && sscanf(line + 1, LOOK_LINE "%" SCNd64 " steps", &looked) == 1 &&
        looked > 0 && looked < list->looked)
        list->looked = looked;
}

static int fail_list(const shot_list *list) {
    return fail_memory("out of memory for a list of %" PRId64
                       " frames; make fewer",
                       list->count);
}

static int describe(const options *opts, const shot_list *list,
                    frame_record *out) {
    free(out->text);
    out->text = write_text(opts, list);
    return out->text ? CONTINUE : fail_list(list);
}

int record_open(const options *opts, shot_list *list, const movie_place *place,
                frame_record *out) {
    *out = (frame_record){.file = -1, .anew = true};
    int done = open_file(place, out);
    if (done != CONTINUE)
        return done;
    char *old = out->file >= 0 ? read_text_of(out->file) : NULL;
    const int64_t all = list->looked;
    if (old && opts->resume)
        keep_look(old, list);
    out->kept = calloc((size_t)list->count, sizeof *out->kept);
    done = out->kept ? describe(opts, list, out) : fail_list(list);
    if (done != CONTINUE) {
        free(old);
        return done;
    }
    bool continues =
        old && *old; /* not of a run that was killed before it wrote */
    out->replaces = opts->overwrite || continues;
    done = continues ? compare(opts, list, place, old, out)
                     : check_other_files(opts, place, false);
    free(old);
    if (done != CONTINUE || out->keeps || list->looked == all)
        return done;
    list->looked = all; /* no frame is there that has the look */
    return describe(opts, list, out);
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

/* Repeats the "done" lines of kept frames when the record is written again. */
static int write_kept(const frame_record *record, const movie_place *place,
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

int record_claim(frame_record *record, const movie_place *place) {
    if (record->file >= 0)
        return 0;
    record->file =
        open(place->record, O_RDWR | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC,
             S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP | S_IROTH | S_IWOTH);
    if (record->file < 0)
        return errno;
    return is_locked_by_others(record->file) ? EAGAIN : 0;
}

/* Old frames are removed before the record that lists them, so that an
 * interruption in between leaves no unlisted frames.  Frames that must not be
 * replaced did not exist when the run began; another program made them. */
int record_begin(frame_record *record, const movie_place *place,
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
