/* movie_names.h - names of files that differ by a number, in printf's notation:
 * run_%04d.nrrd is run_0000.nrrd, run_0001.nrrd, ... */
#ifndef MOVIE_NAMES_H
#define MOVIE_NAMES_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The parts around the number.  The folder is "" or ends with a slash. */
typedef struct frame_names {
    char folder[PATH_MAX];
    char before[NAME_MAX + 1], after[NAME_MAX + 1];
    int digits;      /* minimum, filled up with zeros; 0: as many as needed */
    bool any;        /* each existing name has its own: %T */
    bool iterations; /* at any distance: %T, %06T */
} frame_names;

/* Whether a path contains a %, so that it is meant as a pattern. */
bool names_are_meant(const char *path);

/* Parses a pattern: one %d or %0Nd (N 1 to 9), or %T as openPMD writes it, in
 * the last part of the path, %% for a percent sign.  Returns NULL, or the
 * error: the end of a sentence that begins with the path. */
const char *names_read(const char *path, frame_names *out);

/* The path of number `index`; returns false if it needs more than `size`
 * bytes. */
bool names_path(const frame_names *names, int64_t index, char *out,
                size_t size);

/* The name of a data set with the same number; false if it needs more than
 * `size` bytes, or has another %. */
bool names_in_set(const char *set, int64_t index, char *out, size_t size);

/* The number in a file's name, without its folder; -1 if the name does not fit
 * the pattern. */
int64_t names_index(const frame_names *names, const char *file);

/* Gives a pattern for any minimum the width of this name's number. */
void names_widen(frame_names *names, const char *file);

/* The folder as a path for opendir. */
const char *names_folder(const frame_names *names);

#endif
