/* pieces.h - a picture at rest that is drawn piece by piece, some lines of it
 * at a time.
 *
 * The page's worker hears nothing while the engine draws.  Between two pieces
 * it does: a turn that begins meanwhile waits for one of them, not for all. */
#ifndef WASM_PIECES_H
#define WASM_PIECES_H

#include "draw/drawing.h"

/* Pictures of the drawing in quality high are drawn so from now on. */
void pieces_begin(drawing *d);

#endif
