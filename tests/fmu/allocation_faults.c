/*
 * allocation_faults count|fail LIBRARY GUID METHOD_REFERENCE METHOD: what an FMU does with memory.
 *
 * The program's own malloc, calloc, realloc and free stand in for those of libc in the whole process, so that
 * an integrator inside the FMU meets them too. One life of an instance is counted; "fail" repeats it with the
 * k-th allocation failing, and with all from the k-th on failing. Whatever fails must be refused with a
 * status, leak nothing, and work when tried again with enough memory. Prints
 * allocations=N during_steps=N left=N; exit code 1 and a reason when a claim breaks. SUNDIALS 6.4 reads the
 * null pointers of some failed allocations (N_VClone, SUNHashMap_New), so that "fail" is for FMUs without it.
 */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void __libc_free(void *);

static bool counting;
static long allocations, living, fail_from = -1, fail_to = -1;

static bool refused(void)
{
    if (!counting) {
        return false;
    }
    const long index = allocations++;
    if (fail_from >= 0 && index >= fail_from && index <= fail_to) {
        return true;
    }
    ++living;
    return false;
}

void *malloc(size_t size)
{
    return refused() ? NULL : __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    return refused() ? NULL : __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    if (old == NULL) {
        return malloc(size);
    }
    if (counting && fail_from >= 0 && allocations >= fail_from && allocations <= fail_to) {
        ++allocations;
        return NULL;
    }
    return __libc_realloc(old, size);
}

void free(void *memory)
{
    if (memory != NULL && counting) {
        --living;
    }
    __libc_free(memory);
}

/* fmi2CallbackFunctions without any function but the logger's place: libc's memory is used */
struct callbacks {
    void *logger, *allocate, *release, *finished, *environment;
};

typedef void *(*instantiate_function)(const char *, int, const char *, const char *, const struct callbacks *,
                                      int, int);
typedef void (*free_function)(void *);
typedef int (*setup_function)(void *, int, double, double, int, double);
typedef int (*plain_function)(void *);
typedef int (*step_function)(void *, double, double, int);
typedef int (*set_integer_function)(void *, const unsigned *, size_t, const int *);
typedef int (*state_function)(void *, void **);
typedef int (*set_state_function)(void *, void *);
typedef int (*size_function)(void *, void *, size_t *);
typedef int (*serialize_function)(void *, void *, char *, size_t);
typedef int (*deserialize_function)(void *, const char *, size_t, void **);

static void *library;
static const char *guid;
static unsigned method_reference;
static int method;
static long during_steps;

static int fail(const char *reason)
{
    counting = false;
    printf("%s (allocation %ld)\n", reason, fail_from);
    exit(1);
}

/* dlsym gives an object pointer; POSIX lets it be copied to a function pointer. */
static void find(const char *name, void *function)
{
    void *symbol = dlsym(library, name);
    if (symbol == NULL) {
        fail(name);
    }
    memcpy(function, &symbol, sizeof symbol);
}

/* Calls that failed for want of memory are repeated with memory: they have to work then. */
static bool enough_memory_now(void)
{
    const bool short_of_memory = fail_from >= 0 && allocations > fail_from;
    fail_to = -1;
    return short_of_memory;
}

static void retry(plain_function function, void *instance, const char *name)
{
    if (function(instance) > 1) {
        if (!enough_memory_now()) {
            fail(name);
        }
        if (function(instance) > 1) {
            fail(name);
        }
    }
}

static void *try_instance(void)
{
    const struct callbacks callbacks = {0};
    instantiate_function instantiate;
    find("fmi2Instantiate", &instantiate);
    void *instance = instantiate("faulty", 1, guid, NULL, &callbacks, 0, 0);
    if (instance == NULL) {
        if (!enough_memory_now() || living != 0) {
            fail("fmi2Instantiate");
        }
        instance = instantiate("faulty", 1, guid, NULL, &callbacks, 0, 0);
    }
    return instance;
}

static void start(void *instance)
{
    setup_function setup;
    set_integer_function set_integer;
    plain_function enter, leave;
    find("fmi2SetupExperiment", &setup);
    find("fmi2SetInteger", &set_integer);
    find("fmi2EnterInitializationMode", &enter);
    find("fmi2ExitInitializationMode", &leave);
    if (setup(instance, 0, 0.0, 0.0, 0, 0.0) > 1) {
        fail("fmi2SetupExperiment");
    }
    if (method_reference != 0 && set_integer(instance, &method_reference, 1, &method) != 0) {
        fail("fmi2SetInteger");
    }
    retry(enter, instance, "fmi2EnterInitializationMode");
    retry(leave, instance, "fmi2ExitInitializationMode");
}

