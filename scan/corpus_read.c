#include "corpus_read.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cloudformat.h"
#include "corpus.h"
#include "csv.h"

/* ---- a folder */

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static int not_hidden(const struct dirent *d)
{
    return d->d_name[0] != '.';
}

static enum status add_entry(struct corpus_build *b, const char *name)
{
    const bool scan = cloudformat_ending(name) != NULL;
    char id[CORPUS_MAX_NAME + 1], kind[CORPUS_MAX_NAME + 1];
    char *path = corpus_build_path(b, name);
    const char *why;
    enum status st;

    if (path == NULL)
        return corpus_build_no_memory(b->e);
    if ((why = corpus_build_bad_file(path)) == NULL && !scan)
        why = "its extension is not that of a scan format";
    if (why == NULL)
        why = corpus_build_split(name, id, kind);
    st = why != NULL ? corpus_build_left(b, name, why, scan)
                     : corpus_build_scan(b, name, id, kind);
    free(path);
    return st;
}

static enum status read_folder(struct corpus_build *b)
{
    struct dirent **list;
    const int n = scandir(b->dir, &list, not_hidden, by_name);
    enum status st = ST_OK;

    if (n < 0)
        return errinfo_set(b->e, errno == ENOMEM ? ST_ENOMEM : ST_EIO, "%.160s: %s",
                           b->dir, strerror(errno));
    for (int i = 0; i < n; i++) {
        if (st == ST_OK && strcmp(list[i]->d_name, "subjects.csv") != 0)
            st = add_entry(b, list[i]->d_name);
        free(list[i]);
    }
    free(list);
    return st;
}

/* ---- tables */

struct columns {
    int file, id, kind, population;
};

static enum status find_columns(const struct csv *t, struct columns *c, struct errinfo *e)
{
    enum status st = csv_need(t, "file", &c->file, e);

    if ((c->id = csv_column(t, "subject")) < 0 && st == ST_OK &&
        csv_need(t, "id", &c->id, NULL) != ST_OK)
        st = csv_need(t, "subject", &c->id, e);
    c->kind = csv_column(t, "kind");
    c->population = csv_column(t, "population");
    return st;
}

/* A name from a table: not too long, valid; with `must` not empty. */
static enum status take_name(const struct csv *t, int column, size_t most, bool must,
                             const char **out, struct errinfo *e)
{
    const char *why;

    *out = csv_field(t, column);
    if (must && (*out)[0] == '\0')
        return csv_bad(t, column, e, "empty");
    if ((why = corpus_build_bad_name(*out, most)) != NULL)
        return csv_bad(t, column, e, why);
    return ST_OK;
}

/* A subject's population, said once or more, always the same. */
static enum status set_population(struct corpus_build *b, const struct csv *t, int column,
                                  uint32_t subject)
{
    struct corpus_subject *s = &b->c->subject[subject];
    const char *name;
    uint32_t p;
    enum status st = take_name(t, column, CORPUS_MAX_NAME, false, &name, b->e);

    if (st == ST_OK)
        st = corpus_build_population(b, name, &p);
    if (st != ST_OK)
        return st;
    if (s->population != CORPUS_NONE && s->population != p)
        return csv_bad(t, column, b->e, "a subject is in two populations");
    s->population = p;
    return ST_OK;
}

static enum status read_scan_row(struct corpus_build *b, const struct csv *t,
                                 const struct columns *col)
{
    const char *file, *id, *kind, *why;
    struct corpus_scan *s;
    enum status st;

    if ((st = take_name(t, col->file, 4095, true, &file, b->e)) != ST_OK ||
        (st = take_name(t, col->id, CORPUS_MAX_NAME, true, &id, b->e)) != ST_OK ||
        (st = take_name(t, col->kind, CORPUS_MAX_NAME, false, &kind, b->e)) != ST_OK ||
        (st = corpus_build_scan(b, file, id, kind)) != ST_OK)
        return st;
    s = &b->c->scan[b->c->nscan - 1];
    if ((why = corpus_build_bad_file(s->path)) != NULL) {
        (void)csv_bad(t, col->file, b->e, why);
        return b->e == NULL ? ST_ENOTFOUND : (b->e->code = ST_ENOTFOUND);
    }
    if (col->population >= 0)
        st = set_population(b, t, col->population, s->subject);
    return st;
}

static enum status read_manifest(struct corpus_build *b, const char *path)
{
    struct columns col;
    struct csv *t;
    bool more;
    enum status st = csv_open(path, false, &t, b->e);

    if (st == ST_OK)
        st = find_columns(t, &col, b->e);
    while (st == ST_OK && (st = csv_next(t, &more, b->e)) == ST_OK && more)
        st = read_scan_row(b, t, &col);
    csv_close(t);
    return st;
}

static enum status read_subject_row(struct corpus_build *b, const struct csv *t, int id,
                                    int population, int relative)
{
    const char *name, *other;
    uint32_t s, o;
    enum status st;

    if ((st = take_name(t, id, CORPUS_MAX_NAME, true, &name, b->e)) != ST_OK ||
        (st = take_name(t, relative, CORPUS_MAX_NAME, false, &other, b->e)) != ST_OK)
        return st;
    if ((s = corpus_build_find(b, name)) == CORPUS_NONE)
        return ST_OK; /* no scan of that subject is listed */
    if (population >= 0 && (st = set_population(b, t, population, s)) != ST_OK)
        return st;
    if (other[0] == '\0')
        return ST_OK;
    if ((st = corpus_build_subject(b, other, &o)) !=
        ST_OK) /* maybe somebody without scans */
        return st;
    if (o == s)
        return csv_bad(t, relative, b->e, "a subject is its own relative");
    if (b->c->subject[s].relative_of != CORPUS_NONE && b->c->subject[s].relative_of != o)
        return csv_bad(t, relative, b->e, "a subject has two relatives");
    b->c->subject[s].relative_of = o;
    return ST_OK;
}

