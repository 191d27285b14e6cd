#include "intake.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>

#include "app.h"
#include "errmap.h"
#include "logger.h"
#include "request.h"

#define TOKENS  1024
#define HOUR_MS 3600e3
#define FULL_S  60 /* Retry-After where the disk is full: somebody must make room */

/* A bucket with a hole: each template adds 1, and as many leave an hour as there may be. */
struct bucket {
    char token[STORE_ID_LEN + 1];
    double level, at_ms;
};

struct intake {
    pthread_mutex_t lock;
    double per_hour;
    const char *db;
    size_t reserve;
    struct bucket of[TOKENS];
};

struct intake *intake_new(unsigned per_hour, const char *db, size_t reserve)
{
    struct intake *x = calloc(1, sizeof *x);

    if (x == NULL || pthread_mutex_init(&x->lock, NULL) != 0) {
        free(x);
        return NULL;
    }
    x->per_hour = per_hour;
    x->db = db;
    x->reserve = reserve;
    return x;
}

void intake_free(struct intake *x)
{
    if (x == NULL)
        return;
    (void)pthread_mutex_destroy(&x->lock);
    free(x);
}

/* What has not leaked out by now. */
static double level(const struct intake *x, const struct bucket *b, double now_ms)
{
    return fmax(0, b->level - (now_ms - b->at_ms) * x->per_hour / HOUR_MS);
}

/* NULL: it has none. */
static struct bucket *find(struct intake *x, const char *token)
{
    for (size_t i = 0; i < TOKENS; i++)
        if (x->of[i].level > 0 && strcmp(x->of[i].token, token) == 0)
            return &x->of[i];
    return NULL;
}

static struct bucket *emptiest(struct intake *x, double now_ms)
{
    struct bucket *b = x->of;

    for (size_t i = 1; i < TOKENS; i++)
        if (level(x, &x->of[i], now_ms) < level(x, b, now_ms))
            b = &x->of[i];
    return b;
}

unsigned intake_take(struct intake *x, const char *token, unsigned n, double now_ms)
{
    struct bucket *b;
    double over;

    if (x->per_hour <= 0)
        return 0;
    (void)pthread_mutex_lock(&x->lock);
    if ((b = find(x, token)) == NULL) {
        b = emptiest(x, now_ms);
        *b = (struct bucket){.at_ms = now_ms};
        (void)snprintf(b->token, sizeof b->token, "%s", token);
    }
    over = level(x, b, now_ms) + 1 - x->per_hour;
    if (over <= 0) {
        b->level = level(x, b, now_ms) + n;
        b->at_ms = now_ms;
    }
    (void)pthread_mutex_unlock(&x->lock);
    return over > 0 ? (unsigned)ceil(over * HOUR_MS / 1000 / x->per_hour) : 0;
}

void intake_give(struct intake *x, const char *token, unsigned n)
{
    struct bucket *b;

    (void)pthread_mutex_lock(&x->lock);
    if ((b = find(x, token)) != NULL)
        b->level = fmax(0, b->level - n);
    (void)pthread_mutex_unlock(&x->lock);
}

bool intake_full(const struct intake *x, unsigned long long *left)
{
    struct statvfs fs;
    unsigned long long bytes;

    if (statvfs(x->db, &fs) != 0)
        return false; /* then the database itself will say what is wrong */
    bytes = (unsigned long long)fs.f_bavail * fs.f_frsize;
    if (left != NULL)
        *left = bytes;
    return bytes < x->reserve;
}

bool intake_admit(struct request *r, unsigned n)
{
    struct intake *x = r->app->intake;
    unsigned long long left;
    unsigned wait_s;

    if (intake_full(x, &left)) {
        request_problem(r, ERRMAP_STORAGE_FULL,
                        "%llu MB are free on the database's disk, and disk-reserve "
                        "keeps %zu MB for verifications: free some space",
                        left >> 20, x->reserve >> 20);
        r->response.retry_after = FULL_S;
        return false;
    }
    if ((wait_s = intake_take(x, r->actor, n, logger_clock_ms())) == 0)
        return true;
    request_problem(r, ERRMAP_ENROLLMENTS,
                    "this token has added %.0f templates and subjects within an hour, "
                    "which is its limit",
                    x->per_hour);
    r->response.retry_after = wait_s;
    return false;
}
