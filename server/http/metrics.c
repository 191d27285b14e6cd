#include "metrics.h"

#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <dirent.h>
#include <unistd.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "app.h"
#include "auth.h"
#include "errinfo.h"
#include "errmap.h"
#include "events.h"
#include "guard.h"
#include "gallery.h"
#include "json.h"
#include "intake.h"
#include "quota.h"
#include "queue.h"
#include "request.h"
#include "route.h"
#include "store.h"
#include "templates.h"
#include "tls.h"

#define NSTATUS  600
#define NBUCKETS 14
#define NSCORES  8

/* Upper bounds of the histograms' buckets, seconds. */
static const double bound[NBUCKETS] = {0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05,
                                       0.1,    0.25,  0.5,    1,     2.5,  5,     10};

/* Of the buckets of scores: no finer than those of GET /v1/stats, and without a sum, because two readings
 * before and after a verification tell what was added. */
static const int score_bound[NSCORES] = {-32, -16, -8, 0, 4, 8, 16, 32};

typedef atomic_uint_fast64_t counter;

struct histogram {
    counter bucket[NBUCKETS + 1]; /* not cumulative */
    counter ns;
};

/* The counters: first enum metrics_event, then more events, then one for each kind of problem (errmap.h). */
enum {
    CAPTURED = METRICS_EVENTS, /* accepted captures */
    DATABASE,                  /* failures, in the order of metrics_database_error() */
    WRONG_TOKEN = DATABASE + 5,
    PROBLEM,
    COUNTERS = PROBLEM + ERRMAP_COUNT
};

/* The metrics that are counters.  One without help goes on with the metric before it. */
static const struct family {
    unsigned first, n;                 /* its counters */
    const char *name, *label, *values; /* values: with commas; "": codes of problems */
    const char *help;
} family[] = {
    {METRICS_DECISIONS, 3, "surfaced_decisions_total", "decision",
     "match,no_match,inconclusive", "Verifications and comparisons by decision."},
    {METRICS_IDENTIFIED, 3, "surfaced_identifications_total", "decision",
     "match,no_match,inconclusive", "Identifications by decision."},
    {METRICS_ENROLLED, 3, "surfaced_enrollments_total", "outcome",
     "created,known,mismatch",
     "Enrolments; known: the subject has this scan already; mismatch: refused."},
    {PROBLEM + ERRMAP_STORAGE_FULL, 1, "surfaced_enrollments_refused_total", NULL, NULL,
     "Enrolments refused because the disk is nearly full."},
    {PROBLEM + ST_ELIMIT, 1 + ST_EQUALITY - ST_ELIMIT, "surfaced_scans_refused_total",
     "code", "", "Scans that could not be used, by the code of the response."},
    {METRICS_ENROLLABLE, 3, "surfaced_checks_total", "outcome",
     "enrollable,usable,unusable",
     "Scans checked without storing; usable: for verification only."},
    {CAPTURED, 1, "surfaced_captures_total", "outcome", "taken",
     "Signed captures: accepted, or refused with this code."},
    {PROBLEM + ERRMAP_CAPTURE_REQUIRED, 1 + ERRMAP_LIVENESS - ERRMAP_CAPTURE_REQUIRED,
     "surfaced_captures_total", "outcome", "", NULL},
    {METRICS_REFUSED_ATTEMPTS, 3, "surfaced_attempts_refused_total", "reason",
     "token,others,subjects",
     "Verifications refused (429) after failures: of the token for the subject, of other "
     "tokens, of the token for many subjects."},
    {METRICS_WARNINGS, 3, "surfaced_attempt_warnings_total", "kind",
     "locked_out,many_subjects,attempts_pattern",
     "Lock-outs; tokens that tried many subjects without a match; subjects whose "
     "verifications fail again and again between matches."},
    {DATABASE, 5, "surfaced_database_errors_total", "kind",
     "busy,io,corrupt,version,other", "Requests that failed because of the database."},
    {METRICS_LOST, 1, "surfaced_lost_events_total", NULL, NULL,
     "Events that could not be written to the database."},
    {PROBLEM + ST_EREPLAYED, 1, "surfaced_replayed_total", NULL, NULL,
     "Probes refused because they were enrolled before (replayed)."},
    {WRONG_TOKEN, 1, "surfaced_wrong_tokens_total", NULL, NULL,
     "Requests with a token that is not valid."},
};

