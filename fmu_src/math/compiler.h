/*
 * What compilers offer beyond C11, in one place. The model is right without any of it: each macro may be
 * empty, and CONTACT_PLAIN_C empties all of them (tests/platforms compares the bits).
 */
#ifndef CONTACT_MATH_COMPILER_H
#define CONTACT_MATH_COMPILER_H

/* gcc and clang; clang as Microsoft's compiler does not call itself GNU C. */
#if (defined __GNUC__ || defined __clang__) && !defined CONTACT_PLAIN_C
#define CONTACT_GNU_C 1
#else
#define CONTACT_GNU_C 0
#endif

/* The function is not inlined, so that the frequent paths of its callers stay small. */
#if CONTACT_GNU_C
#define CONTACT_NOINLINE __attribute__((noinline))
#elif defined _MSC_VER && !defined CONTACT_PLAIN_C
#define CONTACT_NOINLINE __declspec(noinline)
#else
#define CONTACT_NOINLINE
#endif

/* CONTACT_EXPORTED marks a function of the standard, which stays where gcc makes all others of the unit
 * static (-fwhole-program). CONTACT_NOT_FUSED marks sums of products with both signs side by side: gcc 12
 * makes fused operations of them for processors that have these, though -ffp-contract=off forbids it. */
#if CONTACT_GNU_C && !defined __clang__
#define CONTACT_EXPORTED __attribute__((externally_visible))
#define CONTACT_NOT_FUSED __attribute__((optimize("no-tree-slp-vectorize", "no-tree-loop-vectorize")))
#else
#define CONTACT_EXPORTED
#define CONTACT_NOT_FUSED
#endif

/* Parameter number `text` is a format of printf for the parameters from number `first`. gcc for Windows means
 * Microsoft's formats by printf, but the C library that it links knows C11's. */
#if CONTACT_GNU_C && defined __MINGW32__ && !defined __clang__
#define CONTACT_PRINTF_LIKE(text, first) __attribute__((format(gnu_printf, text, first)))
#elif CONTACT_GNU_C
#define CONTACT_PRINTF_LIKE(text, first) __attribute__((format(printf, text, first)))
#else
#define CONTACT_PRINTF_LIKE(text, first)
#endif

/* CONTACT_COLD: the function is seldom called, so the compiler optimizes it for size. CONTACT_FLATTEN:
 * everything the function calls becomes a part of it, where possible; clang of some versions knows no
 * flatten. A double2 holds as many doubles as one vector instruction takes, LANES; each result has the bits
 * of the scalar operation. */
#if CONTACT_GNU_C
#define CONTACT_COLD __attribute__((cold))
#define CONTACT_FLATTEN __attribute__((flatten))
typedef double double2 __attribute__((vector_size(16), aligned(8), may_alias));
enum { LANES = 2 };
#else
#define CONTACT_COLD
#define CONTACT_FLATTEN
typedef double double2;
enum { LANES = 1 };
#endif

static inline double2 double2_at(const double *row, int i)
{
    return *(const double2 *)(row + i);
}

static inline void double2_put(double *row, int i, double2 values)
{
    *(double2 *)(row + i) = values;
}

/* Sets `to` to the sum of row[j] times row j of `from`; `width` is a multiple of four. */
static inline void combine_rows(double *restrict to, const double *row, int count, const double *from,
                                int stride, int width)
{
    for (int i = 0; i < width; i += 2 * LANES) {
        double2 low = {0.0};
        double2 high = {0.0};
        for (int j = 0; j < count - 1; j += 2) { /* two at a time: half the loop's overhead */
            const double *by = from + j * stride + i;
            low = low + double2_at(by, 0) * row[j] + double2_at(by, stride) * row[j + 1];
            high = high + double2_at(by, LANES) * row[j] + double2_at(by, stride + LANES) * row[j + 1];
        }
        if (count % 2 != 0) {
            const double *by = from + (count - 1) * stride + i;
            low += double2_at(by, 0) * row[count - 1];
            high += double2_at(by, LANES) * row[count - 1];
        }
        double2_put(to, i, low);
        double2_put(to, i + LANES, high);
    }
}

/* Returns the larger number; b where one of them is NaN. C11's fmax is a call. */
static inline double larger(double a, double b)
{
    return a > b ? a : b;
}

/* A long sum is made of two, of every other term each, in one double2 or in two of them: the sum then has the
 * same bits everywhere. Term k goes to part(k). */
enum { PARTS = 2 / LANES };

static inline int part(int k)
{
    return k / LANES % PARTS;
}

static inline double parts_together(const double2 sum[PARTS])
{
#if CONTACT_GNU_C
    return sum[0][0] + sum[0][1];
#else
    return sum[0] + sum[1];
#endif
}

/* Returns part l of a pair of numbers. */
static inline double2 part_of_pair(double even, double odd, int l)
{
#if CONTACT_GNU_C
    (void)l;
    return (double2){even, odd};
#else
    return l == 0 ? even : odd;
#endif
}

/* This is the ratio of a circle's circumference to its diameter, rounded to double; C11 itself names none. */
static const double PI = 3.141592653589793;

#endif
