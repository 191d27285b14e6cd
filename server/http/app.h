/* app.h -- what the parts of the daemon share.  Made by main.c before the first request and
 * released after the last; nothing but the atomic members and anchor_behind changes in between. */
#ifndef SERVER_APP_H
#define SERVER_APP_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include "store_attempts.h"

struct cache;         /* cache.h */
struct erasures;      /* erasures.h */
struct guard;         /* guard.h */
struct metrics;       /* metrics.h */
struct surface_model; /* libsurface.h */
struct queue;         /* queue.h */
struct quota;         /* quota.h */
struct recent;        /* recent.h */
struct route;         /* route.h */
struct store;         /* store.h */
struct throttle;      /* throttle.h */
struct tls;           /* tls.h */
struct upkeep;        /* upkeep.h */

struct app {
    struct store *store;         /* its calibration and engine are by the model */
    struct surface_model *model; /* NULL: the shipped one */
    struct cache *cache;
    struct metrics *metrics;
    struct store_limits limits; /* of failed verifications */
    const char *db;             /* the database's file, */
    size_t disk_reserve;        /* and bytes that must be free on its disk to add more */
    struct throttle *throttle;
    struct queue *queue;
    struct queue *slow; /* of one worker: what walks along everything, one at a time */
    atomic_flag slow_taken;
    struct upkeep *upkeep;
    struct erasures *erasures;
    struct recent *recent;
    struct guard *guard;        /* of the connections; http.c's */
    struct quota *quota;        /* of bodies and responses; http.c's, for its thread */
    struct tls *tls;            /* http.c's; NULL: no TLS */
    const struct route *routes; /* [nroutes] */
    size_t nroutes;
    bool no_auth;
    bool no_console;
    const char
        *cors_origin;     /* whose pages may read responses, with commas; NULL: none's */
    bool signed_captures; /* nothing else is taken (capture.h) */
    size_t max_body;      /* bytes */
    atomic_bool stopping;
    atomic_flag refusal_told;
    bool
        anchor_behind; /* the log's last word on the anchor; refusal_tell() alone uses it */
};

#endif
