/* replay FOLDER_OR_FILE...: every input once through the fuzzer's function, with any compiler. Prints how
 * many there were; a broken claim aborts after the input's name. */
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "claim.h"

static long inputs;
static const char *present;

static void name_it(int number)
{
    (void)number;
    fprintf(stderr, "by %s\n", present);
}

static int replay_file(const char *name)
{
    FILE *file = fopen(name, "rb");
    if (file == NULL) {
        perror(name);
        return 1;
    }
    static uint8_t room[1 << 16];
    const size_t size = fread(room, 1, sizeof room, file);
    fclose(file);
    uint8_t *exact = malloc(size > 0 ? size : 1); /* so that a sanitizer sees a read beyond its end */
    if (exact == NULL) {
        return 1;
    }
    memcpy(exact, room, size);
    present = name;
    LLVMFuzzerTestOneInput(exact, size);
    free(exact);
    ++inputs;
    return 0;
}

static int replay(const char *name)
{
    DIR *folder = opendir(name);
    if (folder == NULL) {
        return replay_file(name);
    }
    int failures = 0;
    for (const struct dirent *entry = readdir(folder); entry != NULL; entry = readdir(folder)) {
        char path[4096];
        if (entry->d_name[0] != '.') {
            snprintf(path, sizeof path, "%s/%s", name, entry->d_name);
            failures += replay(path);
        }
    }
    closedir(folder);
    return failures;
}

int main(int count, char **names)
{
    int failures = 0;
    signal(SIGABRT, name_it);
    for (int i = 1; i < count; ++i) {
        failures += replay(names[i]);
    }
    printf("%ld inputs replayed\n", inputs);
    return failures > 0 || inputs == 0;
}
