/* app.h -- the objects and settings that the parts of the daemon share.  main.c creates them before the first
 * request and releases them after the last one.  Only the atomic members and anchor_behind change in between. */
#ifndef SERVER_APP_H
#define SERVER_APP_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include "store_attempts.h"

struct events;        /* events.h */
struct gallery;       /* gallery.h */
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
    struct store *store;         /* with the calibration and engine of the model */
    struct surface_model *model; /* NULL: the shipped one */
    struct metrics *metrics;
    struct store_limits limits; /* limits of failed verifications */
    const char *db;             /* file of the database */
    size_t disk_reserve;        /* bytes that must be free on the disk of db to enrol */
    struct throttle *throttle;  /* of wrong tokens */
    struct throttle *searches;  /* of identifications without a match */
    struct throttle *refusals;  /* of entries of refused requests */
    struct gallery *gallery;    /* NULL: this daemon does not identify */
    struct queue *queue;
    struct queue *slow;     /* queue of routes with ROUTE_SLOW, with one worker */
    atomic_flag slow_taken; /* a request of slow waits or runs */
    struct upkeep *upkeep;
    struct recent *recent;
    struct events *events;
    struct guard *guard;        /* owned by http.c */
    struct quota *quota;        /* owned by http.c; on the I/O thread only */
    struct tls *tls;            /* owned by http.c; NULL: no TLS */
    const struct route *routes; /* [nroutes] */
    size_t nroutes;
    bool no_auth;
    bool no_console;
    const char *
        cors_origin; /* origins whose pages may read responses, with commas; NULL: none */
    bool signed_captures; /* a scan without a signature is refused (capture.h) */
    size_t max_body;      /* limit of a body, bytes */
    atomic_bool stopping;
    atomic_flag refusal_told;
    bool
        anchor_behind; /* the last line about the anchor was a warning; for refusal_tell() only */
};

#endif
