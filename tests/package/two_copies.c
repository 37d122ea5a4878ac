/* two_copies.c - two copies of the shared library in one process, as plug-ins
 * of a program may bring them: two_copies LIBRARY LIBRARY FILE [global].
 *
 * Draws the file by both, in turns and from threads at once; the second is
 * still used when the first is closed.  With `global` the first is loaded as a
 * library is that the program links: the second would then call the first's
 * functions by default, and keep it in memory.  Fails with one line. */
#include <dlfcn.h>
#include <pthread.h>
#include <signal.h>
#include <snowglass/snowglass.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TURNS 3
#define THREADS 4 /* every other one draws with the second copy */

/* A copy, and those of its functions that a picture takes. */
typedef struct copy {
    void *library;
    const char *(*version)(void);
    snow_status (*context_new)(const snow_allocator *, snow_context **);
    void (*context_free)(snow_context *);
    const char *(*message)(const snow_context *);
    snow_status (*render_file)(snow_context *, const char *, const snow_view *,
                               const snow_settings *, snow_image **);
    uint64_t (*checksum)(const snow_image *);
    void (*image_free)(snow_image *);
} copy;

typedef struct job {
    pthread_t thread;
    const copy *by;
    const char *path;
    uint64_t sum;
} job;

static void require(bool holds, const char *what) {
    if (holds)
        return;
    fprintf(stderr, "two_copies: not so: %s\n", what);
    exit(1);
}

/* C has no conversion from an object's address to a function's. */
static void take(const copy *from, const char *name, void *function) {
    void *found = dlsym(from->library, name);
    require(found != NULL, name);
    memcpy(function, &found, sizeof found);
}

static copy load(const char *path, int flags) {
    copy c = {.library = dlopen(path, RTLD_NOW | flags)};
    require(c.library != NULL, "the library is loaded");
    take(&c, "snow_version", &c.version);
    take(&c, "snow_context_new", &c.context_new);
    take(&c, "snow_context_free", &c.context_free);
    take(&c, "snow_context_message", &c.message);
    take(&c, "snow_render_file", &c.render_file);
    take(&c, "snow_image_checksum", &c.checksum);
    take(&c, "snow_image_free", &c.image_free);
    return c;
}

static uint64_t draw_in(const copy *c, snow_context *context,
                        const char *path) {
    snow_image *image = NULL;
    require(c->render_file(context, path, NULL, NULL, &image) == SNOW_STATUS_OK,
            "the file is drawn");
    uint64_t sum = c->checksum(image);
    c->image_free(image);
    return sum;
}

static uint64_t draw(const copy *c, const char *path) {
    snow_context *context = NULL;
    require(c->context_new(NULL, &context) == SNOW_STATUS_OK, "a context");
    uint64_t sum = draw_in(c, context, path);
    c->context_free(context);
    return sum;
}

/* Both have a context at the same time; a message is of one alone. */
static void draw_in_turns(const copy *both, const char *path, uint64_t sum) {
    snow_context *contexts[2] = {NULL, NULL};
    snow_image *none = NULL;
    for (int k = 0; k < 2; k++)
        require(both[k].context_new(NULL, &contexts[k]) == SNOW_STATUS_OK,
                "a context");
    require(both[0].render_file(contexts[0], "absent.nrrd", NULL, NULL,
                                &none) != SNOW_STATUS_OK,
            "an absent file is refused");
    require(*both[0].message(contexts[0]), "the first says why");
    require(!*both[1].message(contexts[1]), "the second says nothing");
    for (int turn = 0; turn < 2 * TURNS; turn++)
        require(draw_in(&both[turn % 2], contexts[turn % 2], path) == sum,
                "in turns the pictures are the same");
    both[0].context_free(contexts[0]);
    require(draw_in(&both[1], contexts[1], path) == sum,
            "the second draws when the first's context is freed");
    both[1].context_free(contexts[1]);
}

static void *draw_some(void *user) {
    job *j = user;
    j->sum = draw(j->by, j->path);
    for (int turn = 1; turn < TURNS; turn++)
        require(draw(j->by, j->path) == j->sum,
                "a thread's pictures are the same");
    return NULL;
}

static void draw_at_once(const copy *both, const char *path, uint64_t sum) {
    job jobs[THREADS];
    for (int k = 0; k < THREADS; k++) {
        jobs[k] = (job){.by = &both[k % 2], .path = path};
        require(pthread_create(&jobs[k].thread, NULL, draw_some, &jobs[k]) == 0,
                "a thread");
    }
    for (int k = 0; k < THREADS; k++) {
        pthread_join(jobs[k].thread, NULL);
        require(jobs[k].sum == sum, "threads draw the same picture");
    }
}

/* What belongs to the process, and not to a library in it. */
static bool signals_are_default(void) {
    struct sigaction action;
    bool all = true;
    for (int number = 1; number < 32; number++)
        if (sigaction(number, NULL, &action) == 0)
            all = all && action.sa_handler == SIG_DFL;
    return all;
}

static bool is_loaded(const char *path) {
    void *library = dlopen(path, RTLD_NOW | RTLD_NOLOAD);
    if (library)
        dlclose(library);
    return library != NULL;
}

int main(int argc, char **argv) {
    if (argc < 4)
        return 2;
    bool untouched = signals_are_default();
    copy both[2] = {load(argv[1], argc > 4 ? RTLD_GLOBAL : RTLD_LOCAL),
                    load(argv[2], RTLD_LOCAL)};
    require(both[0].render_file != both[1].render_file, "these are two copies");
    uint64_t sum = draw(&both[0], argv[3]);
    draw_in_turns(both, argv[3], sum);
    draw_at_once(both, argv[3], sum);
    printf("%s %s\n", both[0].version(), both[1].version());
    dlclose(both[0].library);
    require(!is_loaded(argv[1]), "the first, closed, has left the memory");
    require(draw(&both[1], argv[3]) == sum,
            "the second draws without the first");
    dlclose(both[1].library);
    require(!is_loaded(argv[2]), "the second, closed, has left the memory");
    require(!untouched || signals_are_default(), "signals are left alone");
    return 0;
}
