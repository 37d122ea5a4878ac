/* markdown.c - headings, paragraphs, lists, tables and programs of documents as
 * text of a manual page, and pages that are sections of documents. */
#include "manual/markdown.h"
#include "manual/manual.h"
#include "manual/roff.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CELLS 8
#define PARAGRAPH_BYTES 16384

struct markdown {
    char text[PARAGRAPH_BYTES]; /* of a paragraph or item that may go on */
    bool fenced, indented, in_list, blank;
    bool headed;        /* nothing stands below the heading yet */
    char *heads[CELLS]; /* of a table's columns */
    size_t columns;
    int top; /* level of the heading of all */
};

/* --- files ---------------------------------------------------------------- */

char *read_whole(const char *path) {
    FILE *file = fopen(path, "r");
    char *text = NULL;
    size_t room = 0;
    if (!file || getdelim(&text, &room, '\0', file) < 0) {
        fprintf(stderr, "snowglass-manual: cannot read %s\n", path);
        free(text);
        text = NULL;
    }
    if (file)
        fclose(file);
    return text;
}

static int level_of(const char *line) {
    size_t marks = strspn(line, "#");
    return line[marks] == ' ' ? (int)marks : 0;
}

/* --- paragraphs and lists ------------------------------------------------- */

static void flush(markdown *p) {
    if (*p->text)
        roff_prose(p->text, false);
    *p->text = '\0';
}

static void append(markdown *p, const char *line) {
    size_t length = strlen(p->text);
    line += strspn(line, " ");
    snprintf(p->text + length, sizeof p->text - length, "%s%s",
             length ? " " : "", line);
}

static void end_code(markdown *p) {
    if (p->fenced || p->indented)
        puts(".EE\n.RE");
    p->fenced = p->indented = false;
}

static void begin_code(markdown *p) {
    flush(p);
    if (!p->headed)
        puts(".PP");
    puts(".RS 4\n.EX");
    p->in_list = p->headed = false;
}

/* The text behind the mark of an item, or NULL. */
static const char *item_of(const char *line, const char **macro) {
    line += strspn(line, " ");
    size_t digits = strspn(line, "0123456789");
    *macro = ".IP \\(bu 2";
    if (strncmp(line, "- ", 2) == 0)
        return line + 2;
    *macro = NULL;
    return digits && strncmp(line + digits, ". ", 2) == 0 ? line + digits + 2
                                                          : NULL;
}

static void begin_item(markdown *p, const char *line, const char *text,
                       const char *macro) {
    flush(p);
    line += strspn(line, " ");
    if (macro)
        puts(macro);
    else
        printf(".IP %.*s 4\n", (int)strcspn(line, " "), line);
    p->in_list = true;
    p->headed = false;
    append(p, text);
}

/* --- tables --------------------------------------------------------------- */

/* Cuts a row into cells, in place; bars in code and behind a backslash stay. */
static size_t cells_of(char *line, char *cells[CELLS]) {
    size_t count = 0;
    bool code = false;
    for (char *at = line; *at; at++) {
        if (*at == '`')
            code = !code;
        if (*at == '\\' && at[1] == '|')
            memmove(at, at + 1, strlen(at));
        else if (*at == '|' && !code) {
            *at = '\0';
            if (count < CELLS)
                cells[count++] = at + 1;
        }
    }
    count -= count > 0; /* behind the last bar there is none */
    for (size_t i = 0; i < count; i++) {
        cells[i] += strspn(cells[i], " ");
        size_t length = strlen(cells[i]);
        while (length && cells[i][length - 1] == ' ')
            cells[i][--length] = '\0';
    }
    return count;
}

/* A row is an item: its first cell, and the others with their columns' names
 * where there are more than two. */
