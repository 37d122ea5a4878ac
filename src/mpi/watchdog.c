/* mpi/watchdog.c - finds ranks that do not answer, by notes between waiting
 * ranks. */
#include "mpi/watchdog.h"

#include <snowglass/extend.h>

#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

/* This many tests run before the processor is given to other processes. */
#define EAGER_TURNS 50

/* Waits longer than these seconds sleep between tests, a share of what they
 * have lasted, and at most so long: a rank that waits for a page, or for one
 * that reads, leaves its processor to others. */
#define AWAKE_SECONDS 0.02
#define SLEEP_SHARE 16
#define SLEEP_SECONDS 0.004

/* Waits of these seconds get a line. */
#define REPORT_SECONDS 20
#define REPORT_SECONDS_LEAST 8

/* The most notes in flight from a rank. Beyond that notes are not sent;
 * questions are asked again. */
#define NOTES 32

#define TEXT_BYTES 400
#define HOST_BYTES 64

enum { ASK, ANSWER, VERDICT };

typedef struct note {
    int kind;
    int waits_for;         /* of an ANSWER: a rank */
    double waited;         /* of an ANSWER: seconds */
    char text[TEXT_BYTES]; /* of a VERDICT */
} note;

/* The host and process of a rank. */
typedef struct place {
    int process;
    char host[HOST_BYTES];
} place;

struct mpi_watchdog {
    snow_context *context;
    MPI_Comm group; /* a duplicate, or MPI_COMM_NULL */
    int rank, ranks;
    double limit;
    place *places;           /* of all ranks */
    unsigned char *answered; /* of all ranks, in this round of questions */
    /* The current wait: when it began, and after this rank was stopped, this
     * round of questions, the last questions, and when the verdict was sent;
     * seconds, 0: not yet. */
    double began, since, round, asked, given;
    double looked; /* last check for notes */
    double turned; /* time of the last turn */
    bool reported; /* that a rank is waited for */
    int64_t turns;
    int waits_for; /* a rank */
    char verdict[TEXT_BYTES];
    MPI_Request sent[NOTES];
    note notes[NOTES]; /* until they are sent */
};

/* --- making --------------------------------------------------------------- */

static int share_places(mpi_watchdog *watchdog) {
    char name[MPI_MAX_PROCESSOR_NAME + 1] = "";
    place mine = {.process = (int)getpid()};
    int length = 0;
    MPI_Get_processor_name(name, &length);
    snprintf(mine.host, sizeof mine.host, "%.*s", HOST_BYTES - 1, name);
    return MPI_Allgather(&mine, (int)sizeof mine, MPI_BYTE, watchdog->places,
                         (int)sizeof mine, MPI_BYTE, watchdog->group);
}

snow_status snow_watchdog_new(snow_context *context, MPI_Comm group,
                              mpi_watchdog **out) {
    int rank = 0, ranks = 1;
    MPI_Comm_rank(group, &rank);
    MPI_Comm_size(group, &ranks);
    mpi_watchdog *watchdog = snow_context_allocate(context, sizeof *watchdog);
    if (watchdog) {
        memset(watchdog, 0, sizeof *watchdog);
        watchdog->context = context;
        watchdog->group = MPI_COMM_NULL;
        watchdog->rank = rank;
        watchdog->ranks = ranks;
        for (int i = 0; i < NOTES; i++)
            watchdog->sent[i] = MPI_REQUEST_NULL;
        watchdog->places =
            snow_context_allocate(context, (size_t)ranks * sizeof(place));
        watchdog->answered = snow_context_allocate(context, (size_t)ranks);
    }
    *out = watchdog;
    const bool mine = watchdog && watchdog->places && watchdog->answered;
    int has = mine, all = 0;
    if (!(MPI_Allreduce(&has, &all, 1, MPI_INT, MPI_MIN, group) ==
              MPI_SUCCESS &&
          all))
        return mine ? snow_context_fail(
                          context, SNOW_STATUS_NO_MEMORY, "another rank: %s",
                          snow_status_description(SNOW_STATUS_NO_MEMORY))
                    : SNOW_STATUS_NO_MEMORY;
    if (MPI_Comm_dup(group, &watchdog->group) != MPI_SUCCESS)
        return snow_context_fail(context, SNOW_STATUS_FAILED,
                                 "MPI cannot duplicate the group");
    MPI_Comm_set_errhandler(watchdog->group, MPI_ERRORS_RETURN);
    if (share_places(watchdog) != MPI_SUCCESS)
        return snow_context_fail(
            context, SNOW_STATUS_FAILED,
            "MPI cannot determine where its processes run");
    return SNOW_STATUS_OK;
}

