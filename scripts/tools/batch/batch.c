#include "batch.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "functions.h"

/* One instance at work, and room for the values of one run. */
struct worker {
    const struct batch *batch;
    struct functions functions;
    fmi2Component instance;
    bool fresh;                      /* not run since it was instantiated or reset */
    fmi2CallbackFunctions callbacks; /* lives as long as the instance */
    char *message;                   /* of the present run, BATCH_MESSAGE_SIZE bytes */
    int32_t *warnings;               /* of the present run */
    fmi2Real *real;                  /* start values, those that vary first */
    fmi2Integer *integer, *boolean;
    double *read;              /* values read at the present communication point: Real, Integer, Boolean */
    double *before;            /* those at the one before */
    double *reduced;           /* of each output */
    fmi2Integer *read_integer; /* room for one call */
};

/* Warnings are counted, and the first message of a run that is worse is kept. The component environment is
   the worker. */
static void log_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                        fmi2String category, fmi2String format, ...)
{
    struct worker *worker = environment;
    (void)instance;
    (void)category;
    *worker->warnings += status == fmi2Warning;
    if (status == fmi2OK || status == fmi2Warning || !format || worker->message[0] != '\0') {
        return;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(worker->message, BATCH_MESSAGE_SIZE, format, arguments);
    va_end(arguments);
}

static bool good(fmi2Status status)
{
    return status == fmi2OK || status == fmi2Warning;
}

static void free_all(struct worker *worker)
{
    if (worker->instance) {
        worker->functions.free_instance(worker->instance);
    }
    free(worker->real);
    free(worker->integer);
    free(worker->boolean);
    free(worker->read);
    free(worker->before);
    free(worker->reduced);
    free(worker->read_integer);
    functions_unload(&worker->functions);
}

/* One element more than asked for: calloc may give NULL for none. */
static void *room(int64_t count, size_t size)
{
    return calloc((size_t)count + 1, size);
}

static bool allocate(struct worker *worker)
{
    const struct batch *batch = worker->batch;
    int64_t integers = batch->read_integer.count, booleans = batch->read_boolean.count;
    int64_t all = batch->read_real.count + integers + booleans;
    worker->real = room(batch->real.count, sizeof *worker->real);
    worker->integer = room(batch->integer.count, sizeof *worker->integer);
    worker->boolean = room(batch->boolean.count, sizeof *worker->boolean);
    worker->read = room(all, sizeof *worker->read);
    worker->before = room(all, sizeof *worker->before);
    worker->reduced = room(batch->output_count, sizeof *worker->reduced);
    worker->read_integer = room(integers > booleans ? integers : booleans, sizeof *worker->read_integer);
    return worker->real && worker->integer && worker->boolean && worker->read && worker->before &&
           worker->reduced && worker->read_integer;
}

/* The constants stay where they are from run to run. */
static void place_constants(void *values, const struct batch_set *set, size_t size)
{
    if (set->count > set->varied) {
        memcpy((char *)values + (size_t)set->varied * size, set->constants,
               (size_t)(set->count - set->varied) * size);
    }
}

static bool instantiate(struct worker *worker)
{
    const struct batch *batch = worker->batch;
    worker->callbacks = (fmi2CallbackFunctions){
        .logger = log_message, .allocateMemory = calloc, .freeMemory = free, .componentEnvironment = worker};
    worker->instance =
        worker->functions.instantiate(batch->name, fmi2CoSimulation, batch->guid, batch->resources,
                                      &worker->callbacks, fmi2False, fmi2False);
    worker->fresh = true;
    return worker->instance != NULL;
}

static fmi2Status set_values(struct worker *worker, int64_t run)
{
    const struct batch *batch = worker->batch;
    const struct batch_set *real = &batch->real, *integer = &batch->integer, *boolean = &batch->boolean;
    for (int64_t i = 0; i < real->varied; i++) {
        worker->real[i] = ((const fmi2Real *)real->columns)[i * batch->runs + run];
    }
    for (int64_t i = 0; i < integer->varied; i++) {
        worker->integer[i] = ((const fmi2Integer *)integer->columns)[i * batch->runs + run];
    }
    for (int64_t i = 0; i < boolean->varied; i++) {
        worker->boolean[i] = ((const fmi2Integer *)boolean->columns)[i * batch->runs + run];
    }
    const struct functions *call = &worker->functions;
    fmi2Component instance = worker->instance;
    fmi2Status status = fmi2OK;
    if (real->count > 0) {
        status = call->set_real(instance, real->references, (size_t)real->count, worker->real);
    }
    if (good(status) && integer->count > 0) {
        status = call->set_integer(instance, integer->references, (size_t)integer->count, worker->integer);
    }
    if (good(status) && boolean->count > 0) {
        status = call->set_boolean(instance, boolean->references, (size_t)boolean->count, worker->boolean);
    }
    if (good(status) && batch->string_count > 0) {
        status =
            call->set_string(instance, batch->string_references, (size_t)batch->string_count, batch->strings);
    }
    return status;
}

static fmi2Status initialize(struct worker *worker, int64_t run)
{
    const struct batch *batch = worker->batch;
    const struct functions *call = &worker->functions;
    fmi2Component instance = worker->instance;
    fmi2Boolean tolerance_defined = batch->tolerance_defined != 0;
    fmi2Status status = call->setup_experiment(instance, tolerance_defined, batch->tolerance,
                                               batch->start_time, fmi2False, 0.0);
    status = good(status) ? set_values(worker, run) : status;
    status = good(status) ? call->enter_initialization_mode(instance) : status;
    return good(status) ? call->exit_initialization_mode(instance) : status;
}

static fmi2Status read_point(struct worker *worker)
{
    const struct batch *batch = worker->batch;
    const struct batch_read *real = &batch->read_real, *integer = &batch->read_integer;
    const struct batch_read *boolean = &batch->read_boolean;
    const struct functions *call = &worker->functions;
    fmi2Component instance = worker->instance;
    double *value = worker->read;
    fmi2Status status = fmi2OK;
    if (real->count > 0) {
        status = call->get_real(instance, real->references, (size_t)real->count, value);
        value += real->count;
    }
    if (good(status) && integer->count > 0) {
        status =
            call->get_integer(instance, integer->references, (size_t)integer->count, worker->read_integer);
        for (int64_t i = 0; i < integer->count; i++) {
            *value++ = (double)worker->read_integer[i];
        }
    }
    if (good(status) && boolean->count > 0) {
        status =
            call->get_boolean(instance, boolean->references, (size_t)boolean->count, worker->read_integer);
        for (int64_t i = 0; i < boolean->count; i++) {
            *value++ = (double)worker->read_integer[i];
        }
    }
    return status;
}

/* Takes in the values of a communication point, `size` s after the one before. What is not a number stays. */
static void reduce(struct worker *worker, int64_t point, double size)
{
    const struct batch *batch = worker->batch;
    for (int64_t i = 0; i < batch->output_count; i++) {
        const struct batch_output *output = &batch->outputs[i];
        double value = worker->read[output->source], *reduced = &worker->reduced[i];
        bool start = point == 0;
        switch ((enum batch_reduction)output->reduction) {
        case BATCH_AT:
            *reduced = point == output->point ? value : *reduced;
            break;
        case BATCH_MAX:
            *reduced = start || value > *reduced || isnan(value) ? value : *reduced;
            break;
        case BATCH_MIN:
            *reduced = start || value < *reduced || isnan(value) ? value : *reduced;
            break;
        case BATCH_MEAN:
            *reduced = start ? 0.0 : *reduced + 0.5 * (worker->before[output->source] + value) * size;
            break;
        }
    }
    double *read = worker->read;
    worker->read = worker->before;
    worker->before = read;
}

/* The time goes on by the very size the FMU was given, so that both have the same bits. */
static fmi2Status run_steps(struct worker *worker)
{
    const struct batch *batch = worker->batch;
    double time = batch->start_time, size = 0.0;
    for (int64_t point = 0; point <= batch->point_count; point++) {
        if (point > 0) {
            size = batch->points[point - 1] - time;
            fmi2Status status = worker->functions.do_step(worker->instance, time, size, fmi2True);
            if (!good(status)) {
                return status;
            }
            time += size;
        }
        if (batch->reads[point]) {
            fmi2Status status = read_point(worker);
            if (!good(status)) {
                return status;
            }
            reduce(worker, point, size);
        }
    }
    for (int64_t i = 0; i < batch->output_count; i++) {
        if (batch->outputs[i].reduction == BATCH_MEAN) {
            worker->reduced[i] /= time - batch->start_time;
        }
    }
    return fmi2OK;
}

/* An instance that is not fresh is reset; one that cannot be, and one after an error, is replaced. */
static bool ready(struct worker *worker)
{
    if (worker->instance && !worker->fresh && !good(worker->functions.reset(worker->instance))) {
        worker->functions.free_instance(worker->instance);
        worker->instance = NULL;
    }
    worker->message[0] = '\0';
    return worker->instance || instantiate(worker);
}

static fmi2Status run_once(struct worker *worker, int64_t run)
{
    if (!ready(worker)) {
        return fmi2Error;
    }
    worker->fresh = false;
    fmi2Status status = initialize(worker, run);
    status = good(status) ? run_steps(worker) : status;
    if (status == fmi2Fatal) {
        worker->instance = NULL; /* after fmi2Fatal no function may be called, fmi2FreeInstance included */
    } else if (status == fmi2Error) {
        worker->functions.free_instance(worker->instance);
        worker->instance = NULL;
    }
    return status;
}

int contact_batch_run(const struct batch *batch)
{
    struct worker worker = {.batch = batch, .message = batch->messages, .warnings = batch->warnings};
    bool loaded = functions_load(&worker.functions, batch->library, batch->messages, BATCH_MESSAGE_SIZE);
    if (!loaded || !allocate(&worker)) {
        if (loaded) {
            snprintf(batch->messages, BATCH_MESSAGE_SIZE, "out of memory");
        }
        free_all(&worker);
        return 1;
    }
    place_constants(worker.real, &batch->real, sizeof(fmi2Real));
    place_constants(worker.integer, &batch->integer, sizeof(fmi2Integer));
    place_constants(worker.boolean, &batch->boolean, sizeof(fmi2Integer));
    for (int64_t run = 0; run < batch->runs; run++) {
        worker.message = batch->messages + run * BATCH_MESSAGE_SIZE;
        worker.warnings = batch->warnings + run;
        fmi2Status status = run_once(&worker, run);
        bool done = good(status);
        if (done) {
            worker.message[0] = '\0';
        }
        batch->status[run] = (uint8_t)(done ? fmi2OK : status);
        for (int64_t i = 0; i < batch->output_count; i++) {
            batch->values[i * batch->runs + run] = done ? worker.reduced[i] : (double)NAN;
        }
    }
    /* fmi2FreeInstance may log, and the run it would be told of is over. */
    char scratch[BATCH_MESSAGE_SIZE] = "";
    int32_t ignored = 0;
    worker.message = scratch;
    worker.warnings = &ignored;
    free_all(&worker);
    return 0;
}
