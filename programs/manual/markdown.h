/* markdown.h - text in the Markdown of docs/, written for a manual page. */
#ifndef MARKDOWN_H
#define MARKDOWN_H

typedef struct markdown markdown;

/* Takes lines one by one; they must stay until the end, which writes the rest.
 * Headings become those of subsections. */
markdown *markdown_new(void);
void markdown_line(markdown *, char *line);
void markdown_free(markdown *);

/* A file's text, or NULL and a message. */
char *read_whole(const char *path);

#endif
