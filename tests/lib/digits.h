/* digits.h -- the numbers of a few fixed comparisons, to the last digit: they must not depend
 * on the compiler or its optimisation. */
#ifndef TESTS_DIGITS_H
#define TESTS_DIGITS_H
#include <stddef.h>

/* digits_text(size): the numbers as lines "NAME NUMBER..."; release the text with free(). */
char *digits_text(size_t *size);

#endif
