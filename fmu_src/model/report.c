/* Messages to the owner of a model. */
#include <stdarg.h>
#include <stdio.h>

#include "model/state.h"

static const char *category_of(enum model_status status)
{
    switch (status) {
    case MODEL_WARNING:
        return "logStatusWarning";
    case MODEL_DISCARD:
        return "logStatusDiscard";
    case MODEL_ERROR:
        return "logStatusError";
    case MODEL_FATAL:
        return "logStatusFatal";
    case MODEL_OK:
    default:
        return "logEvents";
    }
}

enum model_status model_report(const struct model *m, enum model_status status, const char *format, ...)
{
    const char *category = category_of(status);
    if (m->host.log && (!m->host.wants || m->host.wants(m->host.context, category))) {
        char message[512];
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(message, sizeof message, format, arguments);
        va_end(arguments);
        m->host.log(m->host.context, status, category, message);
    }
    return status;
}
