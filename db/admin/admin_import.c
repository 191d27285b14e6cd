#include "admin_import.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "admin_archive.h"
#include "digest.h"
#include "log_row.h"
#include "admin_record.h"
#include "store_rules.h"
#include "store_txn.h"

/* ---- reading an archive */

struct reading {
    FILE *from;
    const struct crypt_file *k;
    struct admin_archive *a;
    const char *made_by;
    uint64_t outdated;
    struct admin_record_item item;
    uint64_t subjects, templates;
};

/* Once more from its beginning. */
static enum status begin(struct reading *m, struct errinfo *e)
{
    admin_archive_close(m->a);
    m->a = NULL;
    m->subjects = m->templates = 0;
    memset(&m->item, 0, sizeof m->item);
    rewind(m->from);
    return admin_archive_open(m->from, m->k, &m->a, e);
}

static enum status next(struct reading *m, struct admin_record_item **out,
                        struct errinfo *e)
{
    const unsigned char *data;
    bool last = false;
    size_t n = 0;
    enum status st;

    *out = &m->item;
    if ((st = admin_archive_read(m->a, &data, &n, &last, e)) != ST_OK ||
        (st = admin_record_parse(data, n, &m->item, e)) != ST_OK)
        return st;
    if (last != (m->item.kind == ADMIN_RECORD_END) ||
        (last && (m->item.subjects != m->subjects || m->item.templates != m->templates)))
        return errinfo_set(e, ST_ECORRUPT, "the archive's end does not fit it");
    m->subjects += m->item.kind == ADMIN_RECORD_SUBJECT;
    m->templates += m->item.kind == ADMIN_RECORD_TEMPLATE;
    return ST_OK;
}

/* Is the template what it says it is? */
static enum status verify_template(struct reading *m, struct surface_work *w,
                                   struct surface_face **f, struct errinfo *e)
{
    const struct store_template *t = &m->item.template.one;
    char digest[65];
    enum status st;

    if ((st = status_from(surface_decode(w, m->item.face, m->item.len, f))) != ST_OK)
        return errinfo_set(e, st, "template %s: %s", t->id, status_message(st));
    if ((st = digest_points(*f, digest)) != ST_OK)
        return errinfo_set(e, st, "out of memory");
    if (surface_face_points(*f, NULL) != t->points ||
        surface_face_triangles(*f, NULL) != t->triangles ||
        strcmp(digest, t->digest) != 0)
        return errinfo_set(e, ST_ECORRUPT, "template %s is not what it says it is",
                           t->id);
    m->outdated += !surface_same_engine(t->engine, m->made_by);
    return ST_OK;
}

/* All of it, before anything is written: that takes the time, and no writer waits for it. */
static enum status verify(struct reading *m, const struct surface_model *model,
                          struct errinfo *e)
{
    struct surface_work *w = surface_work_new(model);
    struct admin_record_item *item = &m->item;
    struct surface_face *f = NULL;
    enum status st;

    if (w == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    if ((st = begin(m, e)) == ST_OK)
        do {
            if ((st = next(m, &item, e)) == ST_OK && item->kind == ADMIN_RECORD_TEMPLATE)
                st = verify_template(m, w, &f, e);
        } while (st == ST_OK && item->kind != ADMIN_RECORD_END);
    surface_face_free(f);
    surface_work_free(w);
    return st;
}

/* ---- its rows */

struct importing {
    struct log_txn t;
    const struct log_act *by;
    struct admin_imported *out;
    struct rows_subject of;   /* the last subject, as it is here */
    size_t templates;         /* that it has */
    bool left_out;            /* it was erased here */
    struct log_entry *erased; /* [nerased], the changes that say who was */
    size_t nerased;
};

static bool was_erased(const struct importing *m, const unsigned char uid[STORE_UID])
{
    for (size_t i = 0; i < m->nerased; i++)
        if (memcmp(m->erased[i].uid, uid, STORE_UID) == 0)
            return true;
    return false;
}

/* The subject of this uid, under whatever id.  ST_ENOTFOUND: there is none, or it is left out. */
static enum status find_subject(struct importing *m, const struct store_subject *s,
                                struct errinfo *e)
{
    struct rows_template *list = NULL;
    struct rows_subject other;
    enum status st;

