#include "corpus.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cloudformat.h"
#include "csv.h"
#include "utf8.h"

#define MAX_NAMES 65536 /* of kinds or populations */

static const char *const pose_column[6] = {"yaw", "pitch", "roll", "tx", "ty", "tz"};

/* A corpus while it is read. */
struct reading {
    struct corpus *c;
    char *dir; /* the scans' */
    uint32_t scan_room, subject_room, left_room;
    uint32_t *hash; /* subjects by id, open addressing; CORPUS_NONE is empty */
    uint32_t nhash; /* a power of two */
    struct errinfo *e;
};

static enum status no_memory(struct errinfo *e)
{
    return errinfo_set(e, ST_ENOMEM, "the list of scans: out of memory");
}

/* grow(at, n, room, size): room for one more of n; false: out of memory. */
static bool grow(void **at, uint32_t n, uint32_t *room, size_t size)
{
    const uint32_t larger = *room > 0 ? 2 * *room : 64;
    void *p;

    if (n < *room)
        return true;
    if ((p = realloc(*at, larger * size)) == NULL)
        return false;
    *at = p;
    *room = larger;
    return true;
}

/* What is wrong with a name, or NULL. */
static const char *bad_name(const char *text, size_t most)
{
    if (strlen(text) > most)
        return "too long";
    return utf8_is_text(text, most) ? NULL : "a control character, or not UTF-8";
}

/* ---- building */

static uint32_t *slot_of(const struct reading *r, const char *id)
{
    uint32_t h = 2166136261U; /* FNV-1a */

    for (const char *p = id; *p != '\0'; p++)
        h = (h ^ (unsigned char)*p) * 16777619U;
    for (;; h++) {
        uint32_t *s = &r->hash[h & (r->nhash - 1)];

        if (*s == CORPUS_NONE || strcmp(r->c->subject[*s].id, id) == 0)
            return s;
    }
}

static bool rehash(struct reading *r)
{
    uint32_t *larger;

    if (2 * r->c->nnamed < r->nhash)
        return true;
    if ((larger = malloc(2 * (size_t)r->nhash * sizeof *larger)) == NULL)
        return false;
    free(r->hash);
    r->hash = larger;
    r->nhash *= 2;
    memset(r->hash, 0xFF, r->nhash * sizeof *r->hash);
    for (uint32_t i = 0; i < r->c->nnamed; i++)
        *slot_of(r, r->c->subject[i].id) = i;
    return true;
}

static enum status intern_subject(struct reading *r, const char *id, uint32_t *out)
{
    struct corpus *c = r->c;
    uint32_t *slot = slot_of(r, id);

    if (*slot == CORPUS_NONE) {
        void *at = c->subject;
        char *copy;

        if (!grow(&at, c->nnamed, &r->subject_room, sizeof *c->subject))
            return no_memory(r->e);
        c->subject = at;
        if ((copy = strdup(id)) == NULL)
            return no_memory(r->e);
        c->subject[c->nnamed].id = copy;
        c->subject[c->nnamed].nscan = 0;
        c->subject[c->nnamed].enrolled = CORPUS_NONE;
        c->subject[c->nnamed].population = CORPUS_NONE;
        c->subject[c->nnamed].relative_of = CORPUS_NONE;
        *slot = c->nnamed++;
        *out = *slot;
        return rehash(r) ? ST_OK : no_memory(r->e);
    }
    *out = *slot;
    return ST_OK;
}

/* The name's place in a list of few. */
static enum status intern(struct reading *r, char ***list, uint32_t *n, const char *name,
                          uint32_t *out)
{
    char **larger;

    for (*out = 0; *out < *n; ++*out)
        if (strcmp((*list)[*out], name) == 0)
            return ST_OK;
    if (*n == MAX_NAMES)
        return errinfo_set(r->e, ST_ELIMIT, "more than %d kinds or populations",
                           MAX_NAMES);
    if ((larger = realloc(*list, (*n + (size_t)1) * sizeof **list)) == NULL)
        return no_memory(r->e);
    *list = larger;
    if ((larger[*n] = strdup(name)) == NULL)
        return no_memory(r->e);
    ++*n;
    return ST_OK;
}

