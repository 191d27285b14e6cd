/* store_people.h -- a transaction of a search among all people: who may be found, by which descriptors, whom
 * changes concern, and the templates of those found (store_snapshot_begin()).  All of one moment. */
#ifndef DB_STORE_PEOPLE_H
#define DB_STORE_PEOPLE_H
#include "store_open.h"

struct store_people;

/* store_people_begin(s, actor, calibration, out, e): Begins the transaction.
 *   calibration  version of the calibration that the caller decides by
 *   out          to be ended by store_people_end(); NULL after a failure */
enum status store_people_begin(struct store *s, const char *actor, int64_t calibration,
                               struct store_people **out, struct errinfo *e);

/* store_people_end(p, st, e): Ends the transaction and frees p; NULL is allowed.  Returns st, or the error of the
 * end. */
enum status store_people_end(struct store_people *p, enum status st, struct errinfo *e);

/* store_people_seq(p): Returns the number of the last change that p sees. */
uint64_t store_people_seq(const struct store_people *p);

/* store_people_bound(p): Returns the groups that the actor is bound to (groups.h), borrowed; "": it is not bound. */
const char *store_people_bound(const struct store_people *p);

/* store_people_calibration(p, k): Returns the version of the newest calibration, 0: there never was one, and
 * sets *k to it if the caller decides by another one; else to zeros. */
int64_t store_people_calibration(const struct store_people *p,
                                 struct store_calibration *k);

/* Receives a template of the subject; all are borrowed.
 *   descriptor  [SURFACE_DESCRIPTOR]; NULL: of another engine, or undescribed: no search finds the template */
typedef enum status store_people_use(void *arg, const struct store_subject *of,
                                     const struct store_template *t,
                                     const unsigned char *descriptor, struct errinfo *e);

/* store_people_all(p, use, report, arg, e): Calls use() for each template, in no order.  Calls report() for a
 * damaged one.
 * Cost: about 10 us each. */
enum status store_people_all(struct store_people *p, store_people_use *use,
                             store_report *report, void *arg, struct errinfo *e);

/* store_people_of(p, uid, use, arg, e): Calls use() for each template of the subject of this uid; a subject that is
 * not there has none.  ST_ECORRUPT: it is damaged. */
enum status store_people_of(struct store_people *p, const unsigned char uid[STORE_UID],
                            store_people_use *use, void *arg, struct errinfo *e);

/* store_people_changed(p, after, uid, n, all, e): Lists the subjects that the changes after number `after` concern.
 *   uid  a new array of *n elements, to be released by free(); a subject may stand in it several times
 *   all  receives true if the changes concern all subjects, or so many that a list makes no sense */
enum status store_people_changed(struct store_people *p, uint64_t after,
                                 unsigned char (**uid)[STORE_UID], size_t *n, bool *all,
                                 struct errinfo *e);

struct log_txn; /* log_txn.h */

/* store_people_txn(p): Returns the transaction, for store_snapshot_begin(). */
struct log_txn *store_people_txn(struct store_people *p);

#endif
