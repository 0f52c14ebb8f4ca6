/* Runs that differ in method, law and motion, for programs that look at memory and threads. Every run is a
 * row of steps, so that many can be interleaved; what it gave is a number of the bits of all outputs. */
#ifndef SANITIZE_SCENARIOS_H
#define SANITIZE_SCENARIOS_H

#include <stdint.h>

#include <fmi2Functions.h>

enum { SCENARIOS = 64, SCENARIO_STEPS = 24 };

struct scenario {
    fmi2Component component;
    int index;
    uint64_t digest;
};

/* An instance of scenario 0 .. SCENARIOS - 1, initialized. Ends the process with a message if a call fails */
struct scenario scenario_begin(int index);

/* The communication steps in order. */
void scenario_step(struct scenario *scenario, int step);

/* Frees the instance; the digest of all bits. */
uint64_t scenario_end(struct scenario *scenario);

#endif
