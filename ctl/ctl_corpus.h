/* ctl_corpus.h -- the scans of a collection, and what of it was not taken. */
#ifndef CTL_CORPUS_H
#define CTL_CORPUS_H

struct corpus; /* corpus.h */
struct json;   /* json.h */

/* ctl_corpus_tell(k): what is left out, on standard error.
 * ctl_corpus_left(j, k): the same, each as an object with file and reason; they end the array
 * that is open. */
void ctl_corpus_tell(const struct corpus *k);
void ctl_corpus_left(struct json *j, const struct corpus *k);

#endif
