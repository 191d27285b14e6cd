/* store_engine.h -- what a database must do to stand behind store.h.
 * store.c checks arguments, encodes and decodes models, makes ids, times and secrets; an
 * engine keeps rows.  Each call is one transaction.  Same errors as store.h. */
#ifndef DB_STORE_ENGINE_H
#define DB_STORE_ENGINE_H
#include <stdbool.h>
#include <stddef.h>
#include "store.h"

#define STORE_HASH_LEN 32 /* bytes of a token's hash */

struct store { /* the first member of an engine's own struct */
    const struct store_engine *engine;
    const struct model *model; /* store_use_model() */
    char made_by[FACE_ENGINE_MAX + 1];
};

struct store_act { /* who changes something, and when */
    const char *actor;
    int64_t ms; /* since 1970, UTC */
    char at[32];
};

/* Receives one template; model is valid during the call only.  Its status ends the
 * reading where it is not ST_OK. */
typedef enum status store_use(void *arg, const struct store_template *t,
                              const void *model, size_t len, struct errinfo *e);

struct store_edit { /* of a subject; what is NULL stays as it is */
    const char *id, *reference, *purpose, *expires;
    const bool *hold, *disabled;
    struct {
        const char *kind, *outcome;
    } event[3];
    int events; /* 1.. */
};

struct store_archive_item; /* store_archive.h */

/* The next record of an archive, up to and with its end; *out is good until the next call. */
typedef enum status store_next(void *arg, struct store_archive_item **out,
                               struct errinfo *e);

typedef void store_report(void *arg, const char *line);

struct store_engine {
    void (*close)(struct store *s);
    enum status (*ready)(struct store *s, struct errinfo *e);

    enum status (*rekey)(struct store *s, const struct store_act *by,
                         const struct store_rekey *to, struct errinfo *e);

    /* Add *t, complete, and its subject where it is new; or, where the subject has its
     * digest already, make *t the template that is there and *created false.
     * newest: NULL, or the id that the subject's newest template must have ("": none). */
    enum status (*template_add)(struct store *s, const struct store_act *by,
                                struct store_template *t, const char *newest,
                                const void *model, size_t len, bool *created,
                                struct errinfo *e);
    /* use may be NULL: then the model is not read. */
    enum status (*template_read)(struct store *s, const char *id,
                                 struct store_template *t, store_use *use, void *arg,
                                 struct errinfo *e);
    /* Every template of one snapshot, or the part'th of so many shares of them, from 0 on; a
     * malformed row is reported and passed over. */
    enum status (*template_each)(struct store *s, unsigned part, unsigned parts,
                                 store_use *use, store_report *report, void *arg,
                                 struct errinfo *e);
    /* The model, engine, quality and number of triangles of *t in the place of what is
     * there; *done is false where that is of t->engine already. */
    enum status (*template_renew)(struct store *s, const struct store_act *by,
                                  const struct store_template *t, const void *model,
                                  size_t len, bool *done, struct errinfo *e);
    /* The ids of those made by none that face_same_engine() as engine; out may be NULL. */
    enum status (*template_stale)(struct store *s, const char *engine,
                                  char (**out)[STORE_ID_LEN + 1], size_t *n,
                                  struct errinfo *e);
    enum status (*template_delete)(struct store *s, const struct store_act *by,
                                   const char *id, struct errinfo *e);
    enum status (*template_list)(struct store *s, const char *subject,
                                 struct store_template **out, size_t *n,
                                 struct errinfo *e);
    enum status (*subject_add)(struct store *s, const struct store_act *by,
                               const struct store_subject *about, struct errinfo *e);
    enum status (*subject_get)(struct store *s, const char *subject,
                               struct store_subject *out, struct errinfo *e);
    enum status (*subject_list)(struct store *s, int64_t after, size_t limit,
                                struct store_subject **out, size_t *n, struct errinfo *e);
    /* With its events; ST_EEXISTS: another has the new id. */
    enum status (*subject_edit)(struct store *s, const struct store_act *by,
                                const char *subject, const struct store_edit *edit,
                                struct errinfo *e);
    /* Note that it was seen; not when that would have to wait for anyone. */
    enum status (*subject_seen)(struct store *s, const char *subject, const char *at,
                                struct errinfo *e);
    /* Those whose end is not after that time, in the order of their ends. */
    enum status (*subject_due)(struct store *s, const char *at,
                               struct store_subject **out, size_t *n, struct errinfo *e);
    /* due: only if its end is not after by->at, or ST_ENOTFOUND.  ST_EHELD. */
    enum status (*subject_delete)(struct store *s, const struct store_act *by,
                                  const char *subject, bool due,
                                  struct store_receipt *out, struct errinfo *e);

