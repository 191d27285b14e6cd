/* store.h -- the template store: an interface; SQLite (store_sqlite.c) is its embedded
 * default.  A store may be used from any number of threads; each call either takes full
 * effect or none, and is on the disk when it returns ST_OK (but see store_event()).  Other
 * processes may use the same database at the same time; each call sees what they have
 * committed.  A template's points never change, what is loaded is always what this engine
 * makes of them, and its id is never used again, so a model may be cached by id as long as
 * store_template_list() or store_template_get() still names it.
 * Strings are UTF-8 without NUL; ids are checked by the callee (ST_EINVAL).
 * actor: who asks, for the events table: a token's id, a program's name or "".
 * Every call returns a status and fills *e (may be NULL) on failure:
 * ST_EINVAL, ST_ENOTFOUND, ST_EEXISTS, ST_ECORRUPT (damaged row or file, not a database),
 * ST_EVERSION (database of another version), ST_EBUSY (locked by another process for longer
 * than 5 s), ST_EIO (disk full, not writable), ST_EDB, ST_ENOMEM. */
#ifndef DB_STORE_H
#define DB_STORE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "status.h"
#include "vault.h"

struct errinfo;
struct keyfile; /* keyfile.h */
struct model;   /* model.h */
struct store;

#define STORE_SUBJECT_MAX 128 /* A-Z a-z 0-9 . _ - @ : */
#define STORE_ID_LEN      32  /* template and token ids: 128 random bits in hex */
#define STORE_LABEL_MAX   256 /* bytes of UTF-8, no control characters */
#define STORE_NAME_MAX    64  /* of a token or an actor, printable ASCII */

enum store_mode {
    STORE_READ,   /* changes are refused with ST_EDENIED */
    STORE_WRITE,  /* the database must be there */
    STORE_CREATE, /* made if it is missing or empty, readable by its owner alone */
    STORE_MIGRATE /* the database must be there; one of an older version is upgraded */
};

struct store_key {               /* where the master key of vault.h comes from */
    const char *path;            /* its file; NULL: OF.key, if there is one */
    const char *of;              /* NULL: the database that is opened, else another */
    const struct keyfile *given; /* instead of a file, while the store is open; or NULL */
    enum vault_kind make;        /* of a database that is made or gets its first key */
};

/* store_open(path, mode, key, out, e): ST_ENOTFOUND when there is no such file.  key: NULL
 * for {.make = VAULT_FILE}.  A key's file that is missing is made with a new database.
 * ST_EDENIED: not the database's key; or the database is plaintext although a path or a key
 * is given, or there is OF.key: whoever can write the file could otherwise put one of their
 * own in its place; the same for a transaction that meets another key record.
 * ST_EVERSION: of another version than this program's; STORE_MIGRATE upgrades an older one in
 * one transaction, of which a verified copy is kept: PATH.v3.bak, in which all stands open
 * that did. */
enum status store_open(const char *path, enum store_mode mode,
                       const struct store_key *key, struct store **out,
                       struct errinfo *e);
void store_close(struct store *s); /* NULL is allowed */

/* store_kind(path, kind, e): how the database's master key is kept, which takes no key. */
enum status store_kind(const char *path, enum vault_kind *kind, struct errinfo *e);

struct store_look {
    int version, newest; /* of the schema, 0: it is empty; what this program makes */
    uint64_t subjects, templates, bytes;
};

/* store_look(path, out, e): how old a database is, and how large, which takes no key. */
enum status store_look(const char *path, struct store_look *out, struct errinfo *e);

/* store_in_use(path, pid): has another process the database open?  *pid: one that has, 0 where
 * that is not known.  Not while this process has it open. */
bool store_in_use(const char *path, int64_t *pid);

struct store_rekey {             /* another master key */
    enum vault_kind kind;        /* of it */
    const struct keyfile *given; /* it, or the passphrase; NULL: a random key, or none */
    bool in_file; /* given is kept in the key's file, in place of the old */
    bool keep;    /* the old key's file stays, as PATH.old */
};

