/* store_sqlite.h -- the parts of the SQLite engine, among themselves.
 * One connection writes, under a lock; readers have a connection each while they read, and
 * in WAL mode neither waits for the other.  Statements are prepared once a connection.
 *   store_sqlite.c        opening, readers, transactions
 *   store_sqlite_conn.c   a connection: errors, statements
 *   store_sqlite_engine.c the table of all calls
 *   store_sqlite_schema.c the tables: made, upgraded, compared
 *   store_sqlite_face.c   templates
 *   store_sqlite_subject.c  subjects
 *   store_sqlite_edit.c   subjects changed
 *   store_sqlite_vault.c  keys
 *   store_sqlite_rekey.c  another master key
 *   store_sqlite_use.c    who has it open
 *   store_sqlite_event.c  events: the end of the chain
 *   store_sqlite_audit.c  events read and verified
 *   store_sqlite_convert.c  the rows of older versions
 *   store_sqlite_admin.c  statistics, check
 *   store_sqlite_backup.c  copies, verified
 *   store_sqlite_restore.c  a copy in the place of the database
 *   store_sqlite_import.c  an archive's rows
 *   store_sqlite_renew.c  templates made anew by another engine
 *   store_sqlite_token.c  tokens
 *   store_sqlite_attempts.c  failed verifications
 *   store_sqlite_calibration.c  calibrations
 *   store_sqlite_rows.c   columns, proofs, lists
 *   store_sqlite_sql.c    the statements' text */
#ifndef DB_STORE_SQLITE_H
#define DB_STORE_SQLITE_H
#include <pthread.h>
#include <sqlite3.h>
#include "store_chain.h"
#include "store_engine.h"
#include "store_seal.h"

#define STORE_SQLITE_SCHEMA  4    /* user_version in schema.sql */
#define STORE_SQLITE_BUSY_MS 5000 /* waited for other threads and processes together */

enum store_sqlite_sql {
    SQL_BEGIN,
    SQL_BEGIN_READ,
    SQL_COMMIT,
    SQL_ROLLBACK,
    SQL_VERSION,
    SQL_ROOT_VERSION,
    SQL_ROOT_GET,
    SQL_ROOT_SET,
    SQL_KEY_LIST,
    SQL_KEY_SET,
    SQL_SUBJECT_FIND,
    SQL_SUBJECT_SAME,
    SQL_SUBJECT_ADD,
    SQL_SUBJECT_GET,
    SQL_SUBJECT_LIST,
    SQL_SUBJECT_ALL,
    SQL_SUBJECT_DUE,
    SQL_SUBJECT_EDIT,
    SQL_SUBJECT_SEEN,
    SQL_SUBJECT_DELETE,
    SQL_TEMPLATE_ADD,
    SQL_TEMPLATE_GET,
    SQL_TEMPLATE_LOAD,
    SQL_TEMPLATE_SAME,
    SQL_TEMPLATE_NEWEST,
    SQL_TEMPLATE_LIST,
    SQL_TEMPLATE_EACH,
    SQL_TEMPLATE_IDS,
    SQL_TEMPLATE_DELETE,
    SQL_TEMPLATE_RENEW,
    SQL_TEMPLATE_STALE,
    SQL_TEMPLATE_STALE_COUNT,
    SQL_EVENT_ADD,
    SQL_EVENT_END,
    SQL_EVENT_SET_END,
    SQL_EVENT_LIST,
    SQL_EVENT_NEWEST,
    SQL_EVENT_EACH,
    SQL_EVENT_ERASED,
    SQL_MARK_ADD,
    SQL_MARK_GET,
    SQL_MARK_LIST,
    SQL_MARK_ALONE,
    SQL_ERASED_LIST,
    SQL_ERASED_ADD,
    SQL_ERASED_NOTE,
    SQL_ERASED_UID,
    SQL_ERASED_LOOKUP,
    SQL_TOKEN_ADD,
    SQL_TOKEN_LIST,
    SQL_TOKEN_GET,
    SQL_TOKEN_REVOKE,
    SQL_TOKEN_ROTATE,
    SQL_TOKEN_FIND,
    SQL_TOKEN_PROVE,
    SQL_TOKEN_USE,
    SQL_ATTEMPTS_GET,
    SQL_ATTEMPTS_LIST,
    SQL_ATTEMPTS_FAIL,
    SQL_ATTEMPTS_SINCE,
    SQL_ATTEMPTS_CLEAR,
    SQL_CALIBRATION_ADD,
    SQL_CALIBRATION_GET,
    SQL_CALIBRATION_PROVE,
    SQL_CALIBRATION_END,
    SQL_CALIBRATION_END_PROVE,
    SQL_CALIBRATION_VERSION,
    SQL_CALIBRATION_LIST,
    SQL_STATS,
    SQL_COUNT
};