static char *join(const char *dir, const char *file)
{
    const size_t size = strlen(dir) + strlen(file) + 2;
    char *path = malloc(size);

    if (path != NULL && file[0] == '/')
        memcpy(path, file, strlen(file) + 1);
    else if (path != NULL)
        (void)snprintf(path, size, "%s/%s", dir, file);
    return path;
}

/* Why what is at path cannot be a scan, or NULL. */
static const char *bad_file(const char *path)
{
    struct stat info;

    if (stat(path, &info) != 0 || (S_ISREG(info.st_mode) && access(path, R_OK) != 0))
        return errno == ENOENT   ? "No such file or directory"
               : errno == EACCES ? "Permission denied"
                                 : "it cannot be opened";
    if (S_ISDIR(info.st_mode))
        return "a folder, not a file: what is in it is not read";
    return S_ISREG(info.st_mode) ? NULL : "not a file";
}

static enum status add_scan(struct reading *r, const char *file, const char *id,
                            const char *kind)
{
    struct corpus *c = r->c;
    struct corpus_scan s = {0};
    void *at = c->scan;
    enum status st;

    if (c->nscan == CORPUS_MAX_SCANS)
        return errinfo_set(r->e, ST_ELIMIT, "more than %d scans", CORPUS_MAX_SCANS);
    if (!grow(&at, c->nscan, &r->scan_room, sizeof *c->scan))
        return no_memory(r->e);
    c->scan = at;
    if ((st = intern_subject(r, id, &s.subject)) != ST_OK ||
        (st = intern(r, &c->kind, &c->nkind, kind, &s.kind)) != ST_OK)
        return st;
    s.file = strdup(file);
    s.path = join(r->dir, file);
    c->subject[s.subject].nscan++;
    c->scan[c->nscan++] = s;
    if (s.file == NULL || s.path == NULL)
        return no_memory(r->e);
    return ST_OK;
}

/* ---- a folder */

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static int not_hidden(const struct dirent *d)
{
    return d->d_name[0] != '.';
}

/* What is wrong with the name SUBJECT_KIND.ply, or NULL; else it is cut in two. */
static const char *split_name(const char *file, char id[CORPUS_MAX_NAME + 1],
                              char kind[CORPUS_MAX_NAME + 1])
{
    const char *cut = strchr(file, '_'), *dot = cloudformat_ending(file);
    const char *why = bad_name(file, 255);

    if (why != NULL)
        return why;
    if (cut == NULL || cut > dot || cut == file || cut + 1 == dot)
        return "not named SUBJECT_KIND.ply (or list it in index.csv)";
    if (cut - file > CORPUS_MAX_NAME || dot - cut - 1 > CORPUS_MAX_NAME)
        return "its subject or kind is too long";
    (void)snprintf(id, CORPUS_MAX_NAME + 1, "%.*s", (int)(cut - file), file);
    (void)snprintf(kind, CORPUS_MAX_NAME + 1, "%.*s", (int)(dot - cut - 1), cut + 1);
    return NULL;
}

/* A name that any terminal can be given. */
static char *printable(const char *name)
{
    char *copy = strdup(name);
    size_t n;

    for (char *p = copy; p != NULL && *p != '\0'; p += n)
        if ((n = utf8_character(p, strlen(p))) == 0 || utf8_is_control(p)) {
            *p = '?';
            n = 1;
        }
    return copy;
}

static enum status leave_out(struct reading *r, const char *file, const char *why,
                             bool scan)
{
    struct corpus *c = r->c;
    void *at = c->left;

    if (!grow(&at, c->nleft, &r->left_room, sizeof *c->left))
        return no_memory(r->e);
    c->left = at;
    c->left[c->nleft] = (struct corpus_left){printable(file), why, scan};
    c->nleft_scan += scan;
    return c->left[c->nleft++].file != NULL ? ST_OK : no_memory(r->e);
}

