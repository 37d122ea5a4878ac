/* files.h - what a page has instead of a system: the files that it was given,
 * which are read in place, and standard output in memory. */
#ifndef WASM_FILES_H
#define WASM_FILES_H

#include <stddef.h>

/* What was written to standard output since it was last forgotten. */
const unsigned char *files_output(size_t *length);
void files_forget_output(void);

#endif
