#include "store_import.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "archive.h"
#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "row_event.h"
#include "row_subject.h"
#include "row_template.h"
#include "store_archive.h"
#include "store_rules.h"
#include "store_txn.h"

/* ---- reading an archive */

struct reading {
    FILE *from;
    const struct keyfile *k;
    struct archive *a;
    const char *made_by;
    uint64_t outdated;
    struct store_archive_item item;
    uint64_t subjects, templates;
};

/* Once more from its beginning. */
static enum status begin(struct reading *m, struct errinfo *e)
{
    archive_close(m->a);
    m->a = NULL;
    m->subjects = m->templates = 0;
    memset(&m->item, 0, sizeof m->item);
    rewind(m->from);
    return archive_open(m->from, m->k, &m->a, e);
}

static enum status next(struct reading *m, struct store_archive_item **out,
                        struct errinfo *e)
{
    const unsigned char *data;
    bool last = false;
    size_t n = 0;
    enum status st;

    *out = &m->item;
    if ((st = archive_read(m->a, &data, &n, &last, e)) != ST_OK ||
        (st = store_archive_parse(data, n, &m->item, e)) != ST_OK)
        return st;
    if (last != (m->item.kind == STORE_ARCHIVE_END) ||
        (last && (m->item.subjects != m->subjects || m->item.templates != m->templates)))
        return errinfo_set(e, ST_ECORRUPT, "the archive's end does not fit it");
    m->subjects += m->item.kind == STORE_ARCHIVE_SUBJECT;
    m->templates += m->item.kind == STORE_ARCHIVE_TEMPLATE;
    return ST_OK;
}

/* Is the template what it says it is? */
static enum status verify_template(struct reading *m, struct face_work *w, struct face *f,
                                   struct errinfo *e)
{
    const struct store_template *t = &m->item.template;
    struct errinfo why = {ST_OK, ""};
    char digest[65];
    enum status st;

    if ((st = codec_decode(m->item.model, m->item.len, w, f, &why)) != ST_OK)
        return errinfo_set(e, st, "template %s: %.180s", t->id, why.msg);
    if ((st = codec_digest(&f->surface.mesh, digest)) != ST_OK)
        return errinfo_set(e, st, "out of memory");
    if (f->surface.mesh.nv != t->points || mesh_real(&f->surface.mesh) != t->triangles ||
        strcmp(digest, t->digest) != 0)
        return errinfo_set(e, ST_ECORRUPT, "template %s is not what it says it is",
                           t->id);
    m->outdated += !face_same_engine(t->engine, m->made_by);
    return ST_OK;
}

/* All of it, before anything is written: that takes the time, and no writer waits for it. */
static enum status verify(struct reading *m, const struct model *model, struct errinfo *e)
{
    struct face_work *w = face_work_new(model);
    struct store_archive_item *item = &m->item;
    struct face f = {0};
    enum status st;

    if (w == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if ((st = begin(m, e)) == ST_OK)
        do {
            if ((st = next(m, &item, e)) == ST_OK && item->kind == STORE_ARCHIVE_TEMPLATE)
                st = verify_template(m, w, &f, e);
        } while (st == ST_OK && item->kind != STORE_ARCHIVE_END);
    face_free(&f);
    face_work_free(w);
    return st;
}

/* ---- its rows */

struct importing {
    struct store_txn t;
    const struct store_act *by;
    struct store_imported *out;
    struct row_subject p;     /* the last subject */
    struct store_subject who; /* the same, as it is here */
    bool left_out;            /* it was erased here */
};

/* The subject that the next templates are of: that of the same uid, whose id may be another by
 * now, or that of the id; ST_ENOTFOUND: neither, or it is left out. */
static enum status find_subject(struct importing *m, const struct store_subject *s,
                                struct errinfo *e)
{
    enum status st = row_event_erased(&m->t, s->uid, NULL, &m->left_out, e);

