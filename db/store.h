/* store.h -- the template store: its whole interface.
 * A store may be used from any number of threads; each call is one transaction: it either
 * takes full effect or none, and is on the disk when it returns ST_OK (except
 * store_event()).  Other processes may use the same database at the same time; each call
 * sees what they have committed.  Ids are checked by the callee (ST_EINVAL).
 * actor: the caller, for the events: a token's id, a program's name or "".
 * Every call returns a status and fills *e (may be NULL) on failure:
 * ST_EINVAL, ST_ENOTFOUND, ST_EEXISTS, ST_ECORRUPT (damaged row or file, not a database),
 * ST_EVERSION (database of another version), ST_EBUSY (locked by another process for
 * longer than 5 s), ST_EIO (disk full, not writable), ST_EDB, ST_ENOMEM. */
#ifndef DB_STORE_H
#define DB_STORE_H
#include "log_walk.h"
#include "store_attempts.h"
#include "store_open.h"
#include "store_template.h"
#include "store_verification.h"

/* ---- subjects */

/* store_subject_add(s, actor, about, e): add a subject without templates, since the
 * consent is known before the first scan. Reads and checks id, reference, purpose and
 * expires (in the future) of *about, and sets created. ST_EEXISTS. */
enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e);

enum status store_subject_get(struct store *s, const char *subject,
                              struct store_subject *out, struct errinfo *e);

/* store_subject_list(s, after, limit, out, n, e): up to limit subjects in the order of
 * creation, those whose key is greater than after (0 from the start); a new array
 * released by free().
 * store_subject_due(s, out, n, e): the expired subjects, also those on hold, the longest
 * expired first; a new array released by free(). */
enum status store_subject_list(struct store *s, int64_t after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e);
enum status store_subject_due(struct store *s, struct store_subject **out, size_t *n,
                              struct errinfo *e);

enum store_state { /* of a subject, at one moment; several may be true */
                   STORE_ANY,
                   STORE_ACTIVE, /* neither disabled nor expired */
                   STORE_DISABLED,
                   STORE_HELD,
                   STORE_EXPIRED,
                   STORE_ENDING /* expires in STORE_ENDING_MS, and has not yet */
};

/* store_subject_state(word, out): "active", "disabled", "hold", "expired", "ending". */
bool store_subject_state(const char *word, enum store_state *out);

#define STORE_ENDING_MS   (INT64_C(30) * 86400000)
#define STORE_SEARCH_ROWS 5000 /* that a search looks at, at most: it decrypts each */

struct store_search {
    const char *part; /* of the id, whatever the case of its letters; "": any */
    enum store_state state;
    int64_t after; /* as of store_subject_list() */
    size_t limit;  /* 1.. */
};

/* store_subject_search(s, what, out, n, next, e): in the order of creation, with their quality;
 * released by free().  *next: to go on after, 0: there are no more.  There may be fewer than limit,
 * or none, and more to come.  Some 8 us a row that is looked at. */
enum status store_subject_search(struct store *s, const struct store_search *what,
                                 struct store_subject **out, size_t *n, int64_t *next,
                                 struct errinfo *e);

/* store_subject_set(s, actor, subject, what, e): apply all of *what or nothing, with an
 * event each for consent, hold and disabled. The caller must not verify a subject that is
 * disabled or has expired. ST_OK also if nothing changes. */
enum status store_subject_set(struct store *s, const char *actor, const char *subject,
                              const struct store_subject_change *what, struct errinfo *e);

/* store_subject_rename(s, actor, subject, to, e): change the id; everything recorded is
 * kept. ST_EEXISTS: a subject has that id, perhaps this one. */
enum status store_subject_rename(struct store *s, const char *actor, const char *subject,
                                 const char *to, struct errinfo *e);

/* ---- subjects erased: the bytes are overwritten, and leave the WAL */

struct store_receipt {
    char subject[STORE_SUBJECT_MAX + 1];
    char uid[2 * STORE_UID + 1]; /* by which the logs name the subject, in hexadecimal */
    char at[32];
    char (*template_id)[STORE_ID_LEN + 1]; /* [templates], oldest first */
    uint32_t templates;
    char digest[65]; /* SHA-256 of all of the above */
    uint64_t seq;    /* of its entry in the change log, and that one's hash */
    char hash[65];
    char signature[129]; /* Ed25519 of digest, seq and hash */
    char public_key[65]; /* that it is verified with */
};

/* store_receipt_true(r): whether digest and signature verify with r->public_key. */
bool store_receipt_true(const struct store_receipt *r);
void store_receipt_free(struct store_receipt *r); /* what it points to, not *r */

/* store_subject_erase(s, actor, subject, out, e): the subject and all its templates.  *out is
 * released by store_receipt_free(), also on failure.  ST_EHELD: it is on hold.
 * store_subject_purge(s, actor, subject, e): only if it has expired, else ST_ENOTFOUND. */
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);

