#include "admin_check.h"

#include <inttypes.h>
#include <pthread.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "digest.h"
#include "rows_calibration.h"
#include "rows_template.h"
#include "sql_file.h"
#include "store.h"
#include "store_txn.h"

#define THREADS 16

struct checking { /* what all threads have in common */
    struct store *store;
    bool decode;
    struct admin_check *found;
    store_report *report;
    void *arg;
    pthread_mutex_t lock; /* of found->problems, and of report() */
};

struct share { /* of the templates */
    struct checking *c;
    unsigned part, parts;
    uint64_t templates, bad;   /* that were read */
    struct surface_work *work; /* from the first template on */
    struct surface_face *face;
    pthread_t thread;
    enum status st;
    struct errinfo e;
};

static void count_problem(void *arg, const char *line)
{
    struct checking *c = arg;

    (void)pthread_mutex_lock(&c->lock);
    c->found->problems++;
    c->report(c->arg, line);
    (void)pthread_mutex_unlock(&c->lock);
}

/* A row so damaged that it describes no template, or whose model cannot be decoded. */
static void count_template(void *arg, const char *line)
{
    struct share *x = arg;

    x->templates++;
    x->bad++;
    count_problem(x->c, line);
}

/* That of another engine's face is not known here. */
static enum status check_descriptor(struct share *x, const struct rows_template *row,
                                    const struct rows_subject *of, struct errinfo *e)
{
    unsigned char is[SURFACE_DESCRIPTOR], wanted[SURFACE_DESCRIPTOR];
    enum status st = rows_template_descriptor(row, of, is, e);
    bool same;

    if (st != ST_OK || is[0] == SURFACE_UNDESCRIBED ||
        !surface_same_engine(row->one.engine, x->c->store->made_by))
        return st;
    if (surface_describe(x->work, x->face, wanted) == SURFACE_ENOMEM)
        return errinfo_memory(e);
    same = sodium_memcmp(is, wanted, sizeof is) == 0;
    sodium_memzero(is, sizeof is);
    sodium_memzero(wanted, sizeof wanted);
    return same ? ST_OK
                : errinfo_set(e, ST_ECORRUPT,
                              "template %s: its descriptor is not that of its face",
                              row->one.id);
}

static enum status check_template(void *arg, const struct rows_template *row,
                                  const struct rows_subject *of, const void *face,
                                  size_t len, struct errinfo *e)
{
    struct share *x = arg;
    const struct store_template *t = &row->one;
    uint32_t points, triangles;
    char digest[65];
    enum status st;

    if (!x->c->decode) {
        x->templates++;
        return ST_OK;
    }
    if (x->work == NULL && (x->work = surface_work_new(x->c->store->model)) == NULL)
        return errinfo_memory(e);
    if ((st = status_from(surface_decode(x->work, face, len, &x->face))) != ST_OK)
        return errinfo_set(e, st == ST_EVERSION ? ST_ECORRUPT : st, "template %s: %s",
                           t->id, status_message(st));
    points = surface_face_points(x->face, NULL);
    triangles = surface_face_triangles(x->face, NULL);
    if (points != t->points || triangles != t->triangles)
        return errinfo_set(e, ST_ECORRUPT,
                           "template %s: its row says %u points and %u "
                           "triangles, its face %u and %u",
                           t->id, t->points, t->triangles, points, triangles);
    if (surface_face_check(x->face) != SURFACE_OK)
        return errinfo_set(e, ST_ECORRUPT,
                           "template %s: its triangulation is not Delaunay, or its "
                           "spanning tree not minimal",
                           t->id);
    if ((st = digest_face(x->face, digest)) != ST_OK)
        return errinfo_set(e, st, "out of memory");
    if (strcmp(digest, t->digest) != 0)
        return errinfo_set(e, ST_ECORRUPT,
                           "template %s: its digest is not that of its points", t->id);
    if ((st = check_descriptor(x, row, of, e)) == ST_OK)
        x->templates++;
    return st;
}

static void count_event(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    char text[240];

    (void)snprintf(text, sizeof text, "audit log, %s, entry %" PRIu64 ": %s",
                   log_word(log), seq, line);
    count_problem(arg, text);
}

/* ---- templates: on all cores, since that takes the time */

static enum status check_part(struct share *x, struct errinfo *e)
{
    struct store *s = x->c->store;
    struct log_txn t;
    const enum status st = store_begin(s, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    return store_end(s, &t,
                     rows_template_each(&t, x->part, x->parts, true, check_template,
                                        count_template, x, e),
                     e);
}

static void *check_share(void *arg)
{
    struct share *x = arg;

    x->st = check_part(x, &x->e);
    surface_face_free(x->face);
    surface_work_free(x->work);
    return NULL;
}

static enum status check_templates(struct checking *c, struct errinfo *e)
{
    const long cores = sysconf(_SC_NPROCESSORS_ONLN);
    const unsigned parts = cores < 1 ? 1 : cores > THREADS ? THREADS : (unsigned)cores;
    struct share share[THREADS] = {{0}};
    enum status st = ST_OK;
    bool started[THREADS] = {false};

