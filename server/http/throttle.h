/* throttle.h -- rate-limits failed authentication per address: after a number of wrong
 * tokens in a minute, no token from that address is checked for a while, except those
 * that were right before: behind a proxy, a client that guesses does not lock out those
 * at work.
 * In memory alone and of fixed size: with more addresses at once than there is room for,
 * those closest to their limit's end are forgotten.  Safe on any thread. */
#ifndef SERVER_THROTTLE_H
#define SERVER_THROTTLE_H
#include <stdbool.h>

struct sockaddr;
struct throttle;

#define THROTTLE_ADDRESS 16 /* bytes */

/* throttle_new(per_minute): 0: no limit.  NULL: out of memory. */
struct throttle *throttle_new(unsigned per_minute);
void throttle_free(struct throttle *t); /* NULL is allowed */

/* throttle_address(addr, out): what counts as one address: of IPv6 the first 64 bits, which
 * is what one customer gets; those without one together, as the clients of a Unix socket
 * are; NULL: without. */
void throttle_address(const struct sockaddr *addr, unsigned char out[THROTTLE_ADDRESS]);

/* throttle_wait(t, address, token, now_ms): seconds until this token from there may be
 * checked; 0: now.  now_ms: logger_clock_ms(). */
unsigned throttle_wait(struct throttle *t, const unsigned char address[THROTTLE_ADDRESS],
                       const char *token, double now_ms);

/* throttle_note(t, address, token, good, now_ms): it was checked. */
void throttle_note(struct throttle *t, const unsigned char address[THROTTLE_ADDRESS],
                   const char *token, bool good, double now_ms);

#endif