struct store_sqlite_conn {
    sqlite3 *db;
    const struct vault *vault; /* of what the transaction sees */
    sqlite3_stmt *stmt[SQL_COUNT];
    struct store_sqlite_conn *next; /* in the list of those at rest */
};

extern const char *const store_sqlite_sql[SQL_COUNT]; /* their text */

extern const struct store_engine store_sqlite_engine;

/* store_sqlite_open(path, mode, key, out, e): as store_open(). */
enum status store_sqlite_open(const char *path, enum store_mode mode,
                              const struct store_key *key, struct store **out,
                              struct errinfo *e);

void store_sqlite_close(struct store *s);
enum status store_sqlite_ready(struct store *s, struct errinfo *e);

/* store_sqlite_kind(path, kind, e): as store_kind(). */
enum status store_sqlite_kind(const char *path, enum vault_kind *kind, struct errinfo *e);

/* store_sqlite_connect(path, flags, alone, out, e): a connection outside of any store, to be
 * closed by store_sqlite_disconnect() (NULL is allowed).  alone: nobody else has the database
 * open, or can read it while this connection is; ST_EBUSY. */
enum status store_sqlite_connect(const char *path, int flags, bool alone,
                                 struct store_sqlite_conn **out, struct errinfo *e);
void store_sqlite_disconnect(struct store_sqlite_conn *c);

/* store_sqlite_has_log(path): is there a log of the database, with something in it?  Another
 * file under that name would be taken for what it was written of. */
bool store_sqlite_has_log(const char *path);

/* store_sqlite_vault.c: vaults are kept until the store is closed, so that a transaction
 * that began before another process changed the master key ends with the one it knows. */
#define STORE_SQLITE_VAULTS 64 /* changes of the master key while a store is open */

struct store_sqlite_vaults {
    pthread_mutex_t lock;
    struct vault *list[STORE_SQLITE_VAULTS];
    int n; /* the newest is the last */
    char *
        path; /* of the key; and ".new", where the next one is until it is in its place */
    bool
        named; /* by the caller: the database must have a key, whether or not it is there */
    const struct keyfile *given;
    enum vault_kind make;
    bool made; /* the key's file is new */
};

enum status store_sqlite_vault_init(struct store_sqlite_vaults *v, const char *db,
                                    const struct store_key *key, struct errinfo *e);
/* store_sqlite_vault_kind(c, kind, e): of the key record. */
enum status store_sqlite_vault_kind(struct store_sqlite_conn *c, enum vault_kind *kind,
                                    struct errinfo *e);
void store_sqlite_vault_free(struct store_sqlite_vaults *v);

/* store_sqlite_vault_new(v, c, e): a first master key for the database, whose transaction
 * is open; if that is rolled back, store_sqlite_vault_undo(v) removes a new key's file. */
enum status store_sqlite_vault_new(struct store_sqlite_vaults *v,
                                   struct store_sqlite_conn *c, struct errinfo *e);
void store_sqlite_vault_undo(struct store_sqlite_vaults *v);

/* store_sqlite_vault_use(v, c, e): c->vault is the one of what c's transaction sees.
 * Returns ST_OK, ST_EDENIED: not the key of the database, or it is plaintext where a key is
 * expected; as keyfile_read(). */
