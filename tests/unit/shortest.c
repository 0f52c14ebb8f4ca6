/* Numbers in messages: they read back as they were, and no shorter text does. */
#include "model/model.h"

#include <float.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "random.h"

TEST(everyday_numbers_are_as_a_user_writes_them)
{
    CHECK(strcmp(shortest_digits(0.7).text, "0.7") == 0);
    CHECK(strcmp(shortest_digits(0.1 + 0.2).text, "0.30000000000000004") == 0);
    CHECK(strcmp(shortest_digits(1e150).text, "1e+150") == 0);
    CHECK(strcmp(shortest_digits(-2.0).text, "-2") == 0);
    CHECK(strcmp(shortest_digits(0.0).text, "0") == 0);
    CHECK(strcmp(shortest_digits(-DBL_MAX).text, "-1.7976931348623157e+308") == 0);
    CHECK(strcmp(shortest_digits((double)INFINITY).text, "inf") == 0);
    CHECK(strstr(shortest_digits((double)NAN).text, "nan") != NULL);
}

/* Up to the exponent, leading zeros apart. */
static int digits_of(const char *text)
{
    int digits = 0;
    for (; *text != '\0' && *text != 'e'; ++text) {
        digits += *text >= (digits > 0 ? '0' : '1') && *text <= '9';
    }
    return digits;
}

/* Doubles of random bits, so that every exponent comes up. */
TEST(any_number_reads_back_and_has_no_digit_too_many)
{
    struct random random = {1};
    for (int i = 0; i < 20000; ++i) {
        const uint64_t bits = random_bits(&random);
        double value = 0.0;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value)) {
            continue;
        }
        const struct shortest shown = shortest_digits(value);
        CHECK(strtod(shown.text, NULL) == value);
        const int digits = digits_of(shown.text);
        CHECK(digits <= 17);
        char fewer[32];
        snprintf(fewer, sizeof fewer, "%.*e", digits > 15 ? digits - 2 : 14,
                 value); /* one before the point */
        CHECK(digits <= 15 || strtod(fewer, NULL) != value);
    }
}
