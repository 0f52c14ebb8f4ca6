#include "claim.h"

#include <stdio.h>
#include <stdlib.h>

struct claim_context claim_context;

void claim(bool holds, const char *text, const char *file, int line)
{
    if (!holds) {
        if (claim_context.show != NULL) {
            claim_context.show();
        }
        fprintf(stderr, "%s\nlast message: %s\n%s:%d: not so: %s\n", claim_context.note,
                claim_context.last_message, file, line, text);
        abort();
    }
}
