#include "options.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char options_usage[] =
    "usage: fmu_host [--repeat N] [--burst N] [--budget S] [--fresh] --case NAME OPTION... [--case ...]...\n"
    "Runs FMI 2.0 co-simulation FMUs and prints one line of JSON for each case, with the wall time of every\n"
    "run. Several cases take turns (A B A B ...), so that their times can be compared.\n"
    "  --repeat N                  each case has N turns (1)\n"
    "  --burst N                   and runs N times in a turn (1): all but the first with warm caches\n"
    "  --budget S                  run a case no more once its runs took S seconds of stepping together\n"
    "  --fresh                     a new instance for every run, instead of fmi2Reset\n"
    "of a case:\n"
    "  --library FILE              the FMU's shared library\n"
    "  --guid TEXT, --resources URI    of its modelDescription.xml; its folder resources, file:///...\n"
    "  --start-time S, --stop-time S, --steps N, --tolerance X\n"
    "                              N equal communication steps (1) from the start (0) to the stop time\n"
    "  --set-real R=V, --set-integer R=V, --set-boolean R=0|1, --set-string R=V\n"
    "                              start value V of value reference R\n"
    "  --get R,R,...               after every communication step one fmi2GetReal of these; may be repeated\n"
    "  --integrator NAME           Model Exchange: radau5 or kencarp4 moves the states\n"
    "  --absolute X                its absolute tolerance; --tolerance is the relative one\n"
    "  --states N,M,K,I,I,...      of the FMU's N states it moves those of the indices I, the first K of "
    "which\n"
    "                              have rates that are as many states further on; the FMU has M indicators\n"
    "  --read-real R,R,..., --read-integer R,R,..., --read-boolean R,R,...\n"
    "                              values to print, read at the end\n";

static bool refuse(const char *option, const char *text, const char *expected)
{
    fprintf(stderr, "fmu_host: %s %s: expected %s\n", option, text, expected);
    return false;
}

static void *grow(void *items, size_t count, size_t size)
{
    void *grown = realloc(items, (count + 1) * size);
    if (!grown) {
        fprintf(stderr, "fmu_host: out of memory\n");
    }
    return grown;
}

/* The whole text has to be a number. */
static bool parse_real(const char *option, const char *text, double *value)
{
    char *end;
    *value = strtod(text, &end);
    return (end != text && *end == '\0') || refuse(option, text, "a number");
}

static bool parse_finite(const char *option, const char *text, double *value)
{
    return parse_real(option, text, value) && (isfinite(*value) || refuse(option, text, "a finite number"));
}

static bool parse_integer(const char *option, const char *text, long least, long most, long *value)
{
    char *end;
    errno = 0;
    *value = strtol(text, &end, 10);
    if (end == text || *end != '\0' || errno != 0 || *value < least || *value > most) {
        char expected[80];
        snprintf(expected, sizeof expected, "an integer from %ld to %ld", least, most);
        return refuse(option, text, expected);
    }
    return true;
}

/* The digits at the start of the text; `rest` is what follows. */
static bool parse_reference(const char *option, const char *text, fmi2ValueReference *reference, char **rest)
{
    errno = 0;
    unsigned long value = strtoul(text, rest, 10);
    if (*text < '0' || *text > '9' || errno != 0 || value > UINT_MAX) {
        return refuse(option, text, "a value reference, 0 to 4294967295");
    }
    *reference = (fmi2ValueReference)value;
    return true;
}

static bool parse_references(const char *option, const char *text, struct references *list)
{
    for (;;) {
        fmi2ValueReference *items = grow(list->items, list->count, sizeof *items);
        char *rest;
        if (!items) {
            return false;
        }
        list->items = items;
        if (!parse_reference(option, text, &items[list->count], &rest)) {
            return false;
        }
        list->count++;
        if (*rest == '\0') {
            return true;
        }
        if (*rest != ',') {
            return refuse(option, text, "value references with commas between them");
        }
        text = rest + 1;
    }
}

static bool parse_start(struct experiment *one, enum value_type type, const char *option, const char *text)
{
    struct start_value value = {.type = type};
    char *rest;
    if (!parse_reference(option, text, &value.reference, &rest)) {
        return false;
    }
    if (*rest != '=') {
        return refuse(option, text, "REFERENCE=VALUE");
    }
    const char *given = rest + 1;
    long integer = 0;
    if (type == TYPE_REAL && !parse_real(option, given, &value.real)) {
        return false;
    }
    bool truth = type == TYPE_BOOLEAN;
    if ((truth || type == TYPE_INTEGER) &&
        !parse_integer(option, given, truth ? 0 : INT_MIN, truth ? 1 : INT_MAX, &integer)) {
        return false;
    }
    value.integer = (fmi2Integer)integer;
    value.string = given;
    struct start_value *start = grow(one->start, one->start_count, sizeof *start);
    if (!start) {
        return false;
    }
    one->start = start;
    start[one->start_count++] = value;
    return true;
}

static bool parse_get(struct experiment *one, const char *option, const char *text)
{
    struct references *get = grow(one->get, one->get_count, sizeof *get);
    if (!get) {
        return false;
    }
    one->get = get;
    get[one->get_count] = (struct references){0};
    return parse_references(option, text, &get[one->get_count++]);
}