struct metrics {
    time_t start;
    struct histogram stage[REQUEST_STAGES + 1]; /* the last one: in all */
    counter count[COUNTERS];
    counter score[NSCORES + 1];     /* not cumulative */
    counter rows_verified;          /* since 1970, s */
    counter tokens_soon, token_end; /* the latter seconds since 1970, 0: none ends */
    const struct route *routes;
    size_t nroutes;
    struct by_route {
        counter status[NSTATUS];
        struct histogram duration;
    } route[]; /* [nroutes + 1], the last for requests without one */
};

struct metrics *metrics_new(const struct route *routes, size_t nroutes)
{
    struct metrics *m = calloc(1, sizeof *m + (nroutes + 1) * sizeof *m->route);

    if (m != NULL) {
        m->start = time(NULL);
        m->routes = routes;
        m->nroutes = nroutes;
    }
    return m;
}

void metrics_free(struct metrics *m)
{
    free(m);
}

/* ---- counting */

static void metrics_add(counter *c, uint_fast64_t n)
{
    (void)atomic_fetch_add_explicit(c, n, memory_order_relaxed);
}

static void observe(struct histogram *h, double ms)
{
    size_t b = 0;

    while (b < NBUCKETS && ms > bound[b] * 1e3)
        b++;
    metrics_add(&h->bucket[b], 1);
    metrics_add(&h->ns, ms > 0.0 ? (uint_fast64_t)(ms * 1e6) : 0);
}

void metrics_event(struct metrics *m, unsigned e)
{
    metrics_add(&m->count[e], 1);
}

void metrics_decision(struct metrics *m, enum surface_decision decision, double score)
{
    size_t b = 0;

    metrics_event(m, METRICS_DECISIONS + decision);
    if (isnan(score))
        return;
    while (b < NSCORES && score > score_bound[b])
        b++;
    metrics_add(&m->score[b], 1);
}

void metrics_refused(struct metrics *m, enum status st)
{
    if (st >= ST_ELIMIT && st <= ST_EQUALITY)
        metrics_event(m, PROBLEM + st);
}

void metrics_database_error(struct metrics *m, enum status st)
{
    static const enum status kind[] = {ST_EBUSY, ST_EIO, ST_ECORRUPT, ST_EVERSION,
                                       ST_EDB};

    for (unsigned i = 0; i < sizeof kind / sizeof *kind; i++)
        if (st == kind[i])
            metrics_event(m, DATABASE + i);
}

static bool of_capture(unsigned problem)
{
    return problem >= ERRMAP_CAPTURE_REQUIRED && problem <= ERRMAP_LIVENESS;
}

void metrics_request(struct metrics *m, const struct request *r, int http, double ms)
{
    struct by_route *by =
        &m->route[r->route == NULL ? m->nroutes : (size_t)(r->route - m->routes)];

    metrics_add(&by->status[http < 0 || http >= NSTATUS ? 0 : http], 1);
    observe(&by->duration, ms);
    for (size_t i = 0; i < REQUEST_STAGES; i++)
        if ((r->stages >> i & 1) != 0)
            observe(&m->stage[i], r->stage_ms[i]);
    if ((r->stages >> REQUEST_PREPARE & 1) != 0) /* it was about a face */
        observe(&m->stage[REQUEST_STAGES], ms);
    if (r->response.bad_token)
        metrics_event(m, WRONG_TOKEN);
    if (r->response.problem != 0)
        metrics_event(m, PROBLEM + r->response.problem);
    if (r->capture.captured[0] != '\0' && !of_capture(r->response.problem))
        metrics_event(m, CAPTURED);
    metrics_database_error(m, r->failed);
}

void metrics_rows_verified(struct metrics *m)
{
    atomic_store(&m->rows_verified, (uint64_t)time(NULL));
}

