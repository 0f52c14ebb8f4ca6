/*
 * Between an FMU and ucrtbase.dll, the C library that is part of Windows 10 and later. Without this file the compiler
 * puts 70 kB of a runtime of its own into each library, with other sines and exponentials. Here is what the headers
 * of mingw-w64 declare and ucrtbase.dll has under another name, or not at all.
 */
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved);
void sincos(double x, double *sine, double *cosine);

/* Windows calls it when the library comes and goes. There is nothing to do: ucrtbase.dll starts itself. */
int __stdcall DllMainCRTStartup(void *library, unsigned long reason, void *reserved)
{
    (void)library, (void)reason, (void)reserved;
    return 1;
}

/* A function with more than a page of variables calls it with their size in rax. The stack grows only when the page
 * below is touched, so that each page is, one after another. No register may change. */
__asm__(".globl ___chkstk_ms\n"
        "___chkstk_ms:\n"
        "    push %rcx\n"
        "    push %rax\n"
        "    lea 24(%rsp), %rcx\n" /* the caller's end of the stack: above both and the way back */
        "1:  cmp $4096, %rax\n"
        "    jbe 2f\n"
        "    sub $4096, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    sub $4096, %rax\n"
        "    jmp 1b\n"
        "2:  sub %rax, %rcx\n"
        "    orq $0, (%rcx)\n"
        "    pop %rax\n"
        "    pop %rcx\n"
        "    ret\n");

/* The options of printf's kin, corecrt_stdio_config.h: return values of C99, and no bound for vsprintf. */
#define LIKE_C99 2u
#define UNBOUNDED 1u

int vsnprintf(char *restrict text, size_t size, const char *restrict format, va_list arguments)
{
    return __stdio_common_vsprintf(LIKE_C99, text, size, format, NULL, arguments);
}

int snprintf(char *restrict text, size_t size, const char *restrict format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = vsnprintf(text, size, format, arguments);
    va_end(arguments);
    return length;
}

/* These two are for SUNDIALS. */
int vsprintf(char *restrict text, const char *restrict format, va_list arguments)
{
    return __stdio_common_vsprintf(UNBOUNDED, text, SIZE_MAX, format, NULL, arguments);
}

int fprintf(FILE *restrict file, const char *restrict format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    const int length = __stdio_common_vfprintf(0, file, format, NULL, arguments);
    va_end(arguments);
    return length;
}

static uint64_t magnitude(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits & 0x7fffffffffffffffu;
}

#define INFINITE 0x7ff0000000000000u /* as bits; above it is what is no number */
#define LEAST_NORMAL 0x0010000000000000u

int __isnan(double x)
{
    return magnitude(x) > INFINITE;
}

int __fpclassify(double x)
{
    const uint64_t bits = magnitude(x);
    if (bits >= INFINITE) {
        return bits == INFINITE ? FP_INFINITE : FP_NAN;
    }
    if (bits < LEAST_NORMAL) {
        return bits == 0 ? FP_ZERO : FP_SUBNORMAL;
    }
    return FP_NORMAL;
}

/* What compilers make of a sine beside a cosine. */
void sincos(double x, double *sine, double *cosine)
{
    *sine = sin(x);
    *cosine = cos(x);
}
