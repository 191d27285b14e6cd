#include "frames.h"

#include <math.h>
#include <string.h>

#include "cloudpoints.h"
#include "lattice.h"
#include "mem.h"

/* Scores against the base: of two people they are at most FRAMES_OTHER where both frames tell
 * something; of one they are hardly ever, though noise may leave less than FRAMES_SAME. */
#define FRAMES_SAME  0.0
#define FRAMES_OTHER (-6.0)

enum status frames_add(struct frames *f, struct cloudpoints *c, size_t *bad)
{
    struct frames_one *one = &f->one[f->n++];
    struct scan_search search = {.done = false};
    struct scan_options how = f->how;

    how.search = &search;
    how.near = f->placed ? &f->near : NULL;
    one->st = scan_build(c, &how, f->w, &one->face, bad, &one->found);
    one->built = one->st == ST_OK;
    if (one->built && !f->placed && search.done && search.st == ST_OK) {
        f->near = (struct scan_near){search.find.pose[0].unit_mm, search.fit.pose};
        f->placed = true;
    }
    return one->st == ST_ENOMEM || one->st == ST_EBUSY ? one->st : ST_OK;
}

/* ---- the base */

static enum status score(struct frames *f, uint32_t base, uint32_t i,
                         struct surface_comparison *out)
{
    return face_compare(&f->one[base].face, &f->one[i].face, (double)NAN, f->w, out);
}

/* How many of the other frames are more likely of the base's person than not. */
static enum status count_alike(struct frames *f, uint32_t base, uint32_t *alike)
{
    struct surface_comparison c;
    enum status st = ST_OK;

    *alike = 0;
    for (uint32_t i = 0; st == ST_OK && i < f->n; i++) {
        if (i == base || !f->one[i].built)
            continue;
        if ((st = score(f, base, i, &c)) == ST_OK)
            *alike += c.score > FRAMES_SAME;
    }
    return st;
}

/* The frame that tells most of those that half of the others agree with; where there is none, of
 * all. */
static enum status choose_base(struct frames *f, uint32_t built)
{
    bool seen[SURFACE_FRAMES_MAX] = {false};
    enum status st = ST_OK;

    for (uint32_t k = 0; k < built; k++) {
        double most = -INFINITY;
        uint32_t best = 0, alike;

        for (uint32_t i = 0; i < f->n; i++) {
            if (!f->one[i].built || seen[i])
                continue;
            if (fuse_worth(&f->one[i].face, f->w) > most) {
                most = fuse_worth(&f->one[i].face, f->w);
                best = i;
            }
        }
        seen[best] = true;
        if (k == 0)
            f->base = best;
        if ((st = count_alike(f, best, &alike)) != ST_OK)
            return st;
        if (2 * alike >= built - 1) {
            f->base = best;
            return ST_OK;
        }
    }
    return ST_OK;
}

/* ---- the others */

/* Sets one's status, score and place over the base. */
static enum status judge(struct frames *f, const float z[GRID_N], uint32_t i)
{
    struct frames_one *one = &f->one[i];
    struct surface_comparison c;
    enum status st = score(f, f->base, i, &c);

    if (st == ST_OK)
        st = fuse_register(&f->one[f->base].face, z, &one->face, f->w, &one->at);
    if (st != ST_OK)
        return st;
    one->score = c.score;
    if (c.decision == SURFACE_NO_MATCH && c.score <= FRAMES_OTHER)
        one->st = ST_EPEOPLE;
    else if (!(c.score > FRAMES_SAME) || !(one->at.gap_mm <= FUSE_GAP_MM))
        one->st = ST_EAPART;
    return ST_OK;
}

static enum status judge_all(struct frames *f)
{
    float z[GRID_N];
    bool other = false;
    enum status st = fuse_cells(&f->one[f->base].face, f->w, z);

    for (uint32_t i = 0; st == ST_OK && i < f->n; i++)
        if (f->one[i].built && i != f->base) {
            st = judge(f, z, i);
            other = other || f->one[i].st == ST_EPEOPLE;
        }
    return st == ST_OK && other ? ST_EPEOPLE : st;
}

/* ---- the fused face */

/* The points of the base with the heights of all. */
static enum status fuse(struct frames *f, struct cloudpoints *out)
{
    const struct surface_face *face[SURFACE_FRAMES_MAX];
    struct fuse_place at[SURFACE_FRAMES_MAX];
    const struct surface_face *base = &f->one[f->base].face;
    uint32_t n = 0;

    for (uint32_t i = 0; i < f->n; i++)
        if (i != f->base && f->one[i].st == ST_OK) {
            at[n] = f->one[i].at;
            face[n++] = &f->one[i].face;
        }
    *out = (struct cloudpoints){.n = base->surface.mesh.nv, .unit_mm = 1};
    if ((out->at = mem_array(out->n, sizeof *out->at)) == NULL)
        return ST_ENOMEM;
    return fuse_heights(base, n, face, at, f->w, out->at);
}

/* What is known of the base's scan, with what the gate says of the fused face, which has nothing
 * around it. */
static void put_found(const struct surface_found *base, const struct surface_found *fused,
                      struct surface_found *out)
{
    *out = *base;
    out->points_used = fused->points_used;
    out->support = fused->support;
    out->support_wanted = fused->support_wanted;
    out->evidence = fused->evidence;
    out->evidence_wanted = fused->evidence_wanted;
    out->seen = fused->seen;
    out->seen_wanted = fused->seen_wanted;
    out->residual_mm = fused->residual_mm;
    out->residual_most = fused->residual_most;
    out->head_size = fused->head_size;
    out->likeness = fused->likeness;
    out->eyes = fused->eyes;
    out->detail = fused->detail;
    out->forehead = fused->forehead;
    out->quality = fused->quality;
}

static enum status build(struct frames *f, struct surface_face *out,
                         struct surface_found *found)
{
    const struct surface_found *base = &f->one[f->base].found;
    const struct scan_options how = {.axes = SCAN_AXES_SCANNER,
                                     .enrolment = f->how.enrolment,
                                     .stop = f->how.stop};
    struct surface_found fused;
    struct cloudpoints c;
    enum status st = fuse(f, &c);

    if (st == ST_OK) {
        st = scan_build(&c, &how, f->w, out, NULL, &fused);
        put_found(base, &fused, found);
    }
    cloudpoints_free(&c);
    if (st == ST_OK && f->how.enrolment && base->occluded > SURFACE_OCCLUDED_MOST)
        return ST_EQUALITY;
    return st;
}

enum status frames_fuse(struct frames *f, struct surface_face *out,
                        struct surface_found *found)
{
    uint32_t built = 0;
    enum status st;

    for (uint32_t i = 0; i < f->n; i++)
        built += f->one[i].built;
    f->base = 0;
    *found = f->one[0].found;
    if (built == 0)
        return f->one[0].st;
    if (!f->how.frame) { /* one scan, judged as such */
        const struct surface_face former = *out;

        *out = f->one[0].face;
        f->one[0].face = former;
        return ST_OK;
    }
    st = choose_base(f, built);
    if (st == ST_OK && (st = judge_all(f)) == ST_OK)
        st = build(f, out, found);
    return st;
}

void frames_free(struct frames *f)
{
    for (uint32_t i = 0; i < f->n; i++)
        face_free(&f->one[i].face);
    f->n = 0;
}