enum status store_sqlite_vault_use(struct store_sqlite_vaults *v,
                                   struct store_sqlite_conn *c, struct errinfo *e);

struct store_sqlite_vaults *store_sqlite_vaults(struct store *s);

/* store_sqlite_vault_read(c, r, e), ..._write(c, r, e): the key record.
 * store_sqlite_vault_fits(path, r): does the file open it?
 * store_sqlite_vault_keep(v, vault, e): is the one of its version from now on; taken over. */
enum status store_sqlite_vault_read(struct store_sqlite_conn *c, struct vault_root *r,
                                    struct errinfo *e);
enum status store_sqlite_vault_write(struct store_sqlite_conn *c,
                                     const struct vault_root *r, struct errinfo *e);
bool store_sqlite_vault_fits(const char *path, const struct vault_root *r);
enum status store_sqlite_vault_keep(struct store_sqlite_vaults *v, struct vault *vault,
                                    struct errinfo *e);

/* store_sqlite_use.c: as store_in_use(). */
bool store_sqlite_in_use(const char *path, int64_t *pid);

/* store_sqlite_rekey.c */
enum status store_sqlite_rekey(struct store *s, const struct store_act *by,
                               const struct store_rekey *to, struct errinfo *e);

/* store_sqlite_write(s, synced, c, e): wait for the writer's connection and begin a
 * transaction; ST_EBUSY when other threads and processes are in the way for 5 s; synced: it
 * is on the disk when it is committed, else it survives a crash of the program but the next
 * loss of power perhaps not.
 * After ST_OK store_sqlite_written(s, st, e) must follow: it commits when st is ST_OK,
 * else rolls back, and returns st or why the commit failed.  It also cuts the log of an
 * erasure, of any process, that a reader had kept from it (store_sqlite_erase_log()). */
enum status store_sqlite_write(struct store *s, bool synced, struct store_sqlite_conn **c,
                               struct errinfo *e);
enum status store_sqlite_written(struct store *s, enum status st, struct errinfo *e);

/* store_sqlite_try(s, c, e): the same, not synced, but ST_EBUSY at once where it would have
 * to wait for another thread or another process. */
enum status store_sqlite_try(struct store *s, struct store_sqlite_conn **c,
                             struct errinfo *e);

/* store_sqlite_erase_log(s): bring the log into the database file and empty it, where no
 * reader is in the way, so that deleted bytes are gone from both; else the next
 * changes of this or another process try again. */
void store_sqlite_erase_log(struct store *s);

/* store_sqlite_rewrite(s, e): the whole file anew, so that nothing is in it but its rows. */
enum status store_sqlite_rewrite(struct store *s, struct errinfo *e);

/* store_sqlite_read(s, c, e): a reader's connection in a transaction, so that all it reads
 * is of one moment; given back by store_sqlite_done(). */
enum status store_sqlite_read(struct store *s, struct store_sqlite_conn **c,
                              struct errinfo *e);
void store_sqlite_done(struct store *s, struct store_sqlite_conn *c);

/* store_sqlite_prepare(c, sql, stmt, e): the statement, ready to bind; to be reset with
 * sqlite3_reset() after use. */
enum status store_sqlite_prepare(struct store_sqlite_conn *c, enum store_sqlite_sql sql,
                                 sqlite3_stmt **stmt, struct errinfo *e);

/* store_sqlite_run(c, stmt, e): step a statement that gives no rows, and reset it. */
enum status store_sqlite_run(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                             struct errinfo *e);

/* store_sqlite_exec(c, sql, e): the same with one that takes nothing. */
enum status store_sqlite_exec(struct store_sqlite_conn *c, enum store_sqlite_sql sql,
                              struct errinfo *e);

/* Turn the statement's current row into the object at out. */
typedef enum status store_sqlite_row(const struct store_sqlite_conn *c,
                                     sqlite3_stmt *stmt, void *out, struct errinfo *e);