/* store_rekey(s, actor, to, e): every subject's key under another master key, in one
 * transaction; an event with it.  The new key lies in PATH.new, on the disk, before that is
 * committed and takes the place of PATH after: whoever opens the database finds it in either,
 * whatever happens in between.  A random key goes into PATH too; the file of an old key that
 * is not replaced is removed: it becomes PATH.new before the commit, because a plaintext
 * database is refused beside PATH.  What was plain before is written anew (VACUUM).
 * ST_EEXISTS: there is PATH.new of a change that was not made, PATH.old, or a PATH that is not
 * this database's key and would be replaced or in the way; nothing was changed.  After ST_EIO the text says what was. */
enum status store_rekey(struct store *s, const char *actor, const struct store_rekey *to,
                        struct errinfo *e);

/* store_use_model(s, m): what is enrolled and calibrated from now on is by this model, which
 * the callers' face_work must be for too.  m is borrowed; NULL, as after store_open():
 * model_default.  Before other threads use s.
 * store_made_by(s): face_engine() of it, s's own. */
void store_use_model(struct store *s, const struct model *m);
const struct model *store_model(const struct store *s);
const char *store_made_by(const struct store *s);

/* store_ready(s, e): can the database be reached, and is its schema this program's?
 * ST_EDENIED: its master key was changed since, and the new one is not known here. */
enum status store_ready(struct store *s, struct errinfo *e);

bool store_subject_valid(const char *subject);
bool store_id_valid(const char *id);

/* store_time_read(text, ms): RFC 3339, "2027-01-31T14:30:00+01:00", or the beginning of a
 * day, "2027-01-31" (UTC), as milliseconds since 1970; false: neither, or before 1970. */
bool store_time_read(const char *text, int64_t *ms);

struct store_template { /* everything about a template but its model */
    char id[STORE_ID_LEN + 1];
    char subject[STORE_SUBJECT_MAX + 1];
    char label[STORE_LABEL_MAX + 1];
    char created[32]; /* RFC 3339, UTC */
    char digest[65];  /* codec_digest(): SHA-256 of the canonical points */
    char engine[FACE_ENGINE_MAX + 1];
    uint32_t points, triangles; /* triangles: real ones, no ghosts */
    struct quality quality;
};

/* store_enroll(s, actor, subject, label, f, t, created, e): encode and store a template,
 * and the subject where it is new; an event with it.  *created is false when the subject
 * has this very cloud (digest) already: then *t describes the one that is there. */
enum status store_enroll(struct store *s, const char *actor, const char *subject,
                         const char *label, const struct face *f,
                         struct store_template *t, bool *created, struct errinfo *e);

/* store_enroll_after(s, actor, subject, label, f, newest, t, created, e): the same for a
 * face that was compared with all of the subject's templates, of which `newest` was the
 * last ("": it had none).  ST_EEXISTS and nothing stored where another is the last by now:
 * then there may be one that it was not compared with, by whatever thread or process. */
enum status store_enroll_after(struct store *s, const char *actor, const char *subject,
                               const char *label, const struct face *f,
                               const char *newest, struct store_template *t,
                               bool *created, struct errinfo *e);

enum status store_template_get(struct store *s, const char *id, struct store_template *t,
                               struct errinfo *e);

/* store_stale(s, t): did another engine make it than s's (store_use_model())?  One stored by
 * another version of the program alone is not stale (face_same_engine()). */
bool store_stale(const struct store *s, const struct store_template *t);

/* store_template_load(s, id, t, w, f, e): the model too, decoded and validated.  Of a stale
 * one *f is made anew from its points (face_rebuild()), for some milliseconds more, and is what
 * it would be after store_renew(); *t is as it is stored.  ST_EVERSION: this engine cannot
 * make a face of them; nothing should be compared with it then. */
enum status store_template_load(struct store *s, const char *id, struct store_template *t,
                                struct face_work *w, struct face *f, struct errinfo *e);

