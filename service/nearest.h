/* nearest.h -- a probe against the templates of one subject: which of them decides.
 * Fusion: the comparison with the highest score decides, so that one matching template suffices;
 * an inconclusive one only where there is no other.  Each is lowered by the logarithm of their
 * number (face_best_of()), so that a stranger is accepted no more often than by one.
 * A non-match is also compared as its mirror image: a scanner that swaps left and right. */
#ifndef VERIFY_NEAREST_H
#define VERIFY_NEAREST_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "admission.h"
#include "face.h"
#include "status.h"

struct errinfo; /* errinfo.h */
struct minimal; /* minimal.h */

struct nearest {
    struct face_result result;
    size_t index;       /* which of the admission's templates */
    uint32_t compared;  /* how many there were */
    double first_score; /* against the oldest of them, not lowered */
    bool mirrored;      /* no match, but its mirror image is one: nearest_judge() */
    double score_ms;    /* over all of them */
};

/* nearest_find(c, a, probe, out, e): the probe compared with the templates of a, by the
 * calibration that c decides by.  Those that this engine cannot re-encode are left out, and
 * those beyond the first ADMISSION_MODELS that were deleted since.
 * Returns ST_OK; ST_ENOTFOUND: none was left; ST_EVERSION: none but of another engine; or as
 * admission_hold(), face_compare(). */
enum status nearest_find(struct admission_context *c, const struct admission *a,
                         const struct face *probe, struct nearest *out,
                         struct errinfo *e);

/* nearest_fit(c, a, probe, out, e): nearest_find() with those templates alone that a further sample
 * must fit: the oldest, and those that were enrolled with scope manage.  Each of the others was itself
 * enrolled because it matched one of these; if samples were held against them too, a row of
 * samples, each like the one before, would lead from the subject to anybody. */
enum status nearest_fit(struct admission_context *c, const struct admission *a,
                        const struct face *probe, struct nearest *out, struct errinfo *e);

/* nearest_judge(n, e): ST_EMIRRORED, and *e for the user, where the scan must be made again
 * with left and right in their places; else ST_OK.  It is as good a sign as a match: to be told
 * after a failed attempt was counted, as no match. */
enum status nearest_judge(const struct nearest *n, struct errinfo *e);

/* nearest_minimal(c, a, probe, of, weigh, out, e): the minimal disparity against the template
 * that decides, from nearest_find()'s `of`, which gets its alignment; weigh: by the weight of
 * each place too (face_weigh()), and of->result gets its regions.
 * Returns as face_minimal(), admission_hold(). */
enum status nearest_minimal(struct admission_context *c, const struct admission *a,
                            const struct face *probe, struct nearest *of, bool weigh,
                            struct minimal *out, struct errinfo *e);

#endif
