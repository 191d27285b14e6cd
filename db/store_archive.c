/* export and import of store.h. */
#include "store_archive.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "archive.h"
#include "bytes.h"
#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "newfile.h"
#include "store_engine.h"
#include "store_rules.h"

#define DIGEST   32
#define HEAD_MAX 2048 /* bytes of a record without a model */
#define PAGE     1000

/* ---- what a record has beside numbers and texts (bytes.h) */

static bool get_u32(struct bytes *b, uint32_t *out)
{
    uint64_t v;
    const bool ok = bytes_get_number(b, 4, &v);

    *out = (uint32_t)v;
    return ok;
}

static bool get_flag(struct bytes *b, bool *out)
{
    uint64_t v;
    const bool ok = bytes_get_number(b, 1, &v);

    *out = v == 1;
    return ok && v <= 1;
}

/* One of nothing but 0 would be none. */
static bool get_uid(struct bytes *b, unsigned char uid[STORE_UID])
{
    return bytes_get(b, uid, STORE_UID) && !sodium_is_zero(uid, STORE_UID);
}

/* As store_rules_time() writes it, or "" where that may be. */
static bool time_valid(const char *at, bool never)
{
    static const char like[] = "0000-00-00T00:00:00.000Z";

    if (at[0] == '\0')
        return never;
    if (strlen(at) != sizeof like - 1)
        return false;
    for (size_t i = 0; i < sizeof like - 1; i++)
        if (like[i] == '0' ? at[i] < '0' || at[i] > '9' : at[i] != like[i])
            return false;
    return true;
}

/* ---- records */

static size_t write_subject(const struct store_subject *s, unsigned char out[HEAD_MAX])
{
    unsigned char *to = out;

    bytes_put_number(&to, 'S', 1);
    bytes_put(&to, s->uid, sizeof s->uid);
    bytes_put_text(&to, s->id);
    bytes_put_text(&to, s->reference);
    bytes_put_text(&to, s->purpose);
    bytes_put_text(&to, s->created);
    bytes_put_text(&to, s->expires);
    bytes_put_text(&to, s->seen);
    bytes_put_number(&to, s->hold, 1);
    bytes_put_number(&to, s->disabled, 1);
    return (size_t)(to - out);
}

static size_t write_template(const struct store_template *t, unsigned char out[HEAD_MAX])
{
    unsigned char digest[DIGEST] = {0};
    unsigned char *to = out;

    (void)sodium_hex2bin(digest, sizeof digest, t->digest, 2 * DIGEST, NULL, NULL, NULL);
    bytes_put_number(&to, 'T', 1);
    bytes_put_text(&to, t->id);
    bytes_put_text(&to, t->label);
    bytes_put_text(&to, t->created);
    bytes_put_text(&to, t->engine);
    bytes_put(&to, digest, sizeof digest);
    bytes_put_number(&to, t->points, 4);
    bytes_put_number(&to, t->triangles, 4);
    bytes_put_real(&to, t->quality.score);
    bytes_put_real(&to, t->quality.coverage);
    bytes_put_real(&to, t->quality.density_mm);
    bytes_put_real(&to, t->quality.noise_mm);
    return (size_t)(to - out);
}

static bool parse_subject(struct bytes *b, struct store_subject *s)
{
    memset(s, 0, sizeof *s);
    return get_uid(b, s->uid) && bytes_get_text(b, s->id, sizeof s->id) &&
           store_subject_valid(s->id) &&
           bytes_get_text(b, s->reference, sizeof s->reference) &&
           store_rules_text(s->reference, STORE_NOTE_MAX) &&
           bytes_get_text(b, s->purpose, sizeof s->purpose) &&
           store_rules_text(s->purpose, STORE_NOTE_MAX) &&
           bytes_get_text(b, s->created, sizeof s->created) &&
           time_valid(s->created, false) &&
           bytes_get_text(b, s->expires, sizeof s->expires) &&
           time_valid(s->expires, true) && bytes_get_text(b, s->seen, sizeof s->seen) &&
           time_valid(s->seen, true) && get_flag(b, &s->hold) &&
           get_flag(b, &s->disabled) && b->at == b->end;
}

