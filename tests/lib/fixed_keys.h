/* fixed_keys.h -- keys that are the same on every run, for tests of bytes that are written down. */
#ifndef TESTS_FIXED_KEYS_H
#define TESTS_FIXED_KEYS_H

struct crypt;

/* fixed_keys(): Returns keys whose every secret is 32 times 0x5a, to be released by crypt_free().
 * Threads: one. */
struct crypt *fixed_keys(void);

#endif