static bool parse_case_text(struct experiment *one, const char *option, const char *text, bool *known)
{
    const struct {
        const char *option;
        const char **text;
    } texts[] = {{"--library", &one->library},
                 {"--guid", &one->guid},
                 {"--resources", &one->resources},
                 {"--integrator", &one->integrator}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (strcmp(option, texts[i].option) == 0) {
            *texts[i].text = text;
            return true;
        }
    }
    static const struct {
        const char *option;
        enum value_type type;
        bool read;
    } values[] = {
        {"--set-real", TYPE_REAL, false},       {"--set-integer", TYPE_INTEGER, false},
        {"--set-boolean", TYPE_BOOLEAN, false}, {"--set-string", TYPE_STRING, false},
        {"--read-real", TYPE_REAL, true},       {"--read-integer", TYPE_INTEGER, true},
        {"--read-boolean", TYPE_BOOLEAN, true},
    };
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        if (strcmp(option, values[i].option) == 0) {
            return values[i].read ? parse_references(option, text, &one->read[values[i].type])
                                  : parse_start(one, values[i].type, option, text);
        }
    }
    *known = false;
    return false;
}

static bool parse_case_option(struct experiment *one, const char *option, const char *text)
{
    if (strcmp(option, "--start-time") == 0) {
        return parse_finite(option, text, &one->start_time);
    }
    if (strcmp(option, "--stop-time") == 0) {
        return parse_finite(option, text, &one->stop_time);
    }
    if (strcmp(option, "--steps") == 0) {
        return parse_integer(option, text, 1, LONG_MAX, &one->steps);
    }
    if (strcmp(option, "--tolerance") == 0) {
        one->tolerance_defined = true;
        return parse_finite(option, text, &one->tolerance);
    }
    if (strcmp(option, "--absolute") == 0) {
        return parse_finite(option, text, &one->absolute_tolerance);
    }
    if (strcmp(option, "--states") == 0) {
        return parse_references(option, text, &one->states) &&
               (one->states.count > STATES_FIRST || refuse(option, text, "N,M,K and a state"));
    }
    if (strcmp(option, "--get") == 0) {
        return parse_get(one, option, text);
    }
    bool known = true;
    bool parsed = parse_case_text(one, option, text, &known);
    if (!known) {
        fprintf(stderr, "fmu_host: unknown option %s; --help lists them\n", option);
    }
    return parsed;
}

static bool parse_pair(struct options *options, const char *option, const char *text)
{
    if (strcmp(option, "--repeat") == 0) {
        return parse_integer(option, text, 1, 1000000, &options->repeat);
    }
    if (strcmp(option, "--burst") == 0) {
        return parse_integer(option, text, 1, 1000000, &options->burst);
    }
    if (strcmp(option, "--budget") == 0) {
        return parse_finite(option, text, &options->budget);
    }
    if (strcmp(option, "--case") == 0) {
        struct experiment *cases = grow(options->cases, options->count, sizeof *cases);
        if (!cases) {
            return false;
        }
        options->cases = cases;
        cases[options->count++] = (struct experiment){.name = text, .stop_time = (double)NAN, .steps = 1};
        return true;
    }
    if (options->count == 0) {
        fprintf(stderr, "fmu_host: %s before the first --case, or unknown; --help lists the options\n",
                option);
        return false;
    }
    return parse_case_option(&options->cases[options->count - 1], option, text);
}

static bool check_case(const struct experiment *one)
{
    const char *missing = !one->library                               ? "--library"
                          : !one->guid                                ? "--guid"
                          : isnan(one->stop_time)                     ? "--stop-time"
                          : one->integrator && one->states.count == 0 ? "--states"
                                                                      : NULL;
    if (missing) {
        fprintf(stderr, "fmu_host: case %s lacks %s\n", one->name, missing);
        return false;
    }
    if (!(one->stop_time > one->start_time)) {
        fprintf(stderr, "fmu_host: case %s: the stop time %g is not after the start time %g\n", one->name,
                one->stop_time, one->start_time);
        return false;
    }
    return true;
}

bool options_parse(struct options *options, int count, char **arguments)
{
    *options = (struct options){.repeat = 1, .burst = 1, .budget = HUGE_VAL};
    for (int i = 1; i < count; i++) {
        if (strcmp(arguments[i], "--help") == 0) {
            options->help = true;
            return true;
        }
        if (strcmp(arguments[i], "--fresh") == 0) {
            options->fresh = true;
            continue;
        }
        if (i + 1 == count) {
            fprintf(stderr, "fmu_host: %s is no option, or lacks its value; --help lists the options\n",
                    arguments[i]);
            return false;
        }
        if (!parse_pair(options, arguments[i], arguments[i + 1])) {
            return false;
        }
        i++;
    }
    if (options->count == 0) {
        fprintf(stderr, "fmu_host: no --case given; --help lists the options\n");
        return false;
    }
    for (size_t i = 0; i < options->count; i++) {
        if (!check_case(&options->cases[i])) {
            return false;
        }
    }
    return true;
}

void options_free(struct options *options)
{
    for (size_t i = 0; i < options->count; i++) {
        struct experiment *one = &options->cases[i];
        for (size_t g = 0; g < one->get_count; g++) {
            free(one->get[g].items);
        }
        for (int type = 0; type < TYPE_STRING; type++) {
            free(one->read[type].items);
        }
        free(one->states.items);
        free(one->get);
        free(one->start);
    }
    free(options->cases);
    *options = (struct options){0};
}