/* Unread notes are not needed any more. */
void snow_watchdog_free(mpi_watchdog *watchdog, bool orderly) {
    if (!watchdog)
        return;
    if (orderly && watchdog->group != MPI_COMM_NULL) {
        for (int i = 0; i < NOTES; i++)
            if (watchdog->sent[i] != MPI_REQUEST_NULL)
                MPI_Request_free(&watchdog->sent[i]);
        MPI_Comm_free(&watchdog->group);
    }
    snow_context_release(watchdog->context, watchdog->places);
    snow_context_release(watchdog->context, watchdog->answered);
    snow_context_release(watchdog->context, watchdog);
}

void snow_watchdog_limit(mpi_watchdog *watchdog, double seconds) {
    watchdog->limit = seconds > 0 ? seconds : 0;
}

/* --- notes ---------------------------------------------------------------- */

static void send_note(mpi_watchdog *watchdog, int to, const note *what) {
    for (int i = 0; i < NOTES; i++) {
        int done = 1;
        if (watchdog->sent[i] != MPI_REQUEST_NULL)
            MPI_Test(&watchdog->sent[i], &done, MPI_STATUS_IGNORE);
        if (!done)
            continue;
        watchdog->notes[i] = *what;
        MPI_Isend(&watchdog->notes[i], (int)sizeof *what, MPI_BYTE, to, 0,
                  watchdog->group, &watchdog->sent[i]);
        return;
    }
}

/* Handles an answer of a waiting rank. If all wait for longer than the timeout
 * of a rank that does not answer, they wait for each other. */
static void take_answer(mpi_watchdog *watchdog, int from, const note *what) {
    watchdog->answered[from] = 1;
    if (what->waited > 3 * watchdog->limit)
        snow_text_print(
            watchdog->verdict, sizeof watchdog->verdict,
            "rank %d waits for rank %d, and that for rank %d, for %.3g s "
            "and more: all ranks must make the same calls",
            watchdog->rank, from, what->waits_for, what->waited);
}

/* Reads what has come. */
static void read_notes(mpi_watchdog *watchdog, double now) {
    MPI_Status status;
    int there = 0;
    watchdog->looked = now;
    while (MPI_Iprobe(MPI_ANY_SOURCE, 0, watchdog->group, &there, &status) ==
               MPI_SUCCESS &&
           there) {
        const int from = status.MPI_SOURCE;
        note what;
        if (MPI_Recv(&what, (int)sizeof what, MPI_BYTE, from, 0,
                     watchdog->group, MPI_STATUS_IGNORE) != MPI_SUCCESS)
            return;
        if (what.kind == ASK)
            send_note(watchdog, from,
                      &(note){.kind = ANSWER,
                              .waits_for = watchdog->waits_for,
                              .waited = now - watchdog->since});
        else if (what.kind == ANSWER)
            take_answer(watchdog, from, &what);
        else
            memcpy(watchdog->verdict, what.text, sizeof watchdog->verdict);
    }
}