    enum status (*event)(struct store *s, const struct store_act *by, const char *kind,
                         const char *subject, const char *template_id,
                         const char *outcome, struct errinfo *e);
    enum status (*audit_list)(struct store *s, const struct store_audit_filter *filter,
                              struct store_audit_entry **out, size_t *n,
                              struct errinfo *e);
    enum status (*audit_sign)(struct store *s, const struct store_act *by,
                              const char *kind, struct store_audit_mark *out,
                              struct errinfo *e);
    enum status (*audit_marks)(struct store *s, struct store_audit_mark **out, size_t *n,
                               struct errinfo *e);
    enum status (*audit_public)(struct store *s, char public_key[65], struct errinfo *e);
    enum status (*audit_verify)(struct store *s,
                                void (*report)(void *arg, uint64_t seq, const char *line),
                                void *arg, struct store_audit *out, struct errinfo *e);
    enum status (*audit_erased)(struct store *s, const char *subject,
                                struct store_erased **out, size_t *n, struct errinfo *e);
    enum status (*token_add)(struct store *s, const struct store_act *by,
                             const struct store_token *t,
                             const unsigned char hash[STORE_HASH_LEN], struct errinfo *e);
    enum status (*token_list)(struct store *s, struct store_token **out, size_t *n,
                              struct errinfo *e);
    enum status (*token_get)(struct store *s, const char *id, struct store_token *t,
                             struct errinfo *e);
    enum status (*token_revoke)(struct store *s, const struct store_act *by,
                                const char *id, struct errinfo *e);
    /* The hash becomes the old one until t->old_until, another the token's, and it expires
     * at t->expires. */
    enum status (*token_rotate)(struct store *s, const struct store_act *by,
                                const struct store_token *t,
                                const unsigned char hash[STORE_HASH_LEN],
                                struct errinfo *e);
    /* The token with this hash, and the hash as it is kept; *old: it is the one before the
     * last rotation.  ST_ENOTFOUND. */
    enum status (*token_find)(struct store *s, const unsigned char hash[STORE_HASH_LEN],
                              struct store_token *t, unsigned char kept[STORE_HASH_LEN],
                              bool *old, struct errinfo *e);
    /* Note that it was used; not when that would have to wait for anyone. */
    enum status (*token_use)(struct store *s, const char *id, const char *at,
                             struct errinfo *e);

    /* 0 failures where there is no row.  ST_ENOTFOUND: no such subject. */
    enum status (*attempts_get)(struct store *s, const char *subject, uint32_t *failures,
                                int64_t *at_ms, struct errinfo *e);
    enum status (*attempts_list)(struct store *s, struct store_attempts **out, size_t *n,
                                 struct errinfo *e);
    /* One failure more, at that time. */
    enum status (*attempts_fail)(struct store *s, const char *subject, int64_t at_ms,
                                 struct errinfo *e);
    /* The last failure was no later than at_ms. */
    enum status (*attempts_since)(struct store *s, const char *subject, int64_t at_ms,
                                  struct errinfo *e);
    /* No failures any more; by: with an event, and on the disk; or NULL. */
    enum status (*attempts_clear)(struct store *s, const struct store_act *by,
                                  const char *subject, struct errinfo *e);

    /* Append *k, complete but for its version, which is set. */
    enum status (*calibration_add)(struct store *s, const struct store_act *by,
                                   struct store_calibration *k, struct errinfo *e);
    enum status (*calibration_get)(struct store *s, struct store_calibration *k,
                                   struct errinfo *e);
    enum status (*calibration_version)(struct store *s, int64_t *version,
                                       struct errinfo *e);
    enum status (*calibration_list)(struct store *s, struct store_calibration **out,
                                    size_t *n, struct errinfo *e);

    enum status (*vacuum)(struct store *s, struct errinfo *e);
    enum status (*stats)(struct store *s, struct store_stats *out, struct errinfo *e);
    /* As store_backup(). */
    enum status (*backup)(struct store *s, const char *path, const struct store_key *key,
                          struct store_copied *out, struct errinfo *e);
    /* As store_import(), of records that were verified. */
    enum status (*import)(struct store *s, const struct store_act *by, store_next *next,
                          void *arg, bool dry, struct store_imported *out,
                          struct errinfo *e);
    /* The database's own structure (pages, indexes, references, schema), and the rows of
     * calibrations. */
    enum status (*check)(struct store *s, store_report *report, void *arg,
                         struct errinfo *e);
};

#endif
