/* store_load DATABASE KEY ANCHOR TOKEN FIRST THREADS SECONDS WORK_MS: what a daemon asks of its database for
 * verifications of cached faces that match (token, snapshot, record), with WORK_MS of waiting in the
 * place of the face work; each thread has a subject of its own, from sFIRST on.  Prints verifications a
 * second, and the median and 99th percentile of the store's part in ms. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "store.h"
#include "store_verification.h"

#define THREADS_MAX 64
#define TIMES_MAX   100000 /* of a thread */

static struct store *store;
static const char *secret;
static double until_ms, work_ms;

struct thread {
    pthread_t id;
    char subject[16];
    double *ms;
    size_t n, failed;
};

static double now_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec / 1e6;
}

static enum status verify(const struct thread *x, double *ms, struct errinfo *e)
{
    const struct store_scan scan = {.noise_mm = 0.25, .quality = 0.9};
    const struct store_probe probe = {
        .read = {"0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef"}};
    const double begin = now_ms();
    struct store_recorded out;
    struct store_snapshot is;
    struct store_token t;
    enum status st = store_token_check(store, secret, &t, e);

    if (st != ST_OK)
        return st;
    st = store_snapshot_begin(
        store, &(struct store_snapshot_of){.subject = x->subject, .token = t.id}, &is, e);
    st = store_snapshot_end(&is, st, e);
    *ms = now_ms() - begin;
    (void)nanosleep(
        &(struct timespec){(time_t)(work_ms / 1e3), (long)(work_ms * 1e6) % 1000000000},
        NULL);
    *ms -= now_ms();
    if (st == ST_OK)
        st = store_record_verification(store,
                                       &(struct store_record){.subject = &is.subject,
                                                              .as = STORE_RECORD_PASSED,
                                                              .actor = t.id,
                                                              .kind = "verify",
                                                              .template_id = is.t[0].id,
                                                              .outcome = "match",
                                                              .decision = "match",
                                                              .score = 20,
                                                              .scan = &scan,
                                                              .probe = &probe},
                                       &out, e);
    *ms += now_ms();
    store_snapshot_free(&is);
    return st;
}

static void *run(void *arg)
{
    struct thread *x = arg;
    struct errinfo e;

    while (now_ms() < until_ms && x->n < TIMES_MAX) {
        if (verify(x, &x->ms[x->n], &e) == ST_OK) {
            x->n++;
        } else if (x->failed++ == 0) {
            (void)fprintf(stderr, "store_load: %s\n", e.msg);
        }
    }
    return NULL;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

static void print(struct thread *x, int threads, double seconds)
{
    static double all[THREADS_MAX * TIMES_MAX];
    size_t n = 0, failed = 0;

    for (int i = 0; i < threads; i++) {
        memcpy(all + n, x[i].ms, x[i].n * sizeof *all);
        n += x[i].n;
        failed += x[i].failed;
    }
    qsort(all, n, sizeof *all, by_value);
    printf("%.0f %.3f %.3f %zu\n", (double)n / seconds, n > 0 ? all[n / 2] : 0,
           n > 0 ? all[n * 99 / 100] : 0, failed);
}

int main(int argc, char **argv)
{
    static struct thread x[THREADS_MAX];
    struct store_key key = {.make = CRYPT_FILE};
    struct errinfo e = {0};
    double seconds, begin;
    int first, threads;

    if (argc != 9)
        return 64;
    key.path = argv[2];
    key.anchor = strcmp(argv[3], "none") != 0 ? argv[3] : NULL;
    secret = argv[4];
    first = atoi(argv[5]);
    threads = atoi(argv[6]);
    seconds = atof(argv[7]);
    work_ms = atof(argv[8]);
    if (threads < 1 || threads > THREADS_MAX ||
        store_open(argv[1], STORE_WRITE, &key, &store, &e) != ST_OK ||
        store_verify(store, NULL, NULL, &e) != ST_OK) {
        (void)fprintf(stderr, "store_load: %s\n", e.msg);
        return 1;
    }
    begin = now_ms();
    until_ms = begin + 1e3 * seconds;
    for (int i = 0; i < threads; i++) {
        (void)snprintf(x[i].subject, sizeof x[i].subject, "s%d", first + i);
        x[i].ms = calloc(TIMES_MAX, sizeof *x[i].ms);
        (void)pthread_create(&x[i].id, NULL, run, &x[i]);
    }
    for (int i = 0; i < threads; i++)
        (void)pthread_join(x[i].id, NULL);
    print(x, threads, (now_ms() - begin) / 1e3);
    store_close(store);
    return 0;
}
