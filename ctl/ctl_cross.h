/* ctl_cross.h -- each subject in the database compared with every other.
 * A comparison is that of a verification: one scan against all templates of a subject, of which the highest
 * score counts, lowered by the logarithm of their number (surface_best_of()).  The score counts also if it
 * is inconclusive at the threshold in force: at a lower one it may match. */
#ifndef CTL_CROSS_H
#define CTL_CROSS_H
#include <stddef.h>
#include <stdint.h>
#include "libsurface.h"
#include "rates.h"
#include "store.h"

struct ctl;

#define CTL_CROSS_MAX 2000 /* subjects with faces in memory at once */

struct ctl_cross_subject {
    char id[STORE_SUBJECT_MAX + 1];
    unsigned char uid[STORE_UID];
    uint32_t first, n; /* its templates: tmpl[first] to tmpl[first + n - 1] */
};

struct ctl_cross_template {
    char id[STORE_ID_LEN + 1];
    char digest[65];
    uint32_t owner; /* index of its subject */
    uint32_t slot;  /* slot of its descriptor; SURFACE_NOWHERE: it has none */
};

struct ctl_cross {
    struct ctl_cross_subject
        *subject;                    /* [nsubject] with templates, in order of creation */
    struct ctl_cross_template *tmpl; /* [ntemplate] */
    uint32_t nsubject, ntemplate;
    struct surface_index *index; /* descriptors of the templates */
    uint32_t damaged;   /* templates that were left out, reported on standard error */
    uint32_t nenrolled; /* number of subjects in the database with templates */
    struct surface_face **face; /* [ntemplate]; NULL: not loaded */

    struct rates_score *score; /* [nscore]; subjects are indices of subject */
    size_t nscore;
};

/* Every function fills c->e if it fails. */

/* ctl_cross_list(c, p): Lists the subjects with templates, and these; reports damaged ones.
 *   p   all zero before; to be released by ctl_cross_free() */
enum status ctl_cross_list(struct ctl *c, struct ctl_cross *p);

/* ctl_cross_load(c, seed, p): Lists them, and loads the faces of the templates.  If there are more than
 * CTL_CROSS_MAX subjects, draws that many.  Skips templates that this engine cannot re-encode.
 * ST_ECORRUPT: also if one template is damaged. */
enum status ctl_cross_load(struct ctl *c, uint64_t seed, struct ctl_cross *p);

void ctl_cross_free(struct ctl_cross *p);

/* ctl_cross_non_mated(c, p, limit, seed): Adds the scores of each subject's templates against those of every
 * other subject.  If these are more than about limit comparisons of two templates, draws for each subject
 * an equal number of probes, without replacement. */
enum status ctl_cross_non_mated(struct ctl *c, struct ctl_cross *p, double limit,
                                uint64_t seed);

/* ctl_cross_mated(c, p): Adds the score of each template against the other templates of its subject. */
enum status ctl_cross_mated(struct ctl *c, struct ctl_cross *p);

#endif
