#include "session.h"

#include <math.h>
#include <string.h>

#include "dry_run.h"
#include "json.h"
#include "mem.h"

static const char *name_of(const struct session *s, size_t i)
{
    return s->frame[i].name[0] != '\0' ? s->frame[i].name : "a frame";
}

/* ---- reading */

/* What the files may still have together. */
static enum status read_bytes(struct cloudfile_options *left, struct session_frame *f,
                              unsigned char *bytes, size_t len, struct errinfo *e)
{
    const unsigned char behind = bytes[len]; /* of a form: the byte after the file */
    enum status st;

    bytes[len] = 0;
    left->format = f->format;
    st = cloudfile_read(bytes, len, left, &f->points, e);
    bytes[len] = behind;
    left->max_points -= f->points.read;
    return st;
}

static enum status read_compressed(struct cloudfile_options *left,
                                   struct session_frame *f, enum inflate_coding coding,
                                   struct errinfo *e)
{
    unsigned char *bytes;
    size_t len;
    enum status st =
        inflate_body(coding, f->bytes, f->len, left->max_bytes, &bytes, &len, e);

    left->max_bytes -= len;
    if (st == ST_OK)
        st = read_bytes(left, f, bytes, len, e);
    mem_free(bytes);
    return st;
}

/* One of a list of files.  A gzip file is unpacked here, so that the limit counts its size. */
static enum status read_file(struct cloudfile_options *left, struct session_frame *f,
                             struct errinfo *e)
{
    static const unsigned char gzip[2] = {0x1f, 0x8b};

    if (f->coding == INFLATE_OTHER)
        return errinfo_set(e, ST_EINVAL,
                           "Content-Encoding may be gzip or zstd, one of them and once");
    if (f->len == 0)
        return errinfo_set(e, ST_EINVAL, "the file is empty");
    if (f->coding != INFLATE_NONE)
        return read_compressed(left, f, f->coding, e);
    if (f->len > 2 && memcmp(f->bytes, gzip, 2) == 0)
        return read_compressed(left, f, INFLATE_GZIP, e);
    return read_bytes(left, f, f->bytes, f->len, e);
}

static enum status read_frame(struct session *s, struct cloudfile_options *left, size_t i,
                              struct errinfo *e)
{
    struct session_frame *f = &s->frame[i];
    enum status st =
        s->files ? read_file(left, f, e) : read_bytes(left, f, f->bytes, f->len, e);

    f->bytes = NULL;
    f->points.axes_given = f->points.axes_given || s->axes_given;
    if (st == ST_EVERSION) /* another format, or a variant of one */
        st = e->code = ST_EINVAL;
    if (st == ST_OK || !s->files)
        return st;
    if (st == ST_ELIMIT)
        return errinfo_set(e, st, "the files together have more than %zu points",
                           s->how.max_points);
    if (st == ST_ESIZE)
        return errinfo_set(e, st,
                           "the limit is %zu bytes of all files together when unpacked",
                           s->how.max_bytes);
    if (st != ST_EINVAL && !dry_run_is_refusal(st))
        return st;
    (void)errinfo_set(&f->why, st, "%.80s: %s", name_of(s, i), e->msg);
    return ST_OK;
}

enum status session_read(struct session *s, const atomic_bool *stop, struct errinfo *e)
{
    struct cloudfile_options left = s->how;
    enum status st = sample_not_stopped(stop, e);

    for (size_t i = 0; st == ST_OK && i < s->n; i++)
        if (s->frame[i].bytes != NULL && (st = read_frame(s, &left, i, e)) == ST_OK)
            st = sample_not_stopped(stop, e);
    mem_free(s->body); /* not needed any more, and may be large */
    s->body = NULL;
    return st;
}

/* ---- building */

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
        f->adds = frame[k].adds;
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

