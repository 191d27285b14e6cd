/* lockout.h -- how long a lock-out lasts: for the daemon, and for the study that counts how long
 * an attacker's attempts take with it. */
#ifndef BASE_LOCKOUT_H
#define BASE_LOCKOUT_H
#include <stdint.h>

/* lockout_ms(limit, wait_s, most_s, failures): after this many failures in a row: 0 below limit,
 * wait_s s at limit, twice as long with each further one, most_s s at most. */
int64_t lockout_ms(unsigned limit, unsigned wait_s, unsigned most_s, uint32_t failures);

#endif