void metrics_tokens(struct metrics *m, uint64_t soon, int64_t left_s)
{
    const int64_t now = time(NULL);

    atomic_store(&m->tokens_soon, soon);
    atomic_store(&m->token_end,
                 left_s > INT64_MAX - now ? 0 : (uint_fast64_t)(now + left_s));
}

/* ---- exposition */

static uint64_t metrics_value(const counter *c)
{
    return atomic_load_explicit(c, memory_order_relaxed);
}

static uint64_t metrics_at(const struct metrics *m, unsigned i)
{
    return metrics_value(&m->count[i]);
}

static void describe_problem(struct json *j, unsigned kind, uint64_t n)
{
    if (n > 0)
        json_number(j, errmap_get(kind)->code, (double)n);
}

/* Adds a member with the code of each kind of problem from first to last that occurred. */
static void describe_problems(const struct metrics *m, struct json *j, unsigned first,
                              unsigned last)
{
    for (unsigned kind = first; kind <= last; kind++)
        describe_problem(j, kind, metrics_at(m, PROBLEM + kind));
}

static void describe_refusals(const struct metrics *m, struct json *j)
{
    json_object(j, "refusals");
    describe_problems(m, j, ST_ENOTFOUND, ST_ENOTFOUND);
    describe_problems(m, j, ST_ELIMIT, ST_EQUALITY);
    describe_problems(m, j, ERRMAP_CAPTURE_REQUIRED, ERRMAP_LIVENESS);
    describe_problems(m, j, ERRMAP_SCOPE, ERRMAP_SCOPE);
    describe_problems(m, j, ERRMAP_DISABLED, ERRMAP_EXPIRED);
    describe_problems(m, j, ERRMAP_ATTEMPTS, ERRMAP_TWIN);
    describe_problems(m, j, ERRMAP_OVERLOAD, ERRMAP_OVERLOAD);
    describe_problems(m, j, ST_EREPLAYED, ST_EREPLAYED);
    describe_problem(j, ST_EMISMATCH, metrics_at(m, METRICS_MISMATCH));
    describe_problems(m, j, ERRMAP_STORAGE_FULL, ERRMAP_STORAGE_FULL);
    describe_problem(j, ERRMAP_NO_TOKEN, metrics_at(m, WRONG_TOKEN));
    json_close(j);
}

/* NAN: nothing was observed. */
static double quantile_ms(const struct histogram *h, double q)
{
    uint64_t all = 0, below = 0;
    size_t b = 0;

    for (size_t i = 0; i <= NBUCKETS; i++)
        all += metrics_value(&h->bucket[i]);
    if (all == 0)
        return (double)NAN;
    while (b < NBUCKETS &&
           (double)(below + metrics_value(&h->bucket[b])) < q * (double)all)
        below += metrics_value(&h->bucket[b++]);
    if (b == NBUCKETS)
        return bound[NBUCKETS - 1] * 1e3;

    const double from = b > 0 ? bound[b - 1] : 0,
                 n = (double)metrics_value(&h->bucket[b]);

    return 1e3 *
           (from + (bound[b] - from) * (q * (double)all - (double)below) / fmax(n, 1));
}

void metrics_describe(const struct metrics *m, struct json *j)
{
    const struct histogram *total = &m->stage[REQUEST_STAGES];
    uint64_t all = 0;

    for (unsigned d = 0; d <= SURFACE_INCONCLUSIVE; d++)
        all += metrics_at(m, METRICS_DECISIONS + d);
    json_number(j, "uptime_s", fmax(0, difftime(time(NULL), m->start)));
    json_object(j, "rates");
    json_number(j, "verifications", (double)all);
    json_object(j, "decisions");
    for (unsigned d = 0; d <= SURFACE_INCONCLUSIVE; d++)
        json_number(j, templates_decision((enum surface_decision)d),
                    (double)metrics_at(m, METRICS_DECISIONS + d));
    json_close(j);
    json_number(j, "enrollments", (double)metrics_at(m, METRICS_ENROLLED));
    describe_refusals(m, j);
    json_close(j);
    json_object(j, "latency_ms");
    json_number(j, "p50", quantile_ms(total, 0.5));
    json_number(j, "p95", quantile_ms(total, 0.95));
    json_number(j, "p99", quantile_ms(total, 0.99));
    json_close(j);
}

