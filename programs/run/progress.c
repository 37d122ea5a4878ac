/* progress.c - how far a long stage is. */
#include "run/interrupt.h"
#include "run/log.h"

#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <time.h>

/* Seconds between two reports of a long stage: on a terminal, elsewhere. */
#define LIVE_SECONDS 1
#define LINE_SECONDS 10

/* The thread that reports it; only one stage is active at a time. */
static struct {
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t ended;
    bool running, ending;
    const options *opts;
    const char *stage;
    double begin;
    double fraction; /* of it, as far as the library has said; below 0: not */
} clock_of_stage = {.lock = PTHREAD_MUTEX_INITIALIZER,
                    .ended = PTHREAD_COND_INITIALIZER};

#define BAR_CELLS 20

void progress_bar(double fraction, char *out, size_t size) {
    char bar[BAR_CELLS + 1] = "";
    int full = (int)(fraction * BAR_CELLS);
    for (int i = 0; i < BAR_CELLS; i++)
        bar[i] = i < full ? '#' : '-';
    snprintf(out, size, "[%s] ", bar);
}

/* "[####----------------] reading, 22 %, 3 s" (under the lock). */
static void report_stage(void) {
    char bar[BAR_CELLS + 4] = "", share[16] = "", line[80];
    if (clock_of_stage.fraction >= 0)
        snprintf(share, sizeof share, ", %.0f %%",
                 100 * clock_of_stage.fraction);
    if (clock_of_stage.fraction >= 0 && progress_is_live())
        progress_bar(clock_of_stage.fraction, bar, sizeof bar);
    snprintf(line, sizeof line, "%s%s%s, %.0f s", bar, clock_of_stage.stage,
             share, seconds_now() - clock_of_stage.begin);
    if (progress_is_live())
        progress(clock_of_stage.opts, line);
    else
        say("%s", line);
}

static void *watch_stage(void *unused) {
    (void)unused;
    pthread_mutex_lock(&clock_of_stage.lock);
    while (!clock_of_stage.ending) {
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_sec += progress_is_live() ? LIVE_SECONDS : LINE_SECONDS;
        if (pthread_cond_timedwait(&clock_of_stage.ended, &clock_of_stage.lock,
                                   &until) == ETIMEDOUT &&
            !clock_of_stage.ending)
            report_stage();
    }
    pthread_mutex_unlock(&clock_of_stage.lock);
    return NULL;
}

/* Signals are handled by the thread that waits for them. */
void progress_begin(const options *opts, const char *stage) {
    sigset_t all, before;
    progress(opts, stage);
    if (!progress_is_wanted(opts))
        return;
    clock_of_stage.opts = opts;
    clock_of_stage.stage = stage;
    clock_of_stage.begin = seconds_now();
    clock_of_stage.fraction = -1;
    clock_of_stage.ending = false;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    clock_of_stage.running =
        pthread_create(&clock_of_stage.thread, NULL, watch_stage, NULL) == 0;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

void progress_end(const options *opts) {
    if (clock_of_stage.running) {
        pthread_mutex_lock(&clock_of_stage.lock);
        clock_of_stage.ending = true;
        pthread_cond_signal(&clock_of_stage.ended);
        pthread_mutex_unlock(&clock_of_stage.lock);
        pthread_join(clock_of_stage.thread, NULL);
        clock_of_stage.running = false;
    }
    progress(opts, NULL);
}

bool progress_show(void *unused, snow_stage stage, double fraction) {
    static const char *const names[] = {[SNOW_STAGE_READ] = "reading",
                                        [SNOW_STAGE_ENCODE] = "encoding",
                                        [SNOW_STAGE_RENDER] = "rendering",
                                        [SNOW_STAGE_WRITE] = "writing"};
    (void)unused;
    pthread_mutex_lock(&clock_of_stage.lock);
    if (clock_of_stage.running) {
        clock_of_stage.stage = names[stage];
        clock_of_stage.fraction = fraction;
        if (progress_is_live())
            report_stage();
    }
    pthread_mutex_unlock(&clock_of_stage.lock);
    /* What is being written is let go (interrupt.h). */
    return stage != SNOW_STAGE_WRITE && interrupt_asked(NULL);
}
