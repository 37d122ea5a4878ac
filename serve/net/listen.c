/* listen.c - implements listen.h. */
#define _GNU_SOURCE /* accept4 */
#include "net/listen.h"
#include "answers/answers.h"
#include "message.h"
#include "net/client.h"
#include "net/download.h"
#include "net/pages.h"
#include "net/sizes.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

/* Reasons of a close, for the page, which tries again after CLOSE_LATE: its
 * machine was busy. */
enum {
    CLOSE_BAD = 4400,
    CLOSE_SECRET = 4401,
    CLOSE_LATE = 4408,
    CLOSE_MANY = 4429
};

struct listener {
    struct lws_context *context;
    struct lws_vhost *vhost;
    guard guard;
    viewer_state *state;
    outbox *box;
    movie_job *job; /* NULL: no movies */
    client *clients;
    int count;
    uint64_t last_id;
    struct lws *silent[LISTEN_SILENT_MOST]; /* the oldest first */
    int silent_count;
    listener_hear *hear; /* or NULL */
    void *hearer;
    double idle;
    lws_sorted_usec_list_t idle_timer;
    atomic_bool ended;
};

static listener *of(struct lws *wsi) {
    return lws_context_user(lws_get_context(wsi));
}

/* --- connections without a hello -------------------------------------------
 */

static bool forget_silent(listener *l, struct lws *wsi) {
    for (int i = 0; i < l->silent_count; i++) {
        if (l->silent[i] != wsi)
            continue;
        l->silent_count--;
        memmove(l->silent + i, l->silent + i + 1,
                (size_t)(l->silent_count - i) * sizeof *l->silent);
        return true;
    }
    return false;
}

/* Counts a connection as the newest silent one, with its time limit. */
static void note_silent(listener *l, struct lws *wsi, int seconds) {
    forget_silent(l, wsi);
    if (l->silent_count == LISTEN_SILENT_MOST) {
        struct lws *oldest = l->silent[0];
        forget_silent(l, oldest);
        lws_set_timeout(oldest, PENDING_TIMEOUT_CLOSE_SEND, LWS_TO_KILL_SYNC);
    }
    l->silent[l->silent_count++] = wsi;
    lws_set_timer_usecs(wsi, seconds * LWS_USEC_PER_SEC);
}

