/* The ratio of a circle's circumference to its diameter, rounded to double; C11 itself names none. */
#ifndef CONTACT_MATH_PI_H
#define CONTACT_MATH_PI_H

static const double PI = 3.141592653589793;

#endif
