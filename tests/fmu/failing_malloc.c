/*
 * Preloaded into a process: lets one allocation of one library fail. Only calls that come from the
 * library's own code count, whatever it was linked from; the rest of the process has all it wants.
 */
#include <dlfcn.h>
#include <link.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void __libc_free(void *);

enum { REMEMBERED = 1024 };

static uintptr_t base, end;
static long count, fail_from, fail_to;
static uintptr_t callers[REMEMBERED];
static const void *living[REMEMBERED]; /* blocks of the library; NULL where there is none */

static int find_end(struct dl_phdr_info *info, size_t size, void *wanted)
{
    (void)size;
    if (info->dlpi_addr != (uintptr_t)wanted) {
        return 0;
    }
    for (int i = 0; i < info->dlpi_phnum; ++i) {
        const uintptr_t last = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr + info->dlpi_phdr[i].p_memsz;
        end = info->dlpi_phdr[i].p_type == PT_LOAD && last > end ? last : end;
    }
    return 1;
}

/* From now on the allocations of the library with this function are counted from 0; those from..to fail. */
void failing_malloc_watch(const void *function, long from, long to)
{
    Dl_info info;
    end = 0;
    if (dladdr(function, &info) != 0) {
        base = (uintptr_t)info.dli_fbase;
        dl_iterate_phdr(find_end, info.dli_fbase);
    }
    count = 0;
    for (int i = 0; i < REMEMBERED; ++i) {
        living[i] = NULL;
    }
    fail_from = from;
    fail_to = to;
}

/* There is memory again. */
void failing_malloc_stop(void)
{
    fail_from = fail_to = -1;
}

long failing_malloc_count(void)
{
    return count;
}

/* Blocks that the library has taken and nobody has given back. */
long failing_malloc_living(void)
{
    long found = 0;
    for (int i = 0; i < REMEMBERED; ++i) {
        found += living[i] != NULL;
    }
    return found;
}

/* Where in the library the allocation was asked for. */
uintptr_t failing_malloc_caller(long index)
{
    return index < REMEMBERED ? callers[index] : 0;
}

static bool is_watched(const void *caller)
{
    return (uintptr_t)caller >= base && (uintptr_t)caller < end;
}

static bool refused(const void *caller)
{
    const long index = count++;
    if (index < REMEMBERED) {
        callers[index] = (uintptr_t)caller - base;
    }
    return index >= fail_from && index <= fail_to;
}

/* Blocks are found again by their address: whoever frees one may do so as its last act, from anywhere. */
static void replace(const void *old, const void *new)
{
    for (int i = 0; i < REMEMBERED; ++i) {
        if (living[i] == old) {
            living[i] = new;
            return;
        }
    }
}

void *malloc(size_t size)
{
    const bool watched = is_watched(__builtin_return_address(0));
    void *memory = watched && refused(__builtin_return_address(0)) ? NULL : __libc_malloc(size);
    if (watched && memory != NULL) {
        replace(NULL, memory);
    }
    return memory;
}

void *calloc(size_t number, size_t size)
{
    const bool watched = is_watched(__builtin_return_address(0));
    void *memory = watched && refused(__builtin_return_address(0)) ? NULL : __libc_calloc(number, size);
    if (watched && memory != NULL) {
        replace(NULL, memory);
    }
    return memory;
}

void *realloc(void *old, size_t size)
{
    const bool watched = is_watched(__builtin_return_address(0));
    void *memory = watched && refused(__builtin_return_address(0)) ? NULL : __libc_realloc(old, size);
    if (watched && memory != NULL) {
        replace(old, memory);
    }
    return memory;
}

void free(void *memory)
{
    if (memory != NULL && end > 0) {
        replace(memory, NULL);
    }
    __libc_free(memory);
}
