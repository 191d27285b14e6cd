/* store.h -- the template store: its whole interface.
 * Any number of threads may use a store.  Each call is one transaction: it takes full effect or none,
 * and is durable when it returns ST_OK (except store_event()).  Other processes may use the same database
 * at the same time; each call sees their commits.  The functions check ids (ST_EINVAL).
 * actor: the caller, for the logs: a token's id, a program's name or "".  For a token that is bound to groups
 * (groups.h) no subject of other groups exists, nor its templates, and no token that is not bound to some of
 * these groups; it sees only its own groups of a subject.
 * Each call returns a status, and fills *e (may be NULL) on failure:
 *   ST_EINVAL, ST_ENOTFOUND, ST_EEXISTS
 *   ST_ECORRUPT   a row or the file is damaged, or the file is no database
 *   ST_EVERSION   the database has another version
 *   ST_EBUSY      another process held a lock for longer than 5 s
 *   ST_EIO        the disk is full or not writable
 *   ST_EDB, ST_ENOMEM */
#ifndef DB_STORE_H
#define DB_STORE_H
#include "log_walk.h"
#include "store_attempts.h"
#include "store_open.h"
#include "store_template.h"
#include "store_verification.h"

/* ---- subjects */

/* store_subject_add(s, actor, about, e): Adds a subject without templates, because the consent is known before
 * the first scan.  Reads id, reference, purpose, expires (in the future), groups (as groups_read()) and
 * identify of *about, and sets created.  ST_EEXISTS: a subject has this id, also one that does not exist for actor.
 * Sets groups, if they are "", to the groups that actor is bound to.  ST_EDENIED: they are others. */
enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e);

/* store_subject_get(s, actor, subject, out, e): Reads the subject with this id. */
enum status store_subject_get(struct store *s, const char *actor, const char *subject,
                              struct store_subject *out, struct errinfo *e);

/* store_subject_list(s, after, limit, out, n, e): Lists up to limit subjects in the order of creation.
 *   after  only subjects with a greater key; 0: from the start
 *   out    a new array of *n elements, to be released by free() */
enum status store_subject_list(struct store *s, int64_t after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e);

/* store_subject_due(s, out, n, e): Lists the expired subjects, including those on hold, the longest expired
 * first.  out as in store_subject_list(). */
enum status store_subject_due(struct store *s, struct store_subject **out, size_t *n,
                              struct errinfo *e);

enum store_state { /* state of a subject at one moment; several may be true */
                   STORE_ANY,
                   STORE_ACTIVE, /* neither disabled nor expired */
                   STORE_DISABLED,
                   STORE_HELD,
                   STORE_EXPIRED,
                   STORE_ENDING,    /* not expired, but expires within STORE_ENDING_MS */
                   STORE_LOCKED,    /* a token is locked out of it */
                   STORE_NO_CONSENT /* no reference of a consent */
};

/* store_subject_state(word, out): Reads "active", "disabled", "hold", "expired", "ending", "locked" or "no_consent".
 * Returns false for another word. */
bool store_subject_state(const char *word, enum store_state *out);

#define STORE_ENDING_MS   (INT64_C(30) * 86400000)
#define STORE_SEARCH_ROWS 5000 /* most rows that a search decrypts */

struct store_search {
    const char *group; /* one of the subject's groups; "": any, or none */
    const char *part;  /* part of the id, in any case of its letters; "": any id */
    enum store_state state;
    const struct store_limits *limits; /* for lock-outs; NULL: none is looked for */
    int64_t after;                     /* as in store_subject_list() */
    size_t limit;                      /* most results, 1 or more */
};

/* store_subject_search(s, actor, what, out, n, next, e): Lists subjects, with their quality, in the order of creation.
 *   out   a new array of *n elements, to be released by free(); it may have fewer than what->limit
 *         elements, or none, although more follow
 *   next  value of after for the next call; 0: there are no more
 * Cost: about 8 us for each row read. */