/* store_sqlite_rows(c, stmt, row, size, what, out, n, e): step a bound statement to its end
 * and reset it; its *n rows as a new array of objects of size bytes, released by free(),
 * NULL where there are none.  On failure *out and *n are as before; what: the text of an
 * error of the database. */
enum status store_sqlite_rows(struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              store_sqlite_row *row, size_t size, const char *what,
                              void **out, size_t *n, struct errinfo *e);

/* store_sqlite_fail(c, what, e): the status and text of the connection's last error. */
enum status store_sqlite_fail(const struct store_sqlite_conn *c, const char *what,
                              struct errinfo *e);

/* store_sqlite_size(c, bytes, e): the size of the database, its log not counted. */
enum status store_sqlite_size(struct store_sqlite_conn *c, uint64_t *bytes,
                              struct errinfo *e);

/* store_sqlite_schema.c */

/* store_sqlite_schema_version(c, path, version, e): of this program's database, 1 up to
 * STORE_SQLITE_SCHEMA; 0: it holds nothing at all.  ST_ECORRUPT: another's; ST_EVERSION: a
 * newer one. */
enum status store_sqlite_schema_version(struct store_sqlite_conn *c, const char *path,
                                        int *version, struct errinfo *e);

/* store_sqlite_schema_make(c, v, path, e): create the tables, or bring those of an older
 * version up to this one, in one transaction; nothing if another process has just done so. */
enum status store_sqlite_schema_make(struct store_sqlite_conn *c,
                                     struct store_sqlite_vaults *v, const char *path,
                                     struct errinfo *e);

/* store_sqlite_convert(c, e): rows of version 3 in the tables of this one, c->vault being
 * there; inside a transaction. */
enum status store_sqlite_convert(struct store_sqlite_conn *c, struct errinfo *e);
enum status store_sqlite_schema_check(struct store_sqlite_conn *c, store_report *report,
                                      void *arg, struct errinfo *e);

/* Columns as they should be, or false: a text of 0..size-1 bytes without NUL (*_or: NULL
 * reads as ""); exactly n bytes, or min to max of them; a whole number from 0 to max. */
bool store_sqlite_text(sqlite3_stmt *stmt, int col, char *out, size_t size);
bool store_sqlite_text_or(sqlite3_stmt *stmt, int col, char *out, size_t size);
bool store_sqlite_bytes(sqlite3_stmt *stmt, int col, void *out, size_t n);
const void *store_sqlite_blob(sqlite3_stmt *stmt, int col, size_t min, size_t max,
                              size_t *n);
bool store_sqlite_count(sqlite3_stmt *stmt, int col, int64_t max, uint32_t *out);

/* Rows that are not sealed but proved: a keyed hash of the statement's first n columns is in
 * the one after them.  what: 16 bytes that keep one table from another.  The first column
 * names the row for store_sqlite_prove(), which sets the hash of the current one by the
 * statement `set`, inside a transaction.  Layout: db/FORMAT.md. */
bool store_sqlite_proved(const struct store_sqlite_conn *c, const char what[16],
                         sqlite3_stmt *stmt, int n);
enum status store_sqlite_prove(struct store_sqlite_conn *c, const char what[16],
                               sqlite3_stmt *stmt, int n, enum store_sqlite_sql set,
                               struct errinfo *e);

int store_sqlite_bind(sqlite3_stmt *stmt, int at, const char *text);    /* copied */
int store_sqlite_bind_or(sqlite3_stmt *stmt, int at, const char *text); /* "" as NULL */
int store_sqlite_bind_bytes(sqlite3_stmt *stmt, int at, const void *data,
                            size_t n); /* copied */

/* store_sqlite_event.c */

/* store_sqlite_event_begin(c, e): the end of the events of a new database, which has none.
 * store_sqlite_event_end(c, seq, hash, e): number and hash of the last event; ST_ECORRUPT:
 * the end is missing, or not proved by c->vault.
 * store_sqlite_event_add(c, by, kind, subject, template_id, outcome, e): append to the
 * events, inside a transaction, and sign where that is due.  subject: "" for none.  It
 * follows on what the end says, so that the loss of entries can never be covered up. */
