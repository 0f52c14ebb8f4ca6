/*
 * A small importer that compiles for every platform: host LIBRARY GUID STOP STEPS [r|i VR VALUE]...
 * [get VR]...  Steps from 0 s to STOP and prints after each step a line of time and values, in digits that
 * give the same doubles again. Status 0, or 1 after a message on stderr.
 */
#include <stdarg.h>

#include "fmi2Functions.h"
#include "host_library.h"

enum { MOST = 64 };

#define FUNCTIONS(ROW)                                                                                       \
    ROW(SetReal, set_real)                                                                                   \
    ROW(SetInteger, set_integer)                                                                             \
    ROW(GetReal, get_real)                                                                                   \
    ROW(Instantiate, instantiate)                                                                            \
    ROW(SetupExperiment, setup_experiment)                                                                   \
    ROW(EnterInitializationMode, enter_initialization)                                                       \
    ROW(ExitInitializationMode, exit_initialization)                                                         \
    ROW(DoStep, do_step)                                                                                     \
    ROW(Terminate, terminate)                                                                                \
    ROW(FreeInstance, free_instance)
#define DECLARE(name, place) static fmi2##name##TYPE *place;
#define FIND(name, place) find(library, "fmi2" #name, &place);

FUNCTIONS(DECLARE)

static void tell(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                 fmi2String category, fmi2String text, ...)
{
    (void)environment, (void)instance, (void)category;
    va_list arguments;
    va_start(arguments, text);
    if (status != fmi2OK) {
        vfprintf(stderr, text, arguments);
    }
    va_end(arguments);
}

static void find_all(void *library)
{
    FUNCTIONS(FIND)
}

static int configure(fmi2Component c, int count, char **words, fmi2ValueReference *wanted)
{
    int number = 0;
    for (int i = 0; i + 1 < count; ++i) {
        const fmi2ValueReference reference = (fmi2ValueReference)strtoul(words[i + 1], NULL, 10);
        if (strcmp(words[i], "get") == 0) {
            wanted[number++ % MOST] = reference;
            i += 1;
        } else if (i + 2 < count && words[i][0] == 'r') {
            const fmi2Real value = strtod(words[i + 2], NULL);
            check(set_real(c, &reference, 1, &value), words[i + 1]);
            i += 2;
        } else if (i + 2 < count && words[i][0] == 'i') {
            const fmi2Integer value = (fmi2Integer)strtol(words[i + 2], NULL, 10);
            check(set_integer(c, &reference, 1, &value), words[i + 1]);
            i += 2;
        }
    }
    return number < MOST ? number : MOST;
}

int main(int count, char **words)
{
    void *library = count > 4 ? open_library(words[1]) : NULL;
    if (!library) {
        fail("usage: host LIBRARY GUID STOP STEPS [r|i VR VALUE]... [get VR]..., or the library does not "
             "load");
    }
    find_all(library);
    const fmi2CallbackFunctions callbacks = {tell, calloc, free, NULL, NULL};
    const double stop = strtod(words[3], NULL);
    const long steps = strtol(words[4], NULL, 10);
    fmi2Component c = instantiate("host", fmi2CoSimulation, words[2], "", &callbacks, fmi2False, fmi2False);
    if (!c) {
        fail("no instance");
    }
    fmi2ValueReference wanted[MOST];
    fmi2Real values[MOST];
    const int number = configure(c, count - 5, words + 5, wanted);
    check(setup_experiment(c, fmi2True, 1e-10, 0.0, fmi2True, stop), "fmi2SetupExperiment");
    check(enter_initialization(c), "fmi2EnterInitializationMode");
    check(exit_initialization(c), "fmi2ExitInitializationMode");
    for (long i = 0; i < steps; ++i) {
        const double begin = stop * (double)i / (double)steps;
        const double end = stop * (double)(i + 1) / (double)steps;
        check(do_step(c, begin, end - begin, fmi2True), "fmi2DoStep");
        check(get_real(c, wanted, (size_t)number, values), "fmi2GetReal");
        print_line(end, values, (size_t)number);
    }
    check(terminate(c), "fmi2Terminate");
    free_instance(c);
    return 0;
}
