/* metrics.h -- counters for Prometheus.  Any thread may count; no label names a person. */
#ifndef SERVER_METRICS_H
#define SERVER_METRICS_H
#include <stddef.h>
#include "face.h"

struct app;
struct metrics;

struct metrics *metrics_new(void); /* NULL: out of memory */
void metrics_free(struct metrics *m);

/* metrics_request(m, route, http, ms): a request came to its end; route: routes_index(). */
void metrics_request(struct metrics *m, size_t route, int http, double ms);

/* metrics_decision(m, d): a verification or comparison was decided. */
void metrics_decision(struct metrics *m, enum face_decision d);

/* metrics_lost_event(m): an event could not be written to the store. */
void metrics_lost_event(struct metrics *m);

/* metrics_text(app): the exposition format 0.0.4 as heap text; NULL: out of memory. */
char *metrics_text(const struct app *app);

#endif
