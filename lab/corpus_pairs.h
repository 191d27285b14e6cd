/* corpus_pairs.h -- a list of comparisons: pairs of scans, compared exactly as listed.
 *
 * A file without a heading (csv_open()), a pair a line:
 *   template probe [label]
 * Files are relative to the list's folder.  Every pair has a label or none has: mated,
 * genuine, same or 1, or else non-mated, impostor, different or 0.  With labels the people are
 * the groups of scans that mated pairs connect, whatever their files are called (the subject's id
 * is the first of them); without, a file is named SUBJECT_KIND.ply as in corpus_read.h.  A first row "template,probe" is a heading. */
#ifndef LAB_CORPUS_PAIRS_H
#define LAB_CORPUS_PAIRS_H
#include "errinfo.h"

struct corpus; /* corpus.h */

/* corpus_pairs_read(path, out, e): Reads a list of pairs: its scans by name, none of them enrolled, and
 * c->listed, its pairs in their order.
 *   out  to be released by corpus_free(); NULL on failure
 * Cost: O(n log n) for n pairs.  Messages name the line.
 * Returns as corpus_read(); ST_EINVAL also for a label that is unknown, missing or contradicts the others, and
 * for a scan that is paired with itself. */
enum status corpus_pairs_read(const char *path, struct corpus **out, struct errinfo *e);

#endif
