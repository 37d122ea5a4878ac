/* roff.c - text of manual pages, in the macros man(7). */
#include "manual/roff.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <snowglass/snowglass.h>

#define LINE 76

/* --- plain text ----------------------------------------------------------- */

/* A character beyond ASCII by its number, which every terminal's roff knows. */
static size_t print_wide(const char *text, size_t length) {
    const unsigned char *bytes = (const unsigned char *)text;
    size_t more = bytes[0] >= 0xf0 ? 3 : bytes[0] >= 0xe0 ? 2 : 1;
    unsigned long code = bytes[0] & (0x3fu >> more);
    for (size_t i = 1; i <= more && i < length; i++)
        code = code << 6 | (bytes[i] & 0x3f);
    printf("\\[u%04lX]", code);
    return more;
}

/* A hyphen that is typed stays one when it is copied: that of an option or of a
 * name. */
void roff_chars(const char *text, size_t length, bool typed) {
    for (size_t i = 0; i < length; i++) {
        if ((unsigned char)text[i] >= 0x80)
            i += print_wide(text + i, length - i);
        else if (text[i] == '\\')
            fputs("\\e", stdout);
        else if (text[i] == '-' && typed)
            fputs("\\-", stdout);
        else
            putchar(text[i]);
    }
}

static bool ends_sentence(const char *word, size_t length) {
    size_t last = length - (length > 1 && word[length - 1] == ')');
    return last > 1 && strchr(".!?", word[last - 1]) &&
           !(last > 3 && strncmp(word, "e.g.", 4) == 0);
}

/* Writes a word; `font` is of words with marks. */
typedef void print_fn(const char *text, size_t length, char *font);

/* A paragraph: words on lines, each sentence on a line of its own. */
static void fill_lines(const char *text, size_t line, bool one_line,
                       print_fn *print) {
    size_t at = 0;
    char font = 'R';
    while (*text) {
        size_t length = strcspn(text, " ");
        if (!one_line && at && at + 1 + length > line) {
            putchar('\n');
            at = 0;
        }
        if (at)
            putchar(' ');
        else if (*text == '.' || *text == '\'')
            fputs("\\&", stdout);
        print(text, length, &font);
        at += length + 1;
        if (!one_line && ends_sentence(text, length) && text[length]) {
            putchar('\n');
            at = 0;
        }
        text += length + (text[length] == ' ');
    }
    putchar('\n');
}

static void print_plain(const char *text, size_t length, char *font) {
    (void)font;
    roff_chars(text, length, text[strspn(text, "([")] == '-');
}

void roff_text(const char *text) {
    fill_lines(text, LINE, false, print_plain);
}

/* A line of a macro, whose argument is one text. */
void roff_macro(const char *macro, const char *text) {
    printf("%s ", macro);
    roff_chars(text, strlen(text), true);
    putchar('\n');
}

void roff_item(const char *name, const char *text) {
    puts(".TP");
    roff_macro(".B", name);
    roff_text(text);
}

void roff_code_line(const char *line, size_t length) {
    if (length && (*line == '.' || *line == '\''))
        fputs("\\&", stdout);
    roff_chars(line, length, true);
    putchar('\n');
}

/* The day that the build names, so that two builds are equal. */
void roff_head(const char *title, int section, const char *origin) {
    char day[32] = "";
    const char *epoch = getenv("SOURCE_DATE_EPOCH");
    time_t now = epoch ? (time_t)strtoll(epoch, NULL, 10) : time(NULL);
    struct tm parts;
    if (gmtime_r(&now, &parts))
        strftime(day, sizeof day, "%Y-%m-%d", &parts);
    printf(".\\\" made by snowglass-manual from %s\n.TH ", origin);
    for (; *title; title++)
        putchar(toupper((unsigned char)*title));
    printf(" %d %s \"Snowglass %s\"\n.SH NAME\n", section, day, snow_version());
}

/* --- words of Markdown ---------------------------------------------------- */

static bool opens_link(const char *text) {
    const char *end = strstr(text, "](");
    return *text == '[' && end &&
           !memchr(text + 1, '[', (size_t)(end - text - 1));
}

/* Whether a mark before a word has one behind a word. */
static bool closes(const char *text, const char *mark) {
    const char *at = text += strlen(mark);
    while (isalnum((unsigned char)*text) && (at = strstr(at + 1, mark)))
        if (at[-1] != ' ')
            return true;
    return false;
}

static size_t change_font(char *font, char to, size_t taken) {
    *font = *font == to ? 'R' : to;
    printf("\\f%c", *font == 'b' ? 'B' : *font);
    return taken;
}

/* Writes a mark of Markdown at this place and returns its characters, or 0.
 * `font` is R, I, b (bold) or B (code).  Of a link the words are written. */
static size_t print_mark(const char *text, char *font) {
    if (*text == '`')
        return change_font(font, 'B', 1);
    if (*font == 'B')
        return 0;
    if (strncmp(text, "**", 2) == 0 && (*font == 'b' || closes(text, "**")))
        return change_font(font, 'b', 2);
    if (*text == '*' && (*font == 'I' ? text[-1] != ' ' : closes(text, "*")))
        return change_font(font, 'I', 1);
    if (opens_link(text))
        return 1;
    if (strncmp(text, "](", 2) == 0)
        return strcspn(text, ")") + 1;
    return 0;
}

static void print_word(const char *text, size_t length, char *font) {
    bool typed = text[strspn(text, "([")] == '-';
    for (size_t i = 0; i < length;) {
        size_t taken = print_mark(text + i, font);
        if (!taken) {
            for (taken = 1; (text[i + taken] & 0xc0) == 0x80; taken++)
                ;
            roff_chars(text + i, taken, typed || *font == 'B');
        }
        i += taken;
    }
}

void roff_prose(const char *text, bool one_line) {
    fill_lines(text, LINE - 14, one_line, print_word); /* marks grow */
}
