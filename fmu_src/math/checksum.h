/* The checksum FNV-1a (Fowler, Noll, Vo), applied to words of 64 bits. */
#ifndef CONTACT_MATH_CHECKSUM_H
#define CONTACT_MATH_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define CHECKSUM_START UINT64_C(14695981039346656037)

/* Extends a checksum by `size` bytes, a multiple of eight, and returns it; the first `sum` is CHECKSUM_START.
 * The checksum changes with any one word that is altered. */
static inline uint64_t checksum_of(uint64_t sum, const void *bytes, size_t size)
{
    for (size_t i = 0; i < size; i += sizeof sum) {
        uint64_t word;
        memcpy(&word, (const unsigned char *)bytes + i, sizeof word);
        sum = (sum ^ word) * UINT64_C(1099511628211);
    }
    return sum;
}

#endif
