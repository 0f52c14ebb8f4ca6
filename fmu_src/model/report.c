/* This file sends messages to the owner of a model, and writes numbers in messages. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "model/state.h"

bool model_reports(const struct model *m, enum model_status status)
{
    return m->host.log && (!m->host.wants || m->host.wants(m->host.context, status));
}

enum model_status model_report(const struct model *m, enum model_status status, const char *format, ...)
{
    if (model_reports(m, status)) {
        char message[512];
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message, sizeof message, format, arguments);
        va_end(arguments);
        m->host.log(m->host.context, status, message);
    }
    return status;
}

struct shortest shortest_digits(double value)
{
    struct shortest result = {""};
    /* A double keeps any 15 digits; 17 digits always tell it from its neighbours. */
    for (int digits = 15; digits <= 17; ++digits) {
        snprintf(result.text, sizeof result.text, "%.*g", digits, value);
        if (strtod(result.text, NULL) == value) {
            break;
        }
    }
    return result;
}
