/* hostile.h -- a small database for tests that change it without its key, and the check of all later
 * reads: each returns the truth or an error, never another face, subject, token or threshold.  A
 * wrong result ends the program. */
#ifndef TESTS_HOSTILE_H
#define TESTS_HOSTILE_H
#include <stddef.h>
#include "face.h"
#include "store.h"

/* HOSTILE_MUST(what): Ends the program, which may be a child, unless `what` is true. */
#define HOSTILE_MUST(what) ((what) ? (void)0 : hostile_broken(#what, __FILE__, __LINE__))
_Noreturn void hostile_broken(const char *what, const char *file, int line);
extern struct errinfo hostile_e; /* error of the last failed call */

#define HOSTILE_TEMPLATES                                                                \
    4 /* at most: alice's two, bob's, and carol's, who is disabled */

/* hostile_make(path, key, templates, size): Makes a database with that many templates.  It is not in
 * WAL mode, which read-only tests do not need, and has small pages, which leave few unused bytes.
 * Returns its *size bytes, to be released by free(). */
unsigned char *hostile_make(const char *path, const struct store_key *key,
                            size_t templates, size_t *size);

/* hostile_end(): Releases the faces that later reads are compared with. */
void hostile_end(void);

/* hostile_face(): Returns the face of a person who is not enrolled. */
const struct surface_face *hostile_face(void);

/* hostile_ask(s): Reads all rows that decisions depend on.  Returns the number of successful reads. */
unsigned hostile_ask(struct store *s);

/* hostile_reads(): Returns the number of successful reads of the unchanged database. */
unsigned hostile_reads(void);

#endif
