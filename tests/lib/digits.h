/* digits.h -- the numbers of a few fixed comparisons, to the last digit: the same whatever
 * the compiler and its optimisation. */
#ifndef TESTS_DIGITS_H
#define TESTS_DIGITS_H
#include <stddef.h>

/* digits_text(size): as text of lines "what number...", to be released with free(). */
char *digits_text(size_t *size);

#endif
