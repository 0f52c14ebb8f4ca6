/* This file has the checksum FNV-1a (Fowler, Noll, Vo), applied to words of 32 bits. */
#ifndef CONTACT_MATH_CHECKSUM_H
#define CONTACT_MATH_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define CHECKSUM_START 2166136261u

/* Extends a checksum by `size` bytes, a multiple of four, and returns it; the first `sum` is CHECKSUM_START.
 * The checksum changes with any one word that is altered. */
static inline uint32_t checksum_of(uint32_t sum, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i += sizeof sum) {
        uint32_t word;
        memcpy(&word, (const unsigned char *)bytes + i, sizeof word);
        sum = (sum ^ word) * 16777619u;
    }
    return sum;
}

#endif