static enum status add_entry(struct reading *r, const char *name)
{
    const bool scan = cloudformat_ending(name) != NULL;
    char id[CORPUS_MAX_NAME + 1], kind[CORPUS_MAX_NAME + 1];
    char *path = join(r->dir, name);
    const char *why;
    enum status st;

    if (path == NULL)
        return no_memory(r->e);
    if ((why = bad_file(path)) == NULL && !scan)
        why = "no scan by the ending of its name";
    if (why == NULL)
        why = split_name(name, id, kind);
    st = why != NULL ? leave_out(r, name, why, scan) : add_scan(r, name, id, kind);
    free(path);
    return st;
}

static enum status read_folder(struct reading *r)
{
    struct dirent **list;
    const int n = scandir(r->dir, &list, not_hidden, by_name);
    enum status st = ST_OK;

    if (n < 0)
        return errinfo_set(r->e, errno == ENOMEM ? ST_ENOMEM : ST_EIO, "%.160s: %s",
                           r->dir, strerror(errno));
    for (int i = 0; i < n; i++) {
        if (st == ST_OK && strcmp(list[i]->d_name, "subjects.csv") != 0)
            st = add_entry(r, list[i]->d_name);
        free(list[i]);
    }
    free(list);
    return st;
}

/* ---- tables */

struct columns {
    int file, id, kind, population, pose[6];
};

static enum status find_columns(const struct csv *t, struct columns *c, struct errinfo *e)
{
    enum status st = csv_need(t, "file", &c->file, e);
    int poses = 0;

    if ((c->id = csv_column(t, "subject")) < 0 && st == ST_OK &&
        csv_need(t, "id", &c->id, NULL) != ST_OK)
        st = csv_need(t, "subject", &c->id, e);
    c->kind = csv_column(t, "kind");
    c->population = csv_column(t, "population");
    for (int i = 0; i < 6; i++)
        poses += (c->pose[i] = csv_column(t, pose_column[i])) >= 0;
    for (int i = 0; i < 6 && poses > 0 && st == ST_OK; i++)
        st = csv_need(t, pose_column[i], &c->pose[i], e);
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
    if ((why = bad_name(*out, most)) != NULL)
        return csv_bad(t, column, e, why);
    return ST_OK;
}

/* A subject's population, said once or more, always the same. */
static enum status set_population(struct reading *r, const struct csv *t, int column,
                                  uint32_t subject)
{
    struct corpus_subject *s = &r->c->subject[subject];
    const char *name;
    uint32_t p;
    enum status st = take_name(t, column, CORPUS_MAX_NAME, false, &name, r->e);

    if (st == ST_OK)
        st = intern(r, &r->c->population, &r->c->npopulation, name, &p);
    if (st != ST_OK)
        return st;
    if (s->population != CORPUS_NONE && s->population != p)
        return csv_bad(t, column, r->e, "a subject is in two populations");
    s->population = p;
    return ST_OK;
}

static enum status read_scan_row(struct reading *r, const struct csv *t,
                                 const struct columns *col)
{
    const char *file, *id, *kind, *why;
    struct corpus_scan *s;
    enum status st;

    if ((st = take_name(t, col->file, 4095, true, &file, r->e)) != ST_OK ||
        (st = take_name(t, col->id, CORPUS_MAX_NAME, true, &id, r->e)) != ST_OK ||
        (st = take_name(t, col->kind, CORPUS_MAX_NAME, false, &kind, r->e)) != ST_OK ||
        (st = add_scan(r, file, id, kind)) != ST_OK)
        return st;
    s = &r->c->scan[r->c->nscan - 1];
    if ((why = bad_file(s->path)) != NULL) {
        (void)csv_bad(t, col->file, r->e, why);
        return r->e == NULL ? ST_ENOTFOUND : (r->e->code = ST_ENOTFOUND);
    }
    if (col->population >= 0)
        st = set_population(r, t, col->population, s->subject);
    for (int i = 0; i < 6 && st == ST_OK && r->c->posed; i++)
        st = csv_number(t, col->pose[i], &s->pose[i], r->e);
    return st;
}

