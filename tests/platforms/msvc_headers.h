/*
 * mingw-w64's headers for a compiler in the mode of Microsoft's, whose own are not at hand: they take
 * every compiler that is not gcc for one without attributes. Included before all else (-include).
 */
#include <_mingw.h>

/* It would be a __declspec behind a declaration, where none may stand; and one that is nowhere defined. */
#undef __MINGW_ATTRIB_NORETURN
#define __MINGW_ATTRIB_NORETURN
#undef __MINGW_ATTRIB_DEPRECATED
#define __MINGW_ATTRIB_DEPRECATED

/* All headers of C that contact.c includes, while attributes are defined away. */
#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#undef __attribute__

/* They count arguments as on processors of 32 bits. */
#undef va_start
#undef va_arg
#undef va_end
#undef va_copy
#define va_start(list, last) __builtin_va_start(list, last)
#define va_arg(list, type) __builtin_va_arg(list, type)
#define va_end(list) __builtin_va_end(list)
#define va_copy(to, from) __builtin_va_copy(to, from)

/* A float of mingw's library, which they declare as a double for every compiler but gcc: 2e-314. */
#undef NAN
#define NAN __builtin_nanf("")
