/* cloudvalue.h -- the numbers in binary scans: integers of two's complement, IEEE floats, in
 * either byte order, at any address. */
#ifndef SCAN_CLOUDVALUE_H
#define SCAN_CLOUDVALUE_H
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum cloudvalue {
    CLOUDVALUE_NONE,
    CLOUDVALUE_I8,
    CLOUDVALUE_U8,
    CLOUDVALUE_I16,
    CLOUDVALUE_U16,
    CLOUDVALUE_I32,
    CLOUDVALUE_U32,
    CLOUDVALUE_F32,
    CLOUDVALUE_F64,
    CLOUDVALUE_F16,
    CLOUDVALUE_I64,
    CLOUDVALUE_U64
};

/* In bytes, by type. */
static const unsigned char cloudvalue_size[] = {0, 1, 1, 2, 2, 4, 4, 4, 8, 2, 8, 8};

/* cloudvalue_swap(big): Returns true if this machine has the other byte order than data of this order. */
static inline bool cloudvalue_swap(bool big)
{
    static const uint16_t probe = 1;

    return big == (*(const unsigned char *)&probe == 1);
}

/* cloudvalue_half(h): Returns the value of a float of 16 bits: 10 of the fraction below 5 of the exponent. */
static inline double cloudvalue_half(uint16_t h)
{
    const int exponent = h >> 10 & 31, fraction = h & 1023;
    const double v = exponent == 31  ? (fraction == 0 ? (double)INFINITY : (double)NAN)
                     : exponent == 0 ? ldexp(fraction, -24)
                                     : ldexp(1024 + fraction, exponent - 25);

    return h >> 15 ? -v : v;
}

/* cloudvalue_load(p, type, swap): Reads the value at p.  type is not CLOUDVALUE_NONE. */
static inline double cloudvalue_load(const unsigned char *p, enum cloudvalue type,
                                     bool swap)
{
    uint16_t u16;
    uint32_t u32;
    uint64_t u64;
    float f32;
    double f64;

    switch (cloudvalue_size[type]) {
    case 1:
        return type == CLOUDVALUE_I8 ? (double)(int8_t)*p : (double)*p;
    case 2:
        memcpy(&u16, p, sizeof u16);
        u16 = swap ? __builtin_bswap16(u16) : u16;
        return type == CLOUDVALUE_I16   ? (double)(int16_t)u16
               : type == CLOUDVALUE_F16 ? cloudvalue_half(u16)
                                        : (double)u16;
    case 4:
        memcpy(&u32, p, sizeof u32);
        u32 = swap ? __builtin_bswap32(u32) : u32;
        memcpy(&f32, &u32, sizeof f32);
        return type == CLOUDVALUE_F32   ? (double)f32
               : type == CLOUDVALUE_I32 ? (double)(int32_t)u32
                                        : (double)u32;
    default:
        memcpy(&u64, p, sizeof u64);
        u64 = swap ? __builtin_bswap64(u64) : u64;
        memcpy(&f64, &u64, sizeof f64);
        return type == CLOUDVALUE_I64   ? (double)(int64_t)u64
               : type == CLOUDVALUE_U64 ? (double)u64
                                        : f64;
    }
}

#endif
