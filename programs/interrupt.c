/* interrupt.c - signal handlers that only use what is safe in them. */
#include "interrupt.h"
#include "options.h"

#include <errno.h>
#include <signal.h>
#include <stdatomic.h>
#include <unistd.h>

/* Whether a file is being written, whether that is one of many, and whether a
 * signal has come since.  Atomic, not only sig_atomic_t: the handler may run in
 * any thread. */
static atomic_int held, movie, mute, pending;

/* Only write and _exit here: printf and exit could meet a lock or a buffer that
 * the interrupted code has in hand. */
static void leave(int signal_number) {
    static const char text[] = "snowglass: interrupted\n";
    static const char later[] = "snowglass: interrupted; the frame in hand is "
                                "ended first (a second signal: at once)\n";
    int number = errno;
    ssize_t told = 0;
    (void)signal_number;
    if (!held || atomic_exchange(&pending, 1)) {
        if (!mute)
            told = write(STDERR_FILENO, text, sizeof text - 1);
        (void)told;
        _exit(EXIT_INTERRUPTED);
    }
    if (movie && !mute)
        told = write(STDERR_FILENO, later, sizeof later - 1);
    (void)told;
    errno = number;
}

/* A signal that the parent has switched off (nohup) stays so. */
static void listen_to(int signal_number) {
    struct sigaction action = {.sa_handler = leave, .sa_flags = SA_RESTART};
    struct sigaction old;
    sigemptyset(&action.sa_mask);
    if (sigaction(signal_number, NULL, &old) == 0 && old.sa_handler != SIG_IGN)
        sigaction(signal_number, &action, NULL);
}

void interrupt_install(void) {
    listen_to(SIGINT);
    listen_to(SIGTERM);
    listen_to(SIGHUP);
    /* A reader that went away is an error of the write, exit code 4. */
    signal(SIGPIPE, SIG_IGN);
    /* So is a file that grows beyond a limit (ulimit -f): the writer removes
     * what it has begun. */
    signal(SIGXFSZ, SIG_IGN);
}

void interrupt_hold(void) {
    held = 1;
}

void interrupt_hold_movie(void) {
    movie = 1;
    held = 1;
}

bool interrupt_seen(void) {
    return pending != 0;
}

void interrupt_mute(void) {
    mute = 1;
}
