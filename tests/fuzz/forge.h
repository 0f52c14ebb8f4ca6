/* Saved states whose bytes somebody changed, with a checksum that fits nevertheless. */
#ifndef FUZZ_FORGE_H
#define FUZZ_FORGE_H

#include "bytes.h"

/* The adapter's header, as in support/fmi2/states.py: magic, version, scene, checksum, size, times, flags */
enum { HEADER_SIZE = 48, HEADER_CHECKSUM = 12, CHECKED_FROM = 16, LARGEST_BLOCK = 16384 };

/* Changes some of the bytes. */
void forge_changes(uint8_t *block, size_t size, struct bytes *b);

/* However a state was changed, a step of it has to end soon. */
void forge_bound_work(uint8_t *block, int most_internal_steps);

/* Puts the checksum that fits. */
void forge_checksum(uint8_t *block, size_t size);

#endif
