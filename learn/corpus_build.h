/* corpus_build.h -- a corpus (corpus.h) while it is read: for its two readers,
 * corpus_read.c and corpus_pairs.c.  Functions that return a status fill b->e on failure. */
#ifndef LEARN_CORPUS_BUILD_H
#define LEARN_CORPUS_BUILD_H
#include "corpus.h"

struct corpus_build {
    struct corpus *c;
    char *dir; /* that file names are relative to; the reader sets it, by malloc() */
    uint32_t scan_room, subject_room, left_room;
    uint32_t *hash; /* subjects by id, open addressing; CORPUS_NONE is empty */
    uint32_t nhash; /* a power of two */
    struct errinfo *e;
};

/* corpus_build_begin(b, e): an empty corpus.  corpus_build_end() must follow, also on failure.
 * corpus_build_end(b, st, out): release b; *out is the corpus where st is ST_OK, with the
 * population "" for subjects that have none, else NULL.  Returns st or ST_ENOMEM. */
enum status corpus_build_begin(struct corpus_build *b, struct errinfo *e);
enum status corpus_build_end(struct corpus_build *b, enum status st, struct corpus **out);

/* corpus_build_scan(b, file, id, kind): add a scan, not enrolled, of a new or a known subject.
 * corpus_build_left(b, file, why, scan): add a file that is left out (struct corpus_left).
 * corpus_build_subject(b, id, out): the subject of that id, added where it is new.
 * corpus_build_find(b, id): the same, or CORPUS_NONE.
 * corpus_build_population(b, name, out): likewise a population. */
enum status corpus_build_scan(struct corpus_build *b, const char *file, const char *id,
                              const char *kind);
enum status corpus_build_left(struct corpus_build *b, const char *file, const char *why,
                              bool scan);
enum status corpus_build_subject(struct corpus_build *b, const char *id, uint32_t *out);
uint32_t corpus_build_find(const struct corpus_build *b, const char *id);
enum status corpus_build_population(struct corpus_build *b, const char *name,
                                    uint32_t *out);

/* corpus_build_path(b, file): the path by which it is opened, for free(); NULL: no memory. */
char *corpus_build_path(const struct corpus_build *b, const char *file);

/* What is wrong, static; or NULL.
 * corpus_build_bad_file(path): with a file that should be a scan.
 * corpus_build_bad_name(text, most): with a name of up to that many bytes.
 * corpus_build_split(name, id, kind): with a name that should be SUBJECT_KIND.ply; else it is
 * cut in two. */
const char *corpus_build_bad_file(const char *path);
const char *corpus_build_bad_name(const char *text, size_t most);
const char *corpus_build_split(const char *name, char id[CORPUS_MAX_NAME + 1],
                               char kind[CORPUS_MAX_NAME + 1]);

enum status corpus_build_no_memory(struct errinfo *e); /* ST_ENOMEM */

#endif
