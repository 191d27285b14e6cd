/* corpus.h -- a collection of scans to learn from or to evaluate on: which scans it has, of
 * which subject, of what kind.  The scans themselves are not opened.
 *
 * A folder of scans (by the endings of their names: cloudformat.h; no subfolders), named
 * SUBJECT_KIND.ply: the subject is what comes before the first underscore, the kind the
 * rest; neither may be empty.  Whatever else is in the folder is listed with the reason why it
 * is left out; names that begin with a dot are not looked at.  Or a manifest, a CSV file (csv.h); a folder's manifest is index.csv.
 * Its columns, in any order:
 *   file                  the scan, relative to the manifest's folder
 *   subject, or else id   whose it is
 *   kind                  what it is, any word; optional
 *   population            non-mated pairs are of one population; optional
 *   yaw pitch roll tx ty tz   the pose it was given, degrees and mm: all or none, optional
 * Other columns are ignored.  A file subjects.csv beside it is optional too: columns id and,
 * both optional, population and relative_of (a close relative's id).
 *
 * Of each subject one scan is enrolled: the first of kind `enroll`, or else the first one
 * (a folder's by name, a manifest's as they stand there).  All others are probes. */
#ifndef LEARN_CORPUS_H
#define LEARN_CORPUS_H
#include <stdbool.h>
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
     * scans (train_motion_centre()). */
    double pose[6];
};

struct corpus_subject {
    char *id;
    uint32_t enrolled;    /* of corpus.scan */
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

/* Immutable once read. */
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
};

/* corpus_read(path, out, e): the scans of a folder or of a manifest.
 * out  new object, released by corpus_free(); NULL on error
 * Names are valid UTF-8 without control characters.  Every file is there and readable.
 * Returns ST_OK; ST_ENOTFOUND, ST_EIO a file or the folder; ST_EINVAL no scans, a malformed
 * table or name, a scan listed twice, a subject in two populations; ST_ELIMIT; ST_ENOMEM.
 * Messages say file, line and column. */
enum status corpus_read(const char *path, struct corpus **out, struct errinfo *e);
void corpus_free(struct corpus *c); /* NULL is allowed */

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
