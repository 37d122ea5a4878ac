/* message.c - implements message.h. */
#include "message.h"

#include <stdio.h>
#include <string.h>

/* What a page may change.  Paths, and how a raw file is read, are those of the
 * command line; mask and overlay are switched. */
static const char *const keys[] = {
    "size",
    "background",
    "mode",
    "iso",
    "threshold",
    "preset",
    "colormap",
    "scale",
    "opacity",
    "gradient-opacity",
    "range",
    "window",
    "opacity-unit",
    "shade",
    "light",
    "material",
    "depth-darkening",
    "occlusion",
    "view",
    "azimuth",
    "elevation",
    "roll",
    "zoom",
    "perspective",
    "fit",
    "position",
    "target",
    "up",
    "no-labels",
    "legend",
    "title",
    "annotate",
    "box",
    "measure",
    "crop",
    "channel",
    "component",
    "labels",
    "clip",
    "time",
    "z-scale",
    "mask",
    "overlay",
    "overlay-look",
};

const char *message_switches(size_t index) {
    static const char *const names[] = {"mask", "overlay", NULL};
    return names[index];
}

const char *message_key(size_t index) {
    return index < sizeof keys / sizeof *keys ? keys[index] : NULL;
}

bool message_may_set(const char *key) {
    for (size_t i = 0; message_key(i); i++)
        if (strcmp(message_key(i), key) == 0)
            return true;
    return false;
}

/* jansson itself goes down 2,048 levels, each a call. */
static bool is_shallow(const char *text, size_t length) {
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < length; i++) {
        char c = text[i];
        if (quoted && c == '\\')
            i++;
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && (c == '{' || c == '['))
            depth++;
        else if (!quoted && (c == '}' || c == ']'))
            depth--;
        if (depth > MESSAGE_DEPTH)
            return false;
    }
    return true;
}

static bool read_number(const json_t *tree, const char *key, uint32_t *out) {
    const json_t *number = json_object_get(tree, key);
    json_int_t value = json_integer_value(number);
    *out = (uint32_t)value;
    return json_is_integer(number) && value >= 0 && value <= UINT32_MAX;
}

static const char *read_hello(message *m) {
    size_t index;
    json_t *want;
    m->token = json_string_value(json_object_get(m->tree, "token"));
    json_array_foreach(json_object_get(m->tree, "wants"), index, want) {
        const char *word = json_string_value(want);
        m->webp = m->webp || (word && strcmp(word, "webp") == 0);
    }
    return m->token ? NULL : "hello: needs a token; open the printed URL";
}

/* Pictures of more pixels would make the others wait. */
bool message_has_size(const json_t *size) {
    json_int_t width = json_integer_value(json_array_get(size, 0));
    json_int_t height = json_integer_value(json_array_get(size, 1));
    return json_array_size(size) == 2 && width >= 1 && height >= 1 &&
           width <= MESSAGE_SIDE && height <= MESSAGE_SIDE;
}

/* Whether a page may give a key this value; files are named by nobody but the
 * command line. */
static bool is_settable(const char *key, const json_t *value) {
    for (size_t i = 0; message_switches(i); i++)
        if (strcmp(message_switches(i), key) == 0)
            return json_is_null(value) || json_is_true(value);
    return message_may_set(key) &&
           (strcmp(key, "size") != 0 || message_has_size(value));
}

/* Adds a name to those that are left out, or "..." where it has no room. */
static void note_left_out(message *m, const char *key) {
    static const char more[] = ", ...";
    size_t used = strlen(m->left_out), most = sizeof m->left_out;
    const char *before = used ? ", " : "Left out, as a page cannot set it: ";
    if (used + strlen(before) + strlen(key) + sizeof more <= most)
        snprintf(m->left_out + used, most - used, "%s%s", before, key);
    else if (used && strcmp(m->left_out + used - strlen(more), more) != 0)
        snprintf(m->left_out + used, most - used, more);
    else if (!used)
        snprintf(m->left_out, most, "%s...", before);
}

static const char *read_set(message *m) {
    const char *key;
    json_t *value;
    void *next;
    m->keys = json_object_get(m->tree, "keys");
    if (!read_number(m->tree, "step", &m->n) || !json_is_object(m->keys))
        return "set: needs the number of a step, and keys";
    json_object_foreach_safe(m->keys, next, key, value) {
        if (is_settable(key, value))
            continue;
        note_left_out(m, key);
        json_object_del(m->keys, key);
    }
    return NULL;
}

