/* mpi/watch.c - notes between ranks that wait. */
#include "mpi/watch.h"

#include <sched.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* So many tests come at once before the processor is given to others. */
#define EAGER_TURNS 50

/* Notes that may be under way from a rank.  Where there are more, some are not
 * sent; questions are asked again. */
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

/* Where a rank is. */
typedef struct place {
    int process;
    char host[HOST_BYTES];
} place;

struct mpi_watch {
    snow_context *context;
    MPI_Comm group; /* a duplicate, MPI_COMM_NULL: there is none */
    int rank, ranks;
    double limit;
    place *places;           /* of all ranks */
    unsigned char *answered; /* of all ranks, in this round of questions */
    /* The wait under way: when it began, this round, the last questions, and
     * when the others were told; seconds, 0: not yet. */
    double since, round, asked, told;
    double looked; /* for notes, last */
    double turned; /* when the last turn was */
    int64_t turns;
    int waits_for; /* a rank */
    char verdict[TEXT_BYTES];
    MPI_Request sent[NOTES];
    note notes[NOTES]; /* as long as they are under way */
};

/* --- making --------------------------------------------------------------- */

static int share_places(mpi_watch *watch) {
    char name[MPI_MAX_PROCESSOR_NAME + 1] = "";
    place mine = {.process = (int)getpid()};
    int length = 0;
    MPI_Get_processor_name(name, &length);
    snprintf(mine.host, sizeof mine.host, "%.*s", HOST_BYTES - 1, name);
    return MPI_Allgather(&mine, (int)sizeof mine, MPI_BYTE, watch->places,
                         (int)sizeof mine, MPI_BYTE, watch->group);
}

/* All ranks find memory, or none goes on. */
static bool all_have(MPI_Comm group, bool mine) {
    int has = mine, all = 0;
    return MPI_Allreduce(&has, &all, 1, MPI_INT, MPI_MIN, group) ==
               MPI_SUCCESS &&
           all;
}

snow_status snow_watch_new(snow_context *context, MPI_Comm group,
                           mpi_watch **out) {
    int rank = 0, ranks = 1;
    MPI_Comm_rank(group, &rank);
    MPI_Comm_size(group, &ranks);
    mpi_watch *watch = snow_context_allocate(context, sizeof *watch);
    if (watch) {
        memset(watch, 0, sizeof *watch);
        watch->context = context;
        watch->group = MPI_COMM_NULL;
        watch->rank = rank;
        watch->ranks = ranks;
        for (int i = 0; i < NOTES; i++)
            watch->sent[i] = MPI_REQUEST_NULL;
        watch->places =
            snow_context_allocate(context, (size_t)ranks * sizeof(place));
        watch->answered = snow_context_allocate(context, (size_t)ranks);
    }
    *out = watch;
    const bool mine = watch && watch->places && watch->answered;
    if (!all_have(group, mine))
        return mine ? snow_context_fail(context, SNOW_NO_MEMORY,
                                        "another rank: %s",
                                        snow_status_text(SNOW_NO_MEMORY))
                    : SNOW_NO_MEMORY;
    if (MPI_Comm_dup(group, &watch->group) != MPI_SUCCESS)
        return snow_context_fail(context, SNOW_FAILED,
                                 "MPI cannot duplicate the group");
    MPI_Comm_set_errhandler(watch->group, MPI_ERRORS_RETURN);
    if (share_places(watch) != MPI_SUCCESS)
        return snow_context_fail(context, SNOW_FAILED,
                                 "MPI cannot tell where its processes run");
    return SNOW_OK;
}

/* Notes that nobody read are of no use any more. */
void snow_watch_free(mpi_watch *watch, bool orderly) {
    if (!watch)
        return;
    if (orderly && watch->group != MPI_COMM_NULL) {
        for (int i = 0; i < NOTES; i++)
            if (watch->sent[i] != MPI_REQUEST_NULL)
                MPI_Request_free(&watch->sent[i]);
        MPI_Comm_free(&watch->group);
    }
    snow_context_release(watch->context, watch->places);
    snow_context_release(watch->context, watch->answered);
    snow_context_release(watch->context, watch);
}