/* store_renew(s, actor, id, w, f, t, renewed, e): a stale template is stored as this engine
 * makes it, under the same id, label, time and digest; an event with it.  *f: memory to use;
 * *t: as it is now.  *renewed is false where it was not stale, or not any more.  Others can
 * use it all the time.  For speed it does not wait for the disk, as store_event(): what a
 * loss of power takes back is stale again, and nothing else.
 * ST_EVERSION, as store_template_load(): it stays as it is. */
enum status store_renew(struct store *s, const char *actor, const char *id,
                        struct face_work *w, struct face *f, struct store_template *t,
                        bool *renewed, struct errinfo *e);

/* store_renew_due(s, out, n, e): the ids of all stale templates, oldest first; a new array
 * released by free().
 * store_renew_count(s, n, e): how many there are.  Both read an index alone. */
enum status store_renew_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                            struct errinfo *e);
enum status store_renew_count(struct store *s, uint64_t *n, struct errinfo *e);

/* store_template_delete(s, actor, id, e): the subject stays, even without templates.
 * ST_EHELD: it is on hold. */
enum status store_template_delete(struct store *s, const char *actor, const char *id,
                                  struct errinfo *e);

/* store_template_list(s, subject, out, n, e): the subject's templates, oldest first; a
 * new array released by free().  ST_ENOTFOUND when there is no such subject. */
enum status store_template_list(struct store *s, const char *subject,
                                struct store_template **out, size_t *n,
                                struct errinfo *e);

#define STORE_NOTE_MAX 128 /* bytes of UTF-8, no control characters */
#define STORE_UID      16

struct store_subject {
    int64_t key;                  /* the order of their coming; never used again */
    unsigned char uid[STORE_UID]; /* random: the same, whatever its id and the database */
    char id[STORE_SUBJECT_MAX + 1];
    char reference[STORE_NOTE_MAX + 1]; /* of the consent; "": none */
    char purpose[STORE_NOTE_MAX + 1];
    char created[32];
    char expires[32]; /* "": never */
    char seen[32];    /* last enrolled or verified, to the minute; "": unknown */
    bool hold;        /* neither it nor a template of it can be deleted */
    bool disabled;    /* not to be verified or identified */
    bool expired;     /* as of when it was read; set by store_subject_get() alone */
    uint32_t templates;
};

/* store_subject_add(s, actor, about, e): a subject without templates: who came with which
 * consent is known before the first scan is taken.  Of *about: id, reference, purpose and
 * expires, which are checked; created is set.  ST_EEXISTS. */
enum status store_subject_add(struct store *s, const char *actor,
                              struct store_subject *about, struct errinfo *e);

enum status store_subject_get(struct store *s, const char *subject,
                              struct store_subject *out, struct errinfo *e);

/* store_subject_list(s, after, limit, out, n, e): up to limit subjects in the order of
 * their coming, those whose key is greater than after (0 from the start); a new array
 * released by free(). */
enum status store_subject_list(struct store *s, int64_t after, size_t limit,
                               struct store_subject **out, size_t *n, struct errinfo *e);

struct store_subject_change {        /* what is NULL stays as it is */
    const char *reference, *purpose; /* "": none */
    const char *expires;             /* store_time_read(); "": never */
    const bool *hold, *disabled;
};

/* store_subject_set(s, actor, subject, what, e): all of it or nothing, with an event for the
 * consent, the hold and the being disabled each.  It is the callers' to verify nobody who is
 * disabled or has expired.  ST_OK also where it is so already. */
enum status store_subject_set(struct store *s, const char *actor, const char *subject,
                              const struct store_subject_change *what, struct errinfo *e);

/* store_subject_rename(s, actor, subject, to, e): another id; all that is known of it stays.
 * ST_EEXISTS: there is one of that id, be it this one. */
enum status store_subject_rename(struct store *s, const char *actor, const char *subject,
                                 const char *to, struct errinfo *e);

/* store_subject_seen(s, one): as it was read, it is seen now.  Noted at most once a minute,
 * and only where that waits neither for the disk nor for anybody who writes. */