/* store_erased_since(s, since, erased, e): Sets *erased to true if any process has erased a subject or
 * a template after change *since (0 at first), and *since to the last change.  The caller then drops
 * its copies in memory.  On failure *since is unchanged.  O(changes since). */
enum status store_erased_since(struct store *s, int64_t *since, bool *erased,
                               struct errinfo *e);

/* ---- Bearer tokens: 256 random bits each, of which only a hash is kept */

#define STORE_NEVER    0  /* in the place of an end, ms since 1970 */
#define STORE_SAME_END -1 /* likewise: it is kept */

/* store_token_create(s, actor, name, scopes, end_ms, secret, t, e): a new Bearer token; only a
 * hash of secret is stored. */
enum status store_token_create(struct store *s, const char *actor, const char *name,
                               unsigned scopes, int64_t end_ms, char secret[65],
                               struct store_token *t, struct errinfo *e);

/* store_token_rotate(s, actor, id, grace_s, end_ms, secret, t, e): a new secret for the
 * token; the old secret stays valid for grace_s seconds, and an older one becomes
 * invalid. ST_EDENIED: it was revoked. */
enum status store_token_rotate(struct store *s, const char *actor, const char *id,
                               int64_t grace_s, int64_t end_ms, char secret[65],
                               struct store_token *t, struct errinfo *e);
enum status store_token_get(struct store *s, const char *id, struct store_token *out,
                            struct errinfo *e);
enum status store_token_list(struct store *s, struct store_token **out, size_t *n,
                             struct errinfo *e);

#define STORE_TOKEN_LIFE_S (INT64_C(365) * 86400) /* without another end */
#define STORE_TOKEN_SOON_S (INT64_C(30) * 86400)  /* before a token expires: warn */

/* store_token_left(t): seconds until t expires, INT64_MAX if never; 0: it has expired, or
 * was revoked. */
int64_t store_token_left(const struct store_token *t);

/* store_token_revoke(s, actor, id, e): ST_OK also when it was revoked before. */
enum status store_token_revoke(struct store *s, const char *actor, const char *id,
                               struct errinfo *e);

/* store_token_check(s, secret, t, e): ST_OK and the token, or ST_EDENIED for an unknown,
 * malformed, expired or revoked one.  Compared in constant time.  Rotations and
 * revocations take effect at once. Records at most once a minute that the token is in
 * use, and only if that waits neither for the disk nor for another writer. */
enum status store_token_check(struct store *s, const char *secret, struct store_token *t,
                              struct errinfo *e);

/* ---- devices: scanners that sign what they capture, each by its name and public key */

/* store_device_add(s, actor, name, public, out, e): name: 1 to STORE_DEVICE_MAX
 * characters as in a subject's id; public: Ed25519.  ST_EEXISTS: the name is another's;
 * ST_EINVAL.
 * store_device_list(s, out, n, e): oldest first; released by free().
 * store_device_remove(s, actor, name, e): no process accepts its captures any more, and
 * the name can be used again.  ST_ENOTFOUND. */
enum status store_device_add(struct store *s, const char *actor, const char *name,
                             const unsigned char public[CRYPT_KEY],
                             struct store_device *out, struct errinfo *e);
enum status store_device_list(struct store *s, struct store_device **out, size_t *n,
                              struct errinfo *e);
enum status store_device_remove(struct store *s, const char *actor, const char *name,
                                struct errinfo *e);

/* Whether name is valid for a device. */
bool store_device_valid(const char *name);

/* ---- captures that a device signed */

/* A nonce for each.  It is a time, 128 random bits and a MAC by the database's key:
 * nothing is stored until it is used, so that requesting many costs no space.  A used nonce stays
 * stored for STORE_NONCE_KEPT_MS after its end, so that each is valid once, for all processes.  A
 * clock that was wrong by less than that, and is set right again, makes no used nonce valid.
 * Bytes, as base64url without padding: */
#define STORE_NONCE         40 /* bytes: i64 ms since 1970, 16 random, 16 of the MAC */
#define STORE_NONCE_TEXT    54
#define STORE_NONCE_LIFE_MS 120000
#define STORE_NONCE_KEPT_MS 86400000 /* more than a wrong time zone shifts a clock */

/* store_capture_nonce(s, nonce, expires, e): a new nonce. */
enum status store_capture_nonce(struct store *s, char nonce[STORE_NONCE_TEXT + 1],
                                char expires[32], struct errinfo *e);

struct store_capture {
    const char *device, *nonce; /* as the capture names them, not checked */
    const void *text;           /* of len bytes, that the device has signed */
    size_t len;
    unsigned char signature[CRYPT_SIGN];
};

enum store_captured { /* the first that applies */
                      STORE_CAPTURED,
                      STORE_CAPTURE_UNKNOWN,  /* there is no such device */
                      STORE_CAPTURE_FORGED,   /* the device has not signed this */
                      STORE_CAPTURE_FOREIGN,  /* the nonce is not of this database */
                      STORE_CAPTURE_STALE,    /* it has expired */
                      STORE_CAPTURE_REPLAYED, /* it was used before */
};

