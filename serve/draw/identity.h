/* identity.h - which file is shown, as far as its length and time say: a file
 * may be replaced while it is open, or before the viewer is started again. */
#ifndef IDENTITY_H
#define IDENTITY_H

#define IDENTITY_BYTES 64

/* "1048576.1764489600.000000000" of a file or a folder; "" if there is no such
 * file. */
void identity_of(const char *path, char out[IDENTITY_BYTES]);

/* The instruction set whose bits pictures have, for commands; NULL: that of the
 * machine. */
const char *identity_isa(void);

/* Of this program: another one, or the same started again, has another. */
const char *identity_of_program(void);

#endif