static enum status read_manifest(struct reading *r, const char *path)
{
    struct columns col;
    struct csv *t;
    bool more;
    enum status st = csv_open(path, &t, r->e);

    if (st == ST_OK)
        st = find_columns(t, &col, r->e);
    if (st == ST_OK)
        r->c->posed = col.pose[0] >= 0;
    while (st == ST_OK && (st = csv_next(t, &more, r->e)) == ST_OK && more)
        st = read_scan_row(r, t, &col);
    csv_close(t);
    return st;
}

static enum status read_subject_row(struct reading *r, const struct csv *t, int id,
                                    int population, int relative)
{
    const char *name, *other;
    uint32_t s, o;
    enum status st;

    if ((st = take_name(t, id, CORPUS_MAX_NAME, true, &name, r->e)) != ST_OK ||
        (st = take_name(t, relative, CORPUS_MAX_NAME, false, &other, r->e)) != ST_OK)
        return st;
    if ((s = *slot_of(r, name)) == CORPUS_NONE)
        return ST_OK; /* no scan of that subject is listed */
    if (population >= 0 && (st = set_population(r, t, population, s)) != ST_OK)
        return st;
    if (other[0] == '\0')
        return ST_OK;
    if ((st = intern_subject(r, other, &o)) != ST_OK) /* maybe somebody without scans */
        return st;
    if (o == s)
        return csv_bad(t, relative, r->e, "a subject is its own relative");
    if (r->c->subject[s].relative_of != CORPUS_NONE && r->c->subject[s].relative_of != o)
        return csv_bad(t, relative, r->e, "a subject has two relatives");
    r->c->subject[s].relative_of = o;
    return ST_OK;
}

/* subjects.csv, where there is one. */
static enum status read_subjects(struct reading *r)
{
    char *path = join(r->dir, "subjects.csv");
    struct csv *t = NULL;
    int id, population, relative;
    bool more;
    enum status st;