void store_subject_seen(struct store *s, const struct store_subject *one);

/* store_subject_due(s, out, n, e): those that have expired, also those on hold, the longest
 * ago first; a new array released by free(). */
enum status store_subject_due(struct store *s, struct store_subject **out, size_t *n,
                              struct errinfo *e);

/* store_subject_delete(s, actor, subject, removed, e): the subject and all its templates;
 * the bytes are overwritten.  removed: how many templates went; may be NULL.
 * ST_EHELD: it is on hold.
 * store_subject_purge(s, actor, subject, e): the same if it has expired; else ST_ENOTFOUND. */
enum status store_subject_purge(struct store *s, const char *actor, const char *subject,
                                struct errinfo *e);
enum status store_subject_delete(struct store *s, const char *actor, const char *subject,
                                 uint32_t *removed, struct errinfo *e);

/* What is left of a subject that was erased, for whoever asked for it: signed, so that it
 * can be shown to somebody else (db/FORMAT.md). */
struct store_receipt {
    char subject[STORE_SUBJECT_MAX + 1];
    char at[32];
    char (*template_id)[STORE_ID_LEN + 1]; /* [templates], oldest first */
    uint32_t templates;
    char digest[65]; /* SHA-256 of all of the above */
    uint64_t seq;    /* of its entry in the audit log, and that one's hash */
    char hash[65];
    char signature[129]; /* Ed25519 of digest, seq and hash */
    char public_key[65]; /* that it is verified with */
};

/* store_subject_erase(s, actor, subject, out, e): as store_subject_delete(); *out is to be
 * released by store_receipt_free(), also on failure. */
enum status store_subject_erase(struct store *s, const char *actor, const char *subject,
                                struct store_receipt *out, struct errinfo *e);
void store_receipt_free(struct store_receipt *r);

/* store_event(s, kind, actor, subject, template_id, outcome, e): append to the events
 * table; no biometrics in it.  kind: "verify", "compare", ...; subject, template_id and
 * outcome may be "".  Changes (enroll, delete, tokens) write their own.
 * For speed it does not wait for the disk: a loss of power may lose the last ones. */
enum status store_event(struct store *s, const char *kind, const char *actor,
                        const char *subject, const char *template_id, const char *outcome,
                        struct errinfo *e);

/* The events are the audit log: a chain of hashes, whose end is proved by the database's
 * key and which is signed here and there (store_chain.h). */
struct store_audit_entry {
    uint64_t seq; /* 1, 2, ... */
    char at[32];
    char kind[STORE_NAME_MAX + 1];
    char actor[STORE_NAME_MAX + 1];
    char subject[STORE_SUBJECT_MAX + 1]; /* "": none, or not here, or names not wanted */
    char ref[33];                        /* keyed hash of the subject's id; "": none */
    char template_id[STORE_ID_LEN + 1];
    char outcome[STORE_NAME_MAX + 1];
    char hash[65];
};

struct store_audit_filter { /* all zero: everything */
    uint64_t after;         /* greater numbers alone */
    size_t limit;           /* 0: as many as there are */
    bool newest;            /* the last ones of them, else the first */
    bool names;             /* find subjects by ref, which takes reading them all */
    const char *subject;    /* also one who was erased */
    const char *kind;
    const char *since; /* RFC 3339, or its beginning */
};

/* store_audit_list(s, filter, out, n, e): entries in their order; a new array released by
 * free().  Nothing of them is verified. */
enum status store_audit_list(struct store *s, const struct store_audit_filter *filter,
                             struct store_audit_entry **out, size_t *n,
                             struct errinfo *e);

struct store_audit_mark { /* a checkpoint: an entry that is signed */
    uint64_t seq;
    char at[32];
    char hash[65];
    char signature[129];
};

/* store_audit_sign(s, actor, kind, out, e): add an event of this kind ("checkpoint" or
 * "export_audit") and sign it.
 * store_audit_marks(s, out, n, e): all that there are, in their order; released by free().
 * store_audit_public(s, public_key, e): what signatures are verified with. */
