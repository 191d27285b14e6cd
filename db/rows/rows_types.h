/* rows_types.h -- the types of the store's arguments and results.  Strings are UTF-8 without NUL.  Times are
 * RFC 3339 text, UTC, of fixed length, so that they compare like their texts. */
#ifndef DB_ROWS_TYPES_H
#define DB_ROWS_TYPES_H
#include <stdbool.h>
#include <stdint.h>
#include "crypt.h"
#include "det.h"
#include "groups.h"
#include "libsurface.h"
#include "ident.h"

#define STORE_SUBJECT_MAX IDENT_SUBJECT
#define STORE_ID_LEN      IDENT_ID
/* Digests of the scans that a template was made from (digest.h): 64 digits of the first, and
 * STORE_READ_OTHER of each other. */
#define STORE_READ_OTHER 16
#define STORE_READ_MAX   (64 + (SURFACE_FRAMES_MAX - 1) * STORE_READ_OTHER)

#define STORE_LABEL_MAX 256 /* bytes of UTF-8, no control characters */
#define STORE_NAME_MAX  64 /* bytes of the name of a token or an actor, printable ASCII */
#define STORE_NOTE_MAX  128 /* bytes of UTF-8, no control characters */
#define STORE_UID       16

/* Most templates of a subject: each one takes time in each verification, and is one more chance for a false
 * match. */
#define STORE_TEMPLATES_MAX 20

struct store_template { /* everything about a template but its face */
    char id[STORE_ID_LEN + 1];
    char subject[STORE_SUBJECT_MAX + 1];
    char label[STORE_LABEL_MAX + 1];
    char created[32]; /* RFC 3339, UTC */
    char digest[65];  /* digest_face(): SHA-256 of the canonical points */
    /* digests of the scans' points as they were read (digest_read_add()); "": unknown */
    char read[STORE_READ_MAX + 1];
    char engine[SURFACE_ENGINE_SIZE];
    uint32_t points, triangles; /* numbers of points and of triangles, without ghosts */
    struct surface_quality quality;
    bool manager; /* enrolled with scope manage: further samples are compared with it */
    /* Score against the subject's oldest template at the enrolment; 0: it was the first template. */
    double first_score;
};

struct store_subject {
    int64_t key; /* number in the order of creation; never reused */
    /* Random id in the logs; stays if the subject is renamed or moved to another database. */
    unsigned char uid[STORE_UID];
    char id[STORE_SUBJECT_MAX + 1];
    char reference[STORE_NOTE_MAX + 1]; /* reference of the consent; "": none */
    char purpose[STORE_NOTE_MAX + 1];   /* purpose of the consent; "": none */
    char created[32];
    char expires[32]; /* time of expiry; "": never */
    char seen[32];    /* last enrolment or verification, to the minute; "": unknown */
    bool hold;        /* neither the subject nor its templates can be deleted */
    bool disabled;    /* the subject cannot be verified or identified */
    bool identify;    /* a search among all subjects may find the subject */
    char groups[GROUPS_SIZE]; /* labels of the subject (groups.h) */
    /* It was expired when it was read; set by store_subject_get() and store_snapshot_begin(). */
    bool expired;
    uint32_t templates; /* number of templates */
    char locked
        [32]; /* end of the longest lock-out, set only by store_subject_search(); "": not locked out */
    /* Quality of the best template, set only by store_subject_search(); NAN: no template. */
    double quality;
};

struct store_subject_change {        /* new values; NULL: unchanged */
    const char *reference, *purpose; /* "": none */
    const char *expires; /* time in the future, as utc_read_end(); "": never */
    const bool *hold, *disabled, *identify;
    const char *groups; /* the whole list, as groups_read(); "": none */
};

/* The scopes of a token, a bit each. */
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

/* rows_scopes_read(text, out): Reads one or more names of scopes, separated by commas.  Returns false if a
 * name is unknown. */
bool rows_scopes_read(const char *text, unsigned *out);

/* rows_scopes_write(scopes, out): Writes the names of the scopes, in the order of their bits. */
void rows_scopes_write(unsigned scopes, char out[STORE_SCOPES_MAX]);

struct store_token {
    char id[STORE_ID_LEN + 1];
    char name[STORE_NAME_MAX + 1];
    unsigned scopes; /* sum of enum store_scope */
    char groups
        [GROUPS_SIZE]; /* groups that the token is bound to (groups.h); "": it is not bound */
    char created[32];   /* RFC 3339, UTC, as all times below */
    char expires[32];   /* time of expiry; "": never */
    char used[32];      /* time of the last use, to the minute; "": never */
    char old_until[32]; /* end of validity of the previous secret; "": it is not valid */
    char revoked[32];   /* time of the revocation; "": not revoked */
    bool expired;       /* it was expired when it was read */
    /* Number of the row's last change: its secret, or a revocation; of store_token_check() with the secret before,
     * one less. */
    int64_t revision;
};