    for (unsigned i = 0; i < parts; i++) {
        share[i].c = c;
        share[i].part = i;
        share[i].parts = parts;
        started[i] =
            i > 0 && pthread_create(&share[i].thread, NULL, check_share, &share[i]) == 0;
    }
    for (unsigned i = 0; i < parts; i++) /* what has no thread is done by this one */
        if (!started[i])
            (void)check_share(&share[i]);
    for (unsigned i = 0; i < parts; i++) {
        if (started[i])
            (void)pthread_join(share[i].thread, NULL);
        c->found->templates += share[i].templates;
        c->found->bad_templates += share[i].bad;
        if (st == ST_OK && share[i].st != ST_OK) {
            st = share[i].st;
            if (e != NULL)
                *e = share[i].e;
        }
    }
    return st;
}

/* Pages and references, and the calibrations' numbers. */
static enum status check_pages(struct checking *c, struct errinfo *e)
{
    void *k = NULL;
    struct errinfo why;
    struct log_txn t;
    size_t n;
    enum status st = store_begin(c->store, SQL_READ, &t, e);

    if (st != ST_OK)
        return st;
    if ((st = sql_file_check(t.sql, count_problem, c, e)) == ST_OK &&
        (st = rows_table_all(&t, &rows_calibrations, sizeof(struct store_calibration), &k,
                             &n, &why)) == ST_ECORRUPT) {
        count_problem(c, why.msg);
        st = ST_OK;
    }
    free(k);
    return store_end(c->store, &t, st, e);
}

enum status admin_check(struct store *s, bool decode, store_report *report, void *arg,
                        struct admin_check *out, struct errinfo *e)
{
    struct checking c = {
        .store = s, .decode = decode, .found = out, .report = report, .arg = arg};
    struct log_walk walk;
    enum status st;

    memset(out, 0, sizeof *out);
    (void)pthread_mutex_init(&c.lock, NULL);
    if ((st = check_pages(&c, e)) == ST_OK && (st = check_templates(&c, e)) == ST_OK &&
        (st = store_audit_verify(s, count_event, &c, &walk, e)) == ST_OK)
        out->events = walk.entries;
    (void)pthread_mutex_destroy(&c.lock);
    return st;
}

/* ---- verified or refused */

static void keep_first(void *arg, const char *line)
{
    struct errinfo *first = arg;

    if (first->code == ST_OK)
        (void)errinfo_set(first, ST_ECORRUPT, "%s", line);
}

/* admin_check(); ST_ECORRUPT: the first problem. */
static enum status admin_check_verify(struct store *s, bool decode,
                                      struct admin_copied *found, struct errinfo *e)
{
    struct errinfo first = {ST_OK, ""};
    struct store_stats stats;
    struct admin_check check;
    enum status st;

    memset(found, 0, sizeof *found);
    if ((st = admin_check(s, decode, keep_first, &first, &check, e)) != ST_OK)
        return st;
    if (first.code != ST_OK)
        return errinfo_set(e, ST_ECORRUPT, "%s", first.msg);
    if ((st = store_stats(s, false, &stats, e)) == ST_OK)
        *found = (struct admin_copied){stats.subjects, stats.templates, stats.events, 0};
    return st;
}

/* SQLite takes missing bytes of the last page for zeros, which is not noticed if they were zeros, and does not
 * look at bytes after the last page. */
static enum status is_whole(struct store *s, uint64_t *bytes, struct errinfo *e)
{
    struct log_txn t;
    struct stat sb;
    enum status st = store_begin(s, SQL_READ, &t, e);

    *bytes = 0;
    if (st != ST_OK || (st = store_end(s, &t, sql_bytes(t.sql, bytes, e), e)) != ST_OK ||
        store_on_server(s->path) || sql_file_has_wal(s->path))
        return st;
    if (stat(s->path, &sb) != 0 || (uint64_t)sb.st_size != *bytes)
        return errinfo_set(e, ST_ECORRUPT,
                           "it is cut short, or has something after its end: it should "
                           "have %" PRIu64 " bytes",
                           *bytes);
    return ST_OK;
}

enum status admin_open(const char *path, const struct store_key *key,
                       const struct surface_model *model, struct store **out,
                       struct admin_copied *found, struct errinfo *e)
{
    struct store_key by = *key;
    struct errinfo why = {ST_OK, ""};
    struct store *s;
    uint64_t bytes;
    enum status st;

    *out = NULL;
    by.anchor = NULL;
    if ((st = store_open(path, STORE_READ, &by, &s, e)) != ST_OK)
        return st;
    store_use_model(s, model);
    if ((st = is_whole(s, &bytes, &why)) == ST_OK &&
        (st = admin_check_verify(s, model != NULL, found, &why)) == ST_OK) {
        found->bytes = bytes;
        *out = s;
        return ST_OK;
    }
    store_close(s);
    return errinfo_set(e, st, "%.160s is of no use: %s", path, why.msg);
}
