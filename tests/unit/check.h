/*
 * Claims of the C unit tests. A failed claim is printed with its values and the test goes on; the last line
 * says how many held. A program consists of functions TEST(what_it_claims), which run in their order.
 */
#ifndef CHECK_H
#define CHECK_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

/* Expected values are long double and meet double everywhere: clang counts that as double promotion. */
#ifdef __clang__
#pragma clang diagnostic ignored "-Wdouble-promotion"
#endif

/* The first failures tell the story; thousands of random configurations would bury it. */
enum { CHECK_PRINTED_FAILURES = 25 };

static struct {
    const char *test;
    long claims, failures;
} check_state = {"", 0, 0};

/* Counts a claim; true when it failed and is to be printed. */
static inline bool check_failed(bool holds)
{
    check_state.claims += 1;
    if (holds) {
        return false;
    }
    check_state.failures += 1;
    return check_state.failures <= CHECK_PRINTED_FAILURES;
}

static inline void check_that(bool holds, const char *claim, const char *file, int line)
{
    if (check_failed(holds)) {
        printf("%s:%d: %s: not so: %s\n", file, line, check_state.test, claim);
    }
}

/* Written so that NaN in any of the three fails. Infinities are close to themselves only. */
static inline void check_close(const char *name, long double got, long double expected, long double tolerance,
                               const char *file, int line)
{
    const bool holds = (isinf(expected) && got == expected) || fabsl(got - expected) <= tolerance;
    if (check_failed(holds && !isnan(tolerance))) {
        printf("%s:%d: %s: %s is %.21Lg, expected %.21Lg: off by %.3Lg, allowed %.3Lg\n", file, line,
               check_state.test, name, got, expected, got - expected, tolerance);
    }
}

static inline int check_summary(void)
{
    printf("%s: %ld claims, %ld failed\n", __BASE_FILE__, check_state.claims, check_state.failures);
    return check_state.failures == 0 && check_state.claims > 0 ? 0 : 1;
}

/* The claim itself is the message. */
#define CHECK(claim) check_that((claim), #claim, __FILE__, __LINE__)

/* |got - expected| <= tolerance */
#define CHECK_CLOSE(name, got, expected, tolerance)                                                          \
    check_close((name), (got), (expected), (tolerance), __FILE__, __LINE__)

/* Component by component, of vectors of any type */
#define CHECK_VECTOR(name, got, expected, tolerance)                                                         \
    (CHECK_CLOSE(name, (got).x, (expected).x, tolerance),                                                    \
     CHECK_CLOSE(name, (got).y, (expected).y, tolerance),                                                    \
     CHECK_CLOSE(name, (got).z, (expected).z, tolerance))

enum { CHECK_MOST_TESTS = 32 };

static struct {
    const char *name;
    void (*run)(void);
} check_tests[CHECK_MOST_TESTS];
static int check_test_count;

/* A test, known to main before it begins. */
#define TEST(claim)                                                                                          \
    static void claim(void);                                                                                 \
    __attribute__((constructor)) static void check_know_##claim(void)                                        \
    {                                                                                                        \
        check_tests[check_test_count].name = #claim;                                                         \
        check_tests[check_test_count++].run = claim;                                                         \
    }                                                                                                        \
    static void claim(void)

static inline void check_run(void)
{
    for (int i = 0; i < check_test_count; ++i) {
        check_state.test = check_tests[i].name;
        check_tests[i].run();
    }
}

int main(void)
{
    check_run();
    return check_summary();
}

#endif
