/* modules_threads.c - a program over the shared library that opens files in
 * many threads at once: modules_threads FILE...
 *
 * Each file is opened by THREADS threads, each with its own context, all of
 * which wait for one another first: whichever comes first loads the module.
 * Fails with the first message. */
#include <pthread.h>
#include <snowglass/snowglass.h>
#include <stdio.h>

#define THREADS 3
#define MOST_FILES 16

static pthread_barrier_t barrier;

/* One opening; the message is empty when it went well. */
typedef struct job {
    pthread_t thread;
    const char *path;
    char message[1000];
} job;

static void *open_file(void *user) {
    job *j = user;
    snow_context *context = NULL;
    snow_volume *volume = NULL;
    snow_status status = snow_context_new(NULL, &context);
    pthread_barrier_wait(&barrier);
    if (status == SNOW_STATUS_OK)
        status = snow_volume_open(context, j->path, NULL, &volume);
    if (status != SNOW_STATUS_OK)
        snprintf(j->message, sizeof j->message, "%s",
                 context ? snow_context_message(context) : "no context");
    snow_volume_close(volume);
    snow_context_free(context);
    return NULL;
}

int main(int argc, char **argv) {
    job jobs[THREADS * MOST_FILES] = {0};
    size_t count = (size_t)(argc - 1) * THREADS;
    int wrong = 0;
    if (argc < 2 || argc > 1 + MOST_FILES)
        return 2;
    pthread_barrier_init(&barrier, NULL, (unsigned)count);
    for (size_t i = 0; i < count; i++) {
        jobs[i].path = argv[1 + i / THREADS];
        if (pthread_create(&jobs[i].thread, NULL, open_file, &jobs[i]) != 0)
            return 2;
    }
    for (size_t i = 0; i < count; i++) {
        pthread_join(jobs[i].thread, NULL);
        if (*jobs[i].message && !wrong++)
            fprintf(stderr, "modules_threads: %s\n", jobs[i].message);
    }
    pthread_barrier_destroy(&barrier);
    return wrong ? 1 : 0;
}