/* Sets *e: what the first frame with this status says, if there is one. */
static enum status conclude(const struct session *s, enum status st, struct errinfo *e)
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
            sample_refuse("the fused frames", st, &s->found, e);
            return st;
        }
    for (size_t i = 0; i < s->n; i++)
        if (s->frame[i].why.code == st)
            return errinfo_set(e, st, "none of the %zu frames shows a face; %s", s->n,
                               s->frame[i].why.msg);
    return e->code = st;
}

/* The faces of all frames, as one. */
static enum status fuse(struct session *s, const struct sample_options *o,
                        struct surface_work *w, struct surface_face **out,
                        struct errinfo *e)
{
    const struct surface_stop stop = sample_stop(o);
    struct surface_cloud cloud[SURFACE_FRAMES_MAX];
    struct surface_frame frame[SURFACE_FRAMES_MAX];
    size_t number[SURFACE_FRAMES_MAX];
    struct surface_found fused = {0};
    uint32_t n = 0, base = 0;
    enum status st;

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
        return conclude(s, s->frame[0].why.code, e);
    st = status_from(surface_fuse(w, n, cloud, frame, &base, out, &fused));
    s->base = number[base];
    session_report(s, frame, number, n);
    put_read(s);
    s->found = s->frame[s->base].found;
    fused.unit_found = s->found.scan.unit_found;
    s->found.scan = fused;
    if (st == ST_ENOMEM || st == ST_EBUSY)
        return errinfo_set(e, st, "fusing the frames: %s", status_message(st));
    return conclude(s, st, e);
}

enum status session_build(struct session *s, const struct sample_options *o,
                          struct surface_work *w, struct surface_face **out,
                          struct errinfo *e)
{
    struct session_frame *f = &s->frame[0];
    enum status st = sample_not_stopped(o->stop, e);

    if (st != ST_OK || s->n > 1)
        return st == ST_OK ? fuse(s, o, w, out, e) : st;
    if (f->why.code == ST_OK) {
        f->why.code =
            sample_build(name_of(s, 0), &f->points, o, w, out, &f->found, &f->why);
        s->digest[s->ndigest++] = f->found.digest;
        put_read(s);
    }
    s->found = f->found;
    *e = f->why;
    return e->code;
}

const struct cloudpoints *session_points(const struct session *s)
{
    return &s->frame[s->base].points;
}

size_t session_parts(const struct surface_gain *g,
                     struct session_part out[SURFACE_REGIONS])
{
    size_t n = 0;

    for (int r = 0; r < SURFACE_REGIONS; r++) {
        const double right = g->part[r][0], left = g->part[r][1];

        if (right < SESSION_PART && left < SESSION_PART)
            continue;
        out[n++] = right < SESSION_PART ? (struct session_part){r, 1, left}
                   : left < SESSION_PART
                       ? (struct session_part){r, -1, right}
                       : (struct session_part){r, 0, (right + left) / 2};
    }
    return n;
}

static void describe_gain(struct json *j, const struct surface_gain *g)
{
    static const char *const side[] = {"right", NULL, "left"};
    struct session_part part[SURFACE_REGIONS];
    const size_t n = session_parts(g, part);

    if (g->place == 0) {
        json_text(j, "adds", NULL);
        return;
    }
    json_object(j, "adds");
    json_number(j, "place", g->place);
    json_number(j, "share", g->share);
    json_array(j, "parts");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        json_text(j, "region", surface_region_name(part[i].region));
        json_text(j, "side", side[part[i].side + 1]);
        json_number(j, "share", part[i].share);
        json_close(j);
    }
    json_close(j);
    json_number(j, "noise_mm", g->noise_mm);
    json_close(j);
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
        describe_gain(j, &s->frame[i].adds);
        json_close(j);
    }
    json_close(j);
}

void session_free(struct session *s)
{
    for (size_t i = 0; i < s->n; i++)
        cloudpoints_free(&s->frame[i].points);
    mem_free(s->body);
    memset(s, 0, sizeof *s);
}
