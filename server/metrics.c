#include "metrics.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "app.h"
#include "cache.h"
#include "queue.h"
#include "routes.h"

#define NSTATUS  600
#define NBUCKETS 11

/* Upper bounds of the histogram's buckets, ms. */
static const double bucket_ms[NBUCKETS] = {0.5, 1, 2, 4, 8, 16, 32, 64, 250, 1000, 5000};

struct route_counts {
    atomic_uint_fast64_t status[NSTATUS];
    atomic_uint_fast64_t bucket[NBUCKETS + 1]; /* not cumulative */
    atomic_uint_fast64_t ns;
};

struct metrics {
    struct route_counts route[ROUTES_MAX];
    atomic_uint_fast64_t decision[FACE_INCONCLUSIVE + 1];
    atomic_uint_fast64_t lost_events;
};

struct metrics *metrics_new(void)
{
    return calloc(1, sizeof(struct metrics));
}

void metrics_free(struct metrics *m)
{
    free(m);
}

static void count(atomic_uint_fast64_t *counter, uint_fast64_t n)
{
    (void)atomic_fetch_add_explicit(counter, n, memory_order_relaxed);
}

static uint64_t value(atomic_uint_fast64_t *counter)
{
    return atomic_load_explicit(counter, memory_order_relaxed);
}

void metrics_request(struct metrics *m, size_t route, int http, double ms)
{
    struct route_counts *c = &m->route[route];
    size_t b = 0;

    while (b < NBUCKETS && ms > bucket_ms[b])
        b++;
    count(&c->status[http < 0 || http >= NSTATUS ? 0 : http], 1);
    count(&c->bucket[b], 1);
    count(&c->ns, ms > 0.0 ? (uint_fast64_t)(ms * 1e6) : 0);
}

void metrics_decision(struct metrics *m, enum face_decision d)
{
    count(&m->decision[d], 1);
}

void metrics_lost_event(struct metrics *m)
{
    count(&m->lost_events, 1);
}

static void print_requests(FILE *f, struct metrics *m)
{
    const char *name, *method;

    fputs(
        "# HELP surfaced_http_requests_total Requests by route and status; status 0: the "
        "client went away.\n# TYPE surfaced_http_requests_total counter\n",
        f);
    for (size_t i = 0; (name = routes_name(i, &method)) != NULL; i++)
        for (int s = 0; s < NSTATUS; s++)
            if (value(&m->route[i].status[s]) > 0)
                fprintf(f,
                        "surfaced_http_requests_total{route=\"%s\",method=\"%s\","
                        "status=\"%d\"} %" PRIu64 "\n",
                        name, method, s, value(&m->route[i].status[s]));
}

static void print_durations(FILE *f, struct metrics *m)
{
    const char *name, *method;

    fputs(
        "# HELP surfaced_http_request_duration_seconds From the request line to the end "
        "of the answer.\n# TYPE surfaced_http_request_duration_seconds histogram\n",
        f);
    for (size_t i = 0; (name = routes_name(i, &method)) != NULL; i++) {
        uint64_t sum = 0;

        for (size_t b = 0; b <= NBUCKETS; b++)
            sum += value(&m->route[i].bucket[b]);
        if (sum == 0)
            continue;
        sum = 0;
        for (size_t b = 0; b <= NBUCKETS; b++) {
            char le[16] = "+Inf";

            sum += value(&m->route[i].bucket[b]);
            if (b < NBUCKETS)
                (void)snprintf(le, sizeof le, "%g", bucket_ms[b] / 1e3);
            fprintf(f,
                    "surfaced_http_request_duration_seconds_bucket{route=\"%s\","
                    "method=\"%s\",le=\"%s\"} %" PRIu64 "\n",
                    name, method, le, sum);
        }
        fprintf(f,
                "surfaced_http_request_duration_seconds_sum{route=\"%s\",method=\"%s\"} "
                "%.9f\nsurfaced_http_request_duration_seconds_count{route=\"%s\","
                "method=\"%s\"} %" PRIu64 "\n",
                name, method, (double)value(&m->route[i].ns) / 1e9, name, method, sum);
    }
}

static void print_one(FILE *f, const char *name, const char *type, const char *help,
                      uint64_t v)
{
    fprintf(f, "# HELP %s %s\n# TYPE %s %s\n%s %" PRIu64 "\n", name, help, name, type,
            name, v);
}

static void print_rest(FILE *f, const struct app *app)
{
    static const char *const decision[] = {"match", "no_match", "inconclusive"};
    struct queue_state q;
    struct cache_state c;

    queue_look(app->queue, &q);
    cache_look(app->cache, &c);
    fputs("# HELP surfaced_decisions_total Verifications and comparisons by decision.\n"
          "# TYPE surfaced_decisions_total counter\n",
          f);
    for (size_t i = 0; i < 3; i++)
        fprintf(f, "surfaced_decisions_total{decision=\"%s\"} %" PRIu64 "\n", decision[i],
                value(&app->metrics->decision[i]));
    print_one(f, "surfaced_lost_events_total", "counter",
              "Events that could not be written to the database.",
              value(&app->metrics->lost_events));
    print_one(f, "surfaced_queue_depth", "gauge", "Requests that wait for a worker.",
              q.waiting);
    print_one(f, "surfaced_queue_limit", "gauge", "Requests that may wait.", q.limit);
    print_one(f, "surfaced_workers", "gauge", "Worker threads.", q.workers);
    print_one(f, "surfaced_workers_busy", "gauge", "Worker threads at work.", q.running);
    print_one(f, "surfaced_cache_hits_total", "counter", "Templates found decoded.",
              c.hits);
    print_one(f, "surfaced_cache_misses_total", "counter", "Templates read and decoded.",
              c.misses);
    print_one(f, "surfaced_cache_templates", "gauge", "Decoded templates in memory.",
              c.entries);
    print_one(f, "surfaced_cache_bytes", "gauge", "Memory they take.", c.bytes);
}

char *metrics_text(const struct app *app)
{
    char *text = NULL;
    size_t len;
    FILE *f = open_memstream(&text, &len);
    bool failed;

    if (f == NULL)
        return NULL;
    print_requests(f, app->metrics);
    print_durations(f, app->metrics);
    print_rest(f, app);
    failed = ferror(f) != 0;
    if (fclose(f) != 0 || failed) {
        free(text);
        return NULL;
    }
    return text;
}
