/* ctl_corpus.h -- what of a folder of scans was not taken. */
#ifndef CTL_CORPUS_H
#define CTL_CORPUS_H

struct corpus; /* corpus.h */
struct json;   /* json.h */

/* ctl_corpus_tell(k): the scans that are left out, and what is no scan by its name, on
 * standard error.
 * ctl_corpus_left(j, k): the former, each as an object with file and reason, end the array
 * that is open; the latter are the member "not_read" behind it, null where there is none. */
void ctl_corpus_tell(const struct corpus *k);
void ctl_corpus_left(struct json *j, const struct corpus *k);

#endif
