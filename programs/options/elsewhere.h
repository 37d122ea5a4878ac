/* elsewhere.h - options that other programs have under another name. */
#ifndef ELSEWHERE_H
#define ELSEWHERE_H

/* "is here --range LO,HI": what is written here for an option of others, whose
 * name may be followed by =; NULL: it is none of them. */
const char *option_elsewhere(const char *name);

#endif
