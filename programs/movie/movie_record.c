/* movie_record.c - writes and compares the record of what frames were made
 * with.
 *
 * Settings are compared as text: the options as they were given, from the
 * option table, so an option that is added there is covered here too.  Options
 * that do not change a frame are omitted. */
#define _XOPEN_SOURCE 700
#include "movie/movie_record.h"
#include "picture/outputs.h"
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

#define FIRST_LINE "snowglass frames 2\n"
#define LOOK_LINE "look of "
#define RECORD_MOST                                                           \
    (INT64_C(1) << 30) /* bytes; the record of a million frames takes a tenth \
                        */

static const char *const without_effect[] = {
    "output",  "overwrite", "resume",      "frames",  "fps",
    "threads", "progress",  "stats",       "verbose", "quiet",
    "memory",  "config",    "save-config", "timeout"};

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

/* What all frames have in common.  AVX2 and AVX-512 give the same bits; other
 * instruction sets differ.  An option that names a file (a transfer function, a
 * mask) also records the file's identity. */
static void print_head(FILE *out, const options *opts, const shot_list *list) {
    const size_t others = sizeof without_effect / sizeof *without_effect;
    const char *isa = strcmp(opts->isa, "auto") ? opts->isa : snow_isa_used();
    fprintf(out, FIRST_LINE "version %s\nkernels %s\n", snow_version(),
            opts->deterministic           ? "deterministic"
            : strncmp(isa, "avx", 3) == 0 ? "vector"
                                          : isa);
    if (process_ranks() > 1 && !opts->deterministic)
        fprintf(out, "ranks %d\n", process_ranks());
    if (opts->opacity_unit)
        fprintf(out, "opacity-unit %s\n", opts->opacity_unit);
    for (size_t i = 0; option_table[i].name; i++) {
        const char *text = opts->given[i];
        struct stat what;
        size_t n = 0;
        while (n < others &&
               strcmp(option_table[i].name, without_effect[n]) != 0)
            n++;
        if (!text || n < others)
            continue;
        fprintf(out, "--%s ", option_table[i].name);
        print_clean(out, text);
        if (stat(text, &what) == 0 && S_ISREG(what.st_mode)) {
            fprintf(out, " ");
            print_identity(out, text);
        }
        fprintf(out, "\n");
    }
    if (list->looked)
        fprintf(out, LOOK_LINE "%" PRId64 " steps\n", list->looked);
}

/* The head for `index` -1, else a frame's line from its azimuth on; NULL if out
 * of memory. */
static char *text_of(const options *opts, const shot_list *list,
                     int64_t index) {
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out)
        return NULL;
    if (index < 0) {
        print_head(out, opts, list);
    } else {
        const movie_shot *shot = &list->shots[index];
        fprintf(out, "azimuth %.17g time %" PRId64 " ", shot->azimuth,
                shot->time);
        if (list->slices)
            fprintf(out, "slice %" PRId64 " ", shot->slice);
        print_identity(out, shot->path);
        fprintf(out, "\n");
    }
    bool good = !ferror(out);
    if (fclose(out) != 0 || !good) {
        free(text);
        return NULL;
    }
    return text;
}

