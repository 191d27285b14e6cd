/* tempdb.h -- a database in a folder of its own, for the tests of what is stored.  A program that uses
 * it has the folder and the faces before its own BEFORE_ALL and until after its AFTER_ALL; where the
 * folder cannot be removed, it ends with status 1.  A failure here fails the test that called, and
 * says why. */
#ifndef TESTS_TEMPDB_H
#define TESTS_TEMPDB_H
#include <stdbool.h>
#include <stdint.h>
#include "face.h"
#include "rawdb.h"
#include "store.h"

extern char tempdb_dir[32]; /* the folder, under /tmp */
extern char
    tempdb_path[40]; /* the database in it, or with PGHOST set (scripts/with_postgres) */
extern bool tempdb_server;          /* the URL of one on that server, of the same name */
extern struct store_key tempdb_key; /* its key, in the folder */

/* Scans of different people, 1,500 points each, and working memory to compare them. */
#define TEMPDB_FACES 4
extern struct surface_face tempdb_face[TEMPDB_FACES];
extern struct surface_work *tempdb_work;

/* tempdb_remove(): every file of the folder, keys and copies as well as the database.
 * tempdb_fresh(): then a new database, open.  tempdb_open(mode): the one that is
 * there. */
void tempdb_remove(void);
struct store *tempdb_fresh(void);
struct store *tempdb_open(enum store_mode mode);

/* tempdb_sql(text): run statements on the database, as another program would, which does not
 * keep to the tables' CHECKs; made where it is missing.  Waits for a writer, up to 5 s.  Its tables are
 * in the schema main; another, aside, is empty.
 * tempdb_raw(): that program's connection, to be closed by rawdb_close().
 * tempdb_keep(name), tempdb_put_back(name): subjects and logs are copied aside, as NAME_subjects, and
 * so on; and are again what they were then.
 * tempdb_number(text): the first number that a query gives.
 * tempdb_count(rows): how many there are of "TABLE", or "TABLE WHERE ...".
 * tempdb_mislead(index, rows): an index of one column gets other contents, as a query gives them:
 * the rows' keys, and what each is found by.  Its table stays as it is. */
void tempdb_sql(const char *text);
struct rawdb *tempdb_raw(void);
void tempdb_keep(const char *name);
void tempdb_put_back(const char *name);
int64_t tempdb_number(const char *text);
int64_t tempdb_count(const char *rows);
void tempdb_mislead(const char *index, const char *rows);

/* tempdb_store(s, actor, subject, label, f, t, created, e): store_enroll() of a face that was
 * compared with nothing.
 * tempdb_enroll(s, subject, label, f, t): as "test"; the subject has no such template yet.
 * tempdb_add(s, subject): one without templates.
 * tempdb_erase(s, actor, subject, e): store_subject_erase(), without the receipt.
 * tempdb_in(s): so many seconds from now, as an end; 0: STORE_NEVER.
 * tempdb_expire(s, subject): its end is set to the next moment, and has passed.
 * tempdb_calibration(threshold): a possible one, of 3 knots.
 * tempdb_record(s, subject, as, e): store_record_verification() of a verification by "test".
 * tempdb_attempts(s, token, subject): those of a store_snapshot_begin(). */
enum status tempdb_store(struct store *s, const char *actor, const char *subject,
                         const char *label, const struct surface_face *f,
                         struct store_template *t, bool *created, struct errinfo *e);
void tempdb_add(struct store *s, const char *subject);
void tempdb_enroll(struct store *s, const char *subject, const char *label,
                   const struct surface_face *f, struct store_template *t);
enum status tempdb_erase(struct store *s, const char *actor, const char *subject,
                         struct errinfo *e);
int64_t tempdb_in(int64_t s);
void tempdb_expire(struct store *s, const char *subject);
struct store_calibration tempdb_calibration(double threshold);
enum status tempdb_record(struct store *s, const char *subject, enum store_record_as as,
                          struct errinfo *e);
struct store_attempts tempdb_attempts(struct store *s, const char *token,
                                      const char *subject);

#endif
