/* tests/base/test_writer.c - files come into being whole or not at all.  Built
 * twice: with SNOW_TMPFILE=0 as on a file system where files have names from
 * their first byte. */
#define _GNU_SOURCE /* O_TMPFILE */
#include "io/writer.h"
#include "support/failing.h"
#include "support/folder.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

typedef struct fixture {
    snow_context *context;
    char folder[SUPPORT_FOLDER_BYTES];
    char path[128];
} fixture;

static int set_up(void **state) {
    fixture *f = calloc(1, sizeof *f);
    f->context = support_context();
    support_folder_make(f->folder);
    snprintf(f->path, sizeof f->path, "%s/out.bin", f->folder);
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    support_folder_remove(f->folder);
    assert_int_equal(snow_context_bytes(f->context), 0);
    snow_context_free(f->context);
    free(f);
    return 0;
}

static void put_text(const char *path, const char *text) {
    support_write_file(path, text, strlen(text));
}

static void assert_text(const char *path, const char *text) {
    char bytes[256] = "";
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t got = fread(bytes, 1, sizeof bytes - 1, file);
    bytes[got] = 0;
    fclose(file);
    assert_string_equal(bytes, text);
}

/* Writes a text to the path in one go. */
static snow_status write_text(fixture *f, const char *path, bool overwrite,
                              const char *text) {
    snow_writer *writer = NULL;
    SNOW_TRY(snow_writer_open(f->context, path, overwrite, &writer));
    if (snow_writer_write(writer, text, strlen(text)) != SNOW_STATUS_OK) {
        snow_writer_abandon(writer);
        return SNOW_STATUS_BAD_OUTPUT;
    }
    return snow_writer_commit(writer);
}

static void assert_message(const fixture *f, const char *part) {
    const char *message = snow_context_message(f->context);
    if (!strstr(message, part) || strchr(message, '\n'))
        fail_msg("\"%s\" lacks \"%s\"", message, part);
}

static void a_committed_file_has_its_bytes_and_leaves_no_other(void **state) {
    fixture *f = *state;
    snow_writer *writer = NULL;
    assert_int_equal(snow_writer_open(f->context, f->path, false, &writer),
                     SNOW_STATUS_OK);
    /* Pieces below, at and above the writer's buffer. */
    static unsigned char bytes[300000];
    uint64_t seed = 1;
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (unsigned char)support_random(&seed);
    const size_t pieces[] = {0, 1, 65535, 1, 65536, 100000, 7, 68920};
    size_t at = 0;
    for (size_t i = 0; i < sizeof pieces / sizeof *pieces; at += pieces[i++])
        assert_int_equal(snow_writer_write(writer, bytes + at, pieces[i]),
                         SNOW_STATUS_OK);
    assert_int_equal(at, sizeof bytes);
    assert_int_not_equal(access(f->path, F_OK), 0);
    assert_int_equal(snow_writer_commit(writer), SNOW_STATUS_OK);
    assert_int_equal(support_folder_files(f->folder), 1);
    static unsigned char back[sizeof bytes + 1];
    FILE *file = fopen(f->path, "rb");
    assert_int_equal(fread(back, 1, sizeof back, file), sizeof bytes);
    fclose(file);
    assert_memory_equal(bytes, back, sizeof bytes);
}

static void the_mode_is_what_the_umask_says(void **state) {
    fixture *f = *state;
    mode_t before = umask(027);
    assert_int_equal(write_text(f, f->path, false, "x"), SNOW_STATUS_OK);
    umask(before);
    struct stat here;
    assert_int_equal(stat(f->path, &here), 0);
    assert_int_equal(here.st_mode & 0777, 0640);
}

static void a_replaced_file_keeps_its_permissions(void **state) {
    fixture *f = *state;
    static const mode_t modes[] = {0600, 0664, 0444};
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++) {
        struct stat here;
        unlink(f->path);
        put_text(f->path, "old");
        assert_int_equal(chmod(f->path, modes[i]), 0);
        assert_int_equal(write_text(f, f->path, true, "new"), SNOW_STATUS_OK);
        assert_int_equal(stat(f->path, &here), 0);
        assert_int_equal(here.st_mode & 0777, modes[i]);
        assert_text(f->path, "new");
    }
}