enum status store_audit_sign(struct store *s, const char *actor, const char *kind,
                             struct store_audit_mark *out, struct errinfo *e);
enum status store_audit_marks(struct store *s, struct store_audit_mark **out, size_t *n,
                              struct errinfo *e);
enum status store_audit_public(struct store *s, char public_key[65], struct errinfo *e);

struct store_audit {
    uint64_t entries, checkpoints, problems;
    uint64_t first; /* the least entry that a problem is about, 0 without any */
};

/* store_audit_verify(s, report, arg, out, e): read-only: every entry and checkpoint as it
 * was written, in its place, none missing.  report() is called once a problem, with the
 * entry that it is about.  About 5 us an entry. */
enum status store_audit_verify(struct store *s,
                               void (*report)(void *arg, uint64_t seq, const char *line),
                               void *arg, struct store_audit *out, struct errinfo *e);

struct store_erased { /* who was erased, by a keyed hash of the id */
    char lookup[65];
    char at[32];
};

/* store_audit_erased(s, subject, out, n, e): everybody, in order of time, or who had this id
 * last, where it is not NULL; a new array released by free(). */
enum status store_audit_erased(struct store *s, const char *subject,
                               struct store_erased **out, size_t *n, struct errinfo *e);

enum store_scope { /* what a token may do, a bit each */
                   STORE_SCOPE_ENROLL = 1,
                   STORE_SCOPE_VERIFY = 2,
                   STORE_SCOPE_IDENTIFY = 4,
                   STORE_SCOPE_READ = 8,
                   STORE_SCOPE_DELETE = 16,
                   STORE_SCOPE_MANAGE = 32, /* consent, expiry, holds, disabled */
                   STORE_SCOPE_DETAIL =
                       64, /* measures and gaps: enough to rebuild a face */
                   STORE_SCOPE_ALL = 127
};

#define STORE_SCOPES_MAX 64 /* bytes of their names, "enroll,verify", with the NUL */

/* store_scopes_read(text, out): one or more names with commas between; false: another.
 * store_scopes_write(scopes, out): the names of those that are set, in the order above. */
bool store_scopes_read(const char *text, unsigned *out);
void store_scopes_write(unsigned scopes, char out[STORE_SCOPES_MAX]);

struct store_token {
    char id[STORE_ID_LEN + 1];
    char name[STORE_NAME_MAX + 1];
    unsigned scopes;    /* enum store_scope */
    char created[32];   /* RFC 3339, UTC, like all times of it */
    char expires[32];   /* "": never */
    char used[32];      /* last, within a minute; "": never */
    char old_until[32]; /* what the secret before the last rotation is good for; "": no */
    bool revoked;
    bool expired; /* as of when it was read */
};

#define STORE_LIFE_MAX (INT64_C(36525) * 86400) /* seconds: a century */

/* store_token_create(s, actor, name, scopes, life_s, secret, t, e): a new Bearer token, good
 * for life_s seconds, 0: for ever; secret is shown once and only its hash is kept. */
enum status store_token_create(struct store *s, const char *actor, const char *name,
                               unsigned scopes, int64_t life_s, char secret[65],
                               struct store_token *t, struct errinfo *e);

/* store_token_rotate(s, actor, id, grace_s, life_s, secret, t, e): another secret for the
 * token; the one it had is good for another grace_s seconds, and one before that no more.
 * life_s: from now on, 0: for ever, negative: it expires when it would have.
 * ST_EDENIED: it was revoked. */
enum status store_token_rotate(struct store *s, const char *actor, const char *id,
                               int64_t grace_s, int64_t life_s, char secret[65],
                               struct store_token *t, struct errinfo *e);
enum status store_token_list(struct store *s, struct store_token **out, size_t *n,
                             struct errinfo *e);

/* store_token_revoke(s, actor, id, e): ST_OK also when it was revoked before. */
enum status store_token_revoke(struct store *s, const char *actor, const char *id,
                               struct errinfo *e);

