/* rows_types.h -- what the store takes and gives.  Strings are UTF-8 without NUL; times are
 * RFC 3339 text, UTC, of fixed length, so that they compare like their texts. */
#ifndef DB_ROWS_TYPES_H
#define DB_ROWS_TYPES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "crypt.h"
#include "libsurface.h"
#include "ident.h"

#define STORE_SUBJECT_MAX IDENT_SUBJECT
#define STORE_ID_LEN      IDENT_ID
/* Digests of the scans that a template was made from (digest.h): 64 digits of the first, and
 * STORE_READ_OTHER of each other. */
#define STORE_READ_OTHER 16
#define STORE_READ_MAX   (64 + (SURFACE_FRAMES_MAX - 1) * STORE_READ_OTHER)

#define STORE_LABEL_MAX 256 /* bytes of UTF-8, no control characters */
#define STORE_NAME_MAX  64  /* of a token or an actor, printable ASCII */
#define STORE_NOTE_MAX  128 /* bytes of UTF-8, no control characters */
#define STORE_UID       16

/* Of a subject, at most: each takes time of each verification, and is one more chance for a
 * false match. */
#define STORE_TEMPLATES_MAX 20

struct store_template { /* everything about a template but its face */
    char id[STORE_ID_LEN + 1];
    char subject[STORE_SUBJECT_MAX + 1];
    char label[STORE_LABEL_MAX + 1];
    char created[32]; /* RFC 3339, UTC */
    char digest[65];  /* digest_points(): SHA-256 of the canonical points */
    /* digests of the scans' points as they were read (digest_read_add()); "": unknown */
    char read[STORE_READ_MAX + 1];
    char engine[SURFACE_ENGINE_SIZE];
    uint32_t points, triangles; /* triangles: real ones, no ghosts */
    struct surface_quality quality;
    bool manager; /* enrolled with scope manage: further samples are held against it */
    double first_score; /* when it was enrolled, against the subject's oldest template; 0:
                           it was the first */
};

struct store_subject {
    int64_t key;                  /* the order of creation; never used again */
    unsigned char uid[STORE_UID]; /* random: the same, whatever its id and the database;
                                     names it in the logs */
    char id[STORE_SUBJECT_MAX + 1];
    char reference[STORE_NOTE_MAX + 1]; /* of the consent; "": none */
    char purpose[STORE_NOTE_MAX + 1];
    char created[32];
    char expires[32]; /* "": never */
    char seen[32];    /* last enrolled or verified, to the minute; "": unknown */
    bool hold;        /* neither it nor a template of it can be deleted */
    bool disabled;    /* not to be verified or identified */
    /* as of when it was read; set by store_subject_get() and store_snapshot_begin() */
    bool expired;
    uint32_t templates;
    double quality; /* of the best template, by store_subject_search() alone; NAN: none */
};

struct store_subject_change {        /* what is NULL stays as it is */
    const char *reference, *purpose; /* "": none */
    const char *expires;             /* utc_read_end(), to come; "": never */
    const bool *hold, *disabled;
};

/* What a token may do, a bit each. */
enum store_scope {
    STORE_SCOPE_VERIFY = 1,
    STORE_SCOPE_ENROLL = 2,
    STORE_SCOPE_IDENTIFY = 4,
    STORE_SCOPE_READ = 8,
    STORE_SCOPE_DELETE = 16,
    STORE_SCOPE_MANAGE =
        32, /* subjects: consent, expiry, holds, disabled, force, lock-outs */
    STORE_SCOPE_TOKENS = 64,
    STORE_SCOPE_AUDIT = 128, /* the log, the latest requests, the statistics */
    STORE_SCOPE_EVENTS = 256,
    STORE_SCOPE_SCORE = 512,   /* the numbers of a non-match: enough to rebuild a face */
    STORE_SCOPE_DETAIL = 1024, /* measures, gaps and surfaces; includes score */
    STORE_SCOPE_ALL = 2047
};

#define STORE_SCOPES_MAX 80 /* bytes of their names, "verify,enroll", with the NUL */

/* rows_scopes_read(text, out): one or more names with commas between; false: another.
 * rows_scopes_write(scopes, out): the names of those that are set, in the order of their bits. */
bool rows_scopes_read(const char *text, unsigned *out);
void rows_scopes_write(unsigned scopes, char out[STORE_SCOPES_MAX]);

