/* store_open.h -- a store: opened, made, closed. */
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
    STORE_WRITE,  /* the database must be there */
    STORE_CREATE, /* made if it is missing or empty, readable by its owner alone */
    STORE_BEGIN,  /* the same where there is no key of it either */
    STORE_ALONE   /* as STORE_WRITE, while no other process has it open or can open it */
};

#define STORE_KEY_NEW ".new" /* behind the name of a key's file: a rekey's next key */

struct store_key {    /* where the master key comes from */
    const char *path; /* its file; NULL: PATH.key of the database */
    const struct crypt_file
        *given;           /* instead of a file, while the store is open; or NULL */
    enum crypt_kind make; /* of a database that is made */
    bool
        plaintext; /* the database is plaintext, which is refused otherwise; and no other */
    bool weak;     /* a passphrase of few characters may be made */
    /* A file that says how far the change log has come (log_anchor.h); NULL: there is none.  A
     * database that does not have that change is refused. */
    const char *anchor;
};

/* store_open(path, mode, key, out, e): Opens a database, by its key's file or else by a KEY.new that an
 * interrupted rekey left.  key: NULL for {.make = CRYPT_FILE}.  With a new database it makes the key's
 * file and the anchor if they are missing.  If that fails behind the commit, the key stays.
 *   ST_ENOTFOUND   there is no database, or it is empty, and mode does not make one
 *   ST_EDENIED     not the database's key; or the database is plaintext and key->plaintext is not
 *                  set: with access to the file alone another one could be put in its place
 *   ST_EVERSION    another version than this program's
 *   ST_EREFUSED    older than the anchor says, or the anchor is missing or damaged, and no PATH.part
 *                  of it names a change that the database has
 *   ST_ECORRUPT    the log does not end with an entry of this key
 *   ST_EBUSY       STORE_ALONE, and another process has it open
 *   ST_EUNSYNCED   made, but the anchor may not be on the disk */
enum status store_open(const char *path, enum store_mode mode,
                       const struct store_key *key, struct store **out,
                       struct errinfo *e);
void store_close(struct store *s); /* NULL is allowed */

/* store_root(path, root, e): Reads the key record of a database without its key.  ST_ENOTFOUND: there is
 * no database, or it is empty; ST_EVERSION. */
enum status store_root(const char *path, struct crypt_root *root, struct errinfo *e);

/* store_kind(path, kind, e): how the database's master key is kept, which takes no key.
 * ST_ENOTFOUND, also where it is empty; ST_EVERSION. */
enum status store_kind(const char *path, enum crypt_kind *kind, struct errinfo *e);

/* store_on_server(path): is it the URL of a database on a server, and not a file?
 * store_server(path, out, e): what that server says of itself.  ST_EINVAL: it is a file. */
struct store_server {
    char version[32];
    bool encrypted;   /* the connection, by TLS */
    bool local;       /* by a socket on the same machine */
    bool keeps;       /* what it has committed survives a power failure */
    bool may_define;  /* the role may make and drop tables */
    bool waits;       /* a commit waits for a standby */
    uint32_t others;  /* connections of this program, without this one */
    int64_t ahead_ms; /* its clock, against this machine's, within a round trip */
};
#define STORE_CLOCKS_MS                                                                  \
    1000 /* that clocks may differ: limits and ends of consent go by them */
bool store_on_server(const char *path);
enum status store_server(const char *path, struct store_server *out, struct errinfo *e);

/* store_in_use(path, pid): has another process the database open?  *pid: one that has, 0 where
 * that is not known.  Not while this process has it open. */
bool store_in_use(const char *path, int64_t *pid);

/* store_use_model(s, m): what is enrolled and calibrated from now on is by this model, which
 * the callers' surface_work must be for too.  m is borrowed; NULL, as after store_open():
 * the shipped one.  Before other threads use s.
 * store_made_by(s): surface_engine() of it, s's own. */
void store_use_model(struct store *s, const struct surface_model *m);
const struct surface_model *store_model(const struct store *s);
const char *store_made_by(const struct store *s);

/* store_ready(s, e): can the database be reached?
 * store_verify(s, report, arg, e): all rows with a MAC against the digest of the last change, and
 * the indexes by which they are found.  ST_EREFUSED: a difference; report() (or NULL) is called
 * once a problem.  1 s for 100,000 templates, memory constant.  It is done by itself before the
 * first write of an open store.
 * store_refused(s, e): has a call found that the database is not as it was written, or not the one
 * that was opened?  Then every other one fails with ST_EREFUSED until the store is opened again,
 * and e says why.
 * store_behind(s): is that because a server has no more what this process has seen there, and is there
 * an anchor?  After a failover it may be a change that was never acknowledged: opened again, the
 * store is good where the anchor says so.
 * store_last_change(s, out, e): where the change log ends, for the daemon's log.
 * store_follow(s): the anchor names what this process has seen others change too, once that is
 * durable.  To be called now and then, and before the store is closed; costs nothing where it does. */
enum status store_ready(struct store *s, struct errinfo *e);
enum status store_verify(struct store *s, store_report *report, void *arg,
                         struct errinfo *e);
bool store_refused(struct store *s, struct errinfo *e);
bool store_behind(struct store *s);
enum status store_last_change(struct store *s, struct log_end *out, struct errinfo *e);
void store_follow(struct store *s);

/* store_anchor_fault(s, e): Returns true while the anchor lags behind a change because it cannot be
 * written, and fills *e with the reason.  Changes go on meanwhile. */
bool store_anchor_fault(struct store *s, struct errinfo *e);

/* store_stats(s, sizes, out, e): counts, and with sizes what they take, for which all rows are read:
 * 0.7 s for 100,000 templates, else 10 ms.  events: by their numbers.
 * store_vacuum(s, e): rewrite the database without the room that deleted rows left, while
 * others read it; writers wait, up to 5 s.  It verifies the rows first (store_verify()). */
struct store_stats {
    uint64_t subjects, templates, tokens, devices, calibrations, events;
    uint64_t points, template_bytes, file_bytes;
    uint32_t schema;
};
enum status store_stats(struct store *s, bool sizes, struct store_stats *out,
                        struct errinfo *e);
enum status store_vacuum(struct store *s, struct errinfo *e);

#endif
