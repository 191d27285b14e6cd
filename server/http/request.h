/* request.h -- one HTTP request and its response, without the I/O (http.h).
 * Made and released by http.c.  It belongs to the I/O thread, except from when it is
 * queued (queue.h) until its worker is done: never to two threads at once. */
#ifndef SERVER_REQUEST_H
#define SERVER_REQUEST_H
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include "address.h"
#include "cloudformat.h"
#include "inflate.h"
#include "multipart.h"
#include "status.h"
#include "store.h"
#include "throttle.h"

struct app;
struct errinfo;
struct route; /* route.h */

#define REQUEST_ID_MAX    64
#define REQUEST_TOKEN_MAX 128

/* What ident_subject_valid() takes, for a problem's detail. */
#define REQUEST_SUBJECT_ID                                                               \
    "a subject id is 1 to 128 characters of A-Z a-z 0-9 . _ - @ :, and not . or .."

enum request_method {
    REQUEST_GET,
    REQUEST_POST,
    REQUEST_PATCH,
    REQUEST_DELETE,
    REQUEST_OPTIONS, /* of any path; no route has it */
    REQUEST_OTHER
};

enum request_media { /* of the body, by its Content-Type */
                     REQUEST_NO_MEDIA,
                     REQUEST_JSON,
                     REQUEST_MERGE, /* a JSON merge patch (RFC 7396) */
                     REQUEST_FORM,  /* multipart/form-data */
                     REQUEST_SCAN,  /* a scanner's file, or bytes that may be one */
                     REQUEST_OTHER_MEDIA
};

enum request_stage {                  /* what the time of a request is spent on */
                     REQUEST_QUEUE,   /* waiting for a worker */
                     REQUEST_PARSE,   /* the body to points */
                     REQUEST_PREPARE, /* points to face models */
                     REQUEST_SCORE,   /* over all templates */
                     REQUEST_ALIGN,   /* for the minimal disparity */
                     REQUEST_MINIMAL, /* the minimal disparity, or the asymmetry */
                     REQUEST_STAGES
};

struct response {
    int http;         /* 0: none yet */
    unsigned problem; /* errmap.h; 0: it is none */
    char *body;       /* heap, or NULL */
    const void *page; /* static, in the place of body; NULL for none */
    FILE *file;       /* instead of both: read from its beginning, and closed; or NULL */
    size_t len;       /* of any; 0 for none */
    const char *type; /* static */
    char location[192]; /* "" for none */
    char allow[40];     /* "" for none */
    const char
        *name; /* Content-Disposition: of the file to save; static; NULL for none */
    const char
        *origin; /* whose page may read it; "": none's that asked; NULL: cors.h is off */
    bool preflight;       /* with it: what may be asked for */
    const char *policy;   /* Content-Security-Policy; static; NULL for none */
    const char *etag;     /* of what a client may keep and ask for again; static; NULL */
    bool gzip;            /* Content-Encoding of the page */
    bool challenge;       /* WWW-Authenticate */
    bool bad_token;       /* with it: the token was refused, not missing */
    unsigned lacks;       /* with it: the scope that the token has not; 0 for none */
    bool codings;         /* Accept-Encoding: what a body may be compressed with */
    bool minimal;         /* Preference-Applied: return=minimal */
    unsigned retry_after; /* seconds, at least; 0 for none */
};

#define REQUEST_CAPTURE_MAX  320 /* bytes; the longest that can be right has some 250 */
#define REQUEST_CAPTURED_MAX 48

struct request_capture {                  /* what the scanner has signed: capture.h */
    char header[REQUEST_CAPTURE_MAX + 1]; /* Capture-Signature; "" for none */
    bool bad;                             /* too long, or there twice */
    /* the values of Content-Type and Content-Encoding, which the connection has; NULL for none */
    const char *type, *coding;
    unsigned char body[32];              /* SHA-256 of the body as it was sent, */
    bool digested;                       /* where that is known */
    char captured[REQUEST_CAPTURED_MAX]; /* for the audit log; "" without a capture */
};

struct request_result { /* for recent.h; static texts */
    const char *kind;   /* "verify", "enroll"; NULL: it is not noted */
    const char *outcome;
    bool scored;
    double score, threshold, overlap;
};

