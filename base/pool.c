#include "pool.h"

#include <math.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <unistd.h>

#include "command.h"
#include "errinfo.h"
#include "libsurface.h"

#define THREADS 64

struct pool {
    const char *what;
    const struct surface_model *model;
    pool_item *item;
    void *arg;
    size_t n;
    bool terminal;
    double start_ms;

    pthread_mutex_t lock;
    size_t next, done;
    unsigned percent; /* percentage that was shown last */
    enum status st;
    struct errinfo e;
};

/* "3 min left", by what is done; 16 characters. */
static void time_left(const struct pool *p, char out[17])
{
    const double spent = (command_clock_ms() - p->start_ms) / 1e3;
    const double left = spent / (double)p->done * (double)(p->n - p->done);

    if (p->done == p->n || spent < 2)
        (void)snprintf(out, 17, "%16s", "");
    else if (left < 90)
        (void)snprintf(out, 17, "  %4.0f s left   ", left);
    else if (left < 90 * 60)
        (void)snprintf(out, 17, "  %4.0f min left ", left / 60);
    else
        (void)snprintf(out, 17, "  %4.0f h left   ", fmin(left / 3600, 9999));
}

static void pool_show(struct pool *p)
{
    static const char full[] = "##################################################";
    const unsigned percent = (unsigned)(100 * p->done / p->n);
    const int bar = (int)percent / 2;
    char left[17];

    if (!p->terminal || percent == p->percent)
        return;
    p->percent = percent;
    time_left(p, left);
    (void)fprintf(stderr, "\r%-12s [%.*s%*s] %3u %%%s%s", p->what, bar, full, 50 - bar,
                  "", percent, left, p->done == p->n ? "\n" : "");
}

static void *work(void *arg)
{
    struct pool *p = arg;
    struct surface_work *w = surface_work_new(p->model);
    struct errinfo e = {.code = ST_ENOMEM, .msg = "out of memory"};
    enum status st = w != NULL ? ST_OK : ST_ENOMEM;

    (void)pthread_mutex_lock(&p->lock);
    while (st == ST_OK && p->st == ST_OK && p->next < p->n) {
        const size_t i = p->next++;

        (void)pthread_mutex_unlock(&p->lock);
        st = p->item(p->arg, i, w, &e);
        (void)pthread_mutex_lock(&p->lock);
        p->done++;
        pool_show(p);
    }
    if (st != ST_OK && p->st == ST_OK) {
        p->st = st;
        p->e = e;
    }
    (void)pthread_mutex_unlock(&p->lock);
    surface_work_free(w);
    return NULL;
}

uint32_t pool_threads(uint32_t wanted)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);

    if (wanted == 0)
        wanted = cores > 0 ? (uint32_t)cores : 1;
    return wanted < THREADS ? wanted : THREADS;
}

enum status pool_run(const char *what, uint32_t threads, const struct surface_model *m,
                     size_t n, pool_item *item, void *arg, struct errinfo *e)
{
    struct pool p = {.what = what, .model = m, .item = item, .arg = arg, .n = n};
    const uint32_t wanted = pool_threads(threads);
    pthread_t thread[THREADS];
    uint32_t started = 1; /* the caller is one of them */

    p.terminal = isatty(STDERR_FILENO) == 1;
    p.start_ms = command_clock_ms();
    (void)pthread_mutex_init(&p.lock, NULL);
    while (started < wanted && pthread_create(&thread[started], NULL, work, &p) == 0)
        started++; /* if a thread cannot be made, fewer work */
    (void)work(&p);
    for (uint32_t i = 1; i < started; i++)
        (void)pthread_join(thread[i], NULL);
    (void)pthread_mutex_destroy(&p.lock);
    if (p.st != ST_OK && p.terminal)
        (void)fputc('\n', stderr);
    return p.st == ST_OK ? ST_OK : errinfo_set(e, p.st, "%s", p.e.msg);
}
