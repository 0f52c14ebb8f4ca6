/*
 * What the hosts of both versions of FMI share: a library, its functions on every platform, and how they end.
 */
#ifndef HOST_LIBRARY_H
#define HOST_LIBRARY_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void fail(const char *what)
{
    fprintf(stderr, "host: %s\n", what);
    exit(1);
}

/* A status of either version: 0 is OK. */
static void check(long long status, const char *what)
{
    if (status != 0) {
        fail(what);
    }
}

static void print_line(double time, const double *values, size_t count)
{
    printf("%.17g", time);
    for (size_t k = 0; k < count; ++k) {
        printf(" %.17g", values[k]);
    }
    printf("\n");
}

#ifdef _WIN32
#include <windows.h>
static void *open_library(const char *name)
{
    return LoadLibraryA(name);
}
static void find(void *library, const char *name, void *function)
{
    FARPROC found = GetProcAddress(library, name);
    if (!found) {
        fail("the library lacks a function");
    }
    memcpy(function, &found, sizeof found);
}
#else
#include <dlfcn.h>
static void *open_library(const char *name)
{
    return dlopen(name, RTLD_NOW | RTLD_LOCAL);
}
static void find(void *library, const char *name, void *function)
{
    void *found = dlsym(library, name);
    if (!found) {
        fail("the library lacks a function");
    }
    memcpy(function, &found, sizeof found);
}
#endif

#endif
