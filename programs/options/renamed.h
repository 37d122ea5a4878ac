/* renamed.h - options that had another spelling before 0.1, or have one in other
 * programs. */
#ifndef RENAMED_H
#define RENAMED_H

/* "is now --box axes": what is written for an option, whose name may be followed
 * by =; NULL: it has no other spelling. */
const char *renamed_option(const char *name);

#endif
