/* header.c - manual pages of the library: those of its public headers, whose
 * comments stand before what they are about. */
#include "manual/manual.h"
#include "manual/markdown.h"
#include "manual/roff.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- names ---------------------------------------------------------------- */

static size_t name_length(const char *text) {
    return strspn(text, "abcdefghijklmnopqrstuvwxyz0123456789_");
}

/* The function declared behind this SNOW_API; its length is 0 if it is not. */
static const char *function_of(const char *text, size_t *length) {
    const char *end = strpbrk(text, "(;");
    *length = 0;
    for (const char *at = text; end && at < end; at++) {
        if (strncmp(at, "snow_", 5) != 0)
            continue;
        *length = name_length(at);
        if (at[*length] == '(')
            return at;
        at += *length;
        *length = 0;
    }
    return text;
}

/* "snowglass-view" of "include/snowglass/view.h"; "snowglass" of snowglass.h */
static void page_name(const char *path, char *name, size_t room) {
    const char *file = strrchr(path, '/');
    file = file ? file + 1 : path;
    int length = (int)strcspn(file, ".");
    if (strncmp(file, "snowglass.", 10) == 0)
        snprintf(name, room, "snowglass");
    else
        snprintf(name, room, "snowglass-%.*s", length, file);
    for (; *name; name++)
        if (*name == '_')
            *name = '-';
}

static const char *package_of(const char *name) {
    if (strcmp(name, "snowglass-mpi") == 0)
        return "snowglass-mpi";
    return strcmp(name, "snowglass-recipe") == 0 ||
                   strcmp(name, "snowglass-look-file") == 0
               ? "snowglass-recipe"
               : "snowglass";
}

/* --- comments and code -----------------------------------------------------
 */

/* The text of a comment, in place: without its marks, and with examples, which
 * are indented, as Markdown has them.  Returns what follows the comment. */
static char *print_comment(char *text) {
    char *end = strstr(text, "*/"), *next = end + 2;
    markdown *out = markdown_new();
    char lines[16384], *at = lines;
    bool example = false;
    while (end > text && end[-1] == ' ')
        end--;
    *end = '\0';
    for (char *line = text + 2; line && out; line = text) {
        if ((text = strchr(line, '\n')))
            *text++ = '\0';
        line += strspn(line, " ");
        line += *line == '*';
        line += *line == ' ';
        bool indented = strncmp(line, "  ", 2) == 0;
        size_t room = sizeof lines - (size_t)(at - lines);
        if (indented != example && *line && room > 1) {
            *at = '\0';
            markdown_line(out, at++);
            example = indented;
        }
        size_t length = strlen(line) + 3;
        if (length + 2 > room)
            break;
        snprintf(at, length, "%s%s", indented ? "  " : "", line);
        markdown_line(out, at);
        at += length;
    }
    markdown_free(out);
    return next + (*next == '\n');
}

/* Lines that are for compilers alone. */
static bool is_guard(const char *line, size_t length) {
    return (strncmp(line, "#ifndef SNOWGLASS_", 18) == 0) ||
           (strncmp(line, "#define SNOWGLASS_", 18) == 0 && length > 2 &&
            strncmp(line + length - 2, "_H", 2) == 0) ||
           strncmp(line, "#include", 8) == 0 || strcmp(line, "#endif\n") == 0;
}

/* Prints code up to the next comment that begins a line, where it returns. */
static char *print_code(char *text, bool first, bool *any) {
    int blank = 0;
    *any = false;
    while (*text && strncmp(text, "/*", 2) != 0) {
        size_t length = strcspn(text, "\n");
        if (length == 0)
            blank++;
        else if (!is_guard(text, length)) {
            if (!*any)
                puts(first ? ".EX" : ".PP\n.EX");
            else if (blank)
                putchar('\n');
            const char *code =
                text + (strncmp(text, "SNOW_API ", 9) == 0 ? 9 : 0);
            roff_code_line(code, length - (size_t)(code - text));
            *any = true;
            blank = 0;
        }
        text += length + (text[length] == '\n');
    }
    if (*any)
        puts(".EE");
    return text;
}

/* A comment stands before what it is about, and here behind it. */
static void print_items(char *text) {
    char *comment = NULL;
    bool first = true, any;
    while (*text || comment) {
        text = print_code(text, first, &any);
        first = first && !any;
        if (comment) {
            puts(any ? ".RS 4" : ".PP\n.RS 4");
            print_comment(comment);
            puts(".RE");
        }
        comment = *text ? text : NULL;
        if (comment) {
            char *end = strstr(comment, "*/");
            text = end ? end + 2 : comment + strlen(comment);
            text += *text == '\n';
        }
    }
}

/* --- a page --------------------------------------------------------------- */

static void print_names(const char *name, const char *text) {
    roff_chars(name, strlen(name), true);
    for (text = strstr(text, "SNOW_API "); text;
         text = strstr(text + 1, "SNOW_API ")) {
        size_t length;
        const char *function = function_of(text + 9, &length);
        if (length)
            printf(",\n%.*s", (int)length, function);
    }
}

/* The first sentence of the file: "snowglass/view.h - the camera. ..." */
static void print_summary(const char *text) {
    char words[512];
    size_t count = 0;
    const char *at = strstr(text, " - ");
    for (at += 3; *at && count + 1 < sizeof words; at++) {
        if ((*at == '.' && strchr(" \n", at[1])) || strncmp(at, "*/", 2) == 0)
            break;
        if (strncmp(at, "\n *", 3) == 0) {
            at += 2;
            continue;
        }
        words[count++] = *at;
    }
    words[count] = '\0';
    fputs("\n\\- ", stdout);
    roff_text(words);
}

/* The pages of the headers that this one includes. */
static void print_included(const char *text) {
    char path[WORD_BYTES], name[WORD_BYTES];
    puts(".SH SEE ALSO");
    while ((text = strstr(text, "#include <snowglass/"))) {
        text += 10;
        snprintf(path, sizeof path, "%.*s", (int)strcspn(text, ">"), text);
        page_name(path, name, sizeof name);
        printf(".BR ");
        roff_chars(name, strlen(name), true);
        puts(" (3),");
    }
    puts(".BR snowglass (3),\n.BR snowglass (7)");
}

/* The comment that a header begins with, without the name of the file. */
static char *print_description(char *text) {
    char *start = strstr(text, " - ");
    memcpy(start, "/* ", 3);
    start[3] = (char)toupper((unsigned char)start[3]);
    puts(".SH DESCRIPTION");
    return print_comment(start);
}

bool print_header(const char *path) {
    char name[WORD_BYTES];
    char *text = read_whole(path);
    if (!text || strncmp(text, "/* snowglass/", 13) != 0 ||
        !strstr(text, " - ") || !strstr(text, "*/")) {
        free(text);
        return false;
    }
    page_name(path, name, sizeof name);
    roff_head(name, 3, "the public headers");
    print_names(name, text);
    print_summary(text);
    printf(".SH SYNOPSIS\n.B #include <%.*s>\n.PP\n",
           (int)strcspn(text + 3, " "), text + 3);
    printf(".B cc program.c $(pkg\\-config \\-\\-cflags \\-\\-libs ");
    roff_chars(package_of(name), strlen(package_of(name)), true);
    puts(")");
    char *copy = strdup(text);
    if (copy) {
        char *items = print_description(copy);
        puts(".SH DECLARATIONS");
        print_items(items);
    }
    free(copy);
    print_included(text);
    free(text);
    return true;
}