static bool parse_template(struct bytes *b, struct store_archive_item *item)
{
    struct store_template *t = &item->template;

    memset(t, 0, sizeof *t);
    memcpy(t->subject, item->subject.id, sizeof t->subject);
    if (!bytes_get_text(b, t->id, sizeof t->id) || !store_id_valid(t->id) ||
        !bytes_get_text(b, t->label, sizeof t->label) ||
        !store_rules_text(t->label, STORE_LABEL_MAX) ||
        !bytes_get_text(b, t->created, sizeof t->created) ||
        !time_valid(t->created, false) ||
        !bytes_get_text(b, t->engine, sizeof t->engine) ||
        !store_rules_printable(t->engine, 1, FACE_ENGINE_MAX) || b->end - b->at < DIGEST)
        return false;
    (void)sodium_bin2hex(t->digest, sizeof t->digest, b->at, DIGEST);
    b->at += DIGEST;
    if (!get_u32(b, &t->points) || t->points < 3 || t->points > MESH_MAX_POINTS ||
        !get_u32(b, &t->triangles) || t->triangles < 1 ||
        t->triangles > 2 * t->points - 5 || !bytes_get_real(b, 1, &t->quality.score) ||
        !bytes_get_real(b, 1, &t->quality.coverage) ||
        !bytes_get_real(b, 1e6, &t->quality.density_mm) ||
        !bytes_get_real(b, 1e6, &t->quality.noise_mm))
        return false;
    item->model = b->at;
    item->len = (size_t)(b->end - b->at);
    return item->len > 0;
}

enum status store_archive_parse(const unsigned char *data, size_t n,
                                struct store_archive_item *item, struct errinfo *e)
{
    struct bytes b = {data, data + n};
    uint64_t kind = 0;
    bool ok = bytes_get_number(&b, 1, &kind);

    item->model = NULL;
    item->len = 0;
    if (kind == 'S') {
        item->kind = STORE_ARCHIVE_SUBJECT;
        ok = ok && parse_subject(&b, &item->subject);
    } else if (kind == 'T') {
        item->kind = STORE_ARCHIVE_TEMPLATE;
        ok = ok && item->subject.id[0] != '\0' && parse_template(&b, item);
    } else {
        item->kind = STORE_ARCHIVE_END;
        ok = ok && kind == 'E' && bytes_get_number(&b, 8, &item->subjects) &&
             bytes_get_number(&b, 8, &item->templates) && b.at == b.end;
    }
    return ok ? ST_OK
              : errinfo_set(e, ST_ECORRUPT, "the archive has a record that cannot be");
}

/* ---- export */

struct exporting {
    struct store *s;
    struct archive *a;
    const char *actor;
    struct store_exported *out;
};

static enum status export_model(void *arg, const struct store_template *t,
                                const void *model, size_t len, struct errinfo *e)
{
    struct exporting *x = arg;
    unsigned char *record = malloc(HEAD_MAX + len);
    enum status st;
    size_t n;

    if (record == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    n = write_template(t, record);
    memcpy(record + n, model, len);
    st = archive_write(x->a, record, n + len, false, e);
    sodium_memzero(record, n + len);
    free(record);
    if (st == ST_OK)
        x->out->templates++;
    return st;
}

static enum status export_subject(struct exporting *x, const struct store_subject *s,
                                  struct errinfo *e)
{
    unsigned char record[HEAD_MAX];
    struct store_template *list = NULL, one;
    size_t n = 0;
    enum status st;

    if ((st = store_template_list(x->s, s->id, &list, &n, e)) != ST_OK ||
        (st = archive_write(x->a, record, write_subject(s, record), false, e)) != ST_OK)
        goto out;
    for (size_t i = 0; i < n && st == ST_OK; i++) {
        st = x->s->engine->template_read(x->s, list[i].id, &one, export_model, x, e);
        if (st == ST_ENOTFOUND)
            st = ST_OK; /* deleted meanwhile */
    }
    if (st == ST_OK)
        st = store_event(x->s, "export", x->actor, s->id, "", "exported", e);
    x->out->subjects++;
out:
    sodium_memzero(record, sizeof record);
    free(list);
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
                st = ST_OK; /* deleted meanwhile */
        }
        after = page[n - 1].key;
        free(page);
        if (st != ST_OK)
            break;
    }
    return st;
}

