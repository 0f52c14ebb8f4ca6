/* Messages to the importer's logger: complete sentences, bounded length, categories of the standard. */
#ifndef CONTACT_FMI_LOG_H
#define CONTACT_FMI_LOG_H

#include "fmi/instance.h"
#include "math/compiler.h"

/*
 * Warnings and worse are always told, unless the importer named categories that leave them out; events
 * only when logging is on.
 */
enum log_category {
    LOG_EVENTS = 1 << 0,
    LOG_STATUS_WARNING = 1 << 1,
    LOG_STATUS_DISCARD = 1 << 2,
    LOG_STATUS_ERROR = 1 << 3,
    LOG_STATUS_FATAL = 1 << 4,
    LOG_STATUS_ALL = LOG_STATUS_WARNING | LOG_STATUS_DISCARD | LOG_STATUS_ERROR | LOG_STATUS_FATAL,
    LOG_ALL = LOG_EVENTS | LOG_STATUS_ALL
};

/* The categories in force for loggingOn without named categories. */
unsigned log_default_categories(bool logging_on);

/* Adds the bits of a category's name; false when there is no such category. */
bool log_category_bits(const char *name, unsigned *categories);

/* "logEvents, logStatusWarning, ..." */
const char *log_category_names(void);

/*
 * Tells the importer, and returns the status so that a caller can say `return log_report(...)`. Until the
 * logger is back the instance is in the midst of something: functions that only read are answered, all others
 * give an error and change nothing (freeing the instance too does nothing), and nothing is told of it.
 */
enum model_status log_report(struct instance *instance, enum model_status status, const char *format, ...)
    CONTACT_PRINTF_LIKE(3, 4);

/* The model's side of it (struct model_host); the context is the instance. */
void log_from_model(void *context, enum model_status status, const char *category, const char *message);
bool log_wanted_by_importer(void *context, const char *category);

#endif
