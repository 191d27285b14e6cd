/* utf8.h -- UTF-8 as Unicode defines it: no overlong forms, no surrogates, nothing above
 * U+10FFFF. */
#ifndef BASE_UTF8_H
#define BASE_UTF8_H
#include <stdbool.h>
#include <stddef.h>

/* utf8_character(s, len): Returns the number of bytes of the character at s; 0 if the first len bytes (1 or
 * more) do not begin with a whole character.  NUL is a character. */
size_t utf8_character(const char *s, size_t len);

/* utf8_is_control(s): Returns true if the whole character at s controls a terminal (U+0000 to U+001F, U+007F to
 * U+009F), is invisible, or changes the order of others: two texts with it may look the same. */
bool utf8_is_control(const char *s);

/* utf8_valid(s, len): Returns the number of bytes at s that are whole characters: len if all of them are UTF-8,
 * else the offset of the first that is not.  Cost: O(len). */
size_t utf8_valid(const char *s, size_t len);

/* utf8_is_text(s, max): Returns true if s is up to max bytes of UTF-8 without control characters. */
bool utf8_is_text(const char *s, size_t max);

#endif