static enum status export_records(struct exporting *x, char *const *subjects, size_t n,
                                  struct errinfo *e)
{
    unsigned char end[17];
    unsigned char *to = end;
    struct store_subject one;
    enum status st = ST_OK;

    /* First, so that the events do not tell of an export that came to nothing. */
    for (size_t i = 0; i < n && st == ST_OK; i++)
        st = store_subject_get(x->s, subjects[i], &one, e);
    if (st == ST_OK && n == 0)
        st = export_all(x, e);
    for (size_t i = 0; i < n && st == ST_OK; i++)
        if ((st = store_subject_get(x->s, subjects[i], &one, e)) == ST_OK)
            st = export_subject(x, &one, e);
    if (st != ST_OK)
        return st;
    bytes_put_number(&to, 'E', 1);
    bytes_put_number(&to, x->out->subjects, 8);
    bytes_put_number(&to, x->out->templates, 8);
    return archive_write(x->a, end, sizeof end, true, e);
}

enum status store_export(struct store *s, const char *actor, char *const *subjects,
                         size_t n, const char *path, const struct keyfile *k,
                         struct store_exported *out, struct errinfo *e)
{
    struct exporting x = {.s = s, .actor = actor, .out = out};
    struct newfile file = NEWFILE_NONE;
    FILE *to = NULL;
    enum status st;
    int fd;

    memset(out, 0, sizeof *out);
    if (access(path, F_OK) == 0)
        return errinfo_set(e, ST_EEXISTS, "there is a file %.160s already", path);
    if ((st = newfile_open(path, &file, e)) != ST_OK)
        return st;
    if ((fd = dup(file.fd)) < 0 || (to = fdopen(fd, "wb")) == NULL) {
        st = errinfo_set(e, ST_EIO, "cannot write %.160s: %s", path, strerror(errno));
        if (fd >= 0)
            (void)close(fd);
        goto out;
    }
    if ((st = archive_create(to, k, &x.a, e)) == ST_OK)
        st = export_records(&x, subjects, n, e);
    if (st == ST_OK && fflush(to) != 0)
        st = errinfo_set(e, ST_EIO, "cannot write %.160s: %s", path, strerror(errno));
    out->bytes = (uint64_t)ftello(to);
    (void)fclose(to);
    if (st == ST_OK)
        st = newfile_keep(&file, e);
out:
    archive_close(x.a);
    newfile_close(&file);
    return st;
}

/* ---- import */

struct importing {
    FILE *from;
    const struct keyfile *k;
    struct archive *a;
    const char *made_by;
    uint64_t stale;
    struct store_archive_item item;
    uint64_t subjects, templates;
};

/* Once more from its beginning. */
static enum status begin(struct importing *m, struct errinfo *e)
{
    archive_close(m->a);
    m->a = NULL;
    m->subjects = m->templates = 0;
    memset(&m->item, 0, sizeof m->item);
    rewind(m->from);
    return archive_open(m->from, m->k, &m->a, e);
}

static enum status next(void *arg, struct store_archive_item **out, struct errinfo *e)
{
    struct importing *m = arg;
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
static enum status verify_template(struct importing *m, struct face_work *w,
                                   struct face *f, struct errinfo *e)
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
    m->stale += !face_same_engine(t->engine, m->made_by);
    return ST_OK;
}

/* All of it, before anything is written: that takes the time, and nobody waits for it. */
static enum status verify(struct importing *m, const struct model *model,
                          struct errinfo *e)
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

enum status store_import(struct store *s, const char *actor, const char *path,
                         const struct keyfile *k, bool dry, struct store_imported *out,
                         struct errinfo *e)
{
    struct importing m = {.k = k, .made_by = s->made_by};
    struct store_act by;
    enum status st;

    memset(out, 0, sizeof *out);
    if ((st = store_rules_act(&by, actor, e)) != ST_OK)
        return st;
    if ((m.from = fopen(path, "rb")) == NULL)
        return errinfo_set(e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO,
                           "cannot read %.160s: %s", path, strerror(errno));
    if ((st = verify(&m, s->model, e)) == ST_OK && (st = begin(&m, e)) == ST_OK)
        st = s->engine->import(s, &by, next, &m, dry, out, e);
    out->stale = m.stale;
    archive_close(m.a);
    (void)fclose(m.from);
    return st;
}
