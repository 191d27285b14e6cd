#include "admin_archive.h"

#include <errno.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "admin_copy.h"
#include "crypt_file.h"
#include "log_row.h"
#include "sql_file.h"
#include "store_txn.h"

/* ---- export */

struct exporting {
    struct store *s;
    const char *actor;
    char *const *subjects;
    size_t n; /* 0: all */
    struct log_txn *to;
};

/* It is on record before the archive has its name. */
static enum status export_subject(void *arg, struct log_txn *from,
                                  const struct rows_subject *of, struct errinfo *e)
{
    struct exporting *x = arg;
    struct log_txn t;
    enum status st;

    if ((st = admin_copy_subject(x->to, from, of, e)) != ST_OK ||
        (st = store_begin_use(x->s, x->actor, SQL_LAZY,
                              &(struct store_use){.appends = true}, &t, e)) != ST_OK)
        return st;
    return store_end(x->s, &t, log_access(&t, "export", of->one.uid, "", "exported", e),
                     e);
}

static enum status export_subjects(void *arg, struct log_txn *from, struct log_txn *to,
                                   struct errinfo *e)
{
    struct exporting *x = arg;
    struct rows_subject of = {.revision = 0}, twice;
    enum status st = ST_OK;

    x->to = to;
    if (x->n == 0)
        return admin_each(from, export_subject, x, e);
    /* First, so that the events do not tell of an export that came to nothing. */
    for (size_t i = 0; i < x->n && st == ST_OK; i++)
        st = rows_subject_find(from, x->subjects[i], &of, e);
    for (size_t i = 0; i < x->n && st == ST_OK; i++)
        if ((st = rows_subject_find(from, x->subjects[i], &of, e)) == ST_OK &&
            (st = rows_subject_get(to, of.one.uid, &twice, e)) == ST_ENOTFOUND)
            st = export_subject(x, from, &of, e);
    sodium_memzero(&of, sizeof of);
    sodium_memzero(&twice, sizeof twice);
    return st;
}

enum status admin_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct crypt_file *k,
                         bool replace, struct admin_copied *out, struct errinfo *e)
{
    struct exporting x = {.s = s, .actor = actor, .subjects = subjects, .n = n};
    unsigned char digits[CRYPT_KEY];
    const enum crypt_kind kind =
        crypt_file_key(k, "", digits, NULL) == ST_OK ? CRYPT_FILE : CRYPT_PASSPHRASE;
    const struct store_key key = {.given = k};
    struct newfile file = NEWFILE_NONE;
    struct crypt *crypt = NULL;
    struct crypt_root root;
    struct admin_copy c = {
        .root = &root,
        .key = &key,
        .fill = export_subjects,
        .arg = &x,
        .kind = "create_archive", /* the archive does not say who made it */
        .outcome = "exported"};
    enum status st;

    sodium_memzero(digits, sizeof digits);
    if (!replace && !newfile_missing(path))
        return errinfo_set(e, ST_EEXISTS, "there is a file %.160s already", path);
    if ((st = sql_file_may_be(path, e)) == ST_OK &&
        (st = crypt_file_root(k, path, kind, &root, &crypt, e)) == ST_OK) {
        c.crypt = crypt;
        if ((st = admin_copy(s, path, &c, &file, e)) == ST_OK)
            st = replace ? newfile_commit(&file, e) : newfile_keep(&file, e);
    }
    newfile_close(&file);
    crypt_free(crypt);
    *out = c.found;
    return st;
}

/* ---- import */

struct importing {
    struct log_txn *to;
    const char *made_by;
    struct admin_imported *out;
    struct rows_subject as; /* the last subject, as it is here */
    size_t templates;       /* that it has */
    bool left_out;          /* it was erased here */
    bool enrolled;          /* it was here before */
    bool force;
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

/* The subject of this uid, under whatever id.  ST_ENOTFOUND: there is none. */
static enum status find_subject(struct importing *m, const struct store_subject *s,
                                struct errinfo *e)
{
    struct rows_template *list = NULL;
    struct rows_subject other;
    enum status st;