/* store_token_check(s, secret, t, e): ST_OK and the token, or ST_EDENIED for an unknown,
 * malformed, expired or revoked one.  Compared in constant time.  Sees what was rotated or
 * revoked at once.  Notes at most once a minute that the token is in use, and only where
 * that waits neither for the disk nor for anybody who writes. */
enum status store_token_check(struct store *s, const char *secret, struct store_token *t,
                              struct errinfo *e);

/* Verifications of a subject that failed one after the other; what follows from them is the
 * caller's to say. */
struct store_attempts {
    char subject[STORE_SUBJECT_MAX + 1];
    uint32_t failures;
    char at[32];    /* the last one */
    int64_t age_ms; /* since it, never negative; by store_attempts_get() alone */
};

/* store_attempts_get(s, subject, out, e): failures is 0 where there are none.  A last
 * failure that lies in the future (the clock was set back) is moved to now for good, so
 * that whoever waits from it on does not wait for ever.  ST_ENOTFOUND: no such subject. */
enum status store_attempts_get(struct store *s, const char *subject,
                               struct store_attempts *out, struct errinfo *e);

/* store_attempts_fail(s, subject, e): one more, now.  store_attempts_clear(s, subject, e):
 * no more.  For speed neither waits for the disk, as store_event(). */
enum status store_attempts_fail(struct store *s, const char *subject, struct errinfo *e);
enum status store_attempts_clear(struct store *s, const char *subject, struct errinfo *e);

/* store_attempts_reset(s, actor, subject, e): no more, by somebody's order. */
enum status store_attempts_reset(struct store *s, const char *actor, const char *subject,
                                 struct errinfo *e);

/* store_attempts_list(s, out, n, e): of all subjects that have some, in the order of their
 * coming; a new array released by free(). */
enum status store_attempts_list(struct store *s, struct store_attempts **out, size_t *n,
                                struct errinfo *e);

struct store_calibration {
    int64_t version;  /* 1, 2, ...: the greatest is in force */
    char created[32]; /* RFC 3339, UTC */
    char actor[STORE_NAME_MAX + 1];
    char engine[FACE_ENGINE_MAX + 1]; /* that made it: it holds for no other measure, and
                                         for no other model */
    bool shipped;                     /* back to the table that comes with the program */
    double fmr;                       /* the false match rate that was wanted */
    double low_mm, high_mm;           /* 95 % interval of the threshold */
    uint64_t subjects;                /* people whose templates were compared */
    uint64_t impostors; /* comparisons of different people, and of the same */
    uint64_t genuine;
    struct decision decision; /* valid */
    bool ignored; /* set by calibration_in_force() alone: it is the newest, but made by
                     another engine, so that it does not decide */
};

/* store_calibration_add(s, actor, k, e): append *k, whose version, time, actor and engine
 * are set here; an event with it.  ST_EINVAL: its numbers are impossible. */
enum status store_calibration_add(struct store *s, const char *actor,
                                  struct store_calibration *k, struct errinfo *e);

/* store_calibration_get(s, k, e): the newest; ST_ENOTFOUND when there never was one. */
enum status store_calibration_get(struct store *s, struct store_calibration *k,
                                  struct errinfo *e);

/* store_calibration_version(s, version, e): the newest one's version, 0 for none, without
 * reading it: some microseconds. */
enum status store_calibration_version(struct store *s, int64_t *version,
                                      struct errinfo *e);

/* store_calibration_list(s, out, n, e): all, oldest first; released by free(). */
enum status store_calibration_list(struct store *s, struct store_calibration **out,
                                   size_t *n, struct errinfo *e);

struct store_stats {
    uint64_t subjects, templates, points, template_bytes, file_bytes, events, tokens;
    uint32_t schema;
};

enum status store_stats(struct store *s, struct store_stats *out, struct errinfo *e);