static void run(void *instance)
{
    step_function step;
    find("fmi2DoStep", &step);
    const long before = allocations;
    for (int i = 0; i < 100; ++i) {
        if (step(instance, i / 64.0, 1.0 / 64.0, 1) > 1) {
            fail("fmi2DoStep");
        }
    }
    during_steps += allocations - before;
}

/* Room for a serialized state, outside the counted memory */
static char bytes[16384];

/* Saves a state as bytes and frees it; the size */
static size_t save(void *instance)
{
    state_function get, release;
    size_function get_size;
    serialize_function serialize;
    find("fmi2GetFMUstate", &get);
    find("fmi2FreeFMUstate", &release);
    find("fmi2SerializedFMUstateSize", &get_size);
    find("fmi2SerializeFMUstate", &serialize);
    void *state = NULL;
    if (get(instance, &state) > 1 && (!enough_memory_now() || get(instance, &state) > 1)) {
        fail("fmi2GetFMUstate");
    }
    size_t size = 0;
    if (get_size(instance, state, &size) != 0 || serialize(instance, state, bytes, sizeof bytes) != 0) {
        fail("fmi2SerializeFMUstate");
    }
    if (release(instance, &state) != 0 || state != NULL) {
        fail("fmi2FreeFMUstate");
    }
    return size;
}

/* A saved state restored in a second instance, which opens its solver for it; its end has to free the
 * state */
static void copy(void *instance)
{
    set_state_function set;
    deserialize_function deserialize;
    free_function free_instance;
    find("fmi2SetFMUstate", &set);
    find("fmi2DeSerializeFMUstate", &deserialize);
    find("fmi2FreeInstance", &free_instance);
    const size_t size = save(instance);
    const struct callbacks callbacks = {0};
    instantiate_function instantiate;
    find("fmi2Instantiate", &instantiate);
    void *other = instantiate("other", 1, guid, NULL, &callbacks, 0, 0);
    if (other == NULL &&
        (!enough_memory_now() || !(other = instantiate("other", 1, guid, NULL, &callbacks, 0, 0)))) {
        fail("fmi2Instantiate, a second one");
    }
    void *state = NULL;
    if (deserialize(other, bytes, size, &state) > 1 &&
        (!enough_memory_now() || deserialize(other, bytes, size, &state) > 1)) {
        fail("fmi2DeSerializeFMUstate");
    }
    if (set(other, state) > 1 && (!enough_memory_now() || set(other, state) > 1)) {
        fail("fmi2SetFMUstate");
    }
    free_instance(other);
}

static long live(long from, long to)
{
    free_function free_instance;
    find("fmi2FreeInstance", &free_instance);
    allocations = living = 0;
    fail_from = from;
    fail_to = to;
    counting = true;
    void *instance = try_instance();
    if (instance == NULL) {
        fail("fmi2Instantiate with memory");
    }
    start(instance);
    run(instance);
    copy(instance);
    free_instance(instance);
    counting = false;
    if (living != 0) {
        printf("leak of %ld blocks (allocation %ld)\n", living, from);
        exit(1);
    }
    return allocations;
}

int main(int count, char **arguments)
{
    if (count != 6) {
        return 2;
    }
    library = dlopen(arguments[2], RTLD_NOW | RTLD_LOCAL);
    if (library == NULL) {
        printf("%s\n", dlerror());
        return 1;
    }
    guid = arguments[3];
    method_reference = (unsigned)strtoul(arguments[4], NULL, 10);
    method = atoi(arguments[5]);
    (void)live(-1, -1); /* what the C library itself keeps from a first time is not the FMU's */
    during_steps = 0;
    const long total = live(-1, -1);
    const long steps = during_steps;
    for (long index = 0; index < total && strcmp(arguments[1], "fail") == 0; ++index) {
        live(index, index);
        live(index, 1000000);
    }
    printf("allocations=%ld during_steps=%ld left=%ld\n", total, steps, living);
    return 0;
}