/* The whole file as text; NULL, with errno, if it cannot be read. */
static char *read_text_of(int file) {
    struct stat what;
    if (fstat(file, &what) != 0)
        return NULL;
    if (what.st_size > RECORD_MOST) {
        errno = EFBIG;
        return NULL;
    }
    size_t size = (size_t)what.st_size, got = 0;
    char *text = malloc(size + 1);
    while (text && got < size) {
        ssize_t some = pread(file, text + got, size - got, (off_t)got);
        if (some == 0)
            break;
        if (some < 0 && errno != EINTR) {
            free(text);
            return NULL;
        }
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

static size_t line_length(const char *text) {
    size_t length = strcspn(text, "\n");
    return length + (text[length] == '\n');
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

/* --- what an earlier run left ----------------------------------------------
 */

/* A frame's line, the last one of it in a record. */
typedef struct frame_line {
    const char *line; /* NULL: none */
    const char *what; /* from its azimuth on */
    int64_t count;    /* of frames in all, when it was written */
    int64_t bytes;    /* 0: not made yet */
} frame_line;

/* A torn line is the last one. It is ignored, and cut off before others are
 * written. */
static void find_lines(const char *text, int64_t count, frame_line *lines,
                       frame_record *out) {
    const char *begin = text;
    for (; strchr(text, '\n'); text += line_length(text)) {
        frame_line found = {.line = text};
        int64_t index;
        int at = 0;
        if (sscanf(text,
                   "frame %" SCNd64 " of %" SCNd64 " bytes %" SCNd64 " %n",
                   &index, &found.count, &found.bytes, &at) != 3 ||
            !at || index < 0 || index == INT64_MAX)
            continue;
        found.what = text + at;
        if (found.bytes && index >= out->listed)
            out->listed = index + 1;
        if (index < count)
            lines[index] = found;
    }
    out->whole = text - begin;
}

static bool is_same_line(const char *a, const char *b) {
    size_t length = line_length(a);
    return length == line_length(b) && strncmp(a, b, length) == 0;
}

/* Prints both lines, shortened to the size of a message; not where frames may
 * be replaced. */
static int fail_other(const options *opts, const char *old, const char *now) {
    int was = (int)strcspn(old, "\n"), is = (int)strcspn(now, "\n");
    if (opts->overwrite)
        return SNOW_STATUS_BAD_OUTPUT;
    return fail_output("%s: its frames were made with other settings ('%.*s' "
                       "then, '%.*s' now); use the same settings, or "
                       "--overwrite without --resume to start again",
                       opts->output, was > 300 ? 300 : was, old,
                       is > 300 ? 300 : is, now);
}

/* Compares the frames that are kept, and the steps that their look was chosen
 * from.  Others may have changed (a broken step was repaired).  Where steps
 * were added to their file, those before are as they were. */
static int check_frames(const options *opts, const shot_list *list,
                        const frame_line *lines, frame_record *out) {
    int done = CONTINUE;
    for (int64_t i = 0; i < list->count && done == CONTINUE; i++) {
        const frame_line *old = &lines[i];
        if (!old->line || (i >= list->looked && !out->kept[i]))
            continue;
        const char *now = out->inputs[i];
        bool same = is_same_line(old->what, now);
        out->renewed |= !same;
        if (!same && !(old->count < list->count && has_grown(old->what, now)))
            done = fail_other(opts, old->line, now);
    }
    return done;
}

/* Whether a record allows to resume: CONTINUE. */
static int check_old(const options *opts, const shot_list *list,
                     const movie_place *place, const char *old,
                     const frame_line *lines, frame_record *out) {
    const char *now = out->head;
    char path[PATH_MAX];
    struct stat what;
    int done = CONTINUE;
    for (int64_t i = 0; i < list->count; i++) {
        out->kept[i] = lines[i].bytes &&
                       place_frame(place, i, path, sizeof path) &&
                       stat(path, &what) == 0 && S_ISREG(what.st_mode) &&
                       what.st_size == lines[i].bytes;
        out->keeps += out->kept[i];
    }
    while (*now && is_same_line(old, now)) {
        old += line_length(old);
        now += line_length(now);
    }
    const bool ended = !*old || strncmp(old, "frame ", 6) == 0;
    if (!ended || *now)
        done =
            fail_other(opts, ended ? "nothing" : old, *now ? now : "nothing");
    if (done == CONTINUE && out->keeps)
        done = check_frames(opts, list, lines, out);
    if (done == CONTINUE && out->listed > list->count)
        done = fail_other(opts, "more frames", "fewer");
    if (done != CONTINUE)
        out->keeps = 0;
    out->anew = !out->keeps;
    return done;
}

/* Checks frames that have no record, or a record that must not be resumed. */
static int check_other_files(const options *opts, const movie_place *place,
                             bool recorded) {
    char path[PATH_MAX];
    int64_t first = place_first(place, 0);
    if (first < 0 || opts->overwrite ||
        !place_frame(place, first, path, sizeof path))
        return CONTINUE;
    struct stat what;
    if (lstat(path, &what) != 0)
        return fail_output("%s: may exist, as its folder cannot be listed; "
                           "check the permissions and the disk",
                           path);
    if (opts->resume)
        return fail_output(
            "%s: exists without a record of how it was made; use --overwrite "
            "without --resume to start again, or another name",
            path);
    return fail_output(
        "%s: exists; use %s--overwrite to start again, or another name", path,
        recorded ? "--resume to continue, " : "");
}

static int fail_list(const shot_list *list) {
    return fail_memory("out of memory for a list of %" PRId64
                       " frames; make fewer",
                       list->count);
}

/* A record without finished frames counts as none. */
static int compare(const options *opts, const shot_list *list,
                   const movie_place *place, const char *old,
                   frame_record *out) {
    frame_line *lines = calloc((size_t)list->count, sizeof *lines);
    if (!lines)
        return fail_list(list);
    find_lines(old, list->count, lines, out);
    int done = CONTINUE;
    if (opts->resume && out->listed)
        done = check_old(opts, list, place, old, lines, out);
    else if (out->listed && !opts->overwrite && place->format)
        done = fail_output("%s: an unfinished movie is in %s; use --resume to "
                           "continue or --overwrite to start again",
                           place->output, place->folder);
    else
        done = check_other_files(opts, place, true);
    free(lines);
    if (done == CONTINUE || !opts->overwrite)
        return done;
    memset(out->kept, 0, (size_t)list->count * sizeof *out->kept);
    return CONTINUE;
}

/* Opens and locks an existing record; -1 with CONTINUE: there is none. */
static int open_file(const movie_place *place, frame_record *out) {
    out->file = open_bytes(place->record, O_RDWR | O_APPEND);
    if (out->file < 0)
        return errno == ENOENT || errno == ENOTDIR
                   ? CONTINUE
                   : fail_output("%s: %s; %s", place->record, strerror(errno),
                                 place_remedy(errno));
    if (is_locked_by_others(out->file))
        return fail_output("%s: another run is making these frames; wait for "
                           "it, or choose another name",
                           place->output);
    return CONTINUE;
}

/* What the frames are made with now.  Inputs are looked at before any is read:
 * one that changes meanwhile shows when the run is resumed. */
static int describe(const options *opts, const shot_list *list,
                    frame_record *out) {
    out->head = text_of(opts, list, -1);
    out->kept = calloc((size_t)list->count, sizeof *out->kept);
    out->inputs = calloc((size_t)list->count, sizeof *out->inputs);
    if (!out->head || !out->kept || !out->inputs)
        return fail_list(list);
    out->count = list->count;
    for (int64_t i = 0; i < list->count; i++)
        if (!(out->inputs[i] = text_of(NULL, list, i)))
            return fail_list(list);
    return CONTINUE;
}

int record_open(const options *opts, shot_list *list, const movie_place *place,
                frame_record *out) {
    *out = (frame_record){.file = -1, .anew = true};
    int done =
        place->streams ? describe(opts, list, out) : open_file(place, out);
    if (done != CONTINUE || place->streams)
        return done;
    char *old = out->file >= 0 ? read_text_of(out->file) : NULL;
    if (!old && out->file >= 0)
        return errno == ENOMEM
                   ? fail_list(list)
                   : fail_output("%s: cannot be read: %s; check the disk",
                                 place->record, strerror(errno));
    const int64_t all = list->looked;
    /* The look of frames that are there stays when others are added. */
    const char *line = old && opts->resume ? strstr(old, "\n" LOOK_LINE) : NULL;
    int64_t looked;
    if (line && sscanf(line + 1, LOOK_LINE "%" SCNd64 " steps", &looked) == 1 &&
        looked > 0 && looked < list->looked)
        list->looked = looked;
    done = describe(opts, list, out);
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
    free(out->head);
    out->head = text_of(opts, list, -1);
    return out->head ? CONTINUE : fail_list(list);
}

int record_claim(frame_record *record, const movie_place *place) {
    if (record->file >= 0)
        return 0;
    record->file =
        open_bytes(place->record, O_RDWR | O_APPEND | O_CREAT | O_EXCL);
    if (record->file < 0)
        return errno;
    return is_locked_by_others(record->file) ? EAGAIN : 0;
}

/* A line is written at once, so that few are torn. */
static int write_line(const frame_record *record, const shot_list *list,
                      int64_t index, int64_t bytes) {
    char line[96 + 2 * PATH_MAX];
    int length =
        snprintf(line, sizeof line,
                 "frame %" PRId64 " of %" PRId64 " bytes %" PRId64 " %s", index,
                 list->count, bytes, record->inputs[index]);
    return length > 0 && (size_t)length < sizeof line
               ? write_bytes(record->file, line, (size_t)length)
               : ENAMETOOLONG;
}

/* The steps of the look, and frames that are kept. */
static int write_known(frame_record *record, const movie_place *place,
                       const shot_list *list) {
    char path[PATH_MAX];
    struct stat what;
    int number = 0;
    for (int64_t i = 0; i < list->count && number == 0; i++) {
        bool kept = record->kept[i] &&
                    place_frame(place, i, path, sizeof path) &&
                    stat(path, &what) == 0;
        if (kept || i < list->looked)
            number =
                write_line(record, list, i, kept ? (int64_t)what.st_size : 0);
    }
    return number ? number : sync_bytes(record->file);
}

/* Old frames are removed before the record that lists them, so that an
 * interruption in between leaves no unlisted frames.  Frames that must not be
 * replaced did not exist when the run began; another program made them. */
int record_add(frame_record *record, const movie_place *place,
               const shot_list *list, int64_t index, int64_t bytes) {
    const int64_t whole = record->anew ? 0 : record->whole;
    int number = 0;
    if (record->anew && record->replaces)
        place_remove_frames(place, record->listed > list->count ? record->listed
                                                                : list->count);
    if ((record->anew || whole) && ftruncate(record->file, whole) != 0)
        number = errno;
    if (number == 0 && record->anew)
        number = write_bytes(record->file, record->head, strlen(record->head));
    record->whole = 0;
    if (number == 0 && (record->anew || record->renewed))
        number = write_known(record, place, list);
    record->anew = record->renewed = number != 0;
    return number == 0 ? write_line(record, list, index, bytes) : number;
}

void record_close(frame_record *record) {
    if (record->file >= 0)
        close(record->file);
    for (int64_t i = 0; i < record->count; i++)
        free(record->inputs[i]);
    free(record->inputs);
    free(record->head);
    free(record->kept);
    *record = (frame_record){.file = -1};
}