enum status store_subject_search(struct store *s, const char *actor,
                                 const struct store_search *what,
                                 struct store_subject **out, size_t *n, int64_t *next,
                                 struct errinfo *e);

/* store_subject_set(s, actor, subject, what, e): Applies all of *what or nothing, with one event each for
 * consent, hold, disabled, groups and identify.  The caller must not verify a subject that is disabled or has expired.
 * ST_OK also if nothing changes.  An actor that is bound to groups replaces only its own groups of the subject, by
 * at least one; ST_EDENIED: by others. */
enum status store_subject_set(struct store *s, const char *actor, const char *subject,
                              const struct store_subject_change *what, struct errinfo *e);

/* store_subject_rename(s, actor, subject, to, e): Changes the id.  All records are kept.  ST_EEXISTS: a
 * subject has the id `to`, perhaps this one. */
enum status store_subject_rename(struct store *s, const char *actor, const char *subject,
                                 const char *to, struct errinfo *e);

/* ---- erasure of subjects: the bytes are overwritten, and removed from the WAL */

struct store_receipt {
    char subject[STORE_SUBJECT_MAX + 1];
    char (*template_id)[STORE_ID_LEN +
                        1]; /* ids of the templates [templates], oldest first */
    uint32_t templates;     /* number of templates */
    struct log_entry
        entry;       /* the erasure's, in the change log: its seq, at, uid and hash,
                             * and a signature with digest */
    char digest[65]; /* SHA-256 of subject, the entry's uid and at, and the templates */
    unsigned char public_key[CRYPT_KEY]; /* key that verifies the signature */
};

/* store_receipt_true(r): Returns true if digest and signature verify with r->public_key. */
bool store_receipt_true(const struct store_receipt *r);

/* store_receipt_free(r): Releases the members of *r, not *r itself. */
void store_receipt_free(struct store_receipt *r);

/* store_subject_erase(s, actor, subject, out, e): Erases the subject and all its templates.
 *   out  to be released by store_receipt_free(), also after a failure
 * ST_EHELD: the subject is on hold. */
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);

/* store_subject_purge(s, actor, subject, e): Erases the subject if it has expired.  ST_ENOTFOUND: there is no
 * such subject, or it has not expired; ST_EHELD. */
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);

/* ---- Bearer tokens: secrets of 256 random bits; the database stores only their hashes */

#define STORE_NEVER    0  /* as end_ms (ms since 1970): the token does not expire */
#define STORE_SAME_END -1 /* as end_ms: the expiry is not changed */

/* store_token_create(s, actor, name, scopes, groups, end_ms, secret, t, e): Creates a token.  secret receives its
 * secret, of which only a hash is stored.
 *   groups  as groups_read(); "": the groups that actor is bound to, if any
 * ST_EDENIED: actor is bound to others; ST_EINVAL: also for groups together with STORE_SCOPE_AUDIT, which is
 * about all subjects. */
enum status store_token_create(struct store *s, const char *actor, const char *name,
                               unsigned scopes, const char *groups, int64_t end_ms,
                               char secret[65], struct store_token *t, struct errinfo *e);

/* store_token_rotate(s, actor, id, grace_s, end_ms, secret, t, e): Gives the token a new secret.  The old secret
 * stays valid for grace_s seconds; an older one becomes invalid.  ST_EDENIED: the token was revoked. */
enum status store_token_rotate(struct store *s, const char *actor, const char *id,
                               int64_t grace_s, int64_t end_ms, char secret[65],
                               struct store_token *t, struct errinfo *e);

/* store_token_get(s, actor, id, out, e): Reads the token with this id. */
enum status store_token_get(struct store *s, const char *actor, const char *id,
                            struct store_token *out, struct errinfo *e);

/* store_token_list(s, actor, out, n, e): Lists the tokens.
 *   out  a new array of *n elements, to be released by free() */
enum status store_token_list(struct store *s, const char *actor, struct store_token **out,
                             size_t *n, struct errinfo *e);