static void print_row(markdown *p, char *line) {
    char *cells[CELLS];
    if (strncmp(line, "| -", 3) == 0)
        return;
    size_t count = cells_of(line, cells);
    if (!p->columns) {
        for (size_t i = 0; i < count; i++)
            p->heads[i] = cells[i];
        p->columns = count;
        return;
    }
    puts(".TP");
    p->headed = false;
    roff_prose(*cells[0] ? cells[0] : "(any)", true);
    for (size_t i = 1; i < count; i++) {
        if (!*cells[i])
            continue;
        if (count > 2 && i < p->columns && *p->heads[i]) {
            append(p, p->heads[i]);
            strcat(p->text, ":");
        }
        append(p, cells[i]);
        flush(p);
        if (count > 2 && i + 1 < count)
            puts(".br");
    }
}

/* --- lines ---------------------------------------------------------------- */

static void print_heading(markdown *p, const char *line, int level) {
    flush(p);
    line += level + 1;
    if (level > p->top)
        roff_macro(".SS", line);
    p->in_list = false;
    p->headed = true;
}

void markdown_line(markdown *p, char *line) {
    const char *macro, *text = item_of(line, &macro);
    int level = level_of(line);
    bool blank = p->blank;
    if (strncmp(line, "```", 3) == 0 && p->fenced) {
        end_code(p);
    } else if (p->fenced) {
        roff_code_line(line, strlen(line));
    } else if (strncmp(line, "```", 3) == 0) {
        begin_code(p);
        p->fenced = true;
    } else if (!*line) {
        flush(p);
        p->columns = 0;
        p->blank = true;
        return;
    } else if (strncmp(line, "    ", 4) == 0 && (blank || p->indented)) {
        if (!p->indented)
            begin_code(p);
        else if (blank)
            putchar('\n');
        p->indented = true;
        roff_code_line(line + 4, strlen(line + 4));
    } else {
        end_code(p);
        if (level)
            print_heading(p, line, level);
        else if (*line == '|')
            print_row(p, line);
        else if (text)
            begin_item(p, line, text, macro);
        else {
            if (blank && !p->headed && !(p->in_list && *line == ' '))
                puts(".PP");
            p->headed = false;
            append(p, line);
        }
    }
    p->blank = false;
}

markdown *markdown_new(void) {
    markdown *p = calloc(1, sizeof *p);
    if (p)
        p->headed = true;
    return p;
}

void markdown_free(markdown *p) {
    if (p) {
        flush(p);
        end_code(p);
    }
    free(p);
}

/* --- pages ---------------------------------------------------------------- */

/* The lines of a section: from the heading that begins with these words to the
 * next one that is not below it. */
static bool print_section(markdown *p, char *text, const char *heading) {
    bool inside = false, found = false;
    for (char *line = text, *next; line; line = next) {
        if ((next = strchr(line, '\n')))
            *next++ = '\0';
        int level = p->fenced ? 0 : level_of(line);
        if (level && level <= p->top)
            inside = false;
        if (inside) {
            markdown_line(p, line);
        } else if (level && !found &&
                   strncmp(line + level + 1, heading, strlen(heading)) == 0) {
            inside = found = true;
            p->top = level;
        }
    }
    return found;
}

static bool print_part(const char *path, const char *heading,
                       const char *title) {
    char *text = read_whole(path);
    markdown *p = markdown_new();
    bool found = false;
    if (text && p) {
        roff_macro(".SH", title);
        found = print_section(p, text, heading);
        if (!found)
            fprintf(stderr, "snowglass-manual: %s has no section '%s'\n", path,
                    heading);
    }
    markdown_free(p);
    free(text);
    return found;
}

bool print_document(int count, char **words) {
    bool done = count > 4 && count % 3 == 2;
    if (!done)
        return false;
    roff_head("snowglass", atoi(words[0]), "the documents");
    printf("snowglass \\- ");
    roff_text(words[1]);
    for (int i = 2; i < count && done; i += 3)
        done = print_part(words[i], words[i + 1], words[i + 2]);
    puts(".SH SEE ALSO\n.BR snowglass (1),\n.BR snowglass (3),\n"
         ".BR snowglass (5),\n.BR snowglass (7)");
    roff_text("and the documents in the folder share/doc/snowglass.");
    return done;
}
