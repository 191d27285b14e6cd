/* utf8.h -- UTF-8 as Unicode defines it: no overlong forms, no surrogates, nothing above
 * U+10FFFF. */
#ifndef BASE_UTF8_H
#define BASE_UTF8_H
#include <stddef.h>

/* utf8_valid(s, len): the number of bytes from s on that are whole characters; len where all
 * of them are UTF-8, else the offset of the first that is not.  NUL is a character.
 * O(len). */
size_t utf8_valid(const char *s, size_t len);

#endif
