/* store_types.h -- what a store is told and tells.  Strings are UTF-8 without NUL; times are
 * RFC 3339 text, UTC, of fixed length, so that they compare like their texts. */
#ifndef DB_STORE_TYPES_H
#define DB_STORE_TYPES_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "face.h"
#include "status.h"
#include "vault.h"

struct errinfo;
struct keyfile; /* keyfile.h */
struct model;   /* model.h */
struct store;   /* store_open.h */

#define STORE_SUBJECT_MAX 128 /* A-Z a-z 0-9 . _ - @ : */
#define STORE_ID_LEN      32  /* template and token ids: 128 random bits in hex */
#define STORE_LABEL_MAX   256 /* bytes of UTF-8, no control characters */
#define STORE_NAME_MAX    64  /* of a token or an actor, printable ASCII */
#define STORE_NOTE_MAX    128 /* bytes of UTF-8, no control characters */
#define STORE_UID         16

/* Of a subject, at most: each takes time of each verification, and is one more chance for a
 * false match. */
#define STORE_TEMPLATES_MAX 20

enum store_mode {
    STORE_READ,   /* changes are refused with ST_EDENIED */
    STORE_WRITE,  /* the database must be there */
    STORE_CREATE, /* made if it is missing or empty, readable by its owner alone */
    STORE_BEGIN,  /* the same where there is no key of it either */
    STORE_MIGRATE /* the database must be there; one of an older version is upgraded */
};

struct store_key {               /* where the master key of vault.h comes from */
    const char *path;            /* its file; NULL: OF.key, if there is one */
    const char *of;              /* NULL: the database that is opened, else another */
    const struct keyfile *given; /* instead of a file, while the store is open; or NULL */
    enum vault_kind make;        /* of a database that is made or gets its first key */
    /* the database is plaintext, which is refused otherwise; and no other */
    bool plaintext;
    const char *anchor; /* its file; NULL: beside the key (store_anchor.h) */
    bool copy;          /* the anchor is not asked: the file is a copy of the database */
    bool weak;          /* a passphrase of few characters may be made */
};

struct store_look {
    int version, newest; /* of the schema, 0: it is empty; what this program makes */
    uint64_t subjects, templates, bytes;
};

struct store_rekey {             /* another master key */
    enum vault_kind kind;        /* of it */
    const struct keyfile *given; /* it, or the passphrase; NULL: a random key, or none */
    bool in_file;     /* given is kept in the key's file, in place of the old */
    bool keep;        /* the old key's file stays, as PATH.old */
    bool weak;        /* a passphrase may have few characters */
    bool compromised; /* every other secret anew too: others know the old ones */
};

struct store_template { /* everything about a template but its model */
    char id[STORE_ID_LEN + 1];
    char subject[STORE_SUBJECT_MAX + 1];
    char label[STORE_LABEL_MAX + 1];
    char created[32]; /* RFC 3339, UTC */
    char digest[65];  /* codec_digest(): SHA-256 of the canonical points */
    char engine[FACE_ENGINE_MAX + 1];
    uint32_t points, triangles; /* triangles: real ones, no ghosts */
    struct quality quality;
    bool manager; /* enrolled with scope manage: further samples are held against it */
    double first_score; /* when it was enrolled, against the subject's oldest template; 0:
                           it was the first */
};

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
    /* as of when it was read; set by store_subject_get() and store_admit() */
    bool expired;
    uint32_t templates;
};

struct store_subject_change {        /* what is NULL stays as it is */
    const char *reference, *purpose; /* "": none */
    const char *expires;             /* utc_read(); "": never */
    const bool *hold, *disabled;
};

/* What is left of a subject that was erased, for the person who asked for it: signed, so
 * that others can verify it (db/FORMAT.md). */
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

enum store_chain { /* of the audit log; stored, so never renumbered */
                   STORE_CHAIN_CHANGES, /* what changes the database's state; kept */
                   STORE_CHAIN_USES,    /* verifications, refusals, exports */
                   STORE_CHAINS
};

struct store_audit_entry {
    enum store_chain chain;
    uint64_t seq; /* in its chain: 1, 2, ... */
    char at[32];
    char kind[STORE_NAME_MAX + 1];
    char actor[STORE_NAME_MAX + 1];
    char subject[STORE_SUBJECT_MAX + 1]; /* "": none, or not here, or names not wanted */
    char ref[33];                        /* keyed hash of the subject's id; "": none */
    char template_id[STORE_ID_LEN + 1];
    char outcome[STORE_NAME_MAX + 1];
    char object[33], row[65]; /* of changes: whose row, and its MAC; "": none */
    uint64_t uses;            /* of changes: the last of the uses, and its hash */
    char uses_hash[65];
    char hash[65];
};