/* A histogram: the numbers of verifications of a day (UTC) with this decision, by score.  Bins begin at
 * STORE_DAY_FROM and are STORE_DAY_STEP wide.  The first bin also counts all lower scores, the last bin
 * all higher ones. */
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

/* A scan that a token sent to verify or to identify. */
struct store_scan {
    bool unusable; /* it was refused: no face, or a poor one */
    double noise_mm,
        quality; /* as struct surface_quality; not used of an unusable scan */
};

/* Sums of the scans that a token sent on a day: they name no subject. */
#define STORE_SCAN_DAYS 84
struct store_scans {
    char token[STORE_NAME_MAX + 1]; /* id of the token, or the name of another actor */
    int64_t day;                    /* days since 1970, UTC */
    int64_t n;                      /* number of scans that were compared */
    int64_t unusable;               /* number of scans that were refused */
    int64_t noise_um;               /* sum of the noise of the n scans, um */
    int64_t quality;                /* sum of their quality, 1/1000 */
};

/* Receives a problem, as a line of text. */
typedef void store_report(void *arg, const char *line);

#define STORE_DEVICE_MAX 32 /* bytes of a device's name, A-Z a-z 0-9 . _ - @ : */

struct store_device { /* a scanner that signs what it captures */
    char id[STORE_ID_LEN + 1];
    char name[STORE_DEVICE_MAX + 1];
    unsigned char public[CRYPT_KEY]; /* Ed25519 */
    char created[32];                /* RFC 3339, UTC */
};

/* The most that a time written by another daemon may be in the future. */
#define STORE_AHEAD_MS 5000

#define STORE_LIFE_MAX (INT64_C(36525) * 86400) /* seconds: a century */

/* STORE_TRIED_MS: the period in which the subjects that a token failed on count for its limit.
 * STORE_FAILED_MS: the period in which they count for a warning, and a subject's failures for other tokens.
 * STORE_RETRY_MS: the time within which a match explains a failure.
 * STORE_ATTEMPTS_DAYS: the age at which failures no longer count.  Lock-outs grow to a day, and one attempt
 * a day gives more attempts than starting again after this time. */
#define STORE_TRIED_MS      INT64_C(3600000)
#define STORE_FAILED_MS     INT64_C(86400000)
#define STORE_RETRY_MS      INT64_C(600000)
#define STORE_ATTEMPTS_DAYS 30

/* Consecutive failed verifications.  The caller applies the limits (store_attempts.h).  Ages are never
 * negative. */
struct store_attempts {
    char subject[STORE_SUBJECT_MAX + 1];
    char token[STORE_NAME_MAX + 1]; /* id of the token; "": without a token */
    uint32_t failures;              /* consecutive failures of this token on subject */
    char at[32];                    /* time of the last of these failures */
    int64_t age_ms;                 /* ms since at; 0 if failures is 0 */
    /* Not set by store_attempts_list(): */
    uint32_t others; /* failures of other tokens whose last is within STORE_FAILED_MS */
    int64_t others_age_ms; /* ms since the last of these; 0 if others is 0 */
    /* Other subjects on which this token's last attempt failed, within STORE_TRIED_MS. */
    uint32_t tried;
    int64_t tried_age_ms;      /* ms since the last of these failures; 0 if tried is 0 */
    uint32_t tried_warn;       /* the same count for STORE_FAILED_MS */
    uint32_t suspicion;        /* suspicion of this token (STORE_SUSPICION) */
    uint32_t others_suspicion; /* sum of the suspicions of all other tokens */
};

#define STORE_FRAMES_MAX SURFACE_FRAMES_MAX

/* The digests of a probe that matched: 64 hexadecimal digits each, functions only of the set of points. */
struct store_probe {
    /* Digests of each frame's points as they were read; NULL after the last. */
    const char *read[STORE_FRAMES_MAX + 1];
    char used[65]; /* digest_face() of the points used; "": no template has them */
};

struct store_calibration {
    int64_t version;  /* 1, 2, ...; the highest is in force */
    char created[32]; /* RFC 3339, UTC */
    char actor[STORE_NAME_MAX + 1];
    char engine[SURFACE_ENGINE_SIZE]; /* engine that made it, the only one it holds for */
    bool shipped;       /* the table that comes with the program is in force again */
    double fmr;         /* requested false match rate */
    double low, high;   /* 95 % interval of the threshold */
    uint64_t subjects;  /* number of compared subjects */
    uint64_t impostors; /* number of comparisons of different subjects */
    uint64_t genuine;   /* number of comparisons of one subject */
    struct surface_calibration table; /* a valid table */
    struct det det; /* of the compared subjects; zeros: none of them has two templates */
    /* It is the newest, but made by another engine, and does not decide.  Set only by
     * store_calibration_current(). */
    bool ignored;
};

#endif
