/* throttle.h -- rate-limits failed authentication by address: after a number of wrong tokens in a
 * minute, no token from that address is checked for a while, except the tokens that were right before.  So
 * a client that guesses tokens behind a proxy does not lock out the other clients of the proxy.
 * The table is in memory alone and has a fixed size: if there are more addresses at once than it has room
 * for, it forgets those with the shortest wait.  Any thread. */
#ifndef SERVER_THROTTLE_H
#define SERVER_THROTTLE_H
#include <stdbool.h>
#include <stdint.h>

struct throttle;

/* throttle_new(most, period_ms): Returns an empty table.  NULL: out of memory.
 *   most  failures that are allowed in a period; 0: no limit */
struct throttle *throttle_new(unsigned most, double period_ms);
void throttle_free(struct throttle *t); /* NULL is allowed */

/* throttle_wait(t, address, token, now_ms): Returns the time until this token from this address may be checked,
 * s; 0: now.
 *   address  address_key()
 *   now_ms   logger_clock_ms() */
unsigned throttle_wait(struct throttle *t, uint64_t address, const char *token,
                       double now_ms);

/* throttle_note(t, address, token, good, now_ms): Records the result of a check.  The parameters are those
 * of throttle_wait().
 *   good  the token is valid */
void throttle_note(struct throttle *t, uint64_t address, const char *token, bool good,
                   double now_ms);

#endif