enum status store_sqlite_event_begin(struct store_sqlite_conn *c, struct errinfo *e);
enum status store_sqlite_event_end(struct store_sqlite_conn *c, uint64_t *seq,
                                   unsigned char hash[STORE_CHAIN_HASH],
                                   struct errinfo *e);
enum status store_sqlite_event_add(struct store_sqlite_conn *c,
                                   const struct store_act *by, const char *kind,
                                   const char *subject, const char *template_id,
                                   const char *outcome, struct errinfo *e);
enum status store_sqlite_event(struct store *s, const struct store_act *by,
                               const char *kind, const char *subject,
                               const char *template_id, const char *outcome,
                               struct errinfo *e);

/* store_sqlite_audit.c */
enum status store_sqlite_audit_list(struct store *s,
                                    const struct store_audit_filter *filter,
                                    struct store_audit_entry **out, size_t *n,
                                    struct errinfo *e);
enum status store_sqlite_audit_sign(struct store *s, const struct store_act *by,
                                    const char *kind, struct store_audit_mark *out,
                                    struct errinfo *e);
enum status store_sqlite_audit_marks(struct store *s, struct store_audit_mark **out,
                                     size_t *n, struct errinfo *e);
enum status store_sqlite_audit_public(struct store *s, char public_key[65],
                                      struct errinfo *e);
enum status store_sqlite_audit_verify(struct store *s, store_chain_report *report,
                                      void *arg, struct store_audit *out,
                                      struct errinfo *e);
enum status store_sqlite_audit_erased(struct store *s, const char *subject,
                                      struct store_erased **out, size_t *n,
                                      struct errinfo *e);

/* store_sqlite_subject.c */

/* store_sqlite_subject_who(c, stmt, col, s, k): a subject and its key from the columns of
 * SUBJECT_WHO, which begin at col; s->key and s->templates are 0.  false: damaged. */
bool store_sqlite_subject_who(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              int col, struct store_subject *s, struct store_seal_key *k);

/* Bind what a subject is found by. */
int store_sqlite_bind_subject(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                              int at, const char *subject);

struct store_sqlite_person { /* a subject in a transaction */
    int64_t row;
    struct store_seal_key key;
};

/* store_sqlite_subject_find(c, subject, p, e): ST_ENOTFOUND, ST_ECORRUPT: damaged; then
 * *p has the row all the same. */
enum status store_sqlite_subject_find(struct store_sqlite_conn *c, const char *subject,
                                      struct store_sqlite_person *p, struct errinfo *e);

/* store_sqlite_subject_same(c, uid, p, who, e): whoever has this uid, under whatever id.
 * ST_ENOTFOUND; ST_ECORRUPT as above, and *who is empty then. */
enum status store_sqlite_subject_same(struct store_sqlite_conn *c,
                                      const unsigned char uid[STORE_UID],
                                      struct store_sqlite_person *p,
                                      struct store_subject *who, struct errinfo *e);

/* store_sqlite_subject_add(c, about, p, e): with about->uid, or where that is 0 a new one. */
enum status store_sqlite_subject_add(struct store_sqlite_conn *c,
                                     const struct store_subject *about,
                                     struct store_sqlite_person *p, struct errinfo *e);
enum status store_sqlite_subject_enter(struct store *s, const struct store_act *by,
                                       const struct store_subject *about,
                                       struct errinfo *e);
enum status store_sqlite_subject_get(struct store *s, const char *subject,
                                     struct store_subject *out, struct errinfo *e);
enum status store_sqlite_subject_list(struct store *s, int64_t after, size_t limit,
                                      struct store_subject **out, size_t *n,
                                      struct errinfo *e);
enum status store_sqlite_subject_delete(struct store *s, const struct store_act *by,
                                        const char *subject, bool due,
                                        struct store_receipt *out, struct errinfo *e);

/* store_sqlite_subject_read(c, subject, out, e): in a transaction. */
enum status store_sqlite_subject_read(struct store_sqlite_conn *c, const char *subject,
                                      struct store_subject *out, struct errinfo *e);
