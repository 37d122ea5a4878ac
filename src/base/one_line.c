/* base/one_line.c - makes text of any origin one line that a terminal can show.
 *
 * Names of files, values of headers and messages of other libraries may hold
 * anything: line ends, escape sequences, bytes that are no letters, and words
 * without end. */
#include "base/base.h"

#include <stdio.h>
#include <string.h>

/* The longest name of a file that stands whole, and of the end that is left of
 * a longer one; the longest other word, and value of an option, such as
 * "30:0,45:0.02", which a user may want to copy. */
#define NAME_BYTES 200
#define NAME_END_BYTES 197
#define WORD_BYTES 100
#define VALUE_BYTES 1000

/* Bytes of the letter of UTF-8 that a text begins with (RFC 3629), and its
 * number; 0: none, or not all of it. */
static size_t letter_bytes(const unsigned char *text, uint32_t *letter) {
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    const size_t bytes = *text < 0x80             ? 1
                         : (*text & 0xe0) == 0xc0 ? 2
                         : (*text & 0xf0) == 0xe0 ? 3
                         : (*text & 0xf8) == 0xf0 ? 4
                                                  : 0;
    *letter = bytes < 2 ? *text : *text & (0x7fU >> bytes);
    for (size_t i = 1; i < bytes; i++) {
        if ((text[i] & 0xc0) != 0x80)
            return 0;
        *letter = *letter << 6 | (text[i] & 0x3f);
    }
    const bool surrogate = *letter >= 0xd800 && *letter <= 0xdfff;
    return bytes && *letter >= least[bytes] && !surrogate && *letter <= 0x10ffff
               ? bytes
               : 0;
}

/* Control characters, of ASCII and of Latin-1, line ends of Unicode, and those
 * that change the direction of what follows. */
static bool is_control(uint32_t letter) {
    return letter < 0x20 || (letter >= 0x7f && letter < 0xa0) ||
           letter == 0x61c || letter == 0x200e || letter == 0x200f ||
           (letter >= 0x2028 && letter <= 0x202e) ||
           (letter >= 0x2066 && letter <= 0x2069) || letter == 0xfeff;
}

size_t snow_letter_bytes(const char *text, bool *control) {
    uint32_t letter;
    const size_t bytes = letter_bytes((const unsigned char *)text, &letter);
    *control = is_control(letter);
    return bytes;
}

#ifndef __EMSCRIPTEN__

/* Escapes as `ls --escape` writes them: \n and \t, else three octal digits. */
static void escape(const char *text, char *out, size_t capacity) {
    size_t used = 0;
    for (const unsigned char *at = (const unsigned char *)text; *at;) {
        bool control;
        const size_t bytes = snow_letter_bytes((const char *)at, &control);
        if (bytes && !control) {
            if (used + bytes >= capacity)
                break;
            memcpy(out + used, at, bytes);
            used += bytes;
            at += bytes;
            continue;
        }
        if (used + 4 >= capacity)
            break;
        used +=
            (size_t)(*at == '\n'   ? snprintf(out + used, 5, "\\n")
                     : *at == '\t' ? snprintf(out + used, 5, "\\t")
                                   : snprintf(out + used, 5, "\\%03o", *at));
        at++;
    }
    out[used] = 0;
}

/* The first byte of a letter, at or behind `at`. */
static const char *next_letter(const char *at) {
    while (((unsigned char)*at & 0xc0) == 0x80)
        at++;
    return at;
}

/* Copies `length` bytes of a name or a word, of which a long one is cut: of a
 * name the end says more, of a word the beginning. */
static size_t put_word(const char *word, size_t length, bool name, char *out) {
    if (name && length > NAME_BYTES) {
        const char *end = word + length;
        const char *from = next_letter(end - NAME_END_BYTES);
        memcpy(out, "...", 3);
        memcpy(out + 3, from, (size_t)(end - from));
        return 3 + (size_t)(end - from);
    }
    const bool value = memchr(word, ',', length) || memchr(word, '=', length);
    const size_t most = value ? VALUE_BYTES : WORD_BYTES;
    if (!name && length > most) {
        size_t kept = most - 3;
        while (((unsigned char)word[kept] & 0xc0) == 0x80)
            kept--;
        memcpy(out, word, kept);
        memcpy(out + kept, "...", 3);
        return kept + 3;
    }
    memcpy(out, word, length);
    return length;
}

/* What stands before the first ": " is the name of the file, if it is long; a
 * word of elsewhere is a name if it has a slash. */
void snow_text_to_line(char *text, size_t capacity) {
    char line[SNOW_MESSAGE_BYTES + 2048];
    if (capacity > sizeof line)
        capacity = sizeof line;
    escape(text, line, capacity);
    const char *at = line, *first = strstr(line, ": ");
    char *out = text;
    if (first && first - line > NAME_BYTES &&
        memchr(line, '/', (size_t)(first - line))) {
        out += put_word(line, (size_t)(first - line), true, out);
        at = first;
    }
    while (*at) {
        const size_t blanks = strspn(at, " ");
        size_t length = strcspn(at + blanks, " ");
        if (length && strchr(":;,.", at[blanks + length - 1]))
            length--; /* of the sentence, not of the word */
        memcpy(out, at, blanks);
        out += blanks;
        at += blanks;
        out += put_word(at, length, memchr(at, '/', length) != NULL, out);
        at += length;
        for (; *at && *at != ' '; at++)
            *out++ = *at;
    }
    *out = 0;
}

#else

/* A page shows text as text, whatever is in it, and is small. */
void snow_text_to_line(char *text, size_t capacity) {
    (void)text;
    (void)capacity;
}

#endif
