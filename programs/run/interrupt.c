/* interrupt.c - the signal handlers; they only call functions that are safe in
 * a handler. */
#include "run/interrupt.h"
#include "options/options.h"

#include <errno.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/time.h>
#include <unistd.h>

/* Whether a file is being written, whether it belongs to a movie, whether
 * messages are off, and whether a signal has come.  Atomic, not only
 * sig_atomic_t: the handler may run in any thread. */
static atomic_int held, movie, mute, pending;

/* Whether all that was asked for is written. */
static atomic_int finished;

/* Handlers that run.  One in another thread may have seen the state before. */
static atomic_int running;

/* Where messages go. */
static atomic_int message_fd = STDERR_FILENO;

/* Whether the library asks; what SIGALRM did before. */
static atomic_int guarded;
static struct sigaction alarm_before;

/* The library did not stop in time. */
static void give_up(int signal_number) {
    (void)signal_number;
    if (guarded)
        _exit(EXIT_INTERRUPTED);
}

/* A system call, as safe in a handler as alarm(). */
static void set_timer(double seconds) {
    const struct itimerval value = {
        .it_value = {.tv_usec = (suseconds_t)(1e6 * seconds)}};
    setitimer(ITIMER_REAL, &value, NULL);
}

/* Only write and _exit here: printf and exit could meet a lock or a buffer that
 * the interrupted code has in hand. */
static void leave(int signal_number) {
    static const char text[] = "snowglass: interrupted\n";
    static const char later[] =
        "snowglass: interrupted; frames that are being written are ended first "
        "(a second signal ends them too)\n";
    int number = errno;
    ssize_t given = 0;
    (void)signal_number;
    if (finished)
        return;
    running++;
    bool again = (held || guarded) && atomic_exchange(&pending, 1);
    if (again || !held) {
        if (!mute && !(again && guarded))
            given = write(message_fd, text, sizeof text - 1);
        (void)given;
        if (again || !guarded)
            _exit(EXIT_INTERRUPTED);
        set_timer(INTERRUPT_SECONDS);
    }
    if (held && movie && !mute)
        given = write(message_fd, later, sizeof later - 1);
    (void)given;
    running--;
    errno = number;
}

/* Those that leave the process do not end. */
static void let_handlers_end(void) {
    while (running)
        sched_yield();
}

/* A signal that the parent has disabled (nohup) stays disabled. */
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
    /* If the reader goes away, the write fails and the exit code is 4. */
    signal(SIGPIPE, SIG_IGN);
    /* So does a write beyond the file size limit (ulimit -f); the writer then
     * removes the unfinished file. */
    signal(SIGXFSZ, SIG_IGN);
}

void interrupt_guard(void) {
    struct sigaction action = {.sa_handler = give_up, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(SIGALRM, &action, &alarm_before);
    guarded = 1;
}

bool interrupt_unguard(void) {
    guarded = 0;
    let_handlers_end();
    if (pending)
        set_timer(0);
    sigaction(SIGALRM, &alarm_before, NULL);
    return pending != 0;
}

bool interrupt_asked(void *unused) {
    (void)unused;
    return pending != 0;
}

void interrupt_hold(void) {
    held = 1;
    let_handlers_end();
}

void interrupt_finish(void) {
    finished = 1;
    let_handlers_end();
}

void interrupt_hold_movie(void) {
    movie = 1;
    interrupt_hold();
}

void interrupt_write_to(int descriptor) {
    message_fd = descriptor;
}

void interrupt_mute(void) {
    mute = 1;
}
