#include "frames.h"

#include <math.h>

#include "cloudpoints.h"
#include "face_work.h"
#include "lattice.h"
#include "mem.h"
#include "quality.h"

/* A frame that is more likely of the base's person than not is fused.  Another one shows somebody
 * else if it tells as much as TELLS, and its score against the fused face is below this for each mm
 * of its residual: a noisy frame scores less than its noise explains.  Of a depth camera's frames
 * from nine sides none of 405 was taken for somebody else's; of those of other people half were,
 * of a good scanner's six in seven, and nearly all others were left out. */
#define FRAMES_SAME  0.0
#define FRAMES_OTHER (-20.0)
#define FRAMES_TELLS 14.0

/* mm: a frame whose median gap to the base is less shows the same surface.  Of 1,061 pairs of people
 * the nearest lie 0.5 mm apart, which is a false match; frames of a good scanner 0.2. */
#define FRAMES_CLOSE_MM 0.4

/* Share of a step of depth that is added to that: the greatest error of one. */
#define FRAMES_STEP 0.5

/* How many of the best frames are tried as the base. */
#define FRAMES_BASES 3

/* degrees, of yaw and pitch: the base's view is that of the fused face.  By hand. */
#define FRAMES_TURN_DEG 15.0

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
        f->near = (struct scan_near){search.find.pose[0].unit_mm,
                                     pose_unscaled(&search.fit.pose)};
        f->placed = true;
    }
    return one->st == ST_ENOMEM || one->st == ST_EBUSY ? one->st : ST_OK;
}

/* ---- the base, and who lies on it */

/* How good a base a frame is: by what it tells, and half as good if it is turned by TURN. */
static double worth(const struct frames *f, uint32_t i)
{
    const struct frames_one *one = &f->one[i];
    const double yaw = one->found.yaw_deg / FRAMES_TURN_DEG;
    const double pitch = one->found.pitch_deg / FRAMES_TURN_DEG;
    const double turned = yaw * yaw + pitch * pitch;

    return fuse_worth(&one->face, f->w) / (1 + (isnan(turned) ? 0 : turned));
}

/* The score of a frame against the base, from its heights in the base's cells. */
static enum status score(struct frames *f, uint32_t i, const float own[GRID_N],
                         double *out)
{
    struct surface_face *face = &f->one[i].face;
    struct surface_comparison c = {.score = 0};
    enum status st =
        encode_heights(&f->w->encode, own, (double)face->encoding.residual_mm,
                       &f->w->normal, &face->encoding);

    if (st == ST_OK)
        st = status_from(surface_compare(f->w, &f->one[f->base].face, face, &c));
    *out = c.score;
    return st;
}

/* Does the frame show the base's surface, as far as their depths can tell? */
static bool near(const struct frames *f, uint32_t i)
{
    const float *step[] = {&f->one[f->base].face.step_mm, &f->one[i].face.step_mm};
    const double coarser = fmax((double)*step[0], (double)*step[1]);

    return f->one[i].at.gap_mm <= FRAMES_CLOSE_MM + FRAMES_STEP * quality_step(coarser);
}

static void put_there(const float z[GRID_N], bool there[GRID_N])
{
    for (uint32_t i = 0; i < GRID_N; i++)
        there[i] = !isnan(z[i]);
}

/* Lays each on the base; *close: all are so near to it that no score is needed. */
static enum status lay_all(struct frames *f, const float z[GRID_N], bool scored,
                           bool *close)
{
    enum status st = ST_OK;
    float own[GRID_N];

    *close = true;
    for (uint32_t i = 0; st == ST_OK && i < f->n; i++) {
        struct frames_one *one = &f->one[i];

        one->score = 0;
        if (!one->built || i == f->base)
            continue;
        st = fuse_register(&f->one[f->base].face, z, &one->face, f->w, &one->at, own);
        put_there(own, one->there);
        *close = *close && near(f, i);
        if (st == ST_OK && scored)
            st = score(f, i, own, &one->score);
    }
    return st;
}

/* All others over f->base, with their scores if one of them is not near to it. */
static enum status compare_all(struct frames *f, bool *close)
{
    struct surface_face *base = &f->one[f->base].face;
    float z[GRID_N];
    enum status st = fuse_cells(base, f->w, z);

    put_there(z, f->one[f->base].there);
    if (st == ST_OK)
        st = lay_all(f, z, false, close);
    if (st != ST_OK || *close)
        return st;
    st = encode_heights(&f->w->encode, z, (double)base->encoding.residual_mm,
                        &f->w->normal, &base->encoding);
    return st == ST_OK ? lay_all(f, z, true, close) : st;
}

/* The k-th best of the frames that are built. */
static uint32_t nth_best(const struct frames *f, uint32_t k)
{
    bool seen[SURFACE_FRAMES_MAX] = {false};
    uint32_t best = 0;

    for (uint32_t j = 0; j <= k; j++) {
        double most = -INFINITY;

        for (uint32_t i = 0; i < f->n; i++)
            if (f->one[i].built && !seen[i] && worth(f, i) > most) {
                most = worth(f, i);
                best = i;
            }
        seen[best] = true;
    }
    return best;
}

/* The best frame is the base, or one of the next if half of the others lie on that one alone. */
static enum status choose_base(struct frames *f, uint32_t built, bool *close)
{
    enum status st = ST_OK;

