/* bare_loop: the runs of a sweep in one plain loop, and nothing around them: what a sweep is compared with.

   Standard input: library, GUID and resources, a line each; then numbers: tolerance (below 0: none), start
   time; number of communication steps and where each ends; for Real, Integer and Boolean the number of start
   values, how many of them vary, their value references (those that vary first), the constants; for each of
   the three the number of values to read and their references; the number of runs. The file named on the
   command line holds the varied values run by run as doubles. Prints the seconds of the loop by the wall's
   clock and by the processor's, loading not among them, and a sum of all that was read, which keeps the loop
   honest. */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "functions.h"

enum { TYPES = 3, LINE = 4096 }; /* Real, Integer, Boolean; the longest path of Linux */

struct group {
    size_t count, varied, read_count;
    fmi2ValueReference *references, *read;
    fmi2Real *reals;
    fmi2Integer *integers;
};

struct loop {
    char library[LINE], guid[LINE], resources[LINE];
    double tolerance, start, *points;
    size_t point_count, runs, width; /* width: varied values of a run */
    struct group groups[TYPES];
};

static void fail(const char *text)
{
    fprintf(stderr, "bare_loop: %s\n", text);
    exit(1);
}

static void *room(size_t count, size_t size)
{
    void *found = calloc(count + 1, size);
    if (!found) {
        fail("out of memory");
    }
    return found;
}

static double number(void)
{
    double value = 0.0;
    if (scanf("%lf", &value) != 1) {
        fail("a number is missing");
    }
    return value;
}

static size_t count(void)
{
    return (size_t)number();
}

static fmi2ValueReference *references(size_t size)
{
    fmi2ValueReference *found = room(size, sizeof *found);
    for (size_t i = 0; i < size; i++) {
        found[i] = (fmi2ValueReference)number();
    }
    return found;
}

static void read_line(char *text)
{
    if (!fgets(text, LINE, stdin)) {
        fail("a line is missing");
    }
    text[strcspn(text, "\n")] = '\0';
}

static void read_loop(struct loop *loop)
{
    read_line(loop->library);
    read_line(loop->guid);
    read_line(loop->resources);
    loop->tolerance = number();
    loop->start = number();
    loop->point_count = count();
    loop->points = room(loop->point_count, sizeof *loop->points);
    for (size_t i = 0; i < loop->point_count; i++) {
        loop->points[i] = number();
    }
    for (int type = 0; type < TYPES; type++) {
        struct group *group = &loop->groups[type];
        group->count = count();
        group->varied = count();
        group->references = references(group->count);
        group->reals = room(group->count, sizeof *group->reals);
        group->integers = room(group->count, sizeof *group->integers);
        for (size_t i = group->varied; i < group->count; i++) {
            group->reals[i] = number();
            group->integers[i] = type > 0 ? (fmi2Integer)group->reals[i] : 0;
        }
        loop->width += group->varied;
    }
    for (int type = 0; type < TYPES; type++) {
        loop->groups[type].read_count = count();
        loop->groups[type].read = references(loop->groups[type].read_count);
    }
    loop->runs = count();
}

static void place(struct loop *loop, const double *row)
{
    for (int type = 0; type < TYPES; type++) {
        struct group *group = &loop->groups[type];
        for (size_t i = 0; i < group->varied; i++) {
            group->reals[i] = *row;
            group->integers[i] = type > 0 ? (fmi2Integer)*row : 0;
            row++;
        }
    }
}

/* The values read at the end of each communication step; what fails is left alone. */
static double run(const struct loop *loop, const struct functions *call, fmi2Component instance,
                  fmi2Real *real, fmi2Integer *integer)
{
    const struct group *r = &loop->groups[0], *i = &loop->groups[1], *b = &loop->groups[2];
    double sum = 0.0, time = loop->start;
    bool bad =
        call->reset(instance) > fmi2Warning ||
        call->setup_experiment(instance, loop->tolerance >= 0.0, loop->tolerance, time, fmi2False, 0.0) >
            fmi2Warning ||
        (r->count && call->set_real(instance, r->references, r->count, r->reals) > fmi2Warning) ||
        (i->count && call->set_integer(instance, i->references, i->count, i->integers) > fmi2Warning) ||
        (b->count && call->set_boolean(instance, b->references, b->count, b->integers) > fmi2Warning) ||
        call->enter_initialization_mode(instance) > fmi2Warning ||
        call->exit_initialization_mode(instance) > fmi2Warning;
    for (size_t k = 0; k < loop->point_count && !bad; k++) {
        double size = loop->points[k] - time;
        bad = call->do_step(instance, time, size, fmi2True) > fmi2Warning;
        time += size;
        if (!bad && r->read_count && call->get_real(instance, r->read, r->read_count, real) == fmi2OK) {
            sum += real[0];
        }
        if (!bad && i->read_count && call->get_integer(instance, i->read, i->read_count, integer) == fmi2OK) {
            sum += integer[0];
        }
        if (!bad && b->read_count && call->get_boolean(instance, b->read, b->read_count, integer) == fmi2OK) {
            sum += integer[0];
        }
    }
    return bad ? 0.0 : sum;
}

static void quiet(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                  fmi2String category, fmi2String format, ...)
{
    (void)environment, (void)instance, (void)status, (void)category, (void)format;
}

static double seconds(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argument_count, char **arguments)
{
    static struct loop loop;
    struct functions call;
    char failure[LINE];
    read_loop(&loop);
    if (argument_count != 2) {
        fail("usage: bare_loop FILE <description");
    }
    double *rows = room(loop.runs * loop.width, sizeof *rows);
    FILE *file = fopen(arguments[1], "rb");
    if (!file || fread(rows, sizeof *rows, loop.runs * loop.width, file) != loop.runs * loop.width) {
        fail("the file of varied values cannot be read");
    }
    fclose(file);
    if (!functions_load(&call, loop.library, failure, sizeof failure)) {
        fail(failure);
    }
    fmi2CallbackFunctions callbacks = {.logger = quiet, .allocateMemory = calloc, .freeMemory = free};
    fmi2Component instance = call.instantiate("bare", fmi2CoSimulation, loop.guid, loop.resources, &callbacks,
                                              fmi2False, fmi2False);
    if (!instance) {
        fail("fmi2Instantiate gave no instance");
    }
    size_t most = loop.groups[1].read_count + loop.groups[2].read_count;
    fmi2Real *real = room(loop.groups[0].read_count, sizeof *real);
    fmi2Integer *integer = room(most, sizeof *integer);
    double sum = 0.0, begin = seconds(CLOCK_MONOTONIC), used = seconds(CLOCK_PROCESS_CPUTIME_ID);
    for (size_t i = 0; i < loop.runs; i++) {
        place(&loop, rows + i * loop.width);
        sum += run(&loop, &call, instance, real, integer);
    }
    printf("%.9g %.9g %.17g\n", seconds(CLOCK_MONOTONIC) - begin, seconds(CLOCK_PROCESS_CPUTIME_ID) - used,
           sum);
    call.free_instance(instance);
    free(real);
    free(integer);
    return 0;
}