static void head(FILE *f, const char *name, const char *type, const char *help)
{
    fprintf(f, "# HELP %s %s\n# TYPE %s %s\n", name, help, name, type);
}

static void print_one(FILE *f, const char *name, const char *type, uint64_t v,
                      const char *help)
{
    head(f, name, type, help);
    fprintf(f, "%s %" PRIu64 "\n", name, v);
}

/* labels: "a=\"b\",c=\"d\""; nothing is printed of a histogram without observations. */
static void print_histogram(FILE *f, const char *name, const char *labels,
                            const struct histogram *h)
{
    uint64_t n[NBUCKETS + 1], sum = 0;

    for (size_t b = 0; b <= NBUCKETS; b++)
        n[b] = sum += metrics_value(&h->bucket[b]);
    if (sum == 0)
        return;
    for (size_t b = 0; b < NBUCKETS; b++)
        fprintf(f, "%s_bucket{%s,le=\"%g\"} %" PRIu64 "\n", name, labels, bound[b], n[b]);
    fprintf(f, "%s_bucket{%s,le=\"+Inf\"} %" PRIu64 "\n", name, labels, sum);
    fprintf(f, "%s_sum{%s} %.9f\n", name, labels, (double)metrics_value(&h->ns) / 1e9);
    fprintf(f, "%s_count{%s} %" PRIu64 "\n", name, labels, sum);
}

static void print_scores(FILE *f, const struct metrics *m)
{
    uint64_t n = 0;

    head(f, "surfaced_score", "histogram", "Scores of verifications and comparisons.");
    for (size_t b = 0; b < NSCORES; b++)
        fprintf(f, "surfaced_score_bucket{le=\"%d\"} %" PRIu64 "\n", score_bound[b],
                n += metrics_value(&m->score[b]));
    n += metrics_value(&m->score[NSCORES]);
    fprintf(f,
            "surfaced_score_bucket{le=\"+Inf\"} %" PRIu64
            "\nsurfaced_score_count %" PRIu64 "\n",
            n, n);
}

/* Returns NULL for the counters of requests without a route. */
static const struct route *route_at(const struct metrics *m, size_t i)
{
    return i < m->nroutes ? &m->routes[i] : NULL;
}

static void print_requests(FILE *f, const struct metrics *m)
{
    char labels[128];

    head(f, "surfaced_http_requests_total", "counter",
         "Requests by route and status; status 0: the client disconnected.");
    for (size_t i = 0; i <= m->nroutes; i++)
        for (int s = 0; s < NSTATUS; s++)
            if (metrics_value(&m->route[i].status[s]) > 0)
                fprintf(f,
                        "surfaced_http_requests_total{route=\"%s\",method=\"%s\","
                        "status=\"%d\"} %" PRIu64 "\n",
                        route_pattern(route_at(m, i)), route_method(route_at(m, i)), s,
                        metrics_value(&m->route[i].status[s]));
    head(f, "surfaced_http_request_duration_seconds", "histogram",
         "From the request line to the end of the response.");
    for (size_t i = 0; i <= m->nroutes; i++) {
        (void)snprintf(labels, sizeof labels, "route=\"%s\",method=\"%s\"",
                       route_pattern(route_at(m, i)), route_method(route_at(m, i)));
        print_histogram(f, "surfaced_http_request_duration_seconds", labels,
                        &m->route[i].duration);
    }
    head(f, "surfaced_stage_duration_seconds", "histogram",
         "Time of requests by stage; queue: waiting for a worker; total: a request with "
         "a scan, receiving and sending included.");
    for (size_t i = 0; i <= REQUEST_STAGES; i++) {
        (void)snprintf(labels, sizeof labels, "stage=\"%s\"",
                       i == REQUEST_STAGES ? "total"
                                           : request_stage_name((enum request_stage)i));
        print_histogram(f, "surfaced_stage_duration_seconds", labels, &m->stage[i]);
    }
}