static void ask_all(mpi_watchdog *watchdog, const int *peers, int count,
                    double now) {
    if (watchdog->asked <= 0)
        memset(watchdog->answered, 0, (size_t)watchdog->ranks);
    watchdog->asked = now;
    for (int i = 0; i < count; i++)
        if (!watchdog->answered[peers[i]] && peers[i] != watchdog->rank)
            send_note(watchdog, peers[i], &(note){.kind = ASK});
}

/* --- the verdict ---------------------------------------------------------- */

/* The state of a process on this machine, by the letter in Linux's
 * /proc/PID/stat that follows the name in parentheses. */
static char state_of(const mpi_watchdog *watchdog, int rank) {
    const place *there = &watchdog->places[rank];
    char path[64], line[512] = "";
    if (strcmp(there->host, watchdog->places[watchdog->rank].host) != 0)
        return 0;
    snprintf(path, sizeof path, "/proc/%d/stat", there->process);
    FILE *file = fopen(path, "r");
    if (!file)
        return 0;
    line[fread(line, 1, sizeof line - 1, file)] = 0;
    fclose(file);
    const char *end = strrchr(line, ')');
    return end && end[1] == ' ' ? end[2] : 0;
}

#define ALLOW_LONGER "allow a longer timeout (--timeout, snow_comm_set_timeout)"

static const char *guess(char state) {
    if (state == 'T' || state == 't')
        return "it is stopped; let it continue (kill -CONT)";
    if (state == 'R')
        return "it works or hangs; if it works, " ALLOW_LONGER;
    if (state == 'S' || state == 'D')
        return "it sleeps, or waits for a disk; if that is slow, " ALLOW_LONGER;
    return "it is stopped, hangs or works; if it works, " ALLOW_LONGER;
}

static bool is_stopped(const mpi_watchdog *watchdog, int rank) {
    const char state = state_of(watchdog, rank);
    return state == 'T' || state == 't';
}

/* A stopped rank on this machine is the reason even if another one is silent:
 * if it was stopped while writing to memory that they share, the other one
 * receives no notes and cannot answer. */
static int find_reason(const mpi_watchdog *watchdog, int silent) {
    if (is_stopped(watchdog, silent))
        return silent;
    for (int rank = 0; rank < watchdog->ranks; rank++)
        if (is_stopped(watchdog, rank))
            return rank;
    return silent;
}

/* Reports `silent` ranks, the first of which is given. */
static void set_verdict(mpi_watchdog *watchdog, int first, int silent) {
    const int reason = find_reason(watchdog, first);
    const place *there = &watchdog->places[reason];
    char others[48] = "";
    if (silent > 1 && reason == first)
        snprintf(others, sizeof others, " and %d more %s", silent - 1,
                 silent > 2 ? "ranks" : "rank");
    snow_text_print(
        watchdog->verdict, sizeof watchdog->verdict,
        "rank %d (process %d on %s)%s: rank %d has waited %.3g s, and got "
        "no answer: %s",
        reason, there->process, there->host, others, watchdog->rank,
        watchdog->limit, guess(state_of(watchdog, reason)));
}

/* Names those of `peers` that have not answered, each once; returns their
 * number, and the lowest rank that is not among them. */
static int name_silent(mpi_watchdog *watchdog, const int *peers, int count,
                       int *speaker) {
    int silent = 0, first = -1;
    *speaker = 0;
    for (int rank = 0; rank < watchdog->ranks; rank++) {
        bool awaited = false;
        for (int i = 0; i < count && !awaited; i++)
            awaited = peers[i] == rank;
        if (!awaited || watchdog->answered[rank] || rank == watchdog->rank)
            continue;
        if (!silent++)
            first = rank;
        if (rank == *speaker)
            (*speaker)++;
    }
    if (silent)
        set_verdict(watchdog, first, silent);
    return silent;
}

/* All are well: starts a new round of questions. */
static void ask_anew(mpi_watchdog *watchdog, double now) {
    watchdog->round = now;
    watchdog->asked = watchdog->given = 0;
}

