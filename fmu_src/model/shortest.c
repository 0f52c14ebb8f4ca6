/* Numbers in messages. */
#include "model/shortest.h"

#include <stdio.h>
#include <stdlib.h>

struct shortest shortest_digits(double value)
{
    struct shortest result = {""};
    /* 15 digits are always kept by a double, 17 always tell it from its neighbours. */
    for (int digits = 15; digits <= 17; ++digits) {
        snprintf(result.text, sizeof result.text, "%.*g", digits, value);
        if (strtod(result.text, NULL) == value) {
            break;
        }
    }
    return result;
}
