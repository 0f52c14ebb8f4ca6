/*
 * 64 instances of one FMU at a time in 8 threads, each taking turns among its 8: every run gives the bits
 * it gives alone, and the thread sanitizer, with which this program is built, sees no access that two
 * threads share.
 */
#include <pthread.h>
#include <stdio.h>

#include "scenarios.h"

enum { THREADS = 8, EACH = SCENARIOS / THREADS };

static uint64_t digests[SCENARIOS];
static pthread_barrier_t together;

static void *work(void *position)
{
    const int first = *(const int *)position;
    struct scenario runs[EACH];
    pthread_barrier_wait(&together);
    for (int i = 0; i < EACH; ++i) {
        runs[i] = scenario_begin(first + i * THREADS);
    }
    for (int step = 0; step < SCENARIO_STEPS; ++step) {
        for (int i = 0; i < EACH; ++i) {
            scenario_step(&runs[i], step);
        }
    }
    pthread_barrier_wait(&together); /* all are alive until all are done */
    for (int i = 0; i < EACH; ++i) {
        digests[first + i * THREADS] = scenario_end(&runs[i]);
    }
    return NULL;
}

static uint64_t run_alone(int index)
{
    struct scenario run = scenario_begin(index);
    for (int step = 0; step < SCENARIO_STEPS; ++step) {
        scenario_step(&run, step);
    }
    return scenario_end(&run);
}

int main(void)
{
    pthread_t threads[THREADS];
    int positions[THREADS];
    int differing = 0, alike = 0;
    pthread_barrier_init(&together, NULL, THREADS);
    for (int i = 0; i < THREADS; ++i) {
        positions[i] = i;
        if (pthread_create(&threads[i], NULL, work, &positions[i]) != 0) {
            return 2;
        }
    }
    for (int i = 0; i < THREADS; ++i) {
        pthread_join(threads[i], NULL);
    }
    for (int index = 0; index < SCENARIOS; ++index) {
        differing += run_alone(index) != digests[index];
        alike += index > 0 && digests[index] == digests[index - 1]; /* else any digest would do */
    }
    printf("%d instances in %d threads: %d differ from runs alone, %d are like their neighbour\n", SCENARIOS,
           THREADS, differing, alike);
    return differing > 0 || alike > 0;
}