#define STORE_TOKEN_LIFE_S (INT64_C(365) * 86400) /* default life of a token, s */
#define STORE_TOKEN_SOON_S                                                               \
    (INT64_C(30) * 86400) /* remaining life that causes warnings, s */

/* store_token_left(t): Returns the seconds until t expires, INT64_MAX if it never expires, 0 if it has expired
 * or was revoked. */
int64_t store_token_left(const struct store_token *t);

/* store_token_revoke(s, actor, id, e): Revokes the token.  ST_OK also if it was already revoked. */
enum status store_token_revoke(struct store *s, const char *actor, const char *id,
                               struct errinfo *e);

/* store_token_check(s, secret, t, e): Finds the token with this secret, in constant time.  Rotations and
 * revocations take effect at once.  Records the use of the token at most once a minute, and only if this
 * waits neither for the disk nor for another writer.
 * Returns ST_OK and the token in *t; ST_EDENIED: unknown, malformed, expired or revoked. */
enum status store_token_check(struct store *s, const char *secret, struct store_token *t,
                              struct errinfo *e);

/* ---- devices: scanners that sign their captures, each with a name and a public key */

/* store_device_add(s, actor, name, public, out, e): Adds a device.
 *   name    1 to STORE_DEVICE_MAX characters as in a subject's id
 *   public  Ed25519
 * ST_EEXISTS: another device has this name; ST_EINVAL. */
enum status store_device_add(struct store *s, const char *actor, const char *name,
                             const unsigned char public[CRYPT_KEY],
                             struct store_device *out, struct errinfo *e);

/* store_device_list(s, out, n, e): Lists the devices, oldest first.
 *   out  a new array of *n elements, to be released by free() */
enum status store_device_list(struct store *s, struct store_device **out, size_t *n,
                              struct errinfo *e);

/* store_device_remove(s, actor, name, e): Removes a device.  From then on no process accepts its captures, and
 * the name can be used again.  ST_ENOTFOUND: there is no such device. */
enum status store_device_remove(struct store *s, const char *actor, const char *name,
                                struct errinfo *e);

/* store_device_valid(name): Returns true if name is a valid name of a device. */
bool store_device_valid(const char *name);

/* ---- captures that a device signed */

/* Each capture needs a nonce: a time, 128 random bits and a MAC by the database's key.  Nothing is stored until
 * the nonce is used, so that requests for nonces cost no space.  A used nonce stays stored for
 * STORE_NONCE_KEPT_MS after its end, so that it is valid once, for all processes.  If a clock was wrong by
 * less than this time and is corrected, no used nonce becomes valid.
 * Its bytes are sent as base64url without padding: */
#define STORE_NONCE         40 /* bytes: i64 ms since 1970, 16 random, 16 of the MAC */
#define STORE_NONCE_TEXT    54
#define STORE_NONCE_LIFE_MS 120000
#define STORE_NONCE_KEPT_MS 86400000 /* more than the error of a wrong time zone */

/* store_capture_nonce(s, nonce, expires, e): Creates a nonce, and sets its end. */
enum status store_capture_nonce(struct store *s, char nonce[STORE_NONCE_TEXT + 1],
                                char expires[32], struct errinfo *e);

struct store_capture {
    const char *device, *nonce;          /* names in the capture, not checked */
    const void *text;                    /* signed bytes */
    size_t len;                          /* number of signed bytes */
    unsigned char signature[CRYPT_SIGN]; /* signature of text */
};

enum store_captured { /* result of the verification; the first that applies */
                      STORE_CAPTURED,
                      STORE_CAPTURE_UNKNOWN,  /* there is no such device */
                      STORE_CAPTURE_FORGED,   /* the device has not signed this text */
                      STORE_CAPTURE_FOREIGN,  /* the nonce is from another database */
                      STORE_CAPTURE_STALE,    /* the nonce has expired */
                      STORE_CAPTURE_REPLAYED, /* the nonce was already used */
};

