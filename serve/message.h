/* message.h - what a page says: JSON texts, read and checked before anything
 * is done with them; and the head of a picture that is sent to it.
 *
 *   {"t": "hello", "token": "...", "wants": ["jpeg", "webp", "png"]}
 *   {"t": "set", "step": 17, "keys": {"azimuth": 30, "preset": null}}
 *   {"t": "moving", "on": true}
 *   {"t": "ack", "n": 17, "took": 12}
 *   {"t": "part"}
 *   {"t": "ask", "what": "histogram", ...}
 *
 * Nothing here touches a socket or a file. */
#ifndef MESSAGE_H
#define MESSAGE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

/* The longest text, the deepest nesting, the longest side of a picture. */
#define MESSAGE_BYTES 65536
#define MESSAGE_DEPTH 8
#define MESSAGE_SIDE 4096

typedef enum message_kind {
    MESSAGE_HELLO,
    MESSAGE_SET,
    MESSAGE_MOVING,
    MESSAGE_ACK,
    MESSAGE_PART, /* of a picture: it has come */
    MESSAGE_ASK,
    MESSAGE_NONE /* nothing is done, and `left_out` says why */
} message_kind;

typedef struct message {
    message_kind kind;
    uint32_t n;         /* the step of set, or n of ack */
    uint32_t took;      /* of ack: milliseconds from when the picture was there
                           until it was painted; 0: not said */
    bool on;            /* of moving */
    bool webp;          /* of hello: the page can show WebP */
    const char *token;  /* of hello */
    const char *what;   /* of ask */
    json_t *keys;       /* of set: those that change; null takes one out */
    char left_out[160]; /* what was not understood, for the page; "": nothing */
    json_t *tree;       /* owns the texts */
} message;

/* Reads a text.  Returns NULL, and message_free must follow; or what is wrong
 * with it where it is no JSON object of a kind within the limits: then there is
 * nothing to free, and who says so is no page of ours. */
const char *message_read(const char *text, size_t length, message *out);
void message_free(message *m);

/* Whether a page may set a key of the recipe: no value names a file. */
bool message_may_set(const char *key);

/* Whether a size is that of a picture for a page. */
bool message_has_size(const json_t *size);

/* These keys; NULL: no more. */
const char *message_key(size_t index);

/* The keys that a page sets to null or true alone, which stands for the file of
 * the command line; NULL: no more. */
const char *message_switches(size_t index);

#define FRAME_HEAD_BYTES 32

typedef enum frame_kind {
    FRAME_JPEG = 1,
    FRAME_PNG = 2,
    FRAME_WEBP = 3,
    FRAME_LEVELS = 4 /* red, green, blue, 255: to a page without a server */
} frame_kind;

/* What stands before a picture's bytes, little endian:
 *
 *    0 "SNW1" | 4 n | 8 level, kind, pane, part | 12 bytes of all parts
 *   16 width  | 20 height | 24 microseconds of rendering | 28 of packing
 *
 * Most pictures are whole: 0 is their part.  On a thin link the one at rest
 * comes in several, of which the first is FRAME_FIRST and the others
 * FRAME_NEXT, each with this head; a picture that follows ends it before its
 * end. */
typedef struct frame_head {
    uint32_t n;
    int level, kind, pane;
    uint32_t width, height, render_us, pack_us;
} frame_head;

void frame_head_write(const frame_head *head, unsigned char out[32]);

#define FRAME_FIRST 1
#define FRAME_NEXT 2
void frame_head_set_part(unsigned char head[32], int part, uint32_t all);

/* The width and height of a picture, in one number. */
uint64_t frame_shape(const unsigned char head[32]);

/* Replaces n, which each page counts by itself. */
void frame_head_set_n(unsigned char head[32], uint32_t n);

/* What revisions of the state a page's own messages became: the last of them.
 */
#define SET_LOG_LENGTH 64
typedef struct set_log {
    struct {
        uint32_t revision, n;
    } sets[SET_LOG_LENGTH]; /* a ring */
    unsigned count;
} set_log;

/* Notes that message n became a revision. */
void set_log_note(set_log *log, uint32_t n, uint32_t revision);

/* The newest message that a revision has in it; 0: none. */
uint32_t set_log_n(const set_log *log, uint32_t revision);

/* What a text of the state begins with; %-10u is the step, of which a page's
 * own is put in its place when it is sent: its newest set that the state has.
 */
#define STATE_HEAD "{\"t\":\"state\",\"step\":"
void state_text_set_step(unsigned char *text, uint32_t step);

#endif
