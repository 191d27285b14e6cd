/* request.h -- one HTTP request and its response, without the I/O (http.h).
 * http.c creates and frees it.  It belongs to the I/O thread, except between its queueing (queue.h) and the
 * end of its worker's job: never to two threads at once. */
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

struct app;
struct errinfo;
struct events_stream; /* events.h */
struct route;         /* route.h */

#define REQUEST_ID_MAX    64
#define REQUEST_TOKEN_MAX 128

/* The ids that ident_subject_valid() accepts, for the detail of a problem. */
#define REQUEST_SUBJECT_ID                                                               \
    "a subject id is 1 to 128 characters of A-Z a-z 0-9 . _ - @ :, and not . or .."

enum request_method {
    REQUEST_GET,
    REQUEST_POST,
    REQUEST_PATCH,
    REQUEST_DELETE,
    REQUEST_OPTIONS, /* allowed for every path; no route has it */
    REQUEST_OTHER
};

enum request_media { /* kind of the body, by its Content-Type */
                     REQUEST_NO_MEDIA,
                     REQUEST_JSON,
                     REQUEST_MERGE, /* a JSON merge patch (RFC 7396) */
                     REQUEST_FORM,  /* multipart/form-data */
                     REQUEST_SCAN,  /* a scanner's file, or bytes that may be one */
                     REQUEST_OTHER_MEDIA
};

enum request_stage {                  /* stages of a request, to measure their time */
                     REQUEST_QUEUE,   /* waiting for a worker */
                     REQUEST_PARSE,   /* reading points from the body */
                     REQUEST_PREPARE, /* building face models */
                     REQUEST_SCORE,   /* comparison with all templates */
                     REQUEST_ALIGN,   /* alignment for the minimal disparity */
                     REQUEST_MINIMAL, /* minimal disparity, or asymmetry */
                     REQUEST_STAGES
};

struct response {
    int http;         /* status code; 0: no response yet */
    unsigned problem; /* kind of problem (errmap.h); 0: no problem */
    char *body;       /* body on the heap, or NULL */
    const void *page; /* static body, instead of body; or NULL */
    FILE *file;       /* file as body, instead of both, sent whole and closed; or NULL */
    size_t len;       /* bytes of the body; 0: no body */
    struct events_stream *stream; /* instead of all these, an endless body; or NULL */
    const char *type;             /* Content-Type; static */
    char location[192];           /* Location; "": none */
    char allow[40];               /* Allow; "": none */
    const char *name; /* Content-Disposition: name of the file to save; static; or NULL */
    /* Access-Control-Allow-Origin; "": the origin is not allowed; NULL: cors.h is off. */
    const char *origin;
    bool preflight;       /* with origin: also send the allowed methods and headers */
    const char *policy;   /* Content-Security-Policy; static; or NULL */
    const char *etag;     /* ETag of a body that clients may cache; static; or NULL */
    bool gzip;            /* Content-Encoding of page: gzip */
    bool challenge;       /* WWW-Authenticate is sent */
    bool bad_token;       /* with challenge: the token was refused, not missing */
    unsigned lacks;       /* with challenge: the scope that the token lacks; 0: none */
    bool codings;         /* Accept-Encoding is sent: the codings allowed for a body */
    bool minimal;         /* Preference-Applied: return=minimal is sent */
    unsigned retry_after; /* Retry-After, s, at least; 0: none */
};

#define REQUEST_CAPTURE_MAX  320 /* bytes; the longest valid header has some 250 */
#define REQUEST_CAPTURED_MAX 48

struct request_capture {                  /* a signed capture: capture.h */
    char header[REQUEST_CAPTURE_MAX + 1]; /* Capture-Signature; "": none */
    bool bad;                             /* the header is too long, or given twice */
    /* Values of Content-Type and Content-Encoding, borrowed from the connection; NULL: none. */
    const char *type, *coding;
    unsigned char body[32];              /* SHA-256 of the body as sent; see digested */
    bool digested;                       /* body is set */
    char captured[REQUEST_CAPTURED_MAX]; /* text for the audit log; "": no capture */
};

struct request_result { /* result for recent.h; static texts */
    const char *kind;   /* "verify", "enroll"; NULL: not listed */
    const char *outcome;
    bool scored;
    double score, threshold, overlap;
};

