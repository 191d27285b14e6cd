/* corpus_pairs.h -- a list of comparisons: pairs of scans, compared exactly as listed.
 *
 * A file without a heading (csv_open()), a pair a line:
 *   template probe [label]
 * Files are relative to the list's folder.  The label, of every pair or of none, is mated,
 * genuine, same or 1, or else non-mated, impostor, different or 0.  With labels the people are
 * the groups of scans that mated pairs connect, whatever their files are called (the subject's id
 * is the first of them); without, a file is named SUBJECT_KIND.ply as in corpus_read.h.  A first row "template,probe" is a heading. */
#ifndef LAB_CORPUS_PAIRS_H
#define LAB_CORPUS_PAIRS_H
#include "errinfo.h"

struct corpus; /* corpus.h */

/* corpus_pairs_read(path, out, e): the scans that are listed, by name, none of them enrolled;
 * c->listed has the pairs in their order.
 * out  released by corpus_free(); NULL on error
 * Returns as corpus_read(); ST_EINVAL too for a label that is not known or missing, or that
 * contradicts the others, and for a scan that is paired with itself.  Messages say the line.  O(n log n) for n pairs. */
enum status corpus_pairs_read(const char *path, struct corpus **out, struct errinfo *e);

#endif
