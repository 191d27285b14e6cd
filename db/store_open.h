/* store_open.h -- opens, creates and closes a store, and reports its state. */
#ifndef DB_STORE_OPEN_H
#define DB_STORE_OPEN_H
#include "errinfo.h"
#include "rows_types.h"

struct crypt_file;    /* crypt_file.h */
struct log_end;       /* log_entry.h */
struct surface_model; /* libsurface.h */
struct store;

enum store_mode {
    STORE_READ,   /* changes are refused with ST_EDENIED */
    STORE_WRITE,  /* the database must exist */
    STORE_CREATE, /* a missing or empty database is created, readable only by its owner */
    STORE_BEGIN,  /* as STORE_CREATE if its key is missing too, else as STORE_WRITE */
    STORE_ALONE /* as STORE_WRITE; no other process has the database open or can open it */
};

#define STORE_KEY_NEW ".new" /* suffix of a key's file name: the next key of a rekey */

struct store_key {    /* the source of the master key */
    const char *path; /* file of the key; NULL: PATH.key of the database */
    /* The key or passphrase itself instead of a file, borrowed while the store is open; or NULL. */
    const struct crypt_file *given;
    enum crypt_kind make; /* kind of the key of a new database */
    bool plaintext;       /* the database must be plaintext; if false, it must not */
    bool weak;            /* a new passphrase may have few characters */
    /* Anchor: a file that names the newest change of the log (log_anchor.h); NULL: no anchor.  A
     * database that does not have this change is refused. */
    const char *anchor;
};

/* store_open(path, mode, key, out, e): Opens a database with the key in its file, or else with the key in a
 * KEY.new that an interrupted rekey left.  With a new database it creates the key's file and the anchor
 * if they are missing.  If creating the database fails after the commit, the key stays.
 *   key  NULL: {.make = CRYPT_FILE}
 * Returns ST_OK and the store in *out, or an error and NULL in *out:
 *   ST_ENOTFOUND   there is no database, or it is empty, and mode does not create one
 *   ST_EDENIED     the key is another database's; or the database is plaintext and key->plaintext is
 *                  false: anyone who can write the file could replace it by a plaintext one
 *   ST_EINVAL      the database is on a server, and *key names no key
 *   ST_EVERSION    the schema has another version than this program's
 *   ST_EREFUSED    the database is older than its anchor, or the anchor is missing or damaged, and no
 *                  PATH.part of the anchor names a change that the database has
 *   ST_ECORRUPT    the log does not end with an entry authenticated by this key
 *   ST_EBUSY       STORE_ALONE, and another process has the database open
 *   ST_EUNSYNCED   the database was created, but its anchor may not be durable */
enum status store_open(const char *path, enum store_mode mode,
                       const struct store_key *key, struct store **out,
                       struct errinfo *e);

/* store_close(s): Closes s and frees it; NULL is allowed. */
void store_close(struct store *s);

/* store_root(path, root, e): Reads the key record of a database without its key.  ST_ENOTFOUND: there is
 * no database, or it is empty; ST_EVERSION. */
enum status store_root(const char *path, struct crypt_root *root, struct errinfo *e);

/* store_kind(path, kind, e): Reads the kind of the database's master key, without the key.  Errors as
 * store_root(). */
enum status store_kind(const char *path, enum crypt_kind *kind, struct errinfo *e);

struct store_server {
    char version[32]; /* version of PostgreSQL */
    bool encrypted;   /* the connection uses TLS */
    bool local;       /* the connection is a socket on the same machine */
    bool keeps; /* fsync and full_page_writes are on: commits survive a power failure */
    bool may_define; /* the role may create and drop tables */
    bool waits;      /* a commit waits for a standby */
    uint32_t others; /* number of other connections of this program to the database */
    int64_t
        ahead_ms; /* server's clock minus this machine's, ms, to within a round trip */
};

/* The largest allowed difference of two clocks, ms: limits and ends of consent depend on them. */
#define STORE_CLOCKS_MS 1000

/* store_on_server(path): Returns true if path is the URL of a database on a server, false for a file. */
bool store_on_server(const char *path);

/* store_server(path, out, e): Reads the state and settings of the database's server.  ST_EINVAL: the
 * database is in a file. */
enum status store_server(const char *path, struct store_server *out, struct errinfo *e);

/* store_in_use(path, pid): Returns true if another process has the database open, and sets *pid to the id
 * of one such process, or to 0 if unknown.  This process must not have the database open. */
bool store_in_use(const char *path, int64_t *pid);

/* store_use_model(s, m): Sets the model of the templates and calibrations stored from now on.  Call it before
 * other threads use s.  The callers' surface_work must be for the same model.
 *   m  borrowed while s is open; NULL: the shipped model, as after store_open() */
void store_use_model(struct store *s, const struct surface_model *m);

/* store_made_by(s): Returns surface_engine() of the model, borrowed while s is open. */
const char *store_made_by(const struct store *s);

/* store_ready(s, e): Checks that the database can be read, by an empty transaction. */
enum status store_ready(struct store *s, struct errinfo *e);

/* store_verify(s, report, arg, e): Verifies all rows with a MAC against the digest of the last change, and
 * the indexes by which rows are found.  Calls report() (NULL is allowed) once for each problem.  The
 * first write of an open store does this by itself.
 * Cost: 1 s for 100,000 templates; constant memory.
 * ST_EREFUSED: a difference was found. */
enum status store_verify(struct store *s, store_report *report, void *arg,
                         struct errinfo *e);

/* store_refused(s, e): Returns true if a call has found that the rows do not match the last change, or that
 * the database is not the one that was opened; fills *e with the reason.  All other calls then fail with
 * ST_EREFUSED until the store is opened again. */
bool store_refused(struct store *s, struct errinfo *e);

/* store_behind(s): Returns true if s is refused because the server has lost a change that this process has
 * seen, and s has an anchor.  After a failover the lost change may be one that was never acknowledged;
 * then reopening the store succeeds if the anchor does not name it. */
bool store_behind(struct store *s);

/* store_last_change(s, out, e): Reads the end of the change log, for the daemon's log. */
enum status store_last_change(struct store *s, struct log_end *out, struct errinfo *e);

/* store_follow(s): Advances the anchor to the newest change of another process that this process has seen,
 * as soon as that change is durable.  Call it regularly, and before store_close().  Costs nothing if the
 * anchor is up to date. */
void store_follow(struct store *s);

/* store_anchor_fault(s, e): Returns true while the anchor lags behind a change because it cannot be
 * written, and fills *e with the reason.  Changes still succeed meanwhile. */
bool store_anchor_fault(struct store *s, struct errinfo *e);

struct store_stats {
    /* Numbers of rows; events: of entries in all logs, computed from their numbers. */
    uint64_t subjects, templates, tokens, devices, calibrations, events;
    /* Points and bytes of all templates, bytes of the database; 0 without sizes. */
    uint64_t points, template_bytes, file_bytes;
    uint32_t schema; /* version of the schema */
};

/* store_stats(s, sizes, out, e): Counts the rows.  With sizes it also reads all rows to add up their sizes.
 * Cost: for 100,000 templates 10 ms, with sizes 0.7 s. */
enum status store_stats(struct store *s, bool sizes, struct store_stats *out,
                        struct errinfo *e);

/* store_vacuum(s, e): Verifies the rows (store_verify()), then rewrites the database without the space of
 * deleted rows.  Other processes can read meanwhile; writers wait, up to 5 s. */
enum status store_vacuum(struct store *s, struct errinfo *e);

#endif