static void print_family(FILE *f, const struct metrics *m, const struct family *x)
{
    const char *value = x->values;

    if (x->help != NULL)
        head(f, x->name, "counter", x->help);
    for (unsigned i = x->first; i < x->first + x->n; i++) {
        if (value != NULL && *x->values == '\0')
            value = errmap_get(i - PROBLEM)->code;
        fputs(x->name, f);
        if (value != NULL)
            fprintf(f, "{%s=\"%.*s\"}", x->label, (int)strcspn(value, ","), value);
        fprintf(f, " %" PRIu64 "\n", metrics_at(m, i));
        if (value != NULL)
            value += strcspn(value, ",") + 1;
    }
}

/* end: seconds since 1970; 0: there is none. */
static void print_until(FILE *f, const char *name, uint64_t end, const char *help)
{
    const uint64_t now = (uint64_t)time(NULL);

    if (end > 0)
        print_one(f, name, "gauge", end > now ? end - now : 0, help);
}

static void print_tokens(FILE *f, const struct metrics *m)
{
    print_one(f, "surfaced_tokens_expiring", "gauge", metrics_value(&m->tokens_soon),
              "Tokens that expire within 30 days.");
    print_until(f, "surfaced_token_first_end_seconds", metrics_value(&m->token_end),
                "Time until the first token expires.");
}

/* By the system's clock, which may be set back. */
static void print_verified(FILE *f, const struct app *app)
{
    const uint64_t now = (uint64_t)time(NULL),
                   at = metrics_value(&app->metrics->rows_verified);
    struct errinfo e;

    print_one(f, "surfaced_rows_verified_age_seconds", "gauge", now > at ? now - at : 0,
              "Time since the database's rows were last verified against its change "
              "log.");
    print_one(
        f, "surfaced_database_refused", "gauge", store_refused(app->store, &e),
        "1: the database is not the one that was opened, and all of /v1 gives 503.");
    print_until(f, "surfaced_certificate_end_seconds",
                app->tls != NULL ? (uint64_t)tls_end(app->tls) : 0,
                "Time until the daemon's TLS certificate expires.");
}

static void print_gauges(FILE *f, const struct app *app)
{
    struct queue_state q;

    queue_look(app->queue, &q);
    print_one(f, "surfaced_queue_depth", "gauge", q.waiting,
              "Requests that wait for a worker.");
    print_one(f, "surfaced_workers_busy", "gauge", q.running, "Worker threads at work.");
    print_one(
        f, "surfaced_storage_full", "gauge",
        intake_full(app->db, app->disk_reserve, NULL),
        "1: less than the reserve is free on the disk, and enrolments are refused.");
}

static void print_connections(FILE *f, const struct app *app)
{
    struct guard_state g;

    guard_look(app->guard, &g);
    const struct {
        const char *reason;
        uint64_t n;
    } closed[] = {
        {"too_many", g.refused_total},
        {"crowded_out", g.crowded_out},
        {"too_many_of_one_address", g.refused_address},
        {"idle", g.late[GUARD_IDLE]},
        {"slow_headers", g.late[GUARD_REQUEST] + g.late[GUARD_HEADERS]},
        {"slow_body", g.late[GUARD_BODY]},
        {"slow_reader", g.late[GUARD_RESPONSE]},
        {"slow_events", g.late[GUARD_STREAM]},
        {"client_gone", g.gone},
        {"proxy_header", g.proxy_header},
    };

    print_one(f, "surfaced_connections", "gauge", g.open, "Open connections.");
    head(f, "surfaced_held_bytes", "gauge",
         "Bytes of bodies and responses in memory, by size class.");
    for (int i = 0; i < QUOTA_SIZES; i++)
        fprintf(f, "surfaced_held_bytes{size=\"%s\"} %zu\n",
                i == QUOTA_IS_LARGE ? "large" : "small",
                quota_held(app->quota, (enum quota_size)i));
    head(f, "surfaced_connections_closed_total", "counter",
         "Connections closed because of a limit on number or time, or of a proxy's "
         "header.");
    for (size_t i = 0; i < sizeof closed / sizeof *closed; i++)
        fprintf(f, "surfaced_connections_closed_total{reason=\"%s\"} %" PRIu64 "\n",
                closed[i].reason, closed[i].n);
}