/* store_capture_take(s, c, out, e): Verifies the capture and uses its nonce up.  Returns ST_OK for every *out;
 * ST_ECORRUPT: the device's row is damaged. */
enum status store_capture_take(struct store *s, const struct store_capture *c,
                               enum store_captured *out, struct errinfo *e);

/* ---- calibrations */

/* store_calibration_add(s, actor, k, e): Adds *k as the newest calibration, and sets its version, time, actor and
 * engine.  Appends a change.  ST_EINVAL: its numbers are invalid. */
enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e);

/* store_calibration_get(s, k, e): Reads the newest calibration.  ST_ENOTFOUND: there is none. */
enum status store_calibration_get(struct store *s, struct store_calibration *k,
                                  struct errinfo *e);

/* store_calibration_list(s, out, n, e): Lists all calibrations, oldest first.
 *   out  a new array of *n elements, to be released by free() */
enum status store_calibration_list(struct store *s, struct store_calibration **out,
                                   size_t *n, struct errinfo *e);

/* The calibration in force is the newest, or the model's own table (core/face/model.h) if there is none, if the
 * newest says so, or if it was made for another measure or another model.
 *
 * store_calibration_current(s, k, e): Reads the calibration in force.
 *   k  version is that of the newest, 0: there is none; table decides; shipped: it is the model's own;
 *      ignored: the newest does not decide, which a program should report when it starts
 * ST_ECORRUPT: the newest is damaged; nothing may be decided. */
enum status store_calibration_current(struct store *s, struct store_calibration *k,
                                      struct errinfo *e);

/* store_calibration_apply(s, k, w): Makes w decide by k, which is the newest as store_snapshot_begin() reads it;
 * zeros: there is none. */
void store_calibration_apply(const struct store *s, struct store_calibration k,
                             struct surface_work *w);

/* store_calibration_refresh(s, w, version, e): Makes w decide by the calibration in force.  On failure w is unchanged.
 *   version  of the calibration that w decides by, 0 for a new w; the caller keeps it with w
 * Cost: some microseconds if it has not changed. */
enum status store_calibration_refresh(struct store *s, struct surface_work *w,
                                      int64_t *version, struct errinfo *e);

/* ---- the audit log: the change log and the access log (log_entry.h) */

/* store_event(s, kind, actor, subject, object, outcome, e): Appends an entry to the access log; it must not have
 * biometric data.  Changes (enroll, delete, tokens) write their own entries.  Does not wait for the disk:
 * a power failure may lose the last events.
 *   kind     "verify", "compare", ...
 *   subject  an id, or ""; one that does not exist for actor is left out
 *   object   id of a template, or ""
 *   outcome  may be "" */
enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *object, const char *outcome,
                        struct errinfo *e);

/* store_event_scan(s, kind, actor, subject, outcome, scan, e): Like store_event() without an object, and counts the
 * scan for the actor in the same transaction. */
enum status store_event_scan(struct store *s, const char *kind, const char *actor,
                             const char *subject, const char *outcome,
                             const struct store_scan *scan, struct errinfo *e);

struct store_audit_entry {
    struct log_entry entry;
    char subject[STORE_SUBJECT_MAX +
                 1];          /* id of the subject; "": none, or without names */
    char groups[GROUPS_SIZE]; /* groups of the subject */
    char actor_name[STORE_NAME_MAX + 1]; /* name of the token, if the actor is a token */
    bool erased;                         /* the subject was erased */
};

struct store_audit_place {                   /* a position in all logs at once */
    uint64_t changes, accesses[LOG_DAEMONS]; /* number of an entry in each log */
    /* store_audit_mark() of these entries, by which one finds a position of another database; 0: unknown. */
    uint32_t change_mark, access_mark[LOG_DAEMONS];
    uint32_t daemons; /* number of used elements in accesses; the others are 0 */
    bool end;         /* no entries follow */
};

/* store_audit_mark(entry): Returns a part of the hash of an entry, never 0. */
uint32_t store_audit_mark(const struct log_entry *entry);

