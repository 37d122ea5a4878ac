/* pages.h - the files of the page, which are part of the program, and how they
 * are sent. */
#ifndef PAGES_H
#define PAGES_H

#include "net/guard.h"

#include <libwebsockets.h>

/* A file as the build packed it (serve/embed.cmake). */
typedef struct page_file {
    const char *name; /* "" for the page itself */
    const char *type;
    const char *tag;             /* of its content, quoted */
    const unsigned char *packed; /* by gzip */
    size_t packed_length, length;
} page_file;

/* Ends with a row without a name. */
extern const page_file page_files[];

/* Origins whose pages may show the page in a frame, with blanks between; "":
 * none.  The text stays the caller's, and is called for before any request. */
void pages_embed(const char *origins);

/* The head of an answer that is no file of the page; false: the connection is
 * lost.  And one that refuses, which returns what a callback of lws does. */
bool pages_head(struct lws *wsi, const char *type, size_t length);
int pages_refuse(struct lws *wsi, unsigned status, const char *text);

/* Answers a request.  Returns what a callback of lws does. */
int pages_answer(struct lws *wsi, const guard *g, const char *path);

#endif