    if (st != ST_OK)
        return st;
    if (m->left_out)
        return ST_ENOTFOUND;
    st = row_subject_same(&m->t, s->uid, &m->p, &m->who, e);
    if (st != ST_ENOTFOUND)
        return st;
    m->who = *s;
    if ((st = row_subject_find(&m->t, s->id, &m->p, e)) != ST_ENOTFOUND)
        return st;
    st = row_event_erased(&m->t, NULL, s->id, &m->left_out, e);
    return st == ST_OK ? ST_ENOTFOUND : st;
}

static enum status add_subject(struct importing *m, const struct store_subject *s,
                               struct errinfo *e)
{
    enum status st = find_subject(m, s, e);

    m->out->subjects++;
    if (st != ST_ENOTFOUND)
        return st;
    if (m->left_out) {
        m->out->erased++;
        return ST_OK;
    }
    if ((st = row_subject_add(&m->t, s, &m->p, e)) != ST_OK)
        return st;
    m->out->new_subjects++;
    return row_subject_tell(&m->t, m->by, "import", s->id, &m->p, "created", e);
}

static enum status add_template(struct importing *m, const struct store_archive_item *i,
                                struct errinfo *e)
{
    const struct store_template *t = &i->template;
    struct store_template there;
    bool found = false;
    enum status st;

    m->out->templates++;
    if (m->left_out)
        return ST_OK;
    if ((st = row_template_same(&m->t, &m->p, t->digest, &there, &found, e)) != ST_OK ||
        found)
        return found && st == ST_ECORRUPT ? ST_OK : st; /* it is left as it is */
    st = row_template_get(&m->t, t->id, &there, e);
    if (st == ST_OK || st == ST_ECORRUPT)
        return errinfo_set(e, ST_EEXISTS,
                           "there is another template with the id %s already", t->id);
    if (st != ST_ENOTFOUND ||
        (st = store_rules_room(m->who.id, m->p.templates, e)) != ST_OK ||
        (st = row_template_add(&m->t, &m->p, t, i->model, i->len, e)) != ST_OK)
        return st;
    m->out->new_templates++;
    if ((st = row_template_tell(&m->t, m->by, "import", m->who.id, t->id, "created",
                                e)) == ST_OK &&
        (st = row_subject_count(&m->t, m->by, m->who.id, &m->p, 1, e)) == ST_OK)
        m->p.templates++;
    return st;
}

/* Records that were verified, in one transaction. */
static enum status add_all(struct store *s, const struct store_act *by,
                           struct reading *from, bool dry, struct store_imported *out,
                           struct errinfo *e)
{
    struct importing m = {.by = by, .out = out};
    struct store_archive_item *item = NULL;
    enum status st;

    if ((st = store_txn_begin(s, SQL_WRITE, &m.t, e)) != ST_OK)
        return st;
    do {
        if ((st = next(from, &item, e)) != ST_OK)
            break;
        if (item->kind == STORE_ARCHIVE_SUBJECT)
            st = add_subject(&m, &item->subject, e);
        else if (item->kind == STORE_ARCHIVE_TEMPLATE)
            st = add_template(&m, item, e);
    } while (st == ST_OK && item->kind != STORE_ARCHIVE_END);
    sodium_memzero(&m.p, sizeof m.p);
    sodium_memzero(&m.who, sizeof m.who);
    if (st == ST_OK && dry) {
        (void)store_txn_end(&m.t, ST_EDENIED, NULL); /* rolled back */
        return ST_OK;
    }
    return store_txn_end(&m.t, st, e);
}

enum status store_import(struct store *s, const char *actor, const char *path,
                         const struct keyfile *k, bool dry, struct store_imported *out,
                         struct errinfo *e)
{
    struct reading m = {.k = k, .made_by = s->made_by};
    struct store_act by;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    if ((m.from = fopen(path, "rb")) == NULL)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO,
                           "cannot read %.160s: %s", path, strerror(errno));
    if ((st = verify(&m, s->model, e)) == ST_OK && (st = begin(&m, e)) == ST_OK)
        st = add_all(s, &by, &m, dry, out, e);
    out->outdated = m.outdated;
    archive_close(m.a);
    (void)fclose(m.from);
    return st;
}