    m->templates = 0;
    if ((st = rows_subject_get(m->to, s->uid, &m->as, e)) == ST_OK) {
        st = rows_template_list(m->to, &m->as, &list, &m->templates, e);
        free(list);
        return st;
    }
    if (st != ST_ENOTFOUND)
        return st;
    st = rows_subject_find(m->to, s->id, &other, e);
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

static enum status import_template(void *arg, struct rows_template *row,
                                   const struct rows_face *face, struct errinfo *e)
{
    struct importing *m = arg;
    const struct store_template *t = &row->one;
    struct rows_template there;
    struct rows_subject other;
    char id[STORE_ID_LEN + 1];
    enum status st;

    m->out->templates++;
    m->out->outdated += !surface_same_engine(t->engine, m->made_by);
    if (m->left_out)
        return ST_OK;
    if ((st = rows_template_same(m->to, m->as.one.uid, t->digest, row->one.read, id,
                                 e)) != ST_OK ||
        id[0] != '\0')
        return st; /* it is left as it is */
    st = rows_template_get(m->to, t->id, &there, &other, e);
    sodium_memzero(&other, sizeof other);
    if (st == ST_OK || st == ST_ECORRUPT)
        return errinfo_set(e, ST_EEXISTS,
                           "there is another template with the id %s already", t->id);
    if (st == ST_ENOTFOUND && m->enrolled && !m->force)
        return errinfo_set(
            e, ST_EEXISTS,
            "subject %s is enrolled here, and the archive has a template of "
            "theirs that is not: no import compares faces, so add it by "
            "--force if you know who made the archive; nothing was imported",
            m->as.one.id);
    if (st != ST_ENOTFOUND ||
        (st = store_rules_room(m->as.one.id, m->templates, e)) != ST_OK ||
        (st = rows_template_add(m->to, &m->as, row, face, e)) != ST_OK)
        return st;
    m->templates++;
    m->out->new_templates++;
    return log_change(m->to, "import", m->as.one.uid, t->id, "created", e);
}

static enum status import_subject(void *arg, struct log_txn *from,
                                  const struct rows_subject *of, struct errinfo *e)
{
    struct importing *m = arg;
    enum status st;

    m->out->subjects++;
    m->left_out = was_erased(m, of->one.uid);
    m->out->erased += m->left_out;
    st = m->left_out ? ST_OK : find_subject(m, &of->one, e);
    m->enrolled = st == ST_OK;
    if (st == ST_ENOTFOUND &&
        (st = rows_subject_add(m->to, &of->one, &m->as, e)) == ST_OK) {
        m->out->new_subjects++;
        st = log_change(m->to, "import", of->one.uid, "", "created", e);
    }
    return st == ST_OK ? admin_each_template(from, of, import_template, m, e) : st;
}

static enum status import_all(struct importing *m, struct store *archive,
                              struct errinfo *e)
{
    struct log_txn from;
    bool whole;
    enum status st = log_has(m->to, &(struct log_end){.seq = 0}, &whole, e);

    if (st == ST_OK && !whole) /* nor would it say who was erased */
        st = errinfo_set(e, ST_EREFUSED,
                         "the change log is not as it was written: see surfacectl audit "
                         "verify; nothing was imported");
    if (st == ST_OK)
        st = log_list(m->to->sql, "delete_subject", 0, &m->erased, &m->nerased, e);
    if (st == ST_OK && (st = store_begin(archive, SQL_READ, &from, e)) == ST_OK)
        st = store_end(archive, &from, admin_each(&from, import_subject, m, e), e);
    free(m->erased);
    sodium_memzero(&m->as, sizeof m->as);
    return st;
}

/* All of it is verified before anything is written: that takes the time, and no writer waits. */
static enum status open_archive(const char *path, const struct crypt_file *k,
                                const struct surface_model *model, struct store **out,
                                struct errinfo *e)
{
    const struct store_key key = {.given = k};
    struct admin_copied found;
    struct errinfo why;
    enum status st;

    *out = NULL;
    if (access(path, R_OK) != 0)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO,
                           "cannot read %.160s: %s", path, strerror(errno));
    st = admin_open(path, &key, model, out, &found, &why);
    if (st == ST_ENOTFOUND)
        return errinfo_set(e, ST_ECORRUPT, "%.160s is empty", path);
    if (st == ST_EDENIED || st == ST_EINVAL)
        return errinfo_set(e, ST_EDENIED,
                           "%.160s is not encrypted with this key or passphrase", path);
    return st == ST_OK ? st : errinfo_set(e, st, "%s", why.msg);
}

enum status admin_import(struct store *s, const char *actor, const char *path,
                         const struct crypt_file *k, bool dry, bool force,
                         struct admin_imported *out, struct errinfo *e)
{
    struct importing m = {.made_by = s->made_by, .out = out, .force = force};
    struct store *archive;
    struct log_txn t;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = open_archive(path, k, s->model, &archive, e)) != ST_OK)
        return st;
    m.to = &t;
    if ((st = store_act_begin(s, actor, SQL_WRITE, &t, e)) == ST_OK) {
        st = import_all(&m, archive, e);
        if (st == ST_OK && dry)
            (void)store_end(s, &t, ST_EDENIED, NULL); /* rolled back */
        else
            st = store_end(s, &t, st, e);
    }
    store_close(archive);
    return st;
}
