/* renamed.h - the new spellings of options that had another one before 0.1. */
#ifndef RENAMED_H
#define RENAMED_H

/* What is now written for an option, whose name may be followed by =; NULL: it
 * never was one. */
const char *renamed_option(const char *name);

#endif
