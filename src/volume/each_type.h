/* volume/each_type.h - includes a template once for each scalar type, with
 *
 *   TYPE         its C type
 *   TYPED(word)  word with the name that SNOW_TYPE_MAP gives the type
 *   LOWEST       its smallest value; only of integers of 8 and 16 bits, whose
 *                values a table holds
 *
 * Define TEMPLATE, the template's name in quotes, before including.  The
 * template undefines the others; TEMPLATE is undefined at the end. */
#define TYPE int8_t
#define TYPED(word) word##_INT8
#define LOWEST INT8_MIN
#include TEMPLATE
#define TYPE uint8_t
#define TYPED(word) word##_UINT8
#define LOWEST 0
#include TEMPLATE
#define TYPE int16_t
#define TYPED(word) word##_INT16
#define LOWEST INT16_MIN
#include TEMPLATE
#define TYPE uint16_t
#define TYPED(word) word##_UINT16
#define LOWEST 0
#include TEMPLATE
#define TYPE int32_t
#define TYPED(word) word##_INT32
#include TEMPLATE
#define TYPE uint32_t
#define TYPED(word) word##_UINT32
#include TEMPLATE
#define TYPE int64_t
#define TYPED(word) word##_INT64
#include TEMPLATE
#define TYPE uint64_t
#define TYPED(word) word##_UINT64
#include TEMPLATE
#define TYPE float
#define TYPED(word) word##_FLOAT32
#include TEMPLATE
#define TYPE double
#define TYPED(word) word##_FLOAT64
#include TEMPLATE
#undef TEMPLATE
