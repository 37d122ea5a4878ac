/* interrupt.c - signal handlers that only use what is safe in them. */
#include "interrupt.h"
#include "options.h"

#include <signal.h>
#include <unistd.h>

/* Whether a file is being written, and whether a signal has come since. */
static volatile sig_atomic_t held, pending;

/* Only write and _exit here: printf and exit could meet a lock or a buffer that
 * the interrupted code has in hand. */
static void leave(int signal_number) {
    static const char text[] = "snowglass: interrupted\n";
    (void)signal_number;
    if (held && !pending) {
        pending = 1;
        return;
    }
    ssize_t told = write(STDERR_FILENO, text, sizeof text - 1);
    (void)told;
    _exit(EXIT_INTERRUPTED);
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
