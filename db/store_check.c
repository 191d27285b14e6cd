/* store_check() of store.h: is everything in the database as it was written? */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "mst.h"
#include "store_engine.h"

struct checking {
    struct store_check *found;
    store_report *report;
    void *arg;
    struct face_work *work;
    struct face face;
};

static void count_problem(void *arg, const char *line)
{
    struct checking *c = arg;

    c->found->problems++;
    c->report(c->arg, line);
}

/* A row so damaged that it describes no template, or whose model cannot be decoded. */
static void count_template(void *arg, const char *line)
{
    struct checking *c = arg;

    c->found->templates++;
    c->found->bad_templates++;
    count_problem(arg, line);
}

static enum status check_template(void *arg, const struct store_template *t,
                                  const void *model, size_t len, struct errinfo *e)
{
    struct checking *c = arg;
    const struct mesh *m = &c->face.mesh;
    char digest[65];
    enum status st;

    if ((st = codec_decode(model, len, c->work, &c->face, e)) != ST_OK) {
        struct errinfo why;

        if (e != NULL)
            why = *e;
        else
            (void)errinfo_set(&why, st, "%s", status_message(st));
        if (st == ST_EVERSION)
            st = ST_ECORRUPT; /* of this template, not of the check */
        return errinfo_set(e, st, "template %s: %.180s", t->id, why.msg);
    }
    if (m->nv != t->points || mesh_real(m) != t->triangles)
        return errinfo_set(e, ST_ECORRUPT,
                           "template %s: its row says %u points and %u "
                           "triangles, its model %u and %u",
                           t->id, t->points, t->triangles, m->nv, mesh_real(m));
    if (mesh_check(m, true) != ST_OK)
        return errinfo_set(e, ST_ECORRUPT,
                           "template %s: its triangulation is not Delaunay", t->id);
    if (mst_check(m) != ST_OK)
        return errinfo_set(e, ST_ECORRUPT,
                           "template %s: its spanning tree is not minimal", t->id);
    if ((st = codec_digest(m, digest)) != ST_OK)
        return errinfo_set(e, st, "out of memory");
    if (strcmp(digest, t->digest) != 0)
        return errinfo_set(e, ST_ECORRUPT,
                           "template %s: its digest is not that of its "
                           "points",
                           t->id);
    c->found->templates++;
    return ST_OK;
}

static void count_event(void *arg, uint64_t seq, const char *line)
{
    char text[240];

    (void)snprintf(text, sizeof text, "audit log, entry %" PRIu64 ": %s", seq, line);
    count_problem(arg, text);
}

enum status store_check(struct store *s, void (*report)(void *arg, const char *line),
                        void *arg, struct store_check *out, struct errinfo *e)
{
    struct checking c = {.found = out, .report = report, .arg = arg};
    struct store_audit audit;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((c.work = face_work_new(store_model(s))) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if ((st = s->engine->check(s, count_problem, &c, e)) == ST_OK &&
        (st = store_audit_verify(s, count_event, &c, &audit, e)) == ST_OK) {
        out->events = audit.entries;
        st = s->engine->template_each(s, check_template, count_template, &c, e);
    }
    face_free(&c.face);
    face_work_free(c.work);
    return st;
}
