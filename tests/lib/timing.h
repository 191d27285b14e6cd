/* timing.h -- medians of interleaved measurements, and targets.
 * Compared programs are measured in turn within one loop, so that drift of the machine
 * affects all alike; and over many different inputs, since the branch predictor would learn
 * a repeated one. */
#ifndef TESTS_TIMING_H
#define TESTS_TIMING_H
#include <stddef.h>
#include "status.h"

struct peers; /* peers.h */

struct timing {
    double *ms;
    size_t n, cap;
    double since; /* timing_start()'s clock */
};

void timing_start(struct timing *t);
void timing_stop(struct timing *t);           /* one more sample */
void timing_add(struct timing *t, double ms); /* a sample measured elsewhere */
double timing_median(const struct timing *t); /* NAN without samples */
double timing_part(const struct timing *t,
                   double share); /* the sample of this rank, 0..1 */
void timing_free(struct timing *t);

/* Calls and adds the time as a sample; the call's value is lost. */
#define TIMED(t, call) (timing_start(t), (void)(call), timing_stop(t))

double timing_now_ms(void); /* processor time of this thread: waiting does not count */

/* timing_bytes(): Returns the bytes allocated at the moment, from mallinfo2(). */
double timing_bytes(void);

/* timing_peers(): Returns the peers of the shared object $BENCH_PEERS, or NULL if it is not there. */
const struct peers *timing_peers(void);

/* timing_alloc(n, size): Returns zeroed memory; exits if out of memory. */
void *timing_alloc(size_t n, size_t size);

/* timing_must(st): Exits with the message of the status unless st is ST_OK. */
void timing_must(enum status st);

/* timing_unit(ms): Writes CGAL's time for one triangulation of 3,000 points to the file $BENCH_UNIT,
 * the unit of scripts/bench; does nothing if ms is NAN. */
void timing_unit(double ms);

/* timing_target(what, value, limit, unit): Adds a row to the table of targets in the file
 * $BENCH_TARGETS, which scripts/bench prints at the end. */
void timing_target(const char *what, double value, double limit, const char *unit);

#endif