void snow_watch_limit(mpi_watch *watch, double seconds) {
    watch->limit = seconds > 0 ? seconds : 0;
}

/* --- notes ---------------------------------------------------------------- */

static void send_note(mpi_watch *watch, int to, const note *what) {
    for (int i = 0; i < NOTES; i++) {
        int done = 1;
        if (watch->sent[i] != MPI_REQUEST_NULL)
            MPI_Test(&watch->sent[i], &done, MPI_STATUS_IGNORE);
        if (!done)
            continue;
        watch->notes[i] = *what;
        MPI_Isend(&watch->notes[i], (int)sizeof *what, MPI_BYTE, to, 0,
                  watch->group, &watch->sent[i]);
        return;
    }
}

/* A rank that has answered, and waits.  Where all wait for longer than any of
 * them would for one that does not answer, they wait for one another. */
static void hear_answer(mpi_watch *watch, int from, const note *what) {
    watch->answered[from] = 1;
    if (what->waited > 3 * watch->limit)
        snprintf(watch->verdict, sizeof watch->verdict,
                 "rank %d waits for rank %d, and that for rank %d, for %.3g s "
                 "and more; the ranks do different things",
                 watch->rank, from, what->waits_for, what->waited);
}

/* Reads what has come. */
static void read_notes(mpi_watch *watch, double now) {
    MPI_Status status;
    int there = 0;
    watch->looked = now;
    while (MPI_Iprobe(MPI_ANY_SOURCE, 0, watch->group, &there, &status) ==
               MPI_SUCCESS &&
           there) {
        const int from = status.MPI_SOURCE;
        note what;
        if (MPI_Recv(&what, (int)sizeof what, MPI_BYTE, from, 0, watch->group,
                     MPI_STATUS_IGNORE) != MPI_SUCCESS)
            return;
        if (what.kind == ASK)
            send_note(watch, from,
                      &(note){.kind = ANSWER,
                              .waits_for = watch->waits_for,
                              .waited = now - watch->since});
        else if (what.kind == ANSWER)
            hear_answer(watch, from, &what);
        else
            memcpy(watch->verdict, what.text, sizeof watch->verdict);
    }
}

static void ask_all(mpi_watch *watch, const int *peers, int count, double now) {
    if (watch->asked <= 0)
        memset(watch->answered, 0, (size_t)watch->ranks);
    watch->asked = now;
    for (int i = 0; i < count; i++)
        if (!watch->answered[peers[i]] && peers[i] != watch->rank)
            send_note(watch, peers[i], &(note){.kind = ASK});
}

/* --- the verdict ---------------------------------------------------------- */

/* What a process of this machine does, by the letter of Linux's
 * /proc/PID/stat, which follows the name in parentheses. */
