/* utf8.h -- UTF-8 as Unicode defines it: no overlong forms, no surrogates, nothing above
 * U+10FFFF. */
#ifndef BASE_UTF8_H
#define BASE_UTF8_H
#include <stdbool.h>
#include <stddef.h>

/* utf8_character(s, len): the bytes of the character at s, of which len (1 or more) are
 * there; 0: it is none.  NUL is a character. */
size_t utf8_character(const char *s, size_t len);

/* utf8_is_control(s): the whole character at s is one that terminals obey (U+0000 to U+001F, U+007F to
 * U+009F), or one that is not seen or changes the order of others, so that two texts look the same. */
bool utf8_is_control(const char *s);

/* utf8_valid(s, len): the number of bytes from s on that are whole characters; len where
 * all of them are UTF-8, else the offset of the first that is not.  O(len). */
size_t utf8_valid(const char *s, size_t len);

/* utf8_is_text(s, max): up to max bytes of UTF-8 without control characters, up to its
 * NUL. */
bool utf8_is_text(const char *s, size_t max);

#endif
