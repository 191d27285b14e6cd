/* hostile.h -- a small database for those who change it without its key, and what may be read of it
 * then: the truth or an error, never another face, subject, token or threshold.  Anything else ends
 * the program. */
#ifndef TESTS_HOSTILE_H
#define TESTS_HOSTILE_H
#include <stddef.h>
#include "face.h"
#include "store.h"

/* Ends the program, which may be a child, unless `what` is true. */
#define HOSTILE_MUST(what) ((what) ? (void)0 : hostile_broken(#what, __FILE__, __LINE__))
_Noreturn void hostile_broken(const char *what, const char *file, int line);
extern struct errinfo hostile_e; /* of the last call that failed */

#define HOSTILE_TEMPLATES                                                                \
    4 /* at most: alice's two, bob's, and carol's, who is disabled */

/* hostile_make(path, key, templates, size): the database with so many, which read-only tests need
 * not have in WAL mode, and with small pages, which leave few bytes that mean nothing.  Returns its
 * bytes, *size of them, for free().  hostile_end() releases what is kept to compare with.
 * hostile_face(): of a person who is not enrolled. */
unsigned char *hostile_make(const char *path, const struct store_key *key,
                            size_t templates, size_t *size);
void hostile_end(void);
const struct surface_face *hostile_face(void);

/* hostile_ask(s): reads all that decisions depend on.  Returns how many reads succeeded.
 * hostile_reads(): how many do where nothing was changed. */
unsigned hostile_ask(struct store *s);
unsigned hostile_reads(void);

#endif
