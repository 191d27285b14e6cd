/* tempdb.h -- a database in a temporary folder, for the tests of the store.  Folder and faces exist
 * from before the program's BEFORE_ALL until after its AFTER_ALL.  If the folder cannot be removed,
 * the program exits with status 1.  A failure here fails the calling test with a message. */
#ifndef TESTS_TEMPDB_H
#define TESTS_TEMPDB_H
#include <stdbool.h>
#include <stdint.h>
#include "face.h"
#include "rawdb.h"
#include "store.h"

extern char tempdb_dir[32]; /* folder, under /tmp */
/* path of the database in it; with PGHOST set (scripts/with_postgres) the URL of a database there */
extern char tempdb_path[40];
extern bool tempdb_server;          /* true: tempdb_path is a URL */
extern struct store_key tempdb_key; /* key of the database, in the folder */

/* Scans of different people, 1,500 points each, and working memory to compare them. */
#define TEMPDB_FACES 4
extern struct surface_face tempdb_face[TEMPDB_FACES];
extern struct surface_work *tempdb_work;

/* tempdb_remove(): Deletes every file of the folder, and the database on a server. */
void tempdb_remove(void);

/* tempdb_fresh(): Calls tempdb_remove(), and opens a new database. */
struct store *tempdb_fresh(void);

/* tempdb_open(mode): Opens the present database. */
struct store *tempdb_open(enum store_mode mode);

/* tempdb_sql(text): Runs statements as another program, which ignores the CHECKs of the tables and
 * creates a missing database.  Waits for a writer for up to 5 s.  The tables are in the schema main;
 * another schema, aside, is empty. */
void tempdb_sql(const char *text);

/* tempdb_raw(): Returns the connection of that program, to be closed by rawdb_close(). */
struct rawdb *tempdb_raw(void);

/* tempdb_keep(name): Copies subjects and logs to aside.NAME_subjects, and so on. */
void tempdb_keep(const char *name);

/* tempdb_put_back(name): Restores these copies. */
void tempdb_put_back(const char *name);

/* tempdb_number(text): Returns the first number of a query. */
int64_t tempdb_number(const char *text);

/* tempdb_count(rows): Returns the number of rows of "TABLE", or "TABLE WHERE ...". */
int64_t tempdb_count(const char *rows);

/* tempdb_mislead(index, rows): Replaces the contents of an index of one column by the pairs of row key
 * and value that a query gives.  The table is not changed. */
void tempdb_mislead(const char *index, const char *rows);

/* tempdb_store(s, actor, subject, label, f, t, created, e): Calls store_enroll() for a face that was
 * compared with no template. */
enum status tempdb_store(struct store *s, const char *actor, const char *subject,
                         const char *label, const struct surface_face *f,
                         struct store_template *t, bool *created, struct errinfo *e);

/* tempdb_add(s, subject): Adds a subject without templates. */
void tempdb_add(struct store *s, const char *subject);

/* tempdb_enroll(s, subject, label, f, t): Enrols f as actor "test"; the template must be new. */
void tempdb_enroll(struct store *s, const char *subject, const char *label,
                   const struct surface_face *f, struct store_template *t);

/* tempdb_erase(s, actor, subject, e): Calls store_subject_erase() and drops the receipt. */
enum status tempdb_erase(struct store *s, const char *actor, const char *subject,
                         struct errinfo *e);

/* tempdb_in(s): Returns the time s seconds from now; 0: STORE_NEVER. */
int64_t tempdb_in(int64_t s);

/* tempdb_expire(s, subject): Sets the expiry of a subject to the next moment, and waits for it. */
void tempdb_expire(struct store *s, const char *subject);

/* tempdb_calibration(threshold): Returns a valid calibration of 3 knots. */
struct store_calibration tempdb_calibration(double threshold);

/* tempdb_record(s, subject, as, e): Calls store_record_verification() for actor "test". */
enum status tempdb_record(struct store *s, const char *subject, enum store_record_as as,
                          struct errinfo *e);

/* tempdb_attempts(s, token, subject): Returns the attempts of a store_snapshot_begin(). */
struct store_attempts tempdb_attempts(struct store *s, const char *token,
                                      const char *subject);

#endif
