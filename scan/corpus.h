/* corpus.h -- a collection of scans to learn from or to evaluate on: which scans it has, of
 * which subject, of what kind.  The scans themselves are not opened.  It is read by
 * corpus_read.h, and by lab/corpus_pairs.h from a list. */
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
    char *file;       /* as listed */
    char *path;       /* as it is opened */
    uint32_t subject; /* of corpus.subject */
    uint32_t kind;    /* of corpus.kind */
    bool enrolled;
    char **
        frame; /* [nframe] paths of the further frames of its session (corpus_sessions()) */
    uint32_t nframe;
};

struct corpus_subject {
    char *id;             /* by corpus_pairs.h as long as a file's name */
    uint32_t enrolled;    /* of corpus.scan; CORPUS_NONE: nothing (corpus_enroll()) */
    uint32_t nscan;       /* its scans, with the enrolled one */
    uint32_t population;  /* of corpus.population */
    uint32_t relative_of; /* of corpus.subject, or CORPUS_NONE; nsubject or above: of
                             somebody without scans */
};

struct corpus_left { /* what of a folder is left out */
    char *file;      /* its name; '?' for what is not UTF-8 or a control character */
    const char *why; /* static */
    bool scan;       /* it ends like a scan's name */
};

struct corpus_listed {        /* a comparison that was asked for (corpus_pairs.h) */
    uint32_t template, probe; /* of corpus.scan */
    unsigned line;            /* of the list */
};

/* Immutable once read, but for corpus_enroll(). */
struct corpus {
    struct corpus_scan *scan; /* in a folder by name (bytes), in a manifest as listed */
    struct corpus_subject *subject; /* in order of their first scans */
    char **kind, **population;      /* names, "" where there was none */
    uint32_t nscan, nsubject;       /* at least 1 */
    uint32_t nnamed;                /* nsubject, and relatives without scans */
    uint32_t nkind, npopulation;    /* at least 1 */
    struct corpus_left *left;       /* [nleft], by name */
    uint32_t nleft, nleft_scan;     /* of them scans */
    struct corpus_listed *listed; /* [nlisted], as listed; of a folder or manifest none */
    size_t nlisted;
};

void corpus_free(struct corpus *c); /* NULL is allowed */

/* corpus_enroll(c, kind, e): enroll of each subject the first scan of this kind instead, and
 * nothing of a subject that has none.  ST_EINVAL: nobody has one; c is as it was. */
enum status corpus_enroll(struct corpus *c, const char *kind, struct errinfo *e);

/* corpus_sessions(c, n, e): scans of one subject that follow each other and whose kinds differ only in
 * what is behind the last '-' (alice_smile-1.ply, alice_smile-2.ply, ...) become one, with at most n
 * frames; the others of the session are left out.  Not of a corpus with listed pairs, and before
 * corpus_enroll().  Returns ST_OK, ST_ENOMEM. */
enum status corpus_sessions(struct corpus *c, uint32_t n, struct errinfo *e);

/* corpus_is_scan(path): whether path is a file with the extension of a scan, not of a table (.csv and
 * .txt may be either).  For usage messages: a scan was given where a collection is read. */
bool corpus_is_scan(const char *path);

/* What is left out: corpus_left_json(c, j) adds it to the JSON array that is open, and ends that;
 * corpus_left_print(c, program) lists it on standard error. */
void corpus_left_json(const struct corpus *c, struct json *j);
void corpus_left_print(const struct corpus *c, const char *program);

/* What a pair of subjects is. */
enum corpus_pair {
    CORPUS_GENUINE,  /* the same one */
    CORPUS_IMPOSTOR, /* two people of one population */
    CORPUS_RELATIVE, /* close relatives of one population: one names the other, or both
                        name the same third: counted apart */
    CORPUS_FOREIGN   /* of two populations: not compared */
};

/* corpus_pair(c, a, b): a, b of c->subject.  O(1). */
enum corpus_pair corpus_pair(const struct corpus *c, uint32_t a, uint32_t b);

/* ---- while it is read, for its readers (corpus_read.h, and of lists of pairs).  Functions that
 * return a status fill b->e on failure. */

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
