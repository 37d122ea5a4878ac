/* formats/index/index.h - files that name other files of volumes: the steps of
 * a series, and the parts of a grid.
 *
 *   list.c    the names, with the step and time of each -> one volume
 *   mosaic.c  parts that lie side by side -> one volume
 *   named.c   a file that is named
 *   xml.c     XML, element by element
 *   vtk.c     .pvd, .pvti and .vtm of VTK
 *   visit.c   .visit of VisIt
 *   bov.c     .bov of VisIt: a header beside raw data
 *   xdmf.c    XDMF of uniform and rectilinear grids, parsed by xdmf_text.c
 *
 * The files are opened as any other, in their own format. */
#ifndef SNOW_FORMATS_INDEX_INDEX_H
#define SNOW_FORMATS_INDEX_INDEX_H

#include "formats/format.h"
#include "io/seekable.h"

/* A file of the list. */
typedef struct index_entry {
    size_t name; /* where it begins in the block of names */
    int64_t step;
    double time; /* NaN: not given */
} index_entry;

/* Files in the order of their steps, which count from 0. */
typedef struct index_list {
    snow_context *context;
    char *names; /* ending with NUL, one after another */
    size_t used;
    index_entry *entries;
    size_t count;
} index_list;

/* Adds a file.  Errors: SNOW_STATUS_NO_MEMORY. */
snow_status snow_index_add(index_list *list, const char *name, int64_t step,
                           double time);
void snow_index_free(index_list *list);

/* Numbers the steps by rising time; files of one time are parts of a step. */
void snow_index_sort(index_list *list);

static inline const char *snow_index_name(const index_list *list, size_t i) {
    return list->names + list->entries[i].name;
}

/* Reads the step of the options: its only file, or all of them as parts of one
 * grid.  `format` is the name that info gets.  Errors: those of opening. */
snow_status snow_index_read(snow_source *source, const index_list *list,
                            const char *format,
                            const snow_volume_options *options,
                            snow_volume_info *info, snow_volume **out);

/* Parts that lie side by side on one grid: how one is called, and opened. */
#define INDEX_NAME_BYTES 256
typedef struct index_parts {
    snow_context *context;
    size_t count; /* at least 1 */
    void *user;
    void (*name)(void *user, size_t index, char name[INDEX_NAME_BYTES]);
    snow_status (*open)(void *user, size_t index,
                        const snow_volume_options *options,
                        snow_volume_info *info, snow_volume **out);
} index_parts;

snow_status snow_mosaic_read(const index_parts *parts,
                             const snow_volume_options *options,
                             snow_volume_info *info, snow_volume **out);

/* The same of files `first` .. `end` - 1. */
snow_status snow_mosaic_read_named(snow_source *source, const index_list *list,
                                   size_t first, size_t end,
                                   const snow_volume_options *options,
                                   snow_volume_info *info, snow_volume **out);

/* Copies the part of `from`, whose first voxel is voxel `at` of the whole, that
 * lies in `to`, which begins at voxel `first` of the whole. */
void snow_mosaic_copy(const snow_volume *from, const int64_t at[3],
                      const int64_t first[3], snow_volume *to);

/* What an XML file is handed to; any may be NULL.  A status other than
 * SNOW_STATUS_OK ends it. */
typedef struct index_xml {
    snow_status (*begin)(void *user, const char *name, const char **attributes);
    snow_status (*end)(void *user, const char *name);
    snow_status (*text)(void *user, const char *text, size_t length);
} index_xml;

/* Errors: SNOW_STATUS_BAD_INPUT (not well-formed), those of the functions. */
snow_status snow_index_parse(snow_source *source, const index_xml *handlers,
                             void *user);

/* A text of XML, whose bytes come from `next`, which gives none at its end. */
typedef struct index_text {
    snow_context *context;
    const index_xml *handlers;
    void *user;
    snow_status (*next)(void *from, char *bytes, size_t size, size_t *got);
    void *from;
    const char *before; /* tags before its bytes, which are open; NULL: none */
    const char *where;  /* it is, for messages; NULL: their line */
    uint64_t at, end;   /* of the tag whose `begin` is called */
    bool done;          /* set by these functions: no more is wanted */
} index_text;

/* Errors as above. */
snow_status snow_index_parse_text(index_text *text);

/* `next` of bytes in any order, from `at` on. */
typedef struct index_bytes {
    snow_seekable *bytes;
    uint64_t at;
} index_bytes;
snow_status snow_index_next(void *from, char *bytes, size_t size, size_t *got);

/* An attribute's value, NULL if it is missing. */
const char *snow_index_attribute(const char **attributes, const char *name);

#endif
