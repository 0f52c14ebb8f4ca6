/* fmu_host: runs experiments on FMI 2.0 FMUs and measures their wall time, of co-simulation or of Model
   Exchange with an integrator of others.

   What is timed of a run: its initialization (fmi2SetupExperiment to fmi2ExitInitializationMode) and its
   stepping (every fmi2DoStep, and every fmi2GetReal asked for by --get; or the integration), apart from each
   other. Loading, instantiating, resetting and reading the results are not timed. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "exchange.h"
#include "options.h"
#include "result.h"
#include "slave.h"

static double now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static bool set_start_values(struct slave *slave, const struct experiment *one)
{
    for (size_t i = 0; i < one->start_count; i++) {
        const struct start_value *value = &one->start[i];
        const fmi2ValueReference *reference = &value->reference;
        const char *function = NULL;
        fmi2Status status = fmi2Error;
        switch (value->type) {
        case TYPE_REAL:
            function = "fmi2SetReal";
            status = slave->set_real(slave->instance, reference, 1, &value->real);
            break;
        case TYPE_INTEGER:
            function = "fmi2SetInteger";
            status = slave->set_integer(slave->instance, reference, 1, &value->integer);
            break;
        case TYPE_BOOLEAN:
            function = "fmi2SetBoolean";
            status = slave->set_boolean(slave->instance, reference, 1, &value->integer);
            break;
        default:
            function = "fmi2SetString";
            status = slave->set_string(slave->instance, reference, 1, &value->string);
        }
        if (!slave_check(slave, status, function)) {
            return false;
        }
    }
    return true;
}

static bool initialize(struct slave *slave, const struct experiment *one)
{
    fmi2Component instance = slave->instance;
    return slave_check(slave,
                       slave->setup_experiment(instance, one->tolerance_defined, one->tolerance,
                                               one->start_time, fmi2False, 0.0),
                       "fmi2SetupExperiment") &&
           set_start_values(slave, one) &&
           slave_check(slave, slave->enter_initialization_mode(instance), "fmi2EnterInitializationMode") &&
           slave_check(slave, slave->exit_initialization_mode(instance), "fmi2ExitInitializationMode");
}

/* Step i ends at start + i (stop - start)/N; the time goes on by the very size the FMU was given, so that
   both have the same bits and rounding does not add up. */
static bool run_steps(struct slave *slave, const struct experiment *one, fmi2Real *scratch)
{
    fmi2Component instance = slave->instance;
    double length = one->stop_time - one->start_time, time = one->start_time;
    for (long i = 1; i <= one->steps; i++) {
        double size = one->start_time + length * ((double)i / (double)one->steps) - time;
        fmi2Status status = slave->do_step(instance, time, size, fmi2True);
        for (size_t g = 0; g < one->get_count && status <= fmi2Warning; g++) {
            status = slave->get_real(instance, one->get[g].items, one->get[g].count, scratch);
        }
        if (status > fmi2Warning) {
            char function[100];
            snprintf(function, sizeof function, "fmi2DoStep or fmi2GetReal of step %ld from %.17g s", i,
                     time);
            return slave_check(slave, status, function);
        }
        time += size;
    }
    return true;
}

static bool read_results(struct slave *slave, const struct experiment *one, const struct result *result)
{
    const struct references *read = one->read;
    fmi2Component instance = slave->instance;
    return (read[TYPE_REAL].count == 0 ||
            slave_check(slave,
                        slave->get_real(instance, read[TYPE_REAL].items, read[TYPE_REAL].count, result->real),
                        "fmi2GetReal")) &&
           (read[TYPE_INTEGER].count == 0 ||
            slave_check(slave,
                        slave->get_integer(instance, read[TYPE_INTEGER].items, read[TYPE_INTEGER].count,
                                           result->integer),
                        "fmi2GetInteger")) &&
           (read[TYPE_BOOLEAN].count == 0 ||
            slave_check(slave,
                        slave->get_boolean(instance, read[TYPE_BOOLEAN].items, read[TYPE_BOOLEAN].count,
                                           result->boolean),
                        "fmi2GetBoolean"));
}

static bool run_once(struct slave *slave, const struct experiment *one, struct result *result, bool fresh)
{
    if (fresh) {
        slave_free_instance(slave);
    }
    if (!slave->instance) {
        if (!slave_instantiate(slave, one)) {
            return false;
        }
    } else if (!slave_check(slave, slave->reset(slave->instance), "fmi2Reset")) {
        return false;
    }
    double begin = now();
    if (!initialize(slave, one)) {
        return false;
    }
    double initialized = now();
    if (!(one->integrator ? exchange_run(slave, one) : run_steps(slave, one, result->scratch))) {
        return false;
    }
    double end = now();
    result->initialization[result->runs] = initialized - begin;
    result->stepping[result->runs] = end - initialized;
    result->spent += end - initialized;
    result->runs++;
    return read_results(slave, one, result) &&
           slave_check(slave, slave->terminate(slave->instance), "fmi2Terminate");
}

/* Every case gets its library; false only when out of memory. */
static bool load_all(const struct options *options, struct slave *slaves, struct result *results)
{
    for (size_t i = 0; i < options->count; i++) {
        if (!result_prepare(&results[i], &options->cases[i], options->repeat * options->burst)) {
            fprintf(stderr, "fmu_host: out of memory\n");
            return false;
        }
        results[i].failed = !slave_load(&slaves[i], &options->cases[i]);
        const char *const integrator = options->cases[i].integrator;
        const char *const lacks = integrator ? exchange_lacks(integrator) : NULL; /* loads it, too */
        if (!results[i].failed && lacks) {
            snprintf(slaves[i].failure, sizeof slaves[i].failure, "not installed: %s", lacks);
            fprintf(stderr, "%s\n", slaves[i].failure);
            results[i].failed = true;
        }
    }
    return true;
}

/* The cases take turns; one that failed, or whose budget is spent, sits out. */
static void run_all(const struct options *options, struct slave *slaves, struct result *results)
{
    for (long turn = 0; turn < options->repeat; turn++) {
        for (size_t i = 0; i < options->count; i++) {
            struct result *result = &results[i];
            for (long run = 0; run < options->burst && !result->failed; run++) {
                if (result->runs == 0 || result->spent < options->budget) {
                    result->failed = !run_once(&slaves[i], &options->cases[i], result, options->fresh);
                }
            }
        }
    }
}

/* 0: done; 1: a case failed; 2: the command line makes no sense. */
int main(int count, char **arguments)
{
    struct options options;
    bool parsed = options_parse(&options, count, arguments);
    if (!parsed || options.help) {
        if (options.help) {
            fputs(options_usage, stdout);
        }
        options_free(&options);
        return parsed ? 0 : 2;
    }
    struct slave *slaves = calloc(options.count, sizeof *slaves);
    struct result *results = calloc(options.count, sizeof *results);
    bool done = slaves && results && load_all(&options, slaves, results);
    if (done) {
        run_all(&options, slaves, results);
        for (size_t i = 0; i < options.count; i++) {
            result_print(&options.cases[i], &results[i], slaves[i].failure);
            done = done && !results[i].failed;
        }
    }
    for (size_t i = 0; slaves && results && i < options.count; i++) {
        slave_unload(&slaves[i]);
        result_release(&results[i]);
    }
    free(results);
    free(slaves);
    options_free(&options);
    return done ? 0 : 1;
}