struct store_token {
    char id[STORE_ID_LEN + 1];
    char name[STORE_NAME_MAX + 1];
    unsigned scopes;    /* enum store_scope */
    char created[32];   /* RFC 3339, UTC, like all times of it */
    char expires[32];   /* "": never */
    char used[32];      /* last, within a minute; "": never */
    char old_until[32]; /* what the secret before the last rotation is good for; "": no */
    char revoked[32];   /* when; "": it was not */
    bool expired;       /* as of when it was read */
};

/* How many verifications of a day (UTC) were decided so, by their score: from STORE_DAY_FROM on,
 * STORE_DAY_STEP each; the first and the last have what lies beyond, too. */
#define STORE_DAY      10 /* bytes, "2026-11-27" */
#define STORE_DAYS     180
#define STORE_DAY_BINS 64
#define STORE_DAY_FROM (-40.0)
#define STORE_DAY_STEP 2.0
struct store_day {
    char day[STORE_DAY + 1];
    char decision[16];
    uint32_t bin[STORE_DAY_BINS];
};

/* Called once a problem, with a line of text. */
typedef void store_report(void *arg, const char *line);

#define STORE_DEVICE_MAX 32 /* of its name, A-Z a-z 0-9 . _ - @ : */

struct store_device { /* a scanner that signs what it captures */
    char id[STORE_ID_LEN + 1];
    char name[STORE_DEVICE_MAX + 1];
    unsigned char public[CRYPT_KEY]; /* Ed25519 */
    char created[32];                /* RFC 3339, UTC */
};

/* A time that another daemon has written may be ahead by this much. */
#define STORE_AHEAD_MS 5000

#define STORE_LIFE_MAX (INT64_C(36525) * 86400) /* seconds: a century */

/* STORE_TRIED_MS: the time in which the subjects count that a token tries.
 * STORE_FAILED_MS: the time in which they count for a warning, and a subject's failures for other tokens.
 * STORE_RETRY_MS: the time in which a match explains a failure.
 * STORE_ATTEMPTS_DAYS: the time after which failures count no more: at one a day, where lock-outs
 * end, more attempts are left than after. */
#define STORE_TRIED_MS      INT64_C(3600000)
#define STORE_FAILED_MS     INT64_C(86400000)
#define STORE_RETRY_MS      INT64_C(600000)
#define STORE_ATTEMPTS_DAYS 30

/* Verifications of a subject that failed one after the other; what follows from them is the
 * caller's to say.  Ages are never negative. */
struct store_attempts {
    char subject[STORE_SUBJECT_MAX + 1];
    char token[STORE_NAME_MAX + 1]; /* whose they are; "": without one */
    uint32_t failures;              /* of this token */
    char at[32];                    /* the last one */
    int64_t age_ms;                 /* since it */
    /* Not set by store_attempts_list(): */
    uint32_t others; /* failures of other tokens, whose last is within STORE_FAILED_MS */
    int64_t others_age_ms; /* since the last of them */
    uint32_t tried; /* other subjects whose last verification by this token failed, in
                               the last STORE_TRIED_MS */
    int64_t tried_age_ms;      /* since the last of them */
    uint32_t tried_warn;       /* as tried, in the last STORE_FAILED_MS */
    uint32_t suspicion;        /* of this token (STORE_SUSPICION) */
    uint32_t others_suspicion; /* sum of all other tokens' */
};

#define STORE_FRAMES_MAX SURFACE_FRAMES_MAX

/* A probe that matched, by the points as they were read and used: 64 hexadecimal digits each,
 * functions of the set of points alone. */
struct store_probe {
    const char *read[STORE_FRAMES_MAX + 1]; /* of each frame; NULL ends them */
    char used[65]; /* digest_points(); "": they are no template's */
};

struct store_calibration {
    int64_t version;  /* 1, 2, ...: the greatest is in force */
    char created[32]; /* RFC 3339, UTC */
    char actor[STORE_NAME_MAX + 1];
    char engine[SURFACE_ENGINE_SIZE]; /* that made it: it holds for no other measure, and
                                         for no other model */
    bool shipped;                     /* back to the table that comes with the program */
    double fmr;                       /* the false match rate that was wanted */
    double low, high;                 /* 95 % interval of the threshold */
    uint64_t subjects;                /* people whose templates were compared */
    uint64_t impostors; /* comparisons of different people, and of the same */
    uint64_t genuine;
    struct surface_calibration table; /* valid */
    bool ignored; /* set by calibration_current() alone: it is the newest, but made by
                     another engine, so that it does not decide */
};

#endif