static void an_existing_file_is_kept_unless_overwriting(void **state) {
    fixture *f = *state;
    put_text(f->path, "old");
    assert_int_equal(write_text(f, f->path, false, "new"),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_message(f, "exists");
    assert_message(f, "(-y)");
    assert_text(f->path, "old");
    assert_int_equal(write_text(f, f->path, true, "new"), SNOW_STATUS_OK);
    assert_text(f->path, "new");
    assert_int_equal(support_folder_files(f->folder), 1);
}

static void a_file_that_appears_meanwhile_is_kept_or_replaced(void **state) {
    fixture *f = *state;
    for (int overwrite = 0; overwrite < 2; overwrite++) {
        snow_writer *writer = NULL;
        unlink(f->path);
        assert_int_equal(
            snow_writer_open(f->context, f->path, overwrite, &writer),
            SNOW_STATUS_OK);
        assert_int_equal(snow_writer_write(writer, "mine", 4), SNOW_STATUS_OK);
        put_text(f->path, "theirs");
        assert_int_equal(snow_writer_commit(writer),
                         overwrite ? SNOW_STATUS_OK : SNOW_STATUS_BAD_OUTPUT);
        if (!overwrite)
            assert_message(f, "exists");
        assert_text(f->path, overwrite ? "mine" : "theirs");
        assert_int_equal(support_folder_files(f->folder), 1);
    }
}

/* Whether files of the folder have names while they are written. */
static bool are_named(const char *folder) {
#ifdef SNOW_TMPFILE
    (void)folder;
    return true;
#else
    int file = open(folder, O_WRONLY | O_TMPFILE, 0600);
    if (file >= 0)
        close(file);
    return file < 0;
#endif
}

/* Nothing can be removed by one who is killed. */
static void a_writer_that_is_killed_leaves_nothing(void **state) {
    fixture *f = *state;
    static const char many[100000];
    const pid_t child = fork();
    assert_true(child >= 0);
    if (!child) {
        snow_writer *writer = NULL;
        if (snow_writer_open(f->context, f->path, false, &writer) ==
                SNOW_STATUS_OK &&
            snow_writer_write(writer, many, sizeof many) == SNOW_STATUS_OK)
            raise(SIGKILL);
        _exit(1);
    }
    int end = 0;
    assert_int_equal(waitpid(child, &end, 0), child);
    assert_true(WIFSIGNALED(end) && WTERMSIG(end) == SIGKILL);
    assert_int_not_equal(access(f->path, F_OK), 0);
    assert_int_equal(support_folder_files(f->folder), are_named(f->folder));
}

static void an_abandoned_file_leaves_nothing(void **state) {
    fixture *f = *state;
    put_text(f->path, "old");
    snow_writer *writer = NULL;
    assert_int_equal(snow_writer_open(f->context, f->path, true, &writer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_writer_write(writer, "half", 4), SNOW_STATUS_OK);
    snow_writer_abandon(writer);
    snow_writer_abandon(NULL);
    assert_text(f->path, "old");
    assert_int_equal(support_folder_files(f->folder), 1);
}

static void a_link_stays_a_link_and_its_target_is_replaced(void **state) {
    fixture *f = *state;
    char link_path[160];
    snprintf(link_path, sizeof link_path, "%s/link", f->folder);
    put_text(f->path, "old");
    assert_int_equal(symlink("out.bin", link_path), 0);
    assert_int_equal(write_text(f, link_path, false, "new"),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_int_equal(write_text(f, link_path, true, "new"), SNOW_STATUS_OK);
    struct stat here;
    assert_int_equal(lstat(link_path, &here), 0);
    assert_true(S_ISLNK(here.st_mode));
    assert_text(f->path, "new");
}

static void folders_and_missing_folders_are_refused(void **state) {
    fixture *f = *state;
    assert_int_equal(write_text(f, f->folder, true, "x"),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_message(f, "folder");
    assert_int_equal(write_text(f, "/tmp/no/such/folder/a", false, "x"),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_message(f, "No such file or directory; make the folder first");
    assert_int_equal(write_text(f, "", false, "x"), SNOW_STATUS_BAD_OUTPUT);
    assert_message(f, "is not a file name");
    char slash[160];
    snprintf(slash, sizeof slash, "%s/new/", f->folder);
    assert_int_equal(write_text(f, slash, false, "x"), SNOW_STATUS_BAD_OUTPUT);
    assert_int_equal(support_folder_files(f->folder), 0);
}

static void a_name_of_the_greatest_length_can_be_written(void **state) {
    fixture *f = *state;
    char path[400], name[256];
    memset(name, 'n', 255);
    name[255] = 0;
    snprintf(path, sizeof path, "%s/%s", f->folder, name);
    assert_int_equal(write_text(f, path, false, "x"), SNOW_STATUS_OK);
    assert_text(path, "x");
}

static void a_name_that_is_too_long_is_refused_at_once(void **state) {
    fixture *f = *state;
    char path[500];
    snow_writer *writer = NULL;
    snprintf(path, sizeof path, "%s/%0300d", f->folder, 0);
    assert_int_equal(snow_writer_open(f->context, path, false, &writer),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_message(f, "choose a shorter name");
    assert_int_equal(support_folder_files(f->folder), 0);
}

static void devices_are_written_through(void **state) {
    fixture *f = *state;
    assert_int_equal(write_text(f, "/dev/null", false, "x"), SNOW_STATUS_OK);
    struct stat here;
    assert_int_equal(stat("/dev/null", &here), 0);
    assert_true(S_ISCHR(here.st_mode));
}

static void a_full_device_is_reported(void **state) {
    fixture *f = *state;
    if (access("/dev/full", W_OK) != 0)
        skip();
    assert_int_equal(write_text(f, "/dev/full", false, "x"),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_message(f, "free some space");
    snow_writer *writer = NULL;
    static const char many[200000];
    assert_int_equal(snow_writer_open(f->context, "/dev/full", false, &writer),
                     SNOW_STATUS_OK);
    assert_int_equal(snow_writer_write(writer, many, sizeof many),
                     SNOW_STATUS_BAD_OUTPUT);
    /* A failure sticks: the commit cannot succeed after it. */
    assert_int_equal(snow_writer_write(writer, many, 1),
                     SNOW_STATUS_BAD_OUTPUT);
    assert_int_equal(snow_writer_commit(writer), SNOW_STATUS_BAD_OUTPUT);
}

static void a_file_over_the_size_limit_leaves_nothing(void **state) {
    fixture *f = *state;
    struct rlimit before, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    small = before;
    small.rlim_cur = 100000;
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    snow_writer *writer = NULL;
    static const char many[70000];
    snow_status opened = snow_writer_open(f->context, f->path, false, &writer);
    snow_status first = snow_writer_write(writer, many, sizeof many);
    snow_status second = snow_writer_write(writer, many, sizeof many);
    snow_status committed = snow_writer_commit(writer);
    setrlimit(RLIMIT_FSIZE, &before);
    assert_int_equal(opened, SNOW_STATUS_OK);
    assert_int_equal(first, SNOW_STATUS_OK);
    assert_int_equal(second, SNOW_STATUS_BAD_OUTPUT);
    assert_int_equal(committed, SNOW_STATUS_BAD_OUTPUT);
    assert_int_equal(support_folder_files(f->folder), 0);
}

static void a_dash_is_standard_output(void **state) {
    fixture *f = *state;
    fflush(stdout);
    int saved = dup(STDOUT_FILENO);
    FILE *file = fopen(f->path, "wb");
    assert_non_null(file);
    dup2(fileno(file), STDOUT_FILENO);
    snow_status status = write_text(f, "-", false, "to stdout");
    dup2(saved, STDOUT_FILENO);
    close(saved);
    fclose(file);
    assert_int_equal(status, SNOW_STATUS_OK);
    assert_text(f->path, "to stdout");
}

static void no_memory_leaves_nothing(void **state) {
    fixture *f = *state;
    int successes = 0;
    for (int few = 0; few < 6; few++) {
        /* One more for the context. */
        support_failing failing = {.failing = few + 1, .for_good = true};
        snow_allocator allocator = support_failing_allocator(&failing);
        snow_context *context = NULL;
        assert_int_equal(snow_context_new(&allocator, &context),
                         SNOW_STATUS_OK);
        snow_writer *writer = NULL;
        if (snow_writer_open(context, f->path, false, &writer) ==
            SNOW_STATUS_OK) {
            successes++;
            snow_writer_abandon(writer);
        } else {
            assert_null(writer);
        }
        assert_int_equal(snow_context_bytes(context), 0);
        assert_int_equal(support_folder_files(f->folder), 0);
        snow_context_free(context);
    }
    assert_true(successes > 0 && successes < 6);
}

#define UNIT(test) cmocka_unit_test_setup_teardown(test, set_up, tear_down)

int main(void) {
    const struct CMUnitTest tests[] = {
        UNIT(a_committed_file_has_its_bytes_and_leaves_no_other),
        UNIT(the_mode_is_what_the_umask_says),
        UNIT(a_replaced_file_keeps_its_permissions),
        UNIT(an_existing_file_is_kept_unless_overwriting),
        UNIT(a_file_that_appears_meanwhile_is_kept_or_replaced),
        UNIT(a_writer_that_is_killed_leaves_nothing),
        UNIT(an_abandoned_file_leaves_nothing),
        UNIT(a_link_stays_a_link_and_its_target_is_replaced),
        UNIT(folders_and_missing_folders_are_refused),
        UNIT(a_name_of_the_greatest_length_can_be_written),
        UNIT(a_name_that_is_too_long_is_refused_at_once),
        UNIT(devices_are_written_through),
        UNIT(a_full_device_is_reported),
        UNIT(a_file_over_the_size_limit_leaves_nothing),
        UNIT(a_dash_is_standard_output),
        UNIT(no_memory_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
