#include "admin_export.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "admin_archive.h"
#include "bytes.h"
#include "newfile.h"
#include "admin_record.h"
#include "store.h"
#include "store_txn.h"

#define PAGE 1000

struct exporting {
    struct store *s;
    struct admin_archive *a;
    const char *actor;
    struct admin_exported *out;
};

static enum status export_template(struct exporting *x, struct log_txn *t,
                                   const struct rows_template *row,
                                   const struct rows_subject *of, struct errinfo *e)
{
    unsigned char *record = NULL, *face;
    size_t n, len;
    enum status st = rows_template_face(t, row, of, &face, &len, e);

    if (st != ST_OK)
        return st;
    if ((record = malloc(ADMIN_RECORD_HEAD + len)) == NULL) {
        st = errinfo_set(e, ST_ENOMEM, "out of memory");
    } else {
        n = admin_record_template(row, record);
        memcpy(record + n, face, len);
        st = admin_archive_write(x->a, record, n + len, false, e);
        rows_template_wipe(record, n + len);
    }
    rows_template_wipe(face, len);
    x->out->templates += st == ST_OK;
    return st;
}

/* The subject and its templates as they are at one moment. */
static enum status export_rows(struct exporting *x, const struct store_subject *s,
                               struct errinfo *e)
{
    unsigned char record[ADMIN_RECORD_HEAD];
    struct rows_template *list = NULL;
    struct rows_subject of;
    struct log_txn t;
    size_t n = 0;
    enum status st;

    if ((st = store_begin(x->s, SQL_READ, &t, e)) != ST_OK)
        return st;
    if ((st = rows_subject_find(&t, s->id, &of, e)) == ST_OK &&
        (st = rows_template_list(&t, &of, &list, &n, e)) == ST_OK)
        st = admin_archive_write(x->a, record, admin_record_subject(&of.one, record),
                                 false, e);
    for (size_t i = 0; i < n && st == ST_OK; i++)
        st = export_template(x, &t, &list[i], &of, e);
    sodium_memzero(record, sizeof record);
    sodium_memzero(&of, sizeof of);
    free(list);
    return store_end(x->s, &t, st, e);
}

static enum status export_subject(struct exporting *x, const struct store_subject *s,
                                  struct errinfo *e)
{
    enum status st = export_rows(x, s, e);

    if (st == ST_OK)
        st = store_event(x->s, "export", x->actor, s->id, "", "exported", e);
    x->out->subjects += st == ST_OK;
    return st;
}

static enum status export_all(struct exporting *x, struct errinfo *e)
{
    struct store_subject *page = NULL;
    int64_t after = 0;
    size_t n;
    enum status st;

    while ((st = store_subject_list(x->s, after, PAGE, &page, &n, e)) == ST_OK && n > 0) {
        for (size_t i = 0; i < n && st == ST_OK; i++) {
            st = export_subject(x, &page[i], e);
            if (st == ST_ENOTFOUND)
                st = ST_OK; /* erased meanwhile */
        }
        after = page[n - 1].key;
        free(page);
        if (st != ST_OK)
            break;
    }
    return st;
}

/* To a file, as newfile_fill() has it. */
struct wanted {
    struct exporting *x;
    char *const *subjects;
    size_t n; /* 0: all */
    const struct crypt_file *k;
};

static enum status export_records(const struct wanted *w, struct errinfo *e)
{
    struct exporting *x = w->x;
    unsigned char end[17];
    unsigned char *to = end;
    struct store_subject one;
    enum status st = ST_OK;

    /* First, so that the events do not tell of an export that came to nothing. */
    for (size_t i = 0; i < w->n && st == ST_OK; i++)
        st = store_subject_get(x->s, w->subjects[i], &one, e);
    if (st == ST_OK && w->n == 0)
        st = export_all(x, e);
    for (size_t i = 0; i < w->n && st == ST_OK; i++)
        if ((st = store_subject_get(x->s, w->subjects[i], &one, e)) == ST_OK)
            st = export_subject(x, &one, e);
    if (st != ST_OK)
        return st;
    bytes_put_number(&to, 'E', 1);
    bytes_put_number(&to, x->out->subjects, 8);
    bytes_put_number(&to, x->out->templates, 8);
    return admin_archive_write(x->a, end, sizeof end, true, e);
}

static enum status write_archive(FILE *to, const void *arg, struct errinfo *e)
{
    const struct wanted *w = arg;
    enum status st = admin_archive_create(to, w->k, &w->x->a, e);

    if (st == ST_OK)
        st = export_records(w, e);
    admin_archive_close(w->x->a);
    w->x->out->bytes = (uint64_t)ftello(to);
    return st;
}

enum status admin_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct crypt_file *k,
                         struct admin_exported *out, struct errinfo *e)
{
    struct exporting x = {.s = s, .actor = actor, .out = out};
    const struct wanted w = {&x, subjects, n, k};
    struct newfile file = NEWFILE_NONE;
    enum status st;

    memset(out, 0, sizeof *out);
    if (access(path, F_OK) == 0)
        return errinfo_set(e, ST_EEXISTS, "there is a file %.160s already", path);
    if ((st = newfile_open(path, &file, e)) == ST_OK &&
        (st = newfile_fill(&file, write_archive, &w, e)) == ST_OK)
        st = newfile_keep(&file, e);
    newfile_close(&file);
    return st;
}