/* store_audit_end(s, out, e): Sets *out to the last entries of all logs. */
enum status store_audit_end(struct store *s, struct store_audit_place *out,
                            struct errinfo *e);

/* store_audit_known(s, place, known, e): Sets *known to true if place lies in these logs: each entry is there and
 * has its mark, or is an access that was cut off; fills in the unknown marks.  Else place is of another database, or
 * of a later state of this one. */
enum status store_audit_known(struct store *s, struct store_audit_place *place,
                              bool *known, struct errinfo *e);

struct store_audit_filter { /* all zero: all entries, in the order of writing */
    /* One log; NULL: both. The entries of several daemons are in the order of their clocks. */
    const enum log_name *log;
    const uint32_t *daemon; /* one daemon's accesses; NULL: all daemons' */
    bool newest;            /* the last entries, the newest first */
    /* Begin: the entries after this place; with newest, those before it (zeros: from the end). */
    struct store_audit_place from;
    uint64_t limit;      /* most results; 0: no limit */
    uint64_t most;       /* most entries read, including unwanted ones; 0: no limit */
    const char *subject; /* id of a subject; an erased subject: see uid */
    const unsigned char *uid;  /* uid of a subject [LOG_UID] */
    const char *kind;          /* one or more kinds, separated by commas */
    const char *actor;         /* the whole actor */
    const char *since, *until; /* RFC 3339, or the beginning of one; both are included */
    bool names;                /* find the names of subjects and tokens */
};

/* store_audit_list(s, filter, out, n, next, e): Lists entries in order.  They are not verified.
 *   out   a new array of *n elements, to be released by free(); NULL if *n is 0
 *   next  receives the begin of the next page; NULL is allowed
 * Cost: about 2 us for each entry read, and 15 us for the names of one.
 * ST_ENOTFOUND: there is no such subject. */
enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n,
                             struct store_audit_place *next, struct errinfo *e);

/* store_audit_sign(s, actor, kind, out, to, e): Appends a signed change.  For each other daemon that has written
 * accesses since, it first appends a change that names the end of that daemon's access log.
 *   kind  LOG_CHECKPOINT or LOG_EXPORT
 *   out   receives the signed change
 *   to    receives the last entries that the signature covers; NULL is allowed */
enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct log_entry *out, struct store_audit_place *to,
                             struct errinfo *e);

/* store_audit_public(s, hex): Writes the public key of the signatures, in hexadecimal. */
void store_audit_public(const struct store *s, char hex[2 * CRYPT_KEY + 1]);

/* store_audit_has(s, at, has, e): Sets *has to true if the change log has the entry *at. */
enum status store_audit_has(struct store *s, const struct log_end *at, bool *has,
                            struct errinfo *e);

/* store_audit_anchor(s, path, daemon, at, has, e): Reads the anchor of another daemon from the file path, sets
 * *daemon to the number of that daemon and *at to the anchor's entry, and *has as store_audit_has(). */
enum status store_audit_anchor(struct store *s, const char *path, uint32_t *daemon,
                               struct log_end *at, bool *has, struct errinfo *e);

/* store_audit_verify(s, report, arg, out, e): Verifies every entry of both logs, and the rows (store_verify()).
 * Problems of rows are reported with the number of the last change.
 *   out  receives the walk */
enum status store_audit_verify(struct store *s, log_report *report, void *arg,
                               struct log_walk *out, struct errinfo *e);

/* store_audit_trim(s, actor, days, dry, cut, e): Deletes the oldest accesses, up to the first one that is younger
 * than days.  The last one is kept.  Deletes in batches, each a transaction.
 *   days  1 to STORE_TRIM_MAX
 *   dry   only count the accesses
 *   cut   receives their number */
#define STORE_TRIM_MAX 36500 /* days */
enum status store_audit_trim(struct store *s, const char *actor, unsigned days, bool dry,
                             uint64_t *cut, struct errinfo *e);

#endif
