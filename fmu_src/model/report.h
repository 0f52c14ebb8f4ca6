/* Numbers in messages: the fewest digits that read back as the same number. */
#ifndef CONTACT_MODEL_REPORT_H
#define CONTACT_MODEL_REPORT_H

/* Room for a sign, 17 digits, a point, an exponent and the end: -1.2345678901234567e-308 is the longest. */
enum { SHORTEST_SIZE = 25 };

struct shortest {
    char text[SHORTEST_SIZE];
};

/* 0.7 is "0.7", where "%.17g" would say 0.69999999999999996. For "%s": shortest_digits(x).text */
struct shortest shortest_digits(double value);

#endif