/* All that wait are taken, so that none waits for another event. */
static void accept_all(listener *l, int fd) {
    const int on = 1;
    for (;;) {
        lws_sock_file_fd_type taken = {
            .sockfd = accept4(fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK)};
        if (taken.sockfd < 0)
            return;
        setsockopt(taken.sockfd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        struct lws *wsi = lws_adopt_descriptor_vhost(
            l->vhost, LWS_ADOPT_SOCKET | LWS_ADOPT_HTTP, taken, NULL, NULL);
        if (wsi)
            note_silent(l, wsi, LISTEN_REQUEST_SECONDS);
    }
}

/* --- pages
 * -------------------------------------------------------------------- */

static void end_when_idle(lws_sorted_usec_list_t *timer) {
    listener_stop(lws_container_of(timer, listener, idle_timer));
}

/* Pages whose links are not thin share one picture, which suits the slowest of
 * them: a third and a fourth would take the processor from the drawing.  The
 * picture at rest is without loss for all. */
static void count_links(listener *l) {
    int thin = 0, quality = 0;
    for (const client *c = l->clients; c; c = c->next) {
        int own = client_quality(c);
        thin += c->thin;
        if (!c->thin && (!quality || own < quality))
            quality = own;
    }
    outbox_set_audience(l->box, l->count - thin, thin, quality);
}

/* The clock of idleness runs while there is no page. */
static void count_clients(listener *l, int change) {
    bool moving = false;
    l->count += change;
    for (const client *c = l->clients; c; c = c->next)
        moving = moving || c->moving;
    count_links(l);
    sizes_collect(l->clients, l->state);
    state_set_watchers(l->state, l->count);
    if (l->job)
        job_note_pages(l->job, l->count);
    if (!moving && change < 0)
        state_set_moving(l->state, false);
    if (l->count)
        lws_sul_cancel(&l->idle_timer);
    else if (l->idle > 0)
        lws_sul_schedule(l->context, 0, &l->idle_timer, end_when_idle,
                         (lws_usec_t)(l->idle * 1e6));
}

static int close_with(struct lws *wsi, int reason, const char *text) {
    unsigned char scratch[LWS_PRE + 124];
    size_t length = strlen(text);
    length = length < 120 ? length : 120;
    memcpy(scratch + LWS_PRE, text, length);
    lws_close_reason(wsi, (enum lws_close_status)reason, scratch + LWS_PRE,
                     length);
    return -1;
}

static void queue_newest(listener *l, client *c, message_topic about) {
    outgoing *p = outbox_newest(l->box, about);
    if (!p)
        return;
    client_queue(c, l->box, p);
    outgoing_release(l->box, p);
}

static void send_state(listener *l, uint64_t to, uint64_t except) {
    outbox_put(l->box, state_message(l->state, to, except));
}

static int greet(listener *l, client *c, const message *m) {
    if (!guard_token(&l->guard, m->token, strlen(m->token)))
        return close_with(c->wsi, CLOSE_SECRET,
                          "The secret is wrong: open the printed URL.");
    if (l->count == LISTEN_CLIENTS_MOST)
        return close_with(c->wsi, CLOSE_MANY,
                          "32 pages are open: close one of them.");
    forget_silent(l, c->wsi);
    lws_set_timer_usecs(c->wsi, LWS_SET_TIMER_USEC_CANCEL);
    c->id = ++l->last_id;
    c->webp = m->webp;
    c->next = l->clients;
    l->clients = c;
    queue_newest(l, c, MESSAGE_FOLDER);
    queue_newest(l, c, MESSAGE_INFO);
    queue_newest(l, c, MESSAGE_LOOK);
    queue_newest(l, c, MESSAGE_FIGURES);
    queue_newest(l, c, MESSAGE_PICTURE);
    queue_newest(l, c, MESSAGE_MOVIE);
    send_state(l, c->id, 0);
    count_clients(l, 1);
    return 0;
}

static void set(listener *l, client *c, const message *m) {
    uint32_t revision = state_revision(l->state);
    json_t *changes = sizes_take(l->clients, c, l->state, m->keys);
    const bool other = json_object_size(changes) || !c->size.width;
    char *fault = other ? state_set(l->state, changes, &revision) : NULL;
    set_log_note(&c->sets, m->n, revision);
    json_decref(changes);
    if (json_object_size(m->keys) >
        (json_object_get(m->keys, "size") ? 1u : 0u))
        state_touch(l->state);
    if (!other) {
        sizes_serve(c, l->state, l->box);
        return;
    }
    if (fault)
        answer_said(l->box, c->id, fault);
    if (fault || *m->left_out ||
        state_wrote(l->state)) /* not said by the page */
        send_state(l, 0, 0);
    else if (l->count > 1)
        send_state(l, 0, c->id);
    free(fault);
}

static int take(listener *l, client *c, message *m) {
    if (!c->id && m->kind != MESSAGE_HELLO)
        return close_with(c->wsi, CLOSE_SECRET, "hello comes first.");
    if (*m->left_out)
        answer_said(l->box, c->id, m->left_out);
    switch (m->kind) {
    case MESSAGE_HELLO:
        return c->id ? 0 : greet(l, c, m);
    case MESSAGE_SET:
        set(l, c, m);
        break;
    case MESSAGE_MOVING: {
        bool moving = false;
        c->moving = m->on;
        for (const client *other = l->clients; other; other = other->next)
            moving = moving || other->moving;
        state_set_moving(l->state, moving);
        break;
    }
    case MESSAGE_ACK:
        if (client_acknowledge(c, 1e-3 * m->took))
            count_links(l);
        break;
    case MESSAGE_PART:
        client_note_part(c);
        break;
    case MESSAGE_ASK:
        if (!(l->hear && l->hear(l->hearer, c->id, m->tree)) &&
            !state_ask(l->state, c->id, sizes_ask(c, m->tree))) {
            answer_none(l->box, c->id, m->tree);
            answer_said(l->box, c->id, "ask: too many questions wait");
        }
        break;
    case MESSAGE_NONE:
        break;
    }
    if (client_has_more(c))
        lws_callback_on_writable(c->wsi);
    return 0;
}

static int receive(listener *l, client *c, const void *bytes, size_t length) {
    message m;
    bool last = lws_is_final_fragment(c->wsi);
    if (lws_frame_is_binary(c->wsi))
        return close_with(c->wsi, CLOSE_BAD, "messages are texts");
    int whole = client_collect(c, bytes, length, last);
    if (whole < 0)
        return close_with(c->wsi, CLOSE_BAD, "a message is too long");
    if (!whole)
        return 0;
    const char *wrong = message_read(c->text, c->used, &m);
    c->used = 0;
    if (wrong)
        return close_with(c->wsi, CLOSE_BAD, wrong);
    int done = take(l, c, &m);
    message_free(&m);
    return done;
}

/* Gives each page what is meant for it. */
static void distribute(listener *l) {
    for (outgoing *p = outbox_take(l->box), *next; p; p = next) {
        next = p->next;
        for (client *c = l->clients; c; c = c->next)
            if (p->client ? p->client == c->id : p->except != c->id)
                client_queue(c, l->box, p);
        outgoing_release(l->box, p);
    }
    for (client *c = l->clients; c; c = c->next)
        if (c->too_slow) /* whose socket may never take anything again */
            lws_set_timeout(c->wsi, PENDING_TIMEOUT_CLOSE_SEND,
                            LWS_TO_KILL_ASYNC);
        else if (client_has_more(c))
            lws_callback_on_writable(c->wsi);
}

/* --- what lws calls
 * ------------------------------------------------------------- */

/* Before a connection becomes a WebSocket. */
static int check_upgrade(listener *l, struct lws *wsi, const char *protocol) {
    char host[GUARD_HOST_BYTES] = "", origin[GUARD_HOST_BYTES + 16] = "";
    char path[256] = "";
    lws_hdr_copy(wsi, host, sizeof host, WSI_TOKEN_HOST);
    lws_hdr_copy(wsi, origin, sizeof origin, WSI_TOKEN_ORIGIN);
    lws_hdr_copy(wsi, path, sizeof path, WSI_TOKEN_GET_URI);
    const char *page = guard_page(path);
    bool good = protocol && strcmp(protocol, "snowglass.1") == 0 && page &&
                strcmp(page, "ws") == 0 && guard_host(&l->guard, host) &&
                guard_origin(&l->guard, origin, host);
    return good ? 0 : 1;
}

static int serve_page(struct lws *wsi, enum lws_callback_reasons reason,
                      void *user, void *in, size_t length) {
    listener *l = of(wsi);
    switch (reason) {
    case LWS_CALLBACK_HTTP:
        note_silent(l, wsi, LISTEN_REQUEST_SECONDS);
        if (!download_is_meant(in))
            return pages_answer(wsi, &l->guard, in);
        if (download_answer(wsi, &l->guard, l->job, user) != 0)
            return -1;
        forget_silent(l, wsi); /* it may take long */
        return 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE: /* no HTTP/2 */
        return in && strcmp(in, "websocket") == 0 ? 0 : 1;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return 1; /* it named no protocol, or one that is unknown */
    case LWS_CALLBACK_TIMER:
        return download_is_open(user) ? 0 : -1;
    case LWS_CALLBACK_HTTP_WRITEABLE:
        return download_is_open(user) ? download_send(wsi, user) : 0;
    case LWS_CALLBACK_CLOSED_HTTP:
        download_close(user);
        forget_silent(l, wsi);
        return 0;
    case LWS_CALLBACK_WSI_DESTROY:
        forget_silent(l, wsi);
        return 0;
    default:
        return lws_callback_http_dummy(wsi, reason, user, in, length);
    }
}

static int serve_socket(struct lws *wsi, enum lws_callback_reasons reason,
                        void *user, void *in, size_t length) {
    client *c = user;
    listener *l = of(wsi);
    switch (reason) {
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return check_upgrade(l, wsi, in);
    case LWS_CALLBACK_ESTABLISHED:
        c->wsi = wsi;
        note_silent(l, wsi, LISTEN_HELLO_SECONDS);
        return 0;
    case LWS_CALLBACK_TIMER:
        return c->id ? 0
                     : close_with(wsi, CLOSE_LATE, "no hello came in time.");
    case LWS_CALLBACK_RECEIVE:
        return receive(l, c, in, length);
    case LWS_CALLBACK_SERVER_WRITEABLE:
        if (c->too_slow || !client_send(c, l->box))
            return -1;
        if (client_has_more(c))
            lws_callback_on_writable(c->wsi);
        return 0;
    case LWS_CALLBACK_CLOSED:
        forget_silent(l, wsi);
        for (client **at = &l->clients; *at; at = &(*at)->next) {
            if (*at != c)
                continue;
            *at = c->next;
            count_clients(l, -1);
            break;
        }
        client_free(c, l->box);
        return 0;
    case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        distribute(l);
        return 0;
    default:
        return 0;
    }
}

/* The listening sockets; no page may name this protocol. */
static int serve_door(struct lws *wsi, enum lws_callback_reasons reason,
                      void *user, void *in, size_t length) {
    (void)user;
    (void)in;
    (void)length;
    if (reason == LWS_CALLBACK_RAW_RX_FILE)
        accept_all(of(wsi), lws_get_socket_fd(wsi));
    return reason == LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION ? 1 : 0;
}

static const struct lws_protocols protocols[] = {
    {"http", serve_page, sizeof(download), 4096, 0, NULL, 0},
    {"snowglass.1", serve_socket, sizeof(client), 16384, 0, NULL, 0},
    {"door", serve_door, 0, 0, 0, NULL, 0},
    {NULL, NULL, 0, 0, 0, NULL, 0},
};

/* Pages that have gone without a word are asked now and then. */
static const lws_retry_bo_t liveness = {.secs_since_valid_ping = 60,
                                        .secs_since_valid_hangup = 90};

static bool open_doors(listener *l, const sockets *s) {
    for (int i = 0; i < s->count; i++) {
        lws_sock_file_fd_type door = {.filefd = s->fds[i]};
        if (!lws_adopt_descriptor_vhost(l->vhost, LWS_ADOPT_RAW_FILE_DESC, door,
                                        "door", NULL))
            return false;
    }
    return true;
}

listener *listener_new(const sockets *s, const guard *g, double idle) {
    listener *l = calloc(1, sizeof *l);
    struct lws_context_creation_info info = {
        .port = CONTEXT_PORT_NO_LISTEN_SERVER,
        .protocols = protocols,
        .options =
            LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_VALIDATE_UTF8,
        .user = l,
        .server_string = "snowglass",
        .timeout_secs = LISTEN_REQUEST_SECONDS,
        .keepalive_timeout = LISTEN_REQUEST_SECONDS,
        .max_http_header_data = 8192,
        .max_http_header_pool = LISTEN_SILENT_MOST + 8,
        .fd_limit_per_thread = 256,
        .retry_and_idle_policy = &liveness};
    if (!l)
        return NULL;
    lws_set_log_level(0, NULL);
    l->guard = *g;
    pages_embed(l->guard.around);
    l->idle = idle;
    l->context = lws_create_context(&info);
    if (l->context)
        l->vhost = lws_create_vhost(l->context, &info);
    if (l->vhost && open_doors(l, s))
        return l;
    listener_free(l);
    return NULL;
}

void listener_free(listener *l) {
    if (!l)
        return;
    if (l->context)
        lws_context_destroy(l->context);
    free(l);
}

void listener_wake(void *user) {
    listener *l = user;
    lws_cancel_service(l->context);
}

void listener_run(listener *l, viewer_state *state, outbox *box,
                  listener_hear *hear, void *hearer, movie_job *job) {
    l->hear = hear;
    l->hearer = hearer;
    l->state = state;
    l->box = box;
    l->job = job;
    count_clients(l, 0);
    while (!l->ended && lws_service(l->context, 0) >= 0)
        continue;
}

void listener_stop(listener *l) {
    l->ended = true;
    lws_cancel_service(l->context);
}
