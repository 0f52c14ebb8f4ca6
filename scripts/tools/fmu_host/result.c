#include "result.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool result_prepare(struct result *result, const struct experiment *one, long most_runs)
{
    size_t widest = 1;
    for (size_t g = 0; g < one->get_count; g++) {
        widest = one->get[g].count > widest ? one->get[g].count : widest;
    }
    result->stepping = calloc((size_t)most_runs, sizeof *result->stepping);
    result->initialization = calloc((size_t)most_runs, sizeof *result->initialization);
    result->real = calloc(one->read[TYPE_REAL].count + 1, sizeof *result->real);
    result->integer = calloc(one->read[TYPE_INTEGER].count + 1, sizeof *result->integer);
    result->boolean = calloc(one->read[TYPE_BOOLEAN].count + 1, sizeof *result->boolean);
    result->scratch = calloc(widest, sizeof *result->scratch);
    result->sorted = calloc((size_t)most_runs, sizeof *result->sorted);
    return result->sorted && result->stepping && result->initialization && result->real && result->integer &&
           result->boolean && result->scratch;
}

void result_release(struct result *result)
{
    free(result->stepping);
    free(result->initialization);
    free(result->real);
    free(result->integer);
    free(result->boolean);
    free(result->scratch);
    free(result->sorted);
}

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_text(const char *text)
{
    putchar('"');
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') {
            putchar('\\');
        }
        if ((unsigned char)*text >= ' ') {
            putchar(*text);
        }
    }
    putchar('"');
}

/* JSON has no word for what is not finite. */
static void print_real(double value)
{
    if (isfinite(value)) {
        printf("%.17g", value);
    } else {
        printf("null");
    }
}

/* "name_s": [...], "name_min_s": ..., "name_median_s": ... ; sorts a copy. */
static void print_times(const char *name, const double *times, long count, double *copy)
{
    printf("\"%s_s\": [", name);
    for (long i = 0; i < count; i++) {
        printf(i ? ", %.17g" : "%.17g", times[i]);
    }
    memcpy(copy, times, (size_t)count * sizeof *copy);
    qsort(copy, (size_t)count, sizeof *copy, compare);
    printf("], \"%s_min_s\": %.17g, \"%s_median_s\": %.17g", name, copy[0], name,
           0.5 * (copy[(count - 1) / 2] + copy[count / 2]));
}

static void print_measured(const struct experiment *one, const struct result *result)
{
    static const char *const names[] = {"real", "integer", "boolean"};
    printf("\"steps\": %ld, \"runs\": %ld, ", one->steps, result->runs);
    print_times("initialization", result->initialization, result->runs, result->sorted);
    printf(", ");
    print_times("stepping", result->stepping, result->runs, result->sorted);
    for (int type = TYPE_REAL; type < TYPE_STRING; type++) {
        printf(", \"%s\": {", names[type]);
        for (size_t i = 0; i < one->read[type].count; i++) {
            printf("%s\"%u\": ", i ? ", " : "", one->read[type].items[i]);
            if (type == TYPE_REAL) {
                print_real(result->real[i]);
            } else {
                printf("%d", type == TYPE_INTEGER ? result->integer[i] : result->boolean[i]);
            }
        }
        printf("}");
    }
}

void result_print(const struct experiment *one, const struct result *result, const char *failure)
{
    printf("{\"case\": ");
    print_text(one->name);
    printf(", ");
    if (result->failed) {
        printf("\"error\": ");
        print_text(failure);
    } else {
        print_measured(one, result);
    }
    printf("}\n");
}