/* store_vacuum(s, e): write the database anew, without the room that deleted rows left, while
 * others read it; who writes waits, up to 5 s. */
enum status store_vacuum(struct store *s, struct errinfo *e);

struct store_check {
    uint64_t templates, bad_templates, events, problems;
};

/* store_check(s, report, arg, out, e): read-only: SQLite's integrity and foreign keys,
 * every calibration valid, every template decoded, its triangulation Delaunay and its tree
 * minimal, its digest and counts right, the audit log (store_audit_verify()).  report() is
 * called once a problem with one line of text, by one thread at a time.  About 2.5 ms a
 * template of 3,000 points, shared among as many threads as there are cores. */
enum status store_check(struct store *s, void (*report)(void *arg, const char *line),
                        void *arg, struct store_check *out, struct errinfo *e);

struct store_copied { /* what is in a copy that was verified */
    uint64_t subjects, templates, events, bytes;
};

/* store_backup(s, path, key, out, e): a copy of one moment while others write, whole or not
 * at all and readable by its owner alone.  Before it gets its name it is verified: pages,
 * every subject and template opened with its key, the end of the events.  An older backup of
 * that name is replaced; another file is not (ST_EEXISTS).  key: as the store was opened by,
 * with its path.  Of the database's other errors ST_ECORRUPT: what is damaged in it. */
enum status store_backup(struct store *s, const char *path, const struct store_key *key,
                         struct store_copied *out, struct errinfo *e);

struct store_restored {
    struct store_copied backup; /* as it was verified, before anybody was erased again */
    bool was_there;             /* there was a database, and it is PATH.before-restore */
    uint64_t had_subjects, had_templates; /* it had so many */
    uint64_t lost;    /* subjects of it that the backup does not have */
    uint64_t erased;  /* subjects of the backup that were erased since */
    uint64_t revoked; /* tokens of the backup that were revoked since */
};

/* store_restore(path, from, key, actor, dry, out, e): the backup in the place of the
 * database, which is kept as PATH.before-restore, or with dry nothing but *out.  Who was
 * erased since, under whatever id, is erased; tokens keep the secrets that they have, and are
 * revoked if they are.  A database that is missing is made.
 * ST_EBUSY: another process has the database open; ST_EMISMATCH: it is another database's
 * backup; ST_EEXISTS: there is a PATH.before-restore of a restore that
 * came to its end (one of a restore that was killed is replaced); as store_open() and store_backup(). */
enum status store_restore(const char *path, const char *from, const struct store_key *key,
                          const char *actor, bool dry, struct store_restored *out,
                          struct errinfo *e);

struct store_exported {
    uint64_t subjects, templates, bytes;
};

/* store_export(s, actor, subjects, n, path, k, out, e): subjects and their templates, of n
 * ids or all where n is 0, into a new archive (db/FORMAT.md), sealed with k as
 * archive_create(); an event of each.  Whole or not at all.  ST_EEXISTS: there is a file of
 * that name; ST_ENOTFOUND: no such subject. */
enum status store_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct keyfile *k,
                         struct store_exported *out, struct errinfo *e);

struct store_imported {
    uint64_t subjects, templates;         /* of the archive */
    uint64_t new_subjects, new_templates; /* the others are there already */
    uint64_t erased; /* were erased here: left out, with their templates */
    uint64_t stale;  /* of the templates: of another engine */
};

/* store_import(s, actor, path, k, dry, out, e): an archive as a whole, or nothing of it;
 * what is there already is left as it is, also who has another id here by now.  Left out is
 * who was erased here, under whatever id, and whose id somebody had who was erased, unless
 * there is one of that id again.  All of it is verified first; with dry nothing else is
 * done.  Templates of another engine are taken as they are, and stale.
 * ST_EVERSION: an archive or a template's model of a newer version; ST_EEXISTS: a template's
 * id is another's here; as archive_read(). */
enum status store_import(struct store *s, const char *actor, const char *path,
                         const struct keyfile *k, bool dry, struct store_imported *out,
                         struct errinfo *e);

#endif
