/* formats/bytes/number.h - numbers in binary headers, in either byte order. */
#ifndef SNOW_FORMATS_BYTES_NUMBER_H
#define SNOW_FORMATS_BYTES_NUMBER_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* A number of `size` bytes, at most 8. */
static inline uint64_t snow_number_at(const unsigned char *bytes, int size,
                                      bool big_endian) {
    uint64_t value = 0;
    for (int i = 0; i < size; i++)
        value = value << 8 | bytes[big_endian ? i : size - 1 - i];
    return value;
}

/* Stores the low `size` bytes of a number in the machine's order. */
static inline void snow_put_low(uint64_t value, size_t size, void *at) {
    const uint16_t one = 1;
    const bool big_endian = *(const unsigned char *)&one == 0;
    memcpy(at, (const unsigned char *)&value + (big_endian ? 8 - size : 0),
           size);
}

static inline int64_t snow_integer_at(const unsigned char *bytes, int size,
                                      bool big_endian) {
    const uint64_t sign = UINT64_C(1) << (8 * size - 1);
    return (int64_t)((snow_number_at(bytes, size, big_endian) ^ sign) - sign);
}

static inline double snow_float_at(const unsigned char *bytes,
                                   bool big_endian) {
    const uint32_t bits = (uint32_t)snow_number_at(bytes, 4, big_endian);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static inline double snow_double_at(const unsigned char *bytes,
                                    bool big_endian) {
    const uint64_t bits = snow_number_at(bytes, 8, big_endian);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Of 4 or 8 bytes. */
static inline double snow_real_at(const unsigned char *bytes, int size,
                                  bool big_endian) {
    return size == 4 ? snow_float_at(bytes, big_endian)
                     : snow_double_at(bytes, big_endian);
}

#endif