/* Decides after the timeout. */
static void judge(mpi_watchdog *watchdog, const int *peers, int count,
                  double now) {
    int speaker = 0;
    note what = {.kind = VERDICT};
    if (!name_silent(watchdog, peers, count, &speaker)) {
        ask_anew(watchdog, now);
        return;
    }
    watchdog->given = now;
    if (speaker == watchdog->rank)
        return;
    memcpy(what.text, watchdog->verdict, sizeof what.text);
    watchdog->verdict[0] = 0; /* wait as long again for the speaker's */
    send_note(watchdog, speaker, &what);
}

/* --- waiting -------------------------------------------------------------- */

static snow_status give_verdict(const mpi_watchdog *watchdog) {
    return watchdog->verdict[0]
               ? snow_context_fail(watchdog->context, SNOW_STATUS_FAILED, "%s",
                                   watchdog->verdict)
               : SNOW_STATUS_OK;
}

/* Once a job, long before the timeout, unless that comes soon.  The rank that
 * is waited for may wait itself, for one that is stopped. */
static void report_wait(mpi_watchdog *watchdog, double now) {
    const double half = watchdog->limit / 2;
    if (watchdog->reported || half < REPORT_SECONDS_LEAST ||
        now - watchdog->since < (half < REPORT_SECONDS ? half : REPORT_SECONDS))
        return;
    watchdog->reported = true;
    const int reason = find_reason(watchdog, watchdog->waits_for);
    const place *there = &watchdog->places[reason];
    snow_context_warn(watchdog->context,
                      "rank %d waits for rank %d (process %d on %s), as others "
                      "may; if that does not answer, the job ends after %.3g s "
                      "(--timeout)",
                      watchdog->rank, reason, there->process, there->host,
                      watchdog->limit);
}

/* A rank that never waits long is asked too, and looks for notes at times. */
snow_status snow_watchdog_begin(mpi_watchdog *watchdog) {
    double now = MPI_Wtime();
    watchdog->turns = 0;
    watchdog->began = watchdog->since = watchdog->round = watchdog->turned =
        now;
    if (watchdog->limit <= 0)
        return SNOW_STATUS_OK;
    watchdog->asked = watchdog->given = 0;
    if (now - watchdog->looked > watchdog->limit / 16)
        read_notes(watchdog, now);
    return give_verdict(watchdog);
}

/* Lets other processes run, in a wait that has lasted some seconds. */
static void rest(double waited) {
    const double share = waited / SLEEP_SHARE;
    const struct timespec some = {
        .tv_nsec =
            (long)(1e9 * (share < SLEEP_SECONDS ? share : SLEEP_SECONDS))};
    if (waited > AWAKE_SECONDS)
        nanosleep(&some, NULL);
    else
        sched_yield();
}

snow_status snow_watchdog_turn(mpi_watchdog *watchdog, const int *peers,
                               int count) {
    if (++watchdog->turns < EAGER_TURNS)
        return SNOW_STATUS_OK;
    const double now = MPI_Wtime(), limit = watchdog->limit;
    rest(now - watchdog->began);
    if (limit <= 0)
        return SNOW_STATUS_OK;
    watchdog->waits_for = peers[0];
    if (now - watchdog->turned > limit / 8) /* this rank itself was stopped */
        watchdog->since = watchdog->round = now;
    watchdog->turned = now;
    report_wait(watchdog, now);
    if (now - watchdog->looked > (limit < 6.4 ? limit / 64 : 0.1))
        read_notes(watchdog, now);
    if (watchdog->given > 0) {
        if (now - watchdog->given > limit &&
            !name_silent(watchdog, peers, count, &(int){0}))
            ask_anew(watchdog, now);
    } else if (now - watchdog->round > limit) {
        judge(watchdog, peers, count, now);
    } else if (now - watchdog->round > limit / 2 &&
               now - watchdog->asked > limit / 8) {
        ask_all(watchdog, peers, count, now);
    }
    return give_verdict(watchdog);
}
