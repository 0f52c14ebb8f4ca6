/* Claims of the fuzzers, whatever the version of the standard: a broken one ends the process. */
#ifndef FUZZ_CLAIM_H
#define FUZZ_CLAIM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What libFuzzer and replay.c call with one input. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* What a broken claim prints beside itself. */
struct claim_context {
    char last_message[2048]; /* of the FMU */
    char note[128];
    void (*show)(void); /* prints more, where set */
};

extern struct claim_context claim_context;

void claim(bool holds, const char *text, const char *file, int line);

#define CLAIM(holds) claim((holds), #holds, __FILE__, __LINE__)

#endif
