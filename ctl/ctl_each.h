/* ctl_each.h -- every subject of the database, one after the other. */
#ifndef CTL_EACH_H
#define CTL_EACH_H
#include "store.h"

/* ctl_each_subject(s, visit, arg, e): visit(arg, one, e) each subject, in the order in which
 * they were added; not all are in memory at once.  ST_ENOTFOUND of a visit is passed over:
 * the subject was erased since it was listed.  Ends with the first other failure. */
enum status ctl_each_subject(struct store *s,
                             enum status (*visit)(void *arg,
                                                  const struct store_subject *one,
                                                  struct errinfo *e),
                             void *arg, struct errinfo *e);

#endif