struct request {
    struct app *app;
    char *target; /* as sent: path[?query], still percent-encoded */
    enum request_method method;
    const struct route *route;           /* NULL until it is known */
    char subject[STORE_SUBJECT_MAX + 1]; /* of the path, decoded; "" for none */
    char template_id[STORE_ID_LEN + 1];  /* of the path; "" for none */
    char token_id[STORE_ID_LEN + 1];     /* likewise */
    char id[REQUEST_ID_MAX + 1];         /* X-Request-Id, taken or made */
    char client[ADDRESS_HOST_MAX];       /* its address, for the log (address_host()) */
    unsigned char address[THROTTLE_ADDRESS];
    char token[REQUEST_TOKEN_MAX + 1]; /* wiped once it is checked */
    char actor[STORE_ID_LEN + 1];      /* the token's id; "" without one */
    unsigned scopes;                   /* the token's; 0 without one */
    char token_name[STORE_NAME_MAX + 1], token_expires[32]; /* likewise; "": never */
    bool minimal, has_return; /* Prefer: return=minimal; return=anything */
    bool gzip;                /* Accept-Encoding has it */
    char origin[256];         /* Origin; "" for none, "?" for a longer one */
    char host[256];           /* Host; likewise */
    bool cross_site;          /* Sec-Fetch-Site: cross-site */
    bool preflight;           /* Access-Control-Request-Method is there */
    char none_match[256];     /* If-None-Match; "" for none, or a longer one */
    struct request_capture capture;
    enum request_media media;
    enum cloudformat format;                   /* of REQUEST_JSON and REQUEST_SCAN */
    char boundary[MULTIPART_BOUNDARY_MAX + 1]; /* of REQUEST_FORM; "": it has none */
    enum inflate_coding coding;                /* of the body as it is now */
    unsigned char *body;                       /* heap; body[len] is 0 */
    size_t len;
    bool
        large; /* its place in the queue is for bodies that become more than QUOTA_SMALL */
    atomic_bool gone; /* the client has gone: what is done for it may be given up */
    double start_ms;  /* logger_clock_ms() at the request line */
    double stage_ms[REQUEST_STAGES];
    unsigned stages; /* a bit for each that it has been through */
    struct response response;
    enum status failed; /* the status given to request_fail(); ST_OK: none */
    struct request_result result;
    char told[512];  /* the detail of a problem; "" without one */
    char fault[512]; /* for the log: what is behind a 5xx; "" for nothing */
};

/* request_method(name): GET and HEAD are REQUEST_GET. */
enum request_method request_method(const char *name);

/* request_media(type, format): Content-Type's value, parameters ignored; NULL:
 * REQUEST_NO_MEDIA.  *format: CLOUDFORMAT_ANY where it says none. */
enum request_media request_media(const char *type, enum cloudformat *format);

/* request_set_id(r, given, serial): given if it is 1..64 safe characters, else a new one
 * made of a number drawn once a process and the serial. */
void request_set_id(struct request *r, const char *given, unsigned long serial);

/* request_decode(s, len, plus, out, size): undo percent-encoding ("+" is a space if plus).
 * Returns ST_OK; ST_EINVAL: bad encoding, an encoded NUL; ST_ELIMIT: does not fit. */
enum status request_decode(const char *s, size_t len, bool plus, char *out, size_t size);

/* request_query(r, name, out, size): the decoded value of the first parameter of that name.
 * Returns ST_OK; ST_ENOTFOUND: there is none (out is ""); ST_EINVAL, ST_ELIMIT. */
enum status request_query(const struct request *r, const char *name, char *out,
                          size_t size);

/* request_sender(r): the same number for those who take turns in the queue: a token, or an
 * address as long as none is known. */
uint64_t request_sender(const struct request *r);

/* request_stage(r, stage, ms): ms more were spent on it. */
void request_stage(struct request *r, enum request_stage stage, double ms);

/* request_stage_name(stage): "queue", "parse", ... */
const char *request_stage_name(enum request_stage stage);

/* Kinds of response; each sets r->response and replaces one that was set before. */

/* request_respond(r, http, json): json: heap text, taken; NULL: out of memory, which
 * becomes the response. */
void request_respond(struct request *r, int http, char *json);

/* request_written(r, http, json): as request_respond(), for a request that changes something:
 * where the client prefers so, without the body, 204 in the place of 200. */
void request_written(struct request *r, int http, char *json);

/* request_template(r, id): the response is about this template: its Location. */
void request_template(struct request *r, const char *id);

/* request_text(r, type, text): 200 with heap text, taken; NULL as above.  type: static. */
void request_text(struct request *r, const char *type, char *text);

/* request_bytes(r, type, bytes, len): the same with bytes, by mem_array(), malloc() or NULL. */
void request_bytes(struct request *r, const char *type, unsigned char *bytes, size_t len);

/* request_page(r, type, text, len): the same with static bytes. */
void request_page(struct request *r, const char *type, const void *text, size_t len);

/* request_file(r, type, file, len, name): the same from a file, taken. */
void request_file(struct request *r, const char *type, FILE *file, size_t len,
                  const char *name);

/* request_not_modified(r): 304, without a body. */
void request_not_modified(struct request *r);

/* request_problem(r, kind, fmt, ...): problem+json; kind as in errmap.h.  For a 5xx the
 * formatted detail goes to the log alone, and the client gets a general phrase. */
__attribute__((format(printf, 3, 4))) void
request_problem(struct request *r, unsigned kind, const char *fmt, ...);

/* request_refuse(r, kind, json): problem+json that is written already: heap text, taken; NULL: the
 * status code alone. */
void request_refuse(struct request *r, unsigned kind, char *json);

/* request_fail(r, e): the problem of e; r->failed, for the metrics. */
void request_fail(struct request *r, const struct errinfo *e);

/* request_gone(r): the client has gone, and r->response says so to the log. */
bool request_gone(struct request *r);

/* request_free(r): what r points to. */
void request_free(struct request *r);

#endif
