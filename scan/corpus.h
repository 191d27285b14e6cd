/* corpus.h -- a collection of scans to learn from, to evaluate on or to enroll: its scans, their subjects and
 * kinds.  The scans themselves are not opened.  corpus_read.h reads a folder or a manifest,
 * lab/corpus_pairs.h a list of pairs. */
#ifndef SCAN_CORPUS_H
#define SCAN_CORPUS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "errinfo.h"

struct json; /* json.h */

#define CORPUS_MAX_SCANS 1000000
#define CORPUS_MAX_NAME  128 /* bytes of a subject's id, a kind or a population */
#define CORPUS_NONE      UINT32_MAX

struct corpus_scan {
    char *file;       /* name as listed */
    char *path;       /* path to open */
    uint32_t subject; /* index of corpus.subject */
    uint32_t kind;    /* index of corpus.kind */
    bool enrolled;
    char **frame; /* [nframe] paths of the session's further frames (corpus_sessions()) */
    uint32_t nframe;
};

struct corpus_subject {
    char *id;          /* as long as a file's name in a list of pairs */
    uint32_t enrolled; /* index of corpus.scan; CORPUS_NONE: nothing (corpus_enroll()) */
    uint32_t nscan;    /* number of scans, the enrolled one included */
    uint32_t population; /* index of corpus.population */
    uint32_t
        relative_of; /* index of corpus.subject, from nsubject on a person without scans;
                             CORPUS_NONE: none */
};

struct corpus_left { /* a file of a folder that is left out */
    char *file; /* name; '?' for bytes that are not UTF-8 and for control characters */
    const char *why; /* static */
    bool scan;       /* the name ends like a scan's */
};

struct corpus_listed {        /* a comparison that was asked for (corpus_pairs.h) */
    uint32_t template, probe; /* indices of corpus.scan */
    unsigned line;            /* line of the list */
};

/* Only corpus_enroll() and corpus_sessions() change it once it is read. */
struct corpus {
    struct corpus_scan
        *scan; /* [nscan] of a folder sorted by name (bytes), else as listed */
    struct corpus_subject *subject; /* [nnamed] in the order of their first scans */
    char **kind, **population;      /* [nkind], [npopulation] names; "" for none */
    uint32_t nscan, nsubject;       /* at least 1 */
    uint32_t nnamed;                /* nsubject, and relatives without scans */
    uint32_t nkind, npopulation;    /* at least 1 */
    struct corpus_left *left;       /* [nleft], by name */
    uint32_t nleft, nleft_scan;     /* files left out; those named like scans */
    struct corpus_listed *listed;   /* [nlisted] pairs in the list's order; else none */
    size_t nlisted;
};

void corpus_free(struct corpus *c); /* NULL is allowed */

/* corpus_enroll(c, kind, e): Enrolls the first scan of this kind of each subject instead, and nothing of a
 * subject without one.  Returns ST_OK; ST_EINVAL: no subject has one; c is unchanged. */
enum status corpus_enroll(struct corpus *c, const char *kind, struct errinfo *e);

/* corpus_sessions(c, n, e): Joins scans of one subject that follow each other and whose kinds differ only
 * behind the last '-' (alice_smile-1.ply, alice_smile-2.ply, ...) to one scan of at most n frames; leaves
 * out the others of the session.  To be called before corpus_enroll(), and not for listed pairs.
 * Returns ST_OK; ST_ENOMEM. */
enum status corpus_sessions(struct corpus *c, uint32_t n, struct errinfo *e);

/* corpus_is_scan(path): Returns true if path is a file with the extension of a scan, except of a table (.csv
 * and .txt may be either).  For usage messages about a scan in the place of a collection. */
bool corpus_is_scan(const char *path);

/* corpus_left_json(c, j): Adds the files that are left out to the JSON array that is open, and ends it. */
void corpus_left_json(const struct corpus *c, struct json *j);

/* corpus_left_print(c, program): Lists the files that are left out on standard error. */
void corpus_left_print(const struct corpus *c, const char *program);

/* Relation of two subjects. */
enum corpus_pair {
    CORPUS_GENUINE,  /* one subject */
    CORPUS_IMPOSTOR, /* two people of one population */
    CORPUS_RELATIVE, /* close relatives of one population: one names the other, or both name
                        one third person; counted apart */
    CORPUS_FOREIGN   /* people of two populations: not compared */
};

/* corpus_pair(c, a, b): Returns the relation of a and b, indices of c->subject.  Cost: O(1). */
enum corpus_pair corpus_pair(const struct corpus *c, uint32_t a, uint32_t b);

/* ---- while it is read, for its readers.  Functions that return a status fill b->e on failure. */

struct corpus_build {
    struct corpus *c;
    char *dir;      /* folder of relative file names; set by the reader, from malloc() */
    uint32_t *hash; /* subjects by id, open addressing; CORPUS_NONE is empty */
    uint32_t nhash; /* a power of two */
    struct errinfo *e;
};

/* corpus_build_begin(b, e): Begins an empty corpus.  corpus_build_end() must follow, also on failure. */
enum status corpus_build_begin(struct corpus_build *b, struct errinfo *e);

/* corpus_build_end(b, st, out): Releases b, and gives subjects without a population the population "".
 *   out  the corpus if st is ST_OK; else NULL
 * Returns st; ST_ENOMEM. */
enum status corpus_build_end(struct corpus_build *b, enum status st, struct corpus **out);

/* corpus_build_scan(b, file, id, kind): Adds a scan, not enrolled.  The subject is new or known. */
enum status corpus_build_scan(struct corpus_build *b, const char *file, const char *id,
                              const char *kind);

/* corpus_build_left(b, file, why, scan): Adds a file that is left out (struct corpus_left). */
enum status corpus_build_left(struct corpus_build *b, const char *file, const char *why,
                              bool scan);

/* corpus_build_subject(b, id, out): Finds the subject with this id, or adds it. */
enum status corpus_build_subject(struct corpus_build *b, const char *id, uint32_t *out);

/* corpus_build_find(b, id): Returns the subject with this id, or CORPUS_NONE. */
uint32_t corpus_build_find(const struct corpus_build *b, const char *id);

/* corpus_build_population(b, name, out): Finds the population with this name, or adds it. */
enum status corpus_build_population(struct corpus_build *b, const char *name,
                                    uint32_t *out);

/* corpus_build_path(b, file): Returns the path of a file, to be released by free(); NULL: out of memory. */
char *corpus_build_path(const struct corpus_build *b, const char *file);

/* corpus_build_bad_file(path): Returns why the file cannot be a scan, static, or NULL. */
const char *corpus_build_bad_file(const char *path);

/* corpus_build_bad_name(text, most): Returns the fault of a name of up to `most` bytes, static, or NULL. */
const char *corpus_build_bad_name(const char *text, size_t most);

/* corpus_build_split(name, id, kind): Cuts a name SUBJECT_KIND.ply in two.  Returns its fault, static, or
 * NULL. */
const char *corpus_build_split(const char *name, char id[CORPUS_MAX_NAME + 1],
                               char kind[CORPUS_MAX_NAME + 1]);

/* corpus_build_no_memory(e): Returns ST_ENOMEM and fills *e. */
enum status corpus_build_no_memory(struct errinfo *e);

#endif
