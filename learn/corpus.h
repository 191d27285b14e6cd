/* corpus.h -- a collection of scans to learn from or to evaluate on: which scans it has, of
 * which subject, of what kind.  The scans themselves are not opened.  It is read by
 * corpus_read.h or corpus_pairs.h. */
#ifndef LEARN_CORPUS_H
#define LEARN_CORPUS_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "errinfo.h"

#define CORPUS_MAX_SCANS 1000000
#define CORPUS_MAX_NAME  128 /* bytes of a subject's id, a kind or a population */
#define CORPUS_NONE      UINT32_MAX

struct corpus_scan {
    char *file;       /* as listed */
    char *path;       /* as it is opened */
    uint32_t subject; /* of corpus.subject */
    uint32_t kind;    /* of corpus.kind */
    bool enrolled;
    /* If corpus.posed: yaw, pitch, roll (degrees), tx, ty, tz (mm).  A point p of the head is
     * at Rz Rx Ry p plus the shift, where p is relative to some point that is the same in all
     * scans. */
    double pose[6];
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
    bool posed;                     /* the poses are known */
    struct corpus_left *left;       /* [nleft], by name */
    uint32_t nleft, nleft_scan;     /* of them scans */
    struct corpus_listed *listed; /* [nlisted], as listed; of a folder or manifest none */
    size_t nlisted;
};

void corpus_free(struct corpus *c); /* NULL is allowed */

/* corpus_enroll(c, kind, e): enroll of each subject the first scan of this kind instead, and
 * nothing of a subject that has none.  ST_EINVAL: nobody has one; c is as it was. */
enum status corpus_enroll(struct corpus *c, const char *kind, struct errinfo *e);

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

#endif
