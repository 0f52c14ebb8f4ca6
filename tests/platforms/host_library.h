/*
 * What the hosts of both versions of FMI share: a library and its functions on every platform, and how they
 * end.
 */
#ifndef HOST_LIBRARY_H
#define HOST_LIBRARY_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
static void *open_library(const char *name)
{
    return LoadLibraryA(name);
}
static void find(void *library, const char *name, void *function)
{
    FARPROC found = GetProcAddress(library, name);
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
    memcpy(function, &found, sizeof found);
}
#endif

static void fail(const char *what)
{
    fprintf(stderr, "host: %s\n", what);
    exit(1);
}

#endif
