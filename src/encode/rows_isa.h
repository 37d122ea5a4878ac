/* encode/rows_isa.h - the row loops for codes of 8 and 16 bits of one
 * instruction set.  Include simd/select.h first. */
#define ROW_CODE uint8_t
#define ROW(word) NAME(word##_8)
#include "encode/rows.tmpl.h"
#define ROW_CODE uint16_t
#define ROW(word) NAME(word##_16)
#include "encode/rows.tmpl.h"
