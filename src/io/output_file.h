/* io/output_file.h - a file that is complete or absent: it has its final name
 * only when it is finished. */
#ifndef SNOW_IO_OUTPUT_FILE_H
#define SNOW_IO_OUTPUT_FILE_H

#include "base/base.h"

typedef struct snow_output_file {
    snow_context *context;
    char *path;        /* the final name, its links resolved */
    char *temporary;   /* the hidden name; NULL: none */
    bool unnamed;      /* the file has no name yet */
    const char *given; /* the caller's name, in `path`'s block */
    int descriptor;    /* -1: closed */
    bool overwrite;    /* may `path` be replaced? */
    bool hurried;      /* is not synced */
} snow_output_file;

/* Does what snow_writer_open does; after a failure nothing is left. */
snow_status snow_output_file_open(snow_context *context, const char *path,
                                  bool overwrite, snow_output_file *out);

/* Writes bytes; SNOW_STATUS_BAD_OUTPUT if the system does not take them. */
snow_status snow_output_file_write(snow_output_file *file,
                                   const unsigned char *bytes, size_t size);

/* Syncs (unless hurried), closes and names the file; then, or after a failure
 * of any call, it is to be abandoned. */
snow_status snow_output_file_finish(snow_output_file *file);

/* Closes the file, removes it unless it is finished, and frees its names. */
void snow_output_file_abandon(snow_output_file *file);

#endif