    m->templates = 0;
    m->left_out = was_erased(m, s->uid);
    if (m->left_out)
        return ST_ENOTFOUND;
    if ((st = rows_subject_get(&m->t, s->uid, &m->of, e)) == ST_OK) {
        st = rows_template_list(&m->t, &m->of, &list, &m->templates, e);
        free(list);
        return st;
    }
    if (st != ST_ENOTFOUND)
        return st;
    st = rows_subject_find(&m->t, s->id, &other, e);
    sodium_memzero(&other, sizeof other);
    if (st != ST_OK)
        return st;
    return errinfo_set(
        e, ST_EEXISTS,
        "subject %s of the archive was enrolled elsewhere, and the %s that is "
        "enrolled here need not be the same person: rename or erase that one "
        "first; nothing was imported",
        s->id, s->id);
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
    if ((st = rows_subject_add(&m->t, s, &m->of, e)) != ST_OK)
        return st;
    m->out->new_subjects++;
    return log_change(&m->t, m->by, "import", s->uid, "", "created", e);
}

static enum status add_template(struct importing *m, const struct admin_record_item *i,
                                struct errinfo *e)
{
    struct rows_template row = i->template, there;
    const struct store_template *t = &row.one;
    char id[STORE_ID_LEN + 1];
    struct rows_subject other;
    enum status st;

    m->out->templates++;
    if (m->left_out)
        return ST_OK;
    if ((st = rows_template_same(&m->t, &m->of, t->digest, row.read, id, e)) != ST_OK ||
        id[0] != '\0')
        return st; /* it is left as it is */
    st = rows_template_get(&m->t, t->id, &there, &other, e);
    sodium_memzero(&other, sizeof other);
    if (st == ST_OK || st == ST_ECORRUPT)
        return errinfo_set(e, ST_EEXISTS,
                           "there is another template with the id %s already", t->id);
    if (st != ST_ENOTFOUND ||
        (st = store_rules_room(m->of.one.id, m->templates, e)) != ST_OK ||
        (st = rows_template_add(&m->t, &m->of, &row, i->face, i->len, e)) != ST_OK)
        return st;
    m->templates++;
    m->out->new_templates++;
    return log_change(&m->t, m->by, "import", m->of.one.uid, t->id, "created", e);
}

/* Records that were verified, in one transaction. */
static enum status add_all(struct store *s, const struct log_act *by,
                           struct reading *from, bool dry, struct admin_imported *out,
                           struct errinfo *e)
{
    struct importing m = {.by = by, .out = out};
    const struct log_filter erased = {.kind = "delete_subject"};
    struct admin_record_item *item = NULL;
    enum status st;

    if ((st = store_begin(s, SQL_WRITE, &m.t, e)) != ST_OK)
        return st;
    st = log_list(m.t.sql, LOG_CHANGES, &erased, &m.erased, &m.nerased, e);
    do {
        if (st != ST_OK || (st = next(from, &item, e)) != ST_OK)
            break;
        if (item->kind == ADMIN_RECORD_SUBJECT)
            st = add_subject(&m, &item->subject, e);
        else if (item->kind == ADMIN_RECORD_TEMPLATE)
            st = add_template(&m, item, e);
    } while (st == ST_OK && item->kind != ADMIN_RECORD_END);
    free(m.erased);
    sodium_memzero(&m.of, sizeof m.of);
    if (st == ST_OK && dry) {
        (void)store_end(s, &m.t, ST_EDENIED, NULL); /* rolled back */
        return ST_OK;
    }
    return store_end(s, &m.t, st, e);
}

enum status admin_import(struct store *s, const char *actor, const char *path,
                         const struct crypt_file *k, bool dry, struct admin_imported *out,
                         struct errinfo *e)
{
    struct reading m = {.k = k, .made_by = s->made_by};
    struct log_act by;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = log_act(&by, actor, e)) != ST_OK)
        return st;
    if ((m.from = fopen(path, "rb")) == NULL)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO,
                           "cannot read %.160s: %s", path, strerror(errno));
    if ((st = verify(&m, s->model, e)) == ST_OK && (st = begin(&m, e)) == ST_OK)
        st = add_all(s, &by, &m, dry, out, e);
    out->outdated = m.outdated;
    admin_archive_close(m.a);
    (void)fclose(m.from);
    return st;
}
