/*
 * host.c for FMI 3.0: host3 LIBRARY TOKEN STOP STEPS [f VR NUMBER VALUE...|i VR VALUE]... [get VR NUMBER]...
 * A variable is an array of NUMBER values. Steps from 0 s to STOP and prints after each step a line of time
 * and values, in digits that give the same doubles again. Status 0, or 1 after a message on stderr.
 */
#include "fmi3Functions.h"
#include "host_library.h"

enum { MOST = 64, LONGEST = 8 };

struct wanted {
    fmi3ValueReference references[MOST];
    size_t number;
    size_t values; /* of all of them */
};

#define FUNCTIONS(ROW)                                                                                       \
    ROW(SetFloat64, set_float64)                                                                             \
    ROW(SetInt64, set_int64)                                                                                 \
    ROW(GetFloat64, get_float64)                                                                             \
    ROW(InstantiateCoSimulation, instantiate)                                                                \
    ROW(EnterInitializationMode, enter_initialization)                                                       \
    ROW(ExitInitializationMode, exit_initialization)                                                         \
    ROW(DoStep, do_step)                                                                                     \
    ROW(Terminate, terminate)                                                                                \
    ROW(FreeInstance, free_instance)
#define DECLARE(name, place) static fmi3##name##TYPE *place;
#define FIND(name, place) find(library, "fmi3" #name, &place);

FUNCTIONS(DECLARE)

static void tell(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text)
{
    (void)environment, (void)category;
    if (status != fmi3OK) {
        fprintf(stderr, "%s\n", text);
    }
}

static void find_all(void *library)
{
    FUNCTIONS(FIND)
}

static size_t length(const char *word)
{
    const size_t number = (size_t)strtoul(word, NULL, 10);
    if (number < 1 || number > LONGEST) {
        fail("an array of 1 to 8 values is wanted");
    }
    return number;
}

/* Words from words[i] on, of which there are `left`: one setting or one wish. How many words it has. */
static int configure_one(fmi3Instance c, int left, char **words, struct wanted *wanted)
{
    const fmi3ValueReference reference = (fmi3ValueReference)strtoul(words[1], NULL, 10);
    const size_t number = left > 2 ? length(strcmp(words[0], "i") == 0 ? "1" : words[2]) : 1;
    if (strcmp(words[0], "get") == 0 && left > 2) {
        wanted->references[wanted->number++ % MOST] = reference;
        wanted->values += number;
        return 3;
    }
    if (strcmp(words[0], "f") == 0 && left > 2 + (int)number) {
        fmi3Float64 values[LONGEST];
        for (size_t k = 0; k < number; ++k) {
            values[k] = strtod(words[3 + k], NULL);
        }
        check(set_float64(c, &reference, 1, values, number), words[1]);
        return 3 + (int)number;
    }
    if (strcmp(words[0], "i") == 0 && left > 2) {
        const fmi3Int64 value = strtol(words[2], NULL, 10);
        check(set_int64(c, &reference, 1, &value, 1), words[1]);
        return 3;
    }
    fail("a word that is none of f, i, get");
    return left;
}

static void advance(fmi3Instance c, double begin, double end)
{
    fmi3Boolean events = fmi3False;
    fmi3Boolean over = fmi3False;
    fmi3Boolean early = fmi3False;
    fmi3Float64 reached = begin;
    check(do_step(c, begin, end - begin, fmi3True, &events, &over, &early, &reached), "fmi3DoStep");
}

static void run(fmi3Instance c, double stop, long steps, const struct wanted *wanted)
{
    for (long i = 0; i < steps; ++i) {
        fmi3Float64 values[MOST * LONGEST];
        const double end = stop * (double)(i + 1) / (double)steps;
        advance(c, stop * (double)i / (double)steps, end);
        check(get_float64(c, wanted->references, wanted->number, values, wanted->values), "fmi3GetFloat64");
        print_line(end, values, wanted->values);
    }
}

int main(int count, char **words)
{
    void *library = count > 4 ? open_library(words[1]) : NULL;
    if (!library) {
        fail("usage: host3 LIBRARY TOKEN STOP STEPS [f VR NUMBER VALUE...|i VR VALUE]... [get VR NUMBER]..., "
             "or the library does not load");
    }
    find_all(library);
    const double stop = strtod(words[3], NULL);
    fmi3Instance c = instantiate("host", words[2], NULL, fmi3False, fmi3False, fmi3False, fmi3False, NULL, 0,
                                 NULL, tell, NULL);
    if (!c) {
        fail("no instance");
    }
    struct wanted wanted = {.number = 0};
    for (int i = 5; i + 1 < count;) {
        i += configure_one(c, count - i, words + i, &wanted);
    }
    if (wanted.number > MOST) {
        fail("too many variables");
    }
    check(enter_initialization(c, fmi3True, 1e-10, 0.0, fmi3True, stop), "fmi3EnterInitializationMode");
    check(exit_initialization(c), "fmi3ExitInitializationMode");
    run(c, stop, strtol(words[4], NULL, 10), &wanted);
    check(terminate(c), "fmi3Terminate");
    free_instance(c);
    return 0;
}