    for (uint32_t k = 0; st == ST_OK && k < built && k < FRAMES_BASES; k++) {
        uint32_t alike = 0;

        f->base = nth_best(f, k);
        if ((st = compare_all(f, close)) != ST_OK || *close)
            return st;
        for (uint32_t i = 0; i < f->n; i++)
            alike += f->one[i].built && i != f->base &&
                     (f->one[i].score > FRAMES_SAME || near(f, i));
        if (2 * alike >= built - 1)
            return ST_OK;
    }
    f->base = nth_best(f, 0);
    return st == ST_OK ? compare_all(f, close) : st;
}

static enum status judge_all(struct frames *f, uint32_t built)
{
    bool close = true;
    const enum status st = choose_base(f, built, &close);

    for (uint32_t i = 0; st == ST_OK && !close && i < f->n; i++) {
        struct frames_one *one = &f->one[i];

        if (one->built && i != f->base && !near(f, i) &&
            !(one->score > FRAMES_SAME && one->at.gap_mm <= FUSE_GAP_MM))
            one->st = ST_EAPART;
    }
    return st;
}

/* Does one of those that were left out show another person than the face does? */
static enum status find_others(struct frames *f, const struct surface_face *face)
{
    struct surface_comparison c;
    enum status st = ST_OK;
    bool other = false;

    for (uint32_t i = 0; st == ST_OK && i < f->n; i++) {
        struct frames_one *one = &f->one[i];

        if (!one->built || one->st != ST_EAPART)
            continue;
        st = status_from(surface_compare(f->w, face, &one->face, &c));
        if (st == ST_OK && c.expected >= FRAMES_TELLS &&
            c.score <= FRAMES_OTHER * (double)one->face.encoding.residual_mm) {
            one->score = c.score;
            one->st = ST_EPEOPLE;
            other = true;
        }
    }
    return st == ST_OK && other ? ST_EPEOPLE : st;
}

/* ---- the fused face */

/* The area, on the mean face, that each of n frames has measured and none before it, in all and by halves of
 * regions; then as shares of what all of them have. */
static void put_shares(const struct encode_basis *e, uint32_t n,
                       struct frames_one *const one[])
{
    struct surface_gain all = {.share = 0};

    for (uint32_t i = 0; i < GRID_N; i++) {
        const enum surface_region region = grid_region_of(i);
        const int side = grid_x(i) > 0;
        uint32_t k = 0;
        double area;

        while (k < n && !one[k]->there[i])
            k++;
        if (k == n || !(e->normal_z[i] > 0.0f))
            continue;
        area = 1 / (double)e->normal_z[i];
        all.share += area;
        all.part[region][side] += area;
        one[k]->adds.share += area;
        one[k]->adds.part[region][side] += area;
    }
    for (uint32_t k = 0; k < n; k++) {
        double *part = &one[k]->adds.part[0][0];

        one[k]->adds.share /= fmax(all.share, 1);
        for (int i = 0; i < 2 * SURFACE_REGIONS; i++)
            part[i] /= fmax((&all.part[0][0])[i], 1);
    }
}

/* The points of the fused surface, and what each frame adds to it. */
static enum status fuse(struct frames *f, struct cloudpoints *out)
{
    const struct surface_face *face[SURFACE_FRAMES_MAX];
    struct fuse_place at[SURFACE_FRAMES_MAX];
    struct frames_one *one[SURFACE_FRAMES_MAX] = {&f->one[f->base]};
    double noise_mm[SURFACE_FRAMES_MAX];
    uint32_t n = 0;
    enum status st;

    for (uint32_t i = 0; i < f->n; i++)
        if (i != f->base && f->one[i].st == ST_OK) {
            at[n] = f->one[i].at;
            face[n++] = &f->one[i].face;
            one[n] = &f->one[i];
        }
    *out = (struct cloudpoints){.unit_mm = 1};
    st = fuse_points(&one[0]->face, n, face, at, f->w, &out->at, &out->n, noise_mm);
    for (uint32_t k = 0; st == ST_OK && k <= n; k++)
        one[k]->adds = (struct surface_gain){.place = k + 1, .noise_mm = noise_mm[k]};
    if (st == ST_OK)
        put_shares(&f->w->encode, n + 1, one);
    return st;
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
    out->step_mm = fused->step_mm;
    out->warnings &= ~(1U << SURFACE_STEPPED);
    out->warnings |= fused->warnings & 1U << SURFACE_STEPPED;
    out->quality = fused->quality;
}

/* Steps of depth that the fused face still has: of frames that are moved a little against each other
 * their errors average as noise does. */
static double step_left(const struct frames *f)
{
    double sum = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < f->n; i++)
        if (f->one[i].built && f->one[i].st == ST_OK) {
            sum += (double)f->one[i].face.step_mm;
            n++;
        }
    return n > 0 ? sum / n / sqrt(n) : 0;
}

static enum status frames_build(struct frames *f, struct surface_face *out,
                                struct surface_found *found)
{
    const struct surface_found *base = &f->one[f->base].found;
    const struct scan_options how = {.axes = SCAN_AXES_SCANNER,
                                     .enrolment = f->how.enrolment,
                                     .stop = f->how.stop,
                                     .step_mm = step_left(f)};
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
    enum status st, others;

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
    st = judge_all(f, built);
    if (st == ST_OK)
        st = frames_build(f, out, found);
    if (st == ST_ENOMEM || st == ST_EBUSY)
        return st;
    others = find_others(f, st == ST_OK ? out : &f->one[f->base].face);
    return others != ST_OK ? others : st;
}

void frames_free(struct frames *f)
{
    for (uint32_t i = 0; i < f->n; i++)
        face_free(&f->one[i].face);
    f->n = 0;
}