struct request {
    struct app *app;
    char *target; /* as sent: path[?query], still percent-encoded */
    enum request_method method;
    const struct route *route;           /* NULL until it is known */
    char subject[STORE_SUBJECT_MAX + 1]; /* subject in the path, decoded; "": none */
    char template_id[STORE_ID_LEN + 1];  /* template in the path; "": none */
    char token_id[STORE_ID_LEN + 1];     /* token in the path; "": none */
    char id[REQUEST_ID_MAX + 1];         /* X-Request-Id, of the client or new */
    char client[ADDRESS_HOST_MAX]; /* client's address, for the log (address_host()) */
    uint64_t address;              /* client's address, for the limits (address_key()) */
    char token[REQUEST_TOKEN_MAX + 1]; /* Bearer token; wiped after its check */
    char actor[STORE_ID_LEN + 1];      /* id of the token; "": no token */
    unsigned scopes;                   /* scopes of the token; 0: no token */
    int64_t token_revision;            /* of store_token_check() */
    char groups[GROUPS_SIZE]; /* groups that the token is bound to; "": it is not bound */
    /* Name of the token; its expiry, "": never.  "" without a token. */
    char token_name[STORE_NAME_MAX + 1], token_expires[32];
    bool minimal, has_return; /* Prefer: return=minimal; return= with any value */
    bool gzip;                /* Accept-Encoding has gzip */
    bool streams;             /* Accept has text/event-stream */
    char *last_event;         /* Last-Event-ID; NULL: none */
    char origin[256];         /* Origin; "": none; "?": too long */
    char host[256];           /* Host; "": none; "?": too long */
    bool cross_site;          /* Sec-Fetch-Site: cross-site */
    bool preflight;           /* Access-Control-Request-Method is given */
    char none_match[256];     /* If-None-Match; "": none, or too long */
    struct request_capture capture;
    enum request_media media;
    enum cloudformat format; /* format, for REQUEST_JSON and REQUEST_SCAN */
    char boundary[MULTIPART_BOUNDARY_MAX + 1]; /* boundary, for REQUEST_FORM; "": none */
    enum inflate_coding coding;                /* present coding of body */
    unsigned char *body;                       /* body on the heap; body[len] is 0 */
    size_t len;                                /* bytes of body */
    bool large; /* place in the queue for bodies that become larger than QUOTA_SMALL */
    atomic_bool gone; /* the client has disconnected: its work may be cancelled */
    double start_ms;  /* logger_clock_ms() at the request line */
    double stage_ms[REQUEST_STAGES]; /* time of each stage, ms */
    unsigned stages;                 /* a bit for each stage that was entered */
    struct response response;
    struct events_stream *waits; /* response comes later, by events_wait(); or NULL */
    enum status failed;          /* the status given to request_fail(); ST_OK: none */
    struct request_result result;
    char told[512];  /* detail of the problem; "": no problem */
    char fault[512]; /* cause of a 5xx, for the log; "": none */
};

/* request_method(name): Returns the method with this name.  GET and HEAD are REQUEST_GET. */
enum request_method request_method(const char *name);

/* request_media(type, format): Returns the kind of a Content-Type, and sets *format to its format, or to
 * CLOUDFORMAT_ANY if it names none.  Ignores parameters.
 *   type  NULL: REQUEST_NO_MEDIA */
enum request_media request_media(const char *type, enum cloudformat *format);

/* request_set_id(r, given, serial): Sets the id of r to given if that has 1 to 64 safe characters.  Otherwise it
 * makes an id from the serial and a random number of the process. */
void request_set_id(struct request *r, const char *given, unsigned long serial);

/* request_decode(s, len, plus, out, size): Decodes percent-encoding; with plus, "+" is a space.
 * Returns ST_OK; ST_EINVAL: a bad encoding, or an encoded NUL; ST_ELIMIT: longer than size. */
enum status request_decode(const char *s, size_t len, bool plus, char *out, size_t size);

/* request_query(r, name, out, size): Decodes the value of the first query parameter with this name.
 * Returns ST_OK; ST_ENOTFOUND: there is none (out is ""); ST_EINVAL, ST_ELIMIT: as request_decode(). */
enum status request_query(const struct request *r, const char *name, char *out,
                          size_t size);

/* request_sender(r): Returns a number for the sender, which has one scheduling share in the queue: the token, or
 * the address while no token is known. */
uint64_t request_sender(const struct request *r);

/* request_stage(r, stage, ms): Adds ms to the time of a stage. */
void request_stage(struct request *r, enum request_stage stage, double ms);

/* request_stage_name(stage): Returns "queue", "parse", ... */
const char *request_stage_name(enum request_stage stage);

/* ---- responses: each function sets r->response, and replaces an earlier one */

/* request_respond(r, http, json): Responds with JSON.
 *   json  heap text, takes ownership; NULL: out of memory, which becomes the response */
void request_respond(struct request *r, int http, char *json);

/* request_written(r, http, json): Like request_respond(), for a request that changes data: if the client prefers
 * a minimal response, it has no body, and 204 replaces 200. */
void request_written(struct request *r, int http, char *json);

/* request_template(r, id): Sets Location to this template. */
void request_template(struct request *r, const char *id);

/* request_text(r, type, text): Responds 200 with text.
 *   type  static
 *   text  as json in request_respond() */
void request_text(struct request *r, const char *type, char *text);

/* request_bytes(r, type, bytes, len): Responds 200 with bytes.
 *   bytes  by mem_array() or malloc(), takes ownership; NULL: as in request_respond() */
void request_bytes(struct request *r, const char *type, unsigned char *bytes, size_t len);

/* request_page(r, type, text, len): Responds 200 with static bytes. */
void request_page(struct request *r, const char *type, const void *text, size_t len);

/* request_file(r, type, file, len, name): Responds 200 with the content of a file; takes ownership of file. */
void request_file(struct request *r, const char *type, FILE *file, size_t len,
                  const char *name);

/* request_stream(r, stream): Responds 200 with a stream of events, which http.c closes. */
void request_stream(struct request *r, struct events_stream *stream);

/* request_not_modified(r): Responds 304, without a body. */
void request_not_modified(struct request *r);

/* request_problem(r, kind, fmt, ...): Responds with a problem document of this kind (errmap.h).  The formatted
 * detail of a 5xx goes only to the log; the client gets a general phrase. */
__attribute__((format(printf, 3, 4))) void
request_problem(struct request *r, unsigned kind, const char *fmt, ...);

/* request_refuse(r, kind, json): Responds with a finished problem document.
 *   json  heap text, takes ownership; NULL: only the status code is sent */
void request_refuse(struct request *r, unsigned kind, char *json);

/* request_fail(r, e): Responds with the problem of e, and sets r->failed, for the metrics. */
void request_fail(struct request *r, const struct errinfo *e);

/* request_gone(r): Returns true if the client has disconnected; r->response then states it for the log. */
bool request_gone(struct request *r);

/* request_free(r): Releases the members of *r, not *r itself. */
void request_free(struct request *r);

#endif