struct store_audit_filter {        /* all zero: everything */
    const enum store_chain *chain; /* NULL: both, in the order of their coming */
    uint64_t after;                /* greater numbers alone, of a chain */
    size_t limit;                  /* 0: as many as there are */
    bool newest;                   /* the last ones of them, else the first */
    bool names;          /* find subjects by ref, which takes reading them all */
    const char *subject; /* also one that was erased */
    const char *kind;
    const char *since; /* RFC 3339, or its beginning */
};

struct store_audit_mark { /* a checkpoint: an entry that is signed */
    enum store_chain chain;
    uint64_t seq;
    char at[32];
    char hash[65];
    char signature[129];
};

struct store_audit {
    uint64_t entries, checkpoints, problems;
    uint64_t first;         /* the least entry that a problem is about, 0 without any, */
    enum store_chain chain; /* and the chain that it is in */
};

struct store_erased { /* a subject that was erased, by a keyed hash of the id */
    char ref[33];
    char at[32];
};

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

#define STORE_DEVICE_MAX 32 /* of its name, A-Z a-z 0-9 . _ - @ : */

struct store_device { /* a scanner that signs what it captures */
    char id[STORE_ID_LEN + 1];
    char name[STORE_DEVICE_MAX + 1];
    unsigned char public[VAULT_KEY]; /* Ed25519 */
    char created[32];                /* RFC 3339, UTC */
};

#define STORE_LIFE_MAX (INT64_C(36525) * 86400) /* seconds: a century */

#define STORE_TRIED_MS                                                                   \
    INT64_C(3600000) /* in which the subjects count that a token tries */
#define STORE_TRIED_WARN_MS INT64_C(86400000) /* and in which for a warning */
#define STORE_ATTEMPTS_DAYS                                                              \
    30 /* after which failures count no more: at one a day, where lock-outs end, more \
          attempts are left than after them */

/* Verifications of a subject that failed one after the other; what follows from them is the
 * caller's to say.  Ages are never negative. */
struct store_attempts {
    char subject[STORE_SUBJECT_MAX + 1];
    char token[STORE_NAME_MAX + 1]; /* whose they are; "": without one */
    uint32_t failures;              /* of this token */
    char at[32];                    /* the last one */
    int64_t age_ms;                 /* since it */
    /* Not set by store_attempts_list(): */
    uint32_t others; /* of all other tokens that failed in the last STORE_TRIED_MS */
    int64_t others_age_ms; /* since the last of them */
    uint32_t tried; /* other subjects whose last verification by this token failed, in
                               the last STORE_TRIED_MS */
    int64_t tried_age_ms; /* since the first of them */
    uint32_t tried_warn;  /* as tried, in the last STORE_TRIED_WARN_MS */
};

/* A probe that matched, by the points as they were read and used: 64 hexadecimal digits each,
 * functions of the set of points alone. */
struct store_probe {
    const char *read;
    char used[65]; /* codec_digest(); "": they are no template's */
};

struct store_calibration {
    int64_t version;  /* 1, 2, ...: the greatest is in force */
    char created[32]; /* RFC 3339, UTC */
    char actor[STORE_NAME_MAX + 1];
    char engine[FACE_ENGINE_MAX + 1]; /* that made it: it holds for no other measure, and
                                         for no other model */
    bool shipped;                     /* back to the table that comes with the program */
    double fmr;                       /* the false match rate that was wanted */
    double low, high;                 /* 95 % interval of the threshold */
    uint64_t subjects;                /* people whose templates were compared */
    uint64_t impostors; /* comparisons of different people, and of the same */
    uint64_t genuine;
    struct calibration table; /* valid */
    bool ignored; /* set by in_force_get() alone: it is the newest, but made by
                     another engine, so that it does not decide */
};

struct store_stats {
    uint64_t subjects, templates, points, template_bytes, file_bytes, events, tokens;
    uint32_t schema;
};

struct store_check {
    uint64_t templates, bad_templates, events, problems;
};

struct store_copied { /* what is in a copy that was verified */
    uint64_t subjects, templates, events, bytes;
};

struct store_restored {
    /* as it was verified, before subjects were erased again */
    struct store_copied backup;
    bool was_there; /* there was a database, and it is PATH.before-restore */
    uint64_t had_subjects, had_templates; /* it had so many */
    uint64_t lost;    /* subjects of it that the backup does not have */
    uint64_t erased;  /* subjects of the backup that were erased since */
    uint64_t revoked; /* tokens of the backup that were revoked since */
};

struct store_exported {
    uint64_t subjects, templates, bytes;
};

struct store_imported {
    uint64_t subjects, templates;         /* of the archive */
    uint64_t new_subjects, new_templates; /* the others are there already */
    uint64_t erased;   /* were erased here: left out, with their templates */
    uint64_t outdated; /* of the templates: of another engine */
};

#endif