/* subjects.csv, where there is one. */
static enum status read_subjects(struct corpus_build *b)
{
    char *path = corpus_build_path(b, "subjects.csv");
    struct csv *t = NULL;
    int id, population, relative;
    bool more;
    enum status st;

    if (path == NULL)
        return corpus_build_no_memory(b->e);
    if (access(path, F_OK) != 0) {
        free(path);
        return ST_OK;
    }
    if ((st = csv_open(path, false, &t, b->e)) == ST_OK &&
        (st = csv_need(t, "id", &id, b->e)) == ST_OK) {
        population = csv_column(t, "population");
        relative = csv_column(t, "relative_of");
        while ((st = csv_next(t, &more, b->e)) == ST_OK && more &&
               (st = read_subject_row(b, t, id, population, relative)) == ST_OK)
            ;
    }
    csv_close(t);
    free(path);
    return st;
}

/* ---- the whole */

static int by_path(const void *a, const void *b)
{
    const struct corpus_scan *const *x = a, *const *y = b;

    return strcmp((*x)->path, (*y)->path);
}

static enum status refuse_twice(struct corpus_build *b)
{
    const struct corpus_scan **list = malloc(b->c->nscan * sizeof *list);
    enum status st = ST_OK;

    if (list == NULL)
        return corpus_build_no_memory(b->e);
    for (uint32_t i = 0; i < b->c->nscan; i++)
        list[i] = &b->c->scan[i];
    qsort(list, b->c->nscan, sizeof *list, by_path);
    for (uint32_t i = 1; i < b->c->nscan && st == ST_OK; i++)
        if (by_path(&list[i - 1], &list[i]) == 0)
            st = errinfo_set(b->e, ST_EINVAL, "%.160s is listed twice", list[i]->file);
    free(list);
    return st;
}

/* The first scan of the kind `enroll`, or else the first. */
static void choose_enrolled(struct corpus *c)
{
    for (uint32_t i = 0; i < c->nscan; i++) {
        uint32_t *enrolled = &c->subject[c->scan[i].subject].enrolled;
        const bool marked = strcmp(c->kind[c->scan[i].kind], "enroll") == 0;

        if (*enrolled == CORPUS_NONE ||
            (marked && strcmp(c->kind[c->scan[*enrolled].kind], "enroll") != 0))
            *enrolled = i;
    }
    for (uint32_t i = 0; i < c->nsubject; i++)
        c->scan[c->subject[i].enrolled].enrolled = true;
}

/* Where the scans are, and the manifest's path, NULL when there is none. */
static enum status find_manifest(struct corpus_build *b, const char *path,
                                 char **manifest)
{
    const char *slash = strrchr(path, '/');
    struct stat info;

    *manifest = NULL;
    if (stat(path, &info) != 0)
        return errinfo_set(b->e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO, "%.160s: %s",
                           path, strerror(errno));
    if (S_ISDIR(info.st_mode)) {
        if ((b->dir = strdup(path)) == NULL ||
            (*manifest = corpus_build_path(b, "index.csv")) == NULL)
            return corpus_build_no_memory(b->e);
        if (access(*manifest, F_OK) != 0) {
            free(*manifest);
            *manifest = NULL;
        }
        return ST_OK;
    }
    b->dir = slash == NULL ? strdup(".")
                           : strndup(path, slash == path ? 1 : (size_t)(slash - path));
    *manifest = strdup(path);
    return b->dir == NULL || *manifest == NULL ? corpus_build_no_memory(b->e) : ST_OK;
}

/* Why there are none, as far as it is known: by the first that looks like one. */
static enum status no_scans(struct corpus_build *b, const char *path)
{
    const struct corpus *c = b->c;
    uint32_t i = 0;

    if (c->nleft == 0)
        return errinfo_set(b->e, ST_EINVAL, "%.160s: no scans", path);
    while (c->nleft_scan > 0 && !c->left[i].scan)
        i++;
    return errinfo_set(b->e, ST_EINVAL, "%.80s: no scans; %.60s: %s; and %u more of %u",
                       path, c->left[i].file, c->left[i].why, c->nleft - 1, c->nleft);
}

enum status corpus_read(const char *path, struct corpus **out, struct errinfo *e)
{
    struct corpus_build b;
    char *manifest = NULL;
    enum status st = corpus_build_begin(&b, e);

    if (st == ST_OK)
        st = find_manifest(&b, path, &manifest);
    if (st == ST_OK)
        st = manifest != NULL ? read_manifest(&b, manifest) : read_folder(&b);
    if (st == ST_OK) {
        b.c->nsubject = b.c->nnamed;
        if (b.c->nscan == 0)
            st = no_scans(&b, path);
    }
    if (st == ST_OK && (st = read_subjects(&b)) == ST_OK &&
        (st = refuse_twice(&b)) == ST_OK)
        choose_enrolled(b.c);
    free(manifest);
    return corpus_build_end(&b, st, out);
}
