#include "session.h"

#include <math.h>

#include "json.h"

static const char *name_of(const struct session *s, size_t i)
{
    return s->frame[i].name[0] != '\0' ? s->frame[i].name : "a frame";
}

/* Why a frame that has a face is left out. */
static void tell_apart(struct session *s, size_t i, const struct surface_frame *f)
{
    struct errinfo *why = &s->frame[i].why;
    const char *own = name_of(s, i), *base = name_of(s, s->base);

    if (f->status == SURFACE_EPEOPLE)
        (void)errinfo_set(why, ST_EPEOPLE,
                          "%.80s shows another person than %.80s: send the frames of one "
                          "person",
                          own, base);
    else if (isinf(f->gap_mm))
        (void)errinfo_set(why, ST_EAPART,
                          "%.80s has too little in common with %.80s to be laid on it: "
                          "hold the head still",
                          own, base);
    else
        (void)errinfo_set(
            why, ST_EAPART,
            "%.80s does not lie on %.80s well enough to show the same person "
            "(median gap %.1f mm, score %.1f): it is too noisy, another "
            "expression, or somebody else",
            own, base, f->gap_mm, f->score);
}

/* The report on the frames that were read: number[k] is that of the k-th. */
static void session_report(struct session *s, const struct surface_frame *frame,
                           const size_t *number, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        struct session_frame *f = &s->frame[number[k]];
        const enum status st = status_from(frame[k].status);

        f->found.scan = frame[k].found;
        f->why.code = st;
        sample_close(&f->points, &f->found);
        if (st == ST_EPEOPLE || st == ST_EAPART)
            tell_apart(s, number[k], &frame[k]);
        else if (st != ST_OK)
            sample_refuse(name_of(s, number[k]), st, &f->found, &f->why);
    }
}

static void put_read(struct session *s)
{
    const char *base = s->frame[s->base].found.digest;

    s->read[0] = '\0';
    digest_read_add(s->read, base);
    for (size_t i = 0; i < s->ndigest; i++)
        if (s->digest[i] != base)
            digest_read_add(s->read, s->digest[i]);
}

/* What is said of them all: of the first frame with that status, if there is one. */
static enum status conclude(const struct session *s, enum status st,
                            const struct sample_found *found, struct errinfo *e)
{
    if (st == ST_OK)
        return st;
    for (size_t i = 0; i < s->n; i++)
        if (s->frame[i].why.code == st && (st == ST_EPEOPLE || s->n == 1)) {
            *e = s->frame[i].why;
            return st;
        }
    for (size_t i = 0; i < s->n; i++)
        if (s->frame[i].why.code == ST_OK) {
            sample_refuse("the fused frames", st, found, e);
            return st;
        }
    for (size_t i = 0; i < s->n; i++)
        if (s->frame[i].why.code == st)
            return errinfo_set(e, st, "none of the %zu frames shows a face; %s", s->n,
                               s->frame[i].why.msg);
    return e->code = st;
}

enum status session_build(struct session *s, const struct sample_options *o,
                          struct surface_work *w, struct surface_face **out,
                          struct sample_found *found, struct errinfo *e)
{
    const struct surface_stop stop = sample_stop(o);
    struct surface_cloud cloud[SURFACE_FRAMES_MAX];
    struct surface_frame frame[SURFACE_FRAMES_MAX];
    size_t number[SURFACE_FRAMES_MAX];
    struct surface_found fused = {0};
    uint32_t n = 0, base = 0;
    enum status st;

    s->ndigest = 0;
    for (size_t i = 0; i < s->n; i++) {
        struct session_frame *f = &s->frame[i];

        if (f->why.code != ST_OK)
            continue;
        if (!sample_open(&f->points, o, &stop, &cloud[n], &f->found))
            return errinfo_set(e, ST_ENOMEM, "no memory for the frames");
        s->digest[s->ndigest++] = f->found.digest;
        frame[n] = (struct surface_frame){0};
        number[n++] = i;
    }
    if (n == 0)
        return conclude(s, s->frame[0].why.code, found, e);
    st = status_from(surface_fuse(w, n, cloud, frame, &base, out, &fused));
    s->base = number[base];
    session_report(s, frame, number, n);
    put_read(s);
    *found = s->frame[s->base].found;
    fused.unit_found = found->scan.unit_found;
    found->scan = fused;
    if (st == ST_ENOMEM || st == ST_EBUSY)
        return errinfo_set(e, st, "fusing the frames: %s", status_message(st));
    return conclude(s, st, found, e);
}

void session_describe(struct json *j, const struct session *s)
{
    json_array(j, "frames");
    for (size_t i = 0; i < s->n; i++) {
        const struct errinfo *why = &s->frame[i].why;

        json_object(j, NULL);
        json_text(j, "file", s->frame[i].name);
        json_flag(j, "used", why->code == ST_OK);
        if (why->code == ST_OK) {
            json_text(j, "reason", NULL);
        } else {
            json_object(j, "reason");
            json_text(j, "code", status_refusal(why->code));
            json_text(j, "detail", why->msg);
            json_close(j);
        }
        json_close(j);
    }
    json_close(j);
}

void session_free(struct session *s)
{
    for (size_t i = 0; i < s->n; i++)
        cloudpoints_free(&s->frame[i].points);
    s->n = 0;
}
