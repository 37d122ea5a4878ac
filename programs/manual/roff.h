/* roff.h - text of manual pages, in the macros man(7), which every reader of
 * manual pages knows. */
#ifndef ROFF_H
#define ROFF_H

#include <stdbool.h>
#include <stddef.h>

/* Characters, `typed` with hyphens that stay so when they are copied; a line
 * of a program; a paragraph; one with the marks of Markdown. */
void roff_chars(const char *text, size_t length, bool typed);
void roff_code_line(const char *line, size_t length);
void roff_text(const char *text);
void roff_prose(const char *text, bool one_line);

/* A line of a macro with one argument; a tagged paragraph. */
void roff_macro(const char *macro, const char *text);
void roff_item(const char *name, const char *text);

/* The title, and the heading of the section NAME. */
void roff_head(const char *title, int section, const char *origin);

#endif