enum status store_sqlite_subject_due(struct store *s, const char *at,
                                     struct store_subject **out, size_t *n,
                                     struct errinfo *e);

/* store_sqlite_edit.c: subjects changed. */
enum status store_sqlite_edit(struct store *s, const struct store_act *by,
                              const char *subject, const struct store_edit *edit,
                              struct errinfo *e);
enum status store_sqlite_edit_seen(struct store *s, const char *subject, const char *at,
                                   struct errinfo *e);
/* store_sqlite_edit_see(c, subject, at, e): the same, inside a transaction. */
enum status store_sqlite_edit_see(struct store_sqlite_conn *c, const char *subject,
                                  const char *at, struct errinfo *e);

/* store_sqlite_face.c */
enum status store_sqlite_face_add(struct store *s, const struct store_act *by,
                                  struct store_template *t, const char *newest,
                                  const void *model, size_t len, bool *created,
                                  struct errinfo *e);
enum status store_sqlite_face_read(struct store *s, const char *id,
                                   struct store_template *t, store_use *use, void *arg,
                                   struct errinfo *e);
enum status store_sqlite_face_each(struct store *s, unsigned part, unsigned parts,
                                   store_use *use, store_report *report, void *arg,
                                   struct errinfo *e);
/* store_sqlite_face_key(c, stmt, t, k, e): the subject's key too of a row of
 * TEMPLATE_COLUMNS; to be wiped. */
enum status store_sqlite_face_key(const struct store_sqlite_conn *c, sqlite3_stmt *stmt,
                                  struct store_template *t, struct store_seal_key *k,
                                  struct errinfo *e);
enum status store_sqlite_face_delete(struct store *s, const struct store_act *by,
                                     const char *id, struct errinfo *e);
enum status store_sqlite_face_list(struct store *s, const char *subject,
                                   struct store_template **out, size_t *n,
                                   struct errinfo *e);
/* store_sqlite_face_store(c, p, t, model, len, e): add a row, inside a transaction. */
enum status store_sqlite_face_store(struct store_sqlite_conn *c,
                                    const struct store_sqlite_person *p,
                                    const struct store_template *t, const void *model,
                                    size_t len, struct errinfo *e);

/* store_sqlite_renew.c */
enum status store_sqlite_renew(struct store *s, const struct store_act *by,
                               const struct store_template *t, const void *model,
                               size_t len, bool *done, struct errinfo *e);
enum status store_sqlite_renew_due(struct store *s, const char *engine,
                                   char (**out)[STORE_ID_LEN + 1], size_t *n,
                                   struct errinfo *e);

/* store_sqlite_calibration.c */
enum status store_sqlite_calibration_add(struct store *s, const struct store_act *by,
                                         struct store_calibration *k, struct errinfo *e);
enum status store_sqlite_calibration_get(struct store *s, struct store_calibration *k,
                                         struct errinfo *e);
enum status store_sqlite_calibration_version(struct store *s, int64_t *version,
                                             struct errinfo *e);
enum status store_sqlite_calibration_list(struct store *s, struct store_calibration **out,
                                          size_t *n, struct errinfo *e);
/* store_sqlite_calibration_prove(c, e): all of them, inside a transaction, as they are. */
enum status store_sqlite_calibration_prove(struct store_sqlite_conn *c,
                                           struct errinfo *e);
/* Every row that is damaged is reported. */
enum status store_sqlite_calibration_check(struct store_sqlite_conn *c,
                                           store_report *report, void *arg,
                                           struct errinfo *e);

/* store_sqlite_admin.c */
enum status store_sqlite_admin_stats(struct store *s, struct store_stats *out,
                                     struct errinfo *e);
enum status store_sqlite_admin_vacuum(struct store *s, struct errinfo *e);
enum status store_sqlite_admin_check(struct store *s, store_report *report, void *arg,
                                     struct errinfo *e);

/* store_sqlite_backup.c */

