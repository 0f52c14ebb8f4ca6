#include "fmi/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Longest message; an instance name or a message beyond it is cut. */
#define MESSAGE_SIZE 1024
#define NAME_SHOWN 200

struct log_category_name {
    const char *name;
    unsigned bits;
};

/* The order of the first five is that of the bits. */
static const struct log_category_name known_categories[] = {
    {"logEvents", LOG_EVENTS},
    {"logStatusWarning", LOG_STATUS_WARNING},
    {"logStatusDiscard", LOG_STATUS_DISCARD},
    {"logStatusError", LOG_STATUS_ERROR},
    {"logStatusFatal", LOG_STATUS_FATAL},
    {"logAll", LOG_ALL},
};

#define CATEGORY_COUNT (sizeof known_categories / sizeof known_categories[0])

unsigned log_default_categories(bool logging_on)
{
    return logging_on ? LOG_ALL : LOG_STATUS_ALL;
}

bool log_category_bits(const char *name, unsigned *bits)
{
    for (size_t i = 0; i < CATEGORY_COUNT; ++i) {
        if (strcmp(known_categories[i].name, name) == 0) {
            *bits |= known_categories[i].bits;
            return true;
        }
    }
    return false;
}

const char *log_category_names(void)
{
    return "logEvents, logStatusWarning, logStatusDiscard, logStatusError, logStatusFatal, logAll";
}

static const struct log_category_name *category_of_status(enum model_status status)
{
    switch (status) {
    case MODEL_WARNING:
        return &known_categories[1];
    case MODEL_DISCARD:
        return &known_categories[2];
    case MODEL_ERROR:
        return &known_categories[3];
    case MODEL_FATAL:
        return &known_categories[4];
    case MODEL_OK:
        break;
    }
    return &known_categories[0];
}

/* Bytes of the UTF-8 character that a text begins with; 0 where it begins with something else or only a
 * part. */
static size_t character_length(const char *text)
{
    const unsigned char first = (unsigned char)text[0];
    const size_t length = first < 0x80u ? 1 : first < 0xC2u ? 0 : first < 0xE0u ? 2 : first < 0xF0u ? 3 : 4;
    for (size_t i = 1; i < length; ++i) {
        if (((unsigned char)text[i] & 0xC0u) != 0x80u) {
            return 0;
        }
    }
    return first < 0xF5u ? length : 0;
}

/* What is no UTF-8, a character cut in two among it, becomes question marks; the characters of `doubled` are
 * written twice. */
static void escape_message(const char *text, const char *doubled, char *escaped)
{
    while (*text != '\0') {
        const size_t length = character_length(text);
        if (strchr(doubled, *text) != NULL) {
            *escaped++ = *text;
        }
        *escaped++ = *text++;
        if (length == 0) {
            escaped[-1] = '?';
        }
        for (size_t i = 1; i < length; ++i) {
            *escaped++ = *text++;
        }
    }
    *escaped = '\0';
}

/* "ball at 0.25 s: " followed by the message, then handed over. */
static void send_message(struct instance *instance, enum model_status status, const char *category,
                         const char *message)
{
    char text[MESSAGE_SIZE];
    char escaped[2 * MESSAGE_SIZE];
    if (instance->model != NULL) {
        (void)snprintf(text, sizeof text, "%.*s at %.12g s: %s", NAME_SHOWN, instance->name,
                       model_time(instance->model), message);
    } else {
        (void)snprintf(text, sizeof text, "%.*s: %s", NAME_SHOWN, instance->name, message);
    }
    escape_message(text, instance->adapter->doubled, escaped);
    const enum phase phase = instance->phase;
    instance->phase = (enum phase)(phase | PHASE_TELLING);
    instance->adapter->send(instance, status, category, escaped);
    instance->phase = phase;
}

/* Never while the logger is at work: one that called wrongly each time it is told would never come to an
 * end. */
static bool is_heard(const struct instance *instance, unsigned category_bits)
{
    return instance->logger_given && (instance->phase & PHASE_TELLING) == 0 &&
           (instance->log_categories & category_bits) != 0;
}

enum model_status log_report(struct instance *instance, enum model_status status, const char *format, ...)
{
    const struct log_category_name *category = category_of_status(status);
    if (!is_heard(instance, category->bits)) {
        return status;
    }
    char message[MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    send_message(instance, status, category->name, message);
    return status;
}

bool log_wanted_by_importer(void *context, const char *category)
{
    const struct instance *instance = context;
    unsigned bits = 0;
    return log_category_bits(category, &bits) && is_heard(instance, bits);
}

void log_from_model(void *context, enum model_status status, const char *category, const char *message)
{
    if (log_wanted_by_importer(context, category)) {
        send_message(context, status, category, message);
    }
}