static char state_of(const mpi_watch *watch, int rank) {
    const place *there = &watch->places[rank];
    char path[64], line[512] = "";
    if (strcmp(there->host, watch->places[watch->rank].host) != 0)
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

static const char *guess(char state) {
    if (state == 'T' || state == 't')
        return "it is stopped; let it go on (kill -CONT)";
    if (state == 'R')
        return "it works or hangs; if it works, allow a longer timeout";
    if (state == 'S' || state == 'D')
        return "it sleeps, or waits for a disk; if that is slow, allow a "
               "longer timeout";
    return "it is stopped, hangs or works; if it works, allow a longer timeout";
}

static bool is_stopped(const mpi_watch *watch, int rank) {
    const char state = state_of(watch, rank);
    return state == 'T' || state == 't';
}

/* A rank of this machine that is stopped is the reason though another one is
 * silent: where it was stopped while it wrote into memory that they share, that
 * one gets no notes, and so cannot answer. */
static int find_reason(const mpi_watch *watch, int silent) {
    if (is_stopped(watch, silent))
        return silent;
    for (int rank = 0; rank < watch->ranks; rank++)
        if (is_stopped(watch, rank))
            return rank;
    return silent;
}

/* What is told of `silent` ranks, of which the first is given. */
static void set_verdict(mpi_watch *watch, int first, int silent) {
    const int reason = find_reason(watch, first);
    const place *there = &watch->places[reason];
    char others[48] = "";
    if (silent > 1 && reason == first)
        snprintf(others, sizeof others, " and %d more %s", silent - 1,
                 silent > 2 ? "ranks" : "rank");
    snprintf(watch->verdict, sizeof watch->verdict,
             "rank %d (process %d on %s)%s: rank %d has waited %.3g s, and got "
             "no answer: %s",
             reason, there->process, there->host, others, watch->rank,
             watch->limit, guess(state_of(watch, reason)));
}

/* Names those of `peers` that have not answered, each once; how many, and the
 * lowest rank that is none of them. */
static int name_silent(mpi_watch *watch, const int *peers, int count,
                       int *speaker) {
    int silent = 0, first = -1;
    *speaker = 0;
    for (int rank = 0; rank < watch->ranks; rank++) {
        bool awaited = false;
        for (int i = 0; i < count && !awaited; i++)
            awaited = peers[i] == rank;
        if (!awaited || watch->answered[rank] || rank == watch->rank)
            continue;
        if (!silent++)
            first = rank;
        if (rank == *speaker)
            (*speaker)++;
    }
    if (silent)
        set_verdict(watch, first, silent);
    return silent;
}

/* All are well. */
static void ask_anew(mpi_watch *watch, double now) {
    watch->round = now;
    watch->asked = watch->told = 0;
}

/* The timeout is over. */
static void judge(mpi_watch *watch, const int *peers, int count, double now) {
    int speaker = 0;
    note what = {.kind = VERDICT};
    if (!name_silent(watch, peers, count, &speaker)) {
        ask_anew(watch, now);
        return;
    }
    watch->told = now;
    if (speaker == watch->rank)
        return;
    memcpy(what.text, watch->verdict, sizeof what.text);
    watch->verdict[0] = 0; /* the speaker's, for as long again */
    send_note(watch, speaker, &what);
}

/* --- waiting -------------------------------------------------------------- */

static snow_status give_verdict(const mpi_watch *watch) {
    return watch->verdict[0] ? snow_context_fail(watch->context, SNOW_FAILED,
                                                 "%s", watch->verdict)
                             : SNOW_OK;
}

/* Who never waits long is asked too, and looks for notes now and then. */
snow_status snow_watch_begin(mpi_watch *watch) {
    watch->turns = 0;
    if (watch->limit <= 0)
        return SNOW_OK;
    double now = MPI_Wtime();
    watch->since = watch->round = watch->turned = now;
    watch->asked = watch->told = 0;
    if (now - watch->looked > watch->limit / 16)
        read_notes(watch, now);
    return give_verdict(watch);
}

snow_status snow_watch_turn(mpi_watch *watch, const int *peers, int count) {
    if (++watch->turns < EAGER_TURNS)
        return SNOW_OK;
    sched_yield();
    if (watch->limit <= 0)
        return SNOW_OK;
    const double now = MPI_Wtime(), limit = watch->limit;
    watch->waits_for = peers[0];
    if (now - watch->turned > limit / 8) /* this rank itself was stopped */
        watch->since = watch->round = now;
    watch->turned = now;
    if (now - watch->looked > (limit < 6.4 ? limit / 64 : 0.1))
        read_notes(watch, now);
    if (watch->told > 0) {
        if (now - watch->told > limit &&
            !name_silent(watch, peers, count, &(int){0}))
            ask_anew(watch, now);
    } else if (now - watch->round > limit) {
        judge(watch, peers, count, now);
    } else if (now - watch->round > limit / 2 &&
               now - watch->asked > limit / 8) {
        ask_all(watch, peers, count, now);
    }
    return give_verdict(watch);
}
