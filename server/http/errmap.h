/* errmap.h -- the one place that maps an outcome to an HTTP status code, the stable machine word `code` and the
 * title of its problem document (RFC 9457). */
#ifndef SERVER_ERRMAP_H
#define SERVER_ERRMAP_H
#include "status.h"

struct json; /* json.h */

/* Outcomes that only HTTP knows, numbered after those of status.h. */
enum errmap_kind {
    ERRMAP_ROUTE = ST_COUNT, /* no such path */
    ERRMAP_METHOD,           /* the path has no such method */
    ERRMAP_TARGET,           /* the path and query are too long */
    ERRMAP_HEADERS,          /* the headers are too large */
    ERRMAP_VERSION,          /* not HTTP/1.0 or 1.1 */
    ERRMAP_TRANSFER,         /* a transfer coding other than chunked */
    ERRMAP_NO_LENGTH,    /* neither Content-Length nor chunks where a body is needed */
    ERRMAP_MEDIA_TYPE,   /* a body of another kind is needed */
    ERRMAP_CODING,       /* a body compressed otherwise, or not at all, is needed */
    ERRMAP_PACKED,       /* the body cannot be unpacked */
    ERRMAP_NO_TOKEN,     /* no token, or an invalid one */
    ERRMAP_SCOPE,        /* the token lacks the scope */
    ERRMAP_OTHER_SITE,   /* --no-auth, and a page of another site */
    ERRMAP_DISABLED,     /* the subject is disabled */
    ERRMAP_EXPIRED,      /* the subject has expired */
    ERRMAP_TOKENS,       /* the address is rate-limited for wrong tokens */
    ERRMAP_ATTEMPTS,     /* the subject is locked out */
    ERRMAP_SUBJECTS,     /* the token has tried too many subjects in vain */
    ERRMAP_SEARCHES,     /* the token has searched too often without a match */
    ERRMAP_GALLERY,      /* there is no gallery to be searched, or not yet */
    ERRMAP_TWIN,         /* unique=true, and the face is another subject's */
    ERRMAP_STORAGE_FULL, /* too little room on the disk for enrolments */
    /* The capture's signature (capture.h), in this order: */
    ERRMAP_CAPTURE_REQUIRED, /* there is none */
    ERRMAP_CAPTURE_INVALID,  /* malformed, of an unknown device, or wrong */
    ERRMAP_CAPTURE_STALE,    /* its nonce has expired */
    ERRMAP_CAPTURE_REPLAYED, /* its nonce was used */
    ERRMAP_LIVENESS,         /* the scanner's liveness check has failed */
    ERRMAP_PARAMETER,        /* a path or query parameter is malformed */
    ERRMAP_OVERLOAD,         /* the queue is full, or the daemon is stopping */
    ERRMAP_STREAMS,          /* too many streams of events are open */
    ERRMAP_CURSOR,           /* a cursor of another database, or of a later state */
    ERRMAP_NOT_READY,        /* /readyz: the daemon cannot work now */
    ERRMAP_OWN_TOKEN,        /* a token is to revoke itself */
    ERRMAP_REVOKED,          /* a token that was revoked is to have a secret */
    ERRMAP_COUNT
};

struct errmap {
    int http;
    const char *code;
    const char *title;
};

/* errmap_get(kind): Returns the entry of an enum status or an enum errmap_kind; for ST_OK and any other value,
 * that of ST_EINTERNAL.  Never NULL. */
const struct errmap *errmap_get(unsigned kind);

/* errmap_problem(m, detail, request_id): Returns the problem document, open for further members (json.h). */
struct json *errmap_problem(const struct errmap *m, const char *detail,
                            const char *request_id);

#endif