    if (path == NULL)
        return no_memory(r->e);
    if (access(path, F_OK) != 0) {
        free(path);
        return ST_OK;
    }
    if ((st = csv_open(path, &t, r->e)) == ST_OK &&
        (st = csv_need(t, "id", &id, r->e)) == ST_OK) {
        population = csv_column(t, "population");
        relative = csv_column(t, "relative_of");
        while ((st = csv_next(t, &more, r->e)) == ST_OK && more &&
               (st = read_subject_row(r, t, id, population, relative)) == ST_OK)
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

static enum status refuse_twice(struct reading *r)
{
    const struct corpus_scan **list = malloc(r->c->nscan * sizeof *list);
    enum status st = ST_OK;

    if (list == NULL)
        return no_memory(r->e);
    for (uint32_t i = 0; i < r->c->nscan; i++)
        list[i] = &r->c->scan[i];
    qsort(list, r->c->nscan, sizeof *list, by_path);
    for (uint32_t i = 1; i < r->c->nscan && st == ST_OK; i++)
        if (by_path(&list[i - 1], &list[i]) == 0)
            st = errinfo_set(r->e, ST_EINVAL, "%.160s is listed twice", list[i]->file);
    free(list);
    return st;
}

/* Choose the enrolled scans; who said nothing is in the population "". */
static enum status complete(struct reading *r)
{
    struct corpus *c = r->c;
    enum status st = ST_OK;

    for (uint32_t i = 0; i < c->nscan; i++) {
        uint32_t *enrolled = &c->subject[c->scan[i].subject].enrolled;
        const bool marked = strcmp(c->kind[c->scan[i].kind], "enroll") == 0;

        if (*enrolled == CORPUS_NONE ||
            (marked && strcmp(c->kind[c->scan[*enrolled].kind], "enroll") != 0))
            *enrolled = i;
    }
    for (uint32_t i = 0; i < c->nsubject && st == ST_OK; i++) {
        c->scan[c->subject[i].enrolled].enrolled = true;
        if (c->subject[i].population == CORPUS_NONE)
            st =
                intern(r, &c->population, &c->npopulation, "", &c->subject[i].population);
    }
    return st;
}

/* Where the scans are, and the manifest's path, NULL when there is none. */
static enum status find_manifest(struct reading *r, const char *path, char **manifest)
{
    const char *slash = strrchr(path, '/');
    struct stat info;

    *manifest = NULL;
    if (stat(path, &info) != 0)
        return errinfo_set(r->e, errno == ENOENT ? ST_ENOTFOUND : ST_EIO, "%.160s: %s",
                           path, strerror(errno));
    if (S_ISDIR(info.st_mode)) {
        if ((r->dir = strdup(path)) == NULL ||
            (*manifest = join(path, "index.csv")) == NULL)
            return no_memory(r->e);
        if (access(*manifest, F_OK) != 0) {
            free(*manifest);
            *manifest = NULL;
        }
        return ST_OK;
    }
    r->dir = slash == NULL ? strdup(".")
                           : strndup(path, slash == path ? 1 : (size_t)(slash - path));
    *manifest = strdup(path);
    return r->dir == NULL || *manifest == NULL ? no_memory(r->e) : ST_OK;
}

/* Why there are none, as far as it is known: by the first that looks like one. */
static enum status no_scans(struct reading *r, const char *path)
{
    const struct corpus *c = r->c;
    uint32_t i = 0;

    if (c->nleft == 0)
        return errinfo_set(r->e, ST_EINVAL, "%.160s: no scans", path);
    while (c->nleft_scan > 0 && !c->left[i].scan)
        i++;
    return errinfo_set(r->e, ST_EINVAL, "%.80s: no scans; %.60s: %s; and %u more of %u",
                       path, c->left[i].file, c->left[i].why, c->nleft - 1, c->nleft);
}

enum status corpus_read(const char *path, struct corpus **out, struct errinfo *e)
{
    struct reading r = {.nhash = 256, .e = e};
    char *manifest = NULL;
    enum status st;

    *out = NULL;
    r.c = calloc(1, sizeof *r.c);
    r.hash = malloc(r.nhash * sizeof *r.hash);
    if (r.c == NULL || r.hash == NULL) {
        st = no_memory(e);
        goto out;
    }
    memset(r.hash, 0xFF, r.nhash * sizeof *r.hash);
    if ((st = find_manifest(&r, path, &manifest)) != ST_OK)
        goto out;
    st = manifest != NULL ? read_manifest(&r, manifest) : read_folder(&r);
    r.c->nsubject = r.c->nnamed;
    if (st == ST_OK && r.c->nscan == 0)
        st = no_scans(&r, path);
    if (st == ST_OK && (st = read_subjects(&r)) == ST_OK &&
        (st = refuse_twice(&r)) == ST_OK)
        st = complete(&r);
out:
    if (st == ST_OK)
        *out = r.c;
    else
        corpus_free(r.c);
    free(manifest);
    free(r.dir);
    free(r.hash);
    return st;
}

void corpus_free(struct corpus *c)
{
    if (c == NULL)
        return;
    for (uint32_t i = 0; i < c->nscan; i++) {
        free(c->scan[i].file);
        free(c->scan[i].path);
    }
    for (uint32_t i = 0; i < c->nnamed; i++)
        free(c->subject[i].id);
    for (uint32_t i = 0; i < c->nleft; i++)
        free(c->left[i].file);
    for (uint32_t i = 0; i < c->nkind; i++)
        free(c->kind[i]);
    for (uint32_t i = 0; i < c->npopulation; i++)
        free(c->population[i]);
    free(c->left);
    free(c->scan);
    free(c->subject);
    free(c->kind);
    free(c->population);
    free(c);
}

enum corpus_pair corpus_pair(const struct corpus *c, uint32_t a, uint32_t b)
{
    const struct corpus_subject *x = &c->subject[a], *y = &c->subject[b];

    if (a == b)
        return CORPUS_GENUINE;
    if (x->population != y->population)
        return CORPUS_FOREIGN;
    if (x->relative_of == b || y->relative_of == a ||
        (x->relative_of != CORPUS_NONE && x->relative_of == y->relative_of))
        return CORPUS_RELATIVE;
    return CORPUS_IMPOSTOR;
}
