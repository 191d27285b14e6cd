/* methods.h -- scores that other methods gave to the comparisons of an evaluation, to be judged by the
 * same rates.
 *
 * A table with a heading: template and probe, files as scores.csv names them; score (higher: more alike),
 * or distance (lower); perhaps method.  Other columns are not read, so a scores.csv is such a table. */
#ifndef LAB_METHODS_H
#define LAB_METHODS_H
#include <stddef.h>
#include "errinfo.h"

struct report_method; /* report.h */
struct trials;        /* trials.h */

/* methods_read(path, t, out, n, e): Reads the scores of the comparisons of t.  A row without a score, or
 * of a pair that t does not have, is left out.  Without the column method all rows are of one method, by
 * the file's name.
 *   out  *n methods in the order of their first rows, measured, released by methods_free(); NULL on error
 * Returns ST_OK; as csv_open(); ST_EINVAL: a score is no number, a pair has two scores of a method, or
 * no pair of a method is one of t; ST_ENOMEM. */
enum status methods_read(const char *path, const struct trials *t,
                         struct report_method **out, size_t *n, struct errinfo *e);
void methods_free(struct report_method *m, size_t n); /* NULL is allowed */

#endif
