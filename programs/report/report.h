/* report.h - the structure of a file's header, without what it says of people.
 *
 * Each format has a function that writes lines such as "(0028,0010) US 2 Rows =
 * 512".  Of values it writes numbers and words of technical elements only
 * (words.c); of anything else the length.  The functions read the bytes
 * themselves, since a report is wanted of files that the library refuses. */
#ifndef REPORT_STRUCTURE_H
#define REPORT_STRUCTURE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

/* A file: its first bytes, unpacked where gzip packed it, and all others by
 * source_read. */
typedef struct source {
    int file; /* -1: none, as of a folder */
    uint64_t size;
    unsigned char *head;
    size_t head_size;
} source;

#define SOURCE_HEAD ((size_t)16 << 20) /* headers are hardly ever longer */

/* Returns false with errno where the file cannot be read. */
bool source_open(const char *path, source *out);
void source_close(source *from);

/* The number of bytes that were there, as they are stored. */
size_t source_read(const source *from, uint64_t at, void *bytes, size_t size);

/* A whole number of 1 to 8 bytes. */
uint64_t whole_at(const unsigned char *bytes, int size, bool big);
double real_at(const unsigned char *bytes, int size, bool big);

/* Each writes the structure of its format; false: the file has another. */
bool report_dicom(FILE *out, const source *from);
bool report_nifti(FILE *out, const source *from);
bool report_text(FILE *out, const source *from); /* NRRD and MetaImage */
bool report_tiff(FILE *out, const source *from);
bool report_hdf5(FILE *out, const source *from);
bool report_netcdf(FILE *out, const source *from);

/* A folder: its Zarr metadata, or the first DICOM file of each kind. */
void report_folder(FILE *out, const char *path);

/* --- words.c -------------------------------------------------------------- */

/* Whether a word is one of those that formats use, such as MONOCHROME2. */
bool is_technical(const char *word, size_t length);

/* Whether that is the name of a technical number, as `slope` is, and `id` is
 * not. */
bool has_technical_number(const char *name, size_t length);

/* Writes a text if it is made of technical words and numbers alone, else "text
 * of 12 bytes"; and a name in the same way. */
void put_text(FILE *out, const char *text, size_t length);
void put_name(FILE *out, const char *name, size_t length);

/* A copy with technical keys, and their numbers and technical words; of others
 * the length. */
json_t *technical_json(const json_t *from);

/* Writes a message of the library with a * for each word that may come from the
 * file: its path, names of data sets, or text in `foreign`. */
void put_message(FILE *out, const char *message, const char *foreign,
                 size_t size);

/* The names and first bytes of a file or folder, which messages may cite. */
char *foreign_text(const char *path, const source *from, size_t *size);

#endif