struct newfile; /* newfile.h */

/* store_sqlite_pages(from, to, e): all pages of one database over another's, which is then
 * of one transaction.
 * store_sqlite_copy(from, n, e): into the part of a new file, as one file without a log. */
enum status store_sqlite_pages(struct store_sqlite_conn *from,
                               struct store_sqlite_conn *to, struct errinfo *e);
enum status store_sqlite_copy(struct store_sqlite_conn *from, const struct newfile *n,
                              struct errinfo *e);

/* store_sqlite_verify(path, key, found, e): every page, and every subject and template
 * opened with its key, and the end of the events.  ST_ECORRUPT. */
enum status store_sqlite_verify(const char *path, const struct store_key *key,
                                struct store_copied *found, struct errinfo *e);

/* As store_backup(), store_restore() and store_look(). */
enum status store_sqlite_backup(struct store *s, const char *path,
                                const struct store_key *key, struct store_copied *out,
                                struct errinfo *e);
enum status store_sqlite_restore(const char *path, const char *from,
                                 const struct store_key *key, const struct store_act *by,
                                 bool dry, struct store_restored *out, struct errinfo *e);
enum status store_sqlite_look(const char *path, struct store_look *out,
                              struct errinfo *e);

/* store_sqlite_backup_old(path, version, n, e): a verified copy of a database of that
 * version, for PATH.vVERSION.bak; the caller gives it its name, and closes it in any case. */
enum status store_sqlite_backup_old(const char *path, int version, struct newfile *n,
                                    struct errinfo *e);

/* store_sqlite_import.c */
enum status store_sqlite_import(struct store *s, const struct store_act *by,
                                store_next *next, void *arg, bool dry,
                                struct store_imported *out, struct errinfo *e);

/* store_sqlite_token.c */

/* store_sqlite_token_prove(c, e): all of them, inside a transaction, as they are. */
enum status store_sqlite_token_prove(struct store_sqlite_conn *c, struct errinfo *e);
/* Every row that is damaged is reported. */
enum status store_sqlite_token_check(struct store_sqlite_conn *c, store_report *report,
                                     void *arg, struct errinfo *e);
enum status store_sqlite_token_add(struct store *s, const struct store_act *by,
                                   const struct store_token *t,
                                   const unsigned char hash[STORE_HASH_LEN],
                                   struct errinfo *e);
enum status store_sqlite_token_list(struct store *s, struct store_token **out, size_t *n,
                                    struct errinfo *e);
enum status store_sqlite_token_get(struct store *s, const char *id, struct store_token *t,
                                   struct errinfo *e);
enum status store_sqlite_token_revoke(struct store *s, const struct store_act *by,
                                      const char *id, struct errinfo *e);
enum status store_sqlite_token_rotate(struct store *s, const struct store_act *by,
                                      const struct store_token *t,
                                      const unsigned char hash[STORE_HASH_LEN],
                                      struct errinfo *e);
enum status store_sqlite_token_find(struct store *s,
                                    const unsigned char hash[STORE_HASH_LEN],
                                    struct store_token *t,
                                    unsigned char kept[STORE_HASH_LEN], bool *old,
                                    struct errinfo *e);
enum status store_sqlite_token_use(struct store *s, const char *id, const char *at,
                                   struct errinfo *e);

/* store_sqlite_attempts.c */
enum status store_sqlite_attempts_get(struct store *s, const char *subject,
                                      uint32_t *failures, int64_t *at_ms,
                                      struct errinfo *e);
enum status store_sqlite_attempts_list(struct store *s, struct store_attempts **out,
                                       size_t *n, struct errinfo *e);
enum status store_sqlite_attempts_fail(struct store *s, const char *subject,
                                       int64_t at_ms, struct errinfo *e);
enum status store_sqlite_attempts_since(struct store *s, const char *subject,
                                        int64_t at_ms, struct errinfo *e);
enum status store_sqlite_attempts_clear(struct store *s, const struct store_act *by,
                                        const char *subject, struct errinfo *e);

#endif