/* store_capture_take(s, c, out, e): verify the capture and use up its nonce. Returns
 * ST_OK for every *out; ST_ECORRUPT: the device's row. */
enum status store_capture_take(struct store *s, const struct store_capture *c,
                               enum store_captured *out, struct errinfo *e);

/* ---- calibrations: the newest is in force (calibration.h) */

/* store_calibration_add(s, actor, k, e): append *k, setting its version, time, actor and
 * engine, with a change. ST_EINVAL: invalid numbers. */
enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e);

/* store_calibration_get(s, k, e): the newest; ST_ENOTFOUND if there is none.
 * store_calibration_list(s, out, n, e): all, oldest first; released by free(). */
enum status store_calibration_get(struct store *s, struct store_calibration *k,
                                  struct errinfo *e);
enum status store_calibration_list(struct store *s, struct store_calibration **out,
                                   size_t *n, struct errinfo *e);

/* ---- the audit log: the change log and the access log (log_entry.h) */

/* store_event(s, kind, actor, subject, object, outcome, e): append to the access log; no
 * biometrics in it.  kind: "verify", "compare", ...; subject, an id, object, an id of a
 * template, and outcome may be "".  Changes (enroll, delete, tokens) write their own
 * entries. It does not wait for the disk: a loss of power may lose the last events. */
enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *object, const char *outcome,
                        struct errinfo *e);

struct store_audit_entry {
    struct log_entry entry;
    /* "": of none, or names are not wanted */
    char subject[STORE_SUBJECT_MAX + 1];
    char actor_name[STORE_NAME_MAX + 1]; /* the token's, where the actor is one */
    bool erased;                         /* the subject was */
};

struct store_audit_place { /* in all logs at once */
    uint64_t changes, accesses[LOG_DAEMONS];
    uint32_t daemons; /* of accesses[], what counts; the others are 0 */
    bool end;         /* there is nothing more */
};

struct store_audit_filter {   /* all zero: everything, in the order of writing */
    const enum log_name *log; /* NULL: both; of several daemons by their clocks */
    const uint32_t *daemon;   /* of accesses, whose; NULL: of all */
    bool newest;              /* the last ones, the newest first */
    struct store_audit_place
        from;            /* behind it, with newest before it (zeros: from the end) */
    uint64_t limit;      /* 0: as many as there are */
    uint64_t most;       /* entries that are looked at, wanted or not; 0: any number */
    const char *subject; /* an id; of one that was erased: */
    const unsigned char *uid;  /* [LOG_UID] */
    const char *kind;          /* one or more, with commas */
    const char *actor;         /* all of it */
    const char *since, *until; /* RFC 3339, or its beginning; both ends are in it */
    bool names;
};

/* store_audit_list(s, filter, out, n, next, e): entries in order, not verified; a new array
 * released by free(), also NULL.  *next (or NULL): where the next page begins.
 * ST_ENOTFOUND: there is no such subject.  About 2 us an entry that is read, and 15 for the
 * names of one. */
enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n,
                             struct store_audit_place *next, struct errinfo *e);

/* store_audit_sign(s, actor, kind, out, to, e): append a signed change of this kind,
 * LOG_CHECKPOINT or LOG_EXPORT; before it, where other daemons have written since, a change for each
 * that names the end of its accesses.  *to (or NULL): the last entries that the signature covers.
 * store_audit_public(s, public, e): the public key of the signatures.
 * store_audit_has(s, at, has, e): whether the change log has this entry.
 * store_audit_anchor(s, path, daemon, at, has, e): the same of what an anchor says, a file of another
 * daemon.  *daemon: whose it is.
 * store_audit_verify(s, report, arg, out, e): verify every entry of both logs, and the
 * rows (store_verify()), which are reported as of the last change. *out: the walk. */
enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct log_entry *out, struct store_audit_place *to,
                             struct errinfo *e);
enum status store_audit_public(struct store *s, unsigned char public[CRYPT_KEY],
                               struct errinfo *e);
enum status store_audit_has(struct store *s, const struct log_end *at, bool *has,
                            struct errinfo *e);
enum status store_audit_anchor(struct store *s, const char *path, uint32_t *daemon,
                               struct log_end *at, bool *has, struct errinfo *e);
enum status store_audit_verify(struct store *s, log_report *report, void *arg,
                               struct log_walk *out, struct errinfo *e);

/* store_audit_trim(s, actor, days, dry, cut, e): delete the oldest accesses, up to the
 * first that is younger than days (1..); the last one is kept. Deletes in batches, each a
 * transaction. dry: only count them. *cut: their number. */
#define STORE_TRIM_MAX 36500 /* days */
enum status store_audit_trim(struct store *s, const char *actor, unsigned days, bool dry,
                             uint64_t *cut, struct errinfo *e);

#endif