static const char *read_moving(message *m) {
    const json_t *on = json_object_get(m->tree, "on");
    m->on = json_is_true(on);
    return json_is_boolean(on) ? NULL : "moving: needs on, true or false";
}

static const char *read_ack(message *m) {
    const bool timed = json_object_get(m->tree, "took") != NULL;
    if (timed && !read_number(m->tree, "took", &m->took))
        return "ack: took is not in whole milliseconds";
    return read_number(m->tree, "n", &m->n) ? NULL : "ack: needs a number n";
}

static const char *read_part(message *m) {
    (void)m;
    return NULL;
}

static const char *read_ask(message *m) {
    m->what = json_string_value(json_object_get(m->tree, "what"));
    return m->what ? NULL : "ask: needs what is asked for";
}

static const char *read_kind(message *m) {
    static const struct {
        const char *name;
        message_kind kind;
        const char *(*read)(message *);
    } rows[] = {{"hello", MESSAGE_HELLO, read_hello},
                {"set", MESSAGE_SET, read_set},
                {"moving", MESSAGE_MOVING, read_moving},
                {"ack", MESSAGE_ACK, read_ack},
                {"part", MESSAGE_PART, read_part},
                {"ask", MESSAGE_ASK, read_ask}};
    const char *name = json_string_value(json_object_get(m->tree, "t"));
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (strcmp(rows[i].name, name) != 0)
            continue;
        m->kind = rows[i].kind;
        return rows[i].read(m);
    }
    return "Left out, as messages of its kind t are not known.";
}

const char *message_read(const char *text, size_t length, message *out) {
    *out = (message){.n = 0};
    if (length > MESSAGE_BYTES || !is_shallow(text, length))
        return "a message has at most 65,536 bytes and 8 levels";
    out->tree = json_loadb(text, length, JSON_REJECT_DUPLICATES, NULL);
    if (!json_is_string(json_object_get(out->tree, "t"))) {
        message_free(out);
        return "a message must be one JSON object with a kind t";
    }
    const char *wrong = read_kind(out);
    if (wrong) {
        out->kind = MESSAGE_NONE;
        snprintf(out->left_out, sizeof out->left_out, "%s", wrong);
    }
    return NULL;
}

void message_free(message *m) {
    json_decref(m->tree);
    m->tree = NULL;
}

static void put_u32(unsigned char *out, uint32_t value) {
    for (int i = 0; i < 4; i++)
        out[i] = (unsigned char)(value >> (8 * i));
}

void frame_head_write(const frame_head *head, unsigned char out[32]) {
    memset(out, 0, FRAME_HEAD_BYTES);
    memcpy(out, "SNW1", 4);
    put_u32(out + 4, head->n);
    out[8] = (unsigned char)head->level;
    out[9] = (unsigned char)head->kind;
    out[10] = (unsigned char)head->pane;
    put_u32(out + 16, head->width);
    put_u32(out + 20, head->height);
    put_u32(out + 24, head->render_us);
    put_u32(out + 28, head->pack_us);
}

uint64_t frame_shape(const unsigned char head[32]) {
    uint64_t shape = 0;
    for (int i = 0; i < 8; i++)
        shape |= (uint64_t)head[16 + i] << (8 * i);
    return shape;
}

void frame_head_set_n(unsigned char head[32], uint32_t n) {
    put_u32(head + 4, n);
}

void frame_head_set_part(unsigned char head[32], int part, uint32_t all) {
    head[11] = (unsigned char)part;
    put_u32(head + 12, all);
}

void state_text_set_step(unsigned char *text, uint32_t step) {
    char digits[16];
    snprintf(digits, sizeof digits, "%-10u", step);
    memcpy(text + strlen(STATE_HEAD), digits, 10);
}

void set_log_note(set_log *log, uint32_t n, uint32_t revision) {
    log->sets[log->count % SET_LOG_LENGTH].n = n;
    log->sets[log->count % SET_LOG_LENGTH].revision = revision;
    log->count++;
}

uint32_t set_log_n(const set_log *log, uint32_t revision) {
    uint32_t n = 0;
    for (unsigned i = 0; i < SET_LOG_LENGTH && i < log->count; i++)
        if (log->sets[i].revision <= revision && log->sets[i].n > n)
            n = log->sets[i].n;
    return n;
}