/* The metrics of a process that all exporters have.  A value that cannot be read is 0.  Cost: some 100 us. */
struct process_state {
    double cpu_seconds;
    uint64_t resident_bytes, virtual_bytes;
    uint64_t open_fds;
};

static uint64_t count_fds(void)
{
    DIR *d = opendir("/proc/self/fd");
    uint64_t n = 0;

    if (d == NULL)
        return 0;
    while (readdir(d) != NULL)
        n++;
    (void)closedir(d);
    return n - 3; /* ".", ".." and the folder's own */
}

static void look_at_memory(struct process_state *out)
{
    FILE *f = fopen("/proc/self/statm", "re");
    uint64_t all, resident, page = (uint64_t)sysconf(_SC_PAGESIZE);

    if (f == NULL)
        return;
    if (fscanf(f, "%" SCNu64 " %" SCNu64, &all, &resident) == 2) {
        out->virtual_bytes = all * page;
        out->resident_bytes = resident * page;
    }
    (void)fclose(f);
}

static void look_at_process(struct process_state *out)
{
    struct timespec cpu;

    *out = (struct process_state){.open_fds = count_fds()};
    look_at_memory(out);
    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu) == 0)
        out->cpu_seconds = (double)cpu.tv_sec + (double)cpu.tv_nsec * 1e-9;
}

static void print_process(FILE *f, const struct app *app, bool all)
{
    struct process_state p;

    look_at_process(&p);
    print_one(f, "process_start_time_seconds", "gauge", (uint64_t)app->metrics->start,
              "Start of the process, seconds since 1970.");
    if (all) {
        head(f, "process_cpu_seconds_total", "counter", "Processor time used.");
        fprintf(f, "process_cpu_seconds_total %.3f\n", p.cpu_seconds);
    }
    print_one(f, "process_resident_memory_bytes", "gauge", p.resident_bytes,
              "Resident memory.");
    print_one(f, "process_virtual_memory_bytes", "gauge", p.virtual_bytes,
              "Virtual memory.");
    print_one(f, "process_open_fds", "gauge", p.open_fds, "Open file descriptors.");
}

static void print_gallery(FILE *f, const struct app *app)
{
    struct gallery_state is;

    if (app->gallery == NULL)
        return;
    is = gallery_state(app->gallery);
    print_one(f, "surfaced_gallery_subjects", "gauge", is.subjects,
              "Subjects who may be identified.");
    print_one(f, "surfaced_gallery_bytes", "gauge", is.bytes, "Memory of the gallery.");
}

static void print_events(FILE *f, const struct app *app)
{
    struct events_state is;

    events_look(app->events, &is);
    print_one(f, "surfaced_event_streams", "gauge", is.open,
              "Open streams of events, and requests that wait for one.");
    print_one(f, "surfaced_events_sent_total", "counter", is.sent,
              "Events given to clients.");
}

/* all: also what grows with each person who comes, the processor time included.  The rest says
 * that the daemon runs, and how much it does at the moment. */
static char *text(const struct app *app, bool all)
{
    char *out = NULL;
    size_t len;
    FILE *f = open_memstream(&out, &len);
    bool failed;

    if (f == NULL)
        return NULL;
    if (all) {
        print_requests(f, app->metrics);
        for (size_t i = 0; i < sizeof family / sizeof *family; i++)
            print_family(f, app->metrics, &family[i]);
        print_scores(f, app->metrics);
        print_tokens(f, app->metrics);
        print_gallery(f, app);
        print_events(f, app);
    }
    print_verified(f, app);
    print_gauges(f, app);
    print_connections(f, app);
    print_process(f, app, all);
    failed = ferror(f) != 0;
    if (fclose(f) != 0 || failed) {
        free(out);
        return NULL;
    }
    return out;
}

void metrics_handle(struct request *r, struct worker *w)
{
    (void)w;
    request_text(r, "text/plain; version=0.0.4; charset=utf-8",
                 text(r->app, auth_has(r, STORE_SCOPE_AUDIT)));
}
