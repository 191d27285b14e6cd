/* status.h -- the outcome of every call that can fail.
 * ST_OK is 0; the statuses of the library have the library's numbers.  core returns a status and nothing
 * else: it prints nothing and never exits.  The other directories add text (base/errinfo.h).  HTTP codes
 * exist only in server/http/errmap.c. */
#ifndef CORE_STATUS_H
#define CORE_STATUS_H
#include "surface_basic.h"

enum status {
    ST_OK = SURFACE_OK,
    ST_EINVAL = SURFACE_EINVAL, /* an argument or a field is malformed */
    ST_ENOMEM = SURFACE_ENOMEM, /* memory ran out; nothing was changed */
    ST_ESIZE,                   /* more bytes than the stated limit */
    /* From here to ST_EQUALITY: what can be wrong with the points of a scan. */
    ST_ELIMIT =
        SURFACE_ELIMIT, /* more than the stated limit of something else (points, depth) */
    ST_ETOOFEW = SURFACE_ETOOFEW,         /* fewer than the points needed */
    ST_ENOTFINITE = SURFACE_ENOTFINITE,   /* a coordinate is NaN or infinite */
    ST_ERANGE = SURFACE_ERANGE,           /* a coordinate lies off the lattice */
    ST_EDEGENERATE = SURFACE_EDEGENERATE, /* all points on one line, or no area */
    ST_EUNITS = SURFACE_EUNITS,     /* the extent is not that of a face in millimetres */
    ST_ENOFACE = SURFACE_ENOFACE,   /* no face was found */
    ST_ESEVERAL = SURFACE_ESEVERAL, /* more than one face */
    ST_EMIRRORED = SURFACE_EMIRRORED, /* a mirror image */
    ST_ENOTFACE = SURFACE_ENOTFACE,   /* the surface is not a face (quality gate) */
    ST_EQUALITY = SURFACE_EQUALITY,   /* a face, but too poor a scan (quality gate) */
    ST_ECORRUPT = SURFACE_ECORRUPT,   /* stored or internal data contradicts itself */
    ST_EVERSION = SURFACE_EVERSION,   /* data of another, unsupported format or version */
    ST_ENOTFOUND,                     /* no such subject, template or token */
    ST_EEXISTS,                       /* it is already there */
    ST_EMISMATCH,                     /* a sample does not fit the subject's others */
    ST_EREPLAYED,                     /* a scan that was used before */
    ST_EDENIED,                       /* no permission */
    ST_EREFUSED, /* not the database that it should be: replaced, older, another key */
    ST_EHELD,    /* a subject on hold is not erased */
    ST_EFULL,    /* a subject has as many templates as it may have */
    ST_EBUSY = SURFACE_ESTOPPED,      /* try again later */
    ST_EIO,                           /* reading or writing failed */
    ST_EDB,                           /* the database failed */
    ST_EINTERNAL = SURFACE_EINTERNAL, /* a defect of this program */
    ST_EUNSYNCED, /* done, but perhaps not on the disk: a loss of power may undo it */
    ST_EPEOPLE = SURFACE_EPEOPLE, /* frames of more than one person */
    ST_EAPART = SURFACE_EAPART,   /* a frame that does not lie on the others */
    ST_ETOKEN,   /* the token was revoked, or has expired, since the request began */
    ST_ECHANGED, /* it was changed since it was read */
    ST_COUNT     /* number of codes; not a code */
};

/* status_from(st): Returns a status of the library as the program's. */
static inline enum status status_from(enum surface_status st)
{
    return (enum status)st;
}

/* status_to(st): Returns a status of core as the library's. */
static inline enum surface_status status_to(enum status st)
{
    return (enum surface_status)st;
}

/* status_message(st): Returns a short English phrase for st, never NULL; "unknown status" for another
 * value. */
const char *status_message(enum status st);

/* status_refusal(st): Returns the API's code of a refused scan ("not_a_face"); "malformed" for a status
 * that is not about the points, NULL for ST_OK. */
const char *status_refusal(enum status st);

#endif
