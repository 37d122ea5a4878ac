/* volume/type.c - scalar types: sizes, names, byte order. */
#include "volume/volume.h"

#include <limits.h>
#include <string.h>

_Static_assert(CHAR_BIT == 8 && sizeof(float) == 4 && sizeof(double) == 8,
               "the scalar types of files are the machine's");

/* A switch without default: the compiler names the type that is forgotten. */
size_t snow_type_size(snow_type type) {
    switch (type) {
#define TYPE_SIZE(name, c_type, text) \
    case SNOW_TYPE_##name:            \
        return sizeof(c_type);
        SNOW_TYPE_MAP(TYPE_SIZE)
#undef TYPE_SIZE
    case SNOW_TYPE_NONE:
        break;
    }
    return 0;
}

/* "none" for what is no type: messages may quote one before it is checked. */
const char *snow_type_name(snow_type type) {
    switch (type) {
#define TYPE_NAME(name, c_type, text) \
    case SNOW_TYPE_##name:            \
        return text;
        SNOW_TYPE_MAP(TYPE_NAME)
#undef TYPE_NAME
    case SNOW_TYPE_NONE:
        break;
    }
    return "none";
}

/* Case does not matter; the many spellings of NRRD and raw names are those
 * readers' matter. */
snow_type snow_type_from_name(const char *name) {
    static const struct {
        const char *name;
        snow_type type;
    } names[] = {
#define TYPE_NAMED(name, c_type, text) {text, SNOW_TYPE_##name},
        SNOW_TYPE_MAP(TYPE_NAMED)
#undef TYPE_NAMED
            {"float", SNOW_TYPE_FLOAT32},
        {"double", SNOW_TYPE_FLOAT64},
    };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (snow_same_name(name, names[i].name))
            return names[i].type;
    return SNOW_TYPE_NONE;
}

snow_type snow_type_of_integer(size_t bytes, bool is_signed) {
    for (int type = is_signed ? SNOW_TYPE_INT8 : SNOW_TYPE_UINT8;
         type < SNOW_TYPE_FLOAT32; type += 2)
        if (snow_type_size((snow_type)type) == bytes)
            return (snow_type)type;
    return SNOW_TYPE_NONE;
}

bool snow_type_is_signed(snow_type type) {
    return type && type == snow_type_of_integer(snow_type_size(type), true);
}

/* Asked at run time, which compilers fold to a constant; C11 has no macro. */
bool snow_machine_big_endian(void) {
    const uint16_t one = 1;
    unsigned char first;
    memcpy(&first, &one, 1);
    return first == 0;
}

/* One loop for each width, so that the compiler makes it byte shuffles. */
static void swap_2(unsigned char *at, uint64_t count) {
    for (uint64_t i = 0; i < count; i++, at += 2) {
        unsigned char first = at[0];
        at[0] = at[1];
        at[1] = first;
    }
}

static void swap_4(unsigned char *at, uint64_t count) {
    for (uint64_t i = 0; i < count; i++, at += 4) {
        uint32_t v;
        memcpy(&v, at, 4);
        v = v >> 24 | (v >> 8 & 0xff00) | (v << 8 & 0xff0000) | v << 24;
        memcpy(at, &v, 4);
    }
}

/* Written as a loop over bytes, which compilers turn into one instruction. */
static void swap_8(unsigned char *at, uint64_t count) {
    for (uint64_t i = 0; i < count; i++, at += 8) {
        unsigned char turned[8];
        for (int k = 0; k < 8; k++)
            turned[k] = at[7 - k];
        memcpy(at, turned, 8);
    }
}

/* Sizes 1 and 0 have nothing to swap. */
void snow_swap_bytes(void *values, uint64_t count, size_t size) {
    if (size == 2)
        swap_2(values, count);
    else if (size == 4)
        swap_4(values, count);
    else if (size == 8)
        swap_8(values, count);
}
