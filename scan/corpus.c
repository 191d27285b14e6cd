#include "corpus.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "cloudformat.h"
#include "command.h"
#include "json.h"
#include "utf8.h"

#define MAX_NAMES 65536 /* of kinds or populations */

enum status corpus_build_no_memory(struct errinfo *e)
{
    return errinfo_set(e, ST_ENOMEM, "the list of scans: out of memory");
}

/* What is wrong with a name, or NULL. */
const char *corpus_build_bad_name(const char *text, size_t most)
{
    if (strlen(text) > most)
        return "too long";
    return utf8_is_text(text, most) ? NULL : "a control character, or not UTF-8";
}

static uint32_t *slot_of(const struct corpus_build *b, const char *id)
{
    uint32_t h = 2166136261U; /* FNV-1a */

    for (const char *p = id; *p != '\0'; p++)
        h = (h ^ (unsigned char)*p) * 16777619U;
    for (;; h++) {
        uint32_t *s = &b->hash[h & (b->nhash - 1)];

        if (*s == CORPUS_NONE || strcmp(b->c->subject[*s].id, id) == 0)
            return s;
    }
}

static bool rehash(struct corpus_build *b)
{
    uint32_t *larger;

    if (2 * b->c->nnamed < b->nhash)
        return true;
    if ((larger = malloc(2 * (size_t)b->nhash * sizeof *larger)) == NULL)
        return false;
    free(b->hash);
    b->hash = larger;
    b->nhash *= 2;
    memset(b->hash, 0xFF, b->nhash * sizeof *b->hash);
    for (uint32_t i = 0; i < b->c->nnamed; i++)
        *slot_of(b, b->c->subject[i].id) = i;
    return true;
}

enum status corpus_build_subject(struct corpus_build *b, const char *id, uint32_t *out)
{
    struct corpus *c = b->c;
    uint32_t *slot = slot_of(b, id);

    if (*slot == CORPUS_NONE) {
        void *larger = command_grow(c->subject, c->nnamed, sizeof *c->subject);
        char *copy;

        if (larger == NULL)
            return corpus_build_no_memory(b->e);
        c->subject = larger;
        if ((copy = strdup(id)) == NULL)
            return corpus_build_no_memory(b->e);
        c->subject[c->nnamed].id = copy;
        c->subject[c->nnamed].nscan = 0;
        c->subject[c->nnamed].enrolled = CORPUS_NONE;
        c->subject[c->nnamed].population = CORPUS_NONE;
        c->subject[c->nnamed].relative_of = CORPUS_NONE;
        *slot = c->nnamed++;
        *out = *slot;
        return rehash(b) ? ST_OK : corpus_build_no_memory(b->e);
    }
    *out = *slot;
    return ST_OK;
}

/* The name's place in a list of few. */
static enum status intern(struct corpus_build *b, char ***list, uint32_t *n,
                          const char *name, uint32_t *out)
{
    void *larger;

    for (*out = 0; *out < *n; ++*out)
        if (strcmp((*list)[*out], name) == 0)
            return ST_OK;
    if (*n == MAX_NAMES)
        return errinfo_set(b->e, ST_ELIMIT, "more than %d kinds or populations",
                           MAX_NAMES);
    if ((larger = command_grow(*list, *n, sizeof **list)) == NULL)
        return corpus_build_no_memory(b->e);
    *list = larger;
    if (((*list)[*n] = strdup(name)) == NULL)
        return corpus_build_no_memory(b->e);
    ++*n;
    return ST_OK;
}

enum status corpus_build_population(struct corpus_build *b, const char *name,
                                    uint32_t *out)
{
    return intern(b, &b->c->population, &b->c->npopulation, name, out);
}

uint32_t corpus_build_find(const struct corpus_build *b, const char *id)
{
    return *slot_of(b, id);
}

char *corpus_build_path(const struct corpus_build *b, const char *file)
{
    const size_t size = strlen(b->dir) + strlen(file) + 2;
    char *path = malloc(size);

    if (path != NULL && file[0] == '/')
        memcpy(path, file, strlen(file) + 1);
    else if (path != NULL)
        (void)snprintf(path, size, "%s/%s", b->dir, file);
    return path;
}

/* Why what is at path cannot be a scan, or NULL. */
const char *corpus_build_bad_file(const char *path)
{
    struct stat info;

    if (stat(path, &info) != 0 || (S_ISREG(info.st_mode) && access(path, R_OK) != 0))
        return errno == ENOENT   ? "No such file or directory"
               : errno == EACCES ? "Permission denied"
                                 : "it cannot be opened";
    if (S_ISDIR(info.st_mode))
        return "a folder, not a file: subfolders are not read";
    return S_ISREG(info.st_mode) ? NULL : "not a file";
}

enum status corpus_build_scan(struct corpus_build *b, const char *file, const char *id,
                              const char *kind)
{
    struct corpus *c = b->c;
    struct corpus_scan s = {0};
    void *larger;
    enum status st;

    if (c->nscan == CORPUS_MAX_SCANS)
        return errinfo_set(b->e, ST_ELIMIT, "more than %d scans", CORPUS_MAX_SCANS);
    if ((larger = command_grow(c->scan, c->nscan, sizeof *c->scan)) == NULL)
        return corpus_build_no_memory(b->e);
    c->scan = larger;
    if ((st = corpus_build_subject(b, id, &s.subject)) != ST_OK ||
        (st = intern(b, &c->kind, &c->nkind, kind, &s.kind)) != ST_OK)
        return st;
    s.file = strdup(file);
    s.path = corpus_build_path(b, file);
    c->subject[s.subject].nscan++;
    c->scan[c->nscan++] = s;
    if (s.file == NULL || s.path == NULL)
        return corpus_build_no_memory(b->e);
    return ST_OK;
}

/* What is wrong with the name SUBJECT_KIND.ply, or NULL; else it is cut in two. */
const char *corpus_build_split(const char *file, char id[CORPUS_MAX_NAME + 1],
                               char kind[CORPUS_MAX_NAME + 1])
{
    const char *cut = strchr(file, '_'), *dot = cloudformat_ending(file);
    const char *why = corpus_build_bad_name(file, 255);

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

enum status corpus_build_left(struct corpus_build *b, const char *file, const char *why,
                              bool scan)
{
    struct corpus *c = b->c;
    void *larger = command_grow(c->left, c->nleft, sizeof *c->left);

    if (larger == NULL)
        return corpus_build_no_memory(b->e);
    c->left = larger;
    c->left[c->nleft] = (struct corpus_left){printable(file), why, scan};
    c->nleft_scan += scan;
    return c->left[c->nleft++].file != NULL ? ST_OK : corpus_build_no_memory(b->e);
}

enum status corpus_build_begin(struct corpus_build *b, struct errinfo *e)
{
    *b = (struct corpus_build){.nhash = 256, .e = e};
    b->c = calloc(1, sizeof *b->c);
    b->hash = malloc(b->nhash * sizeof *b->hash);
    if (b->c == NULL || b->hash == NULL)
        return corpus_build_no_memory(e);
    memset(b->hash, 0xFF, b->nhash * sizeof *b->hash);
    return ST_OK;
}

enum status corpus_build_end(struct corpus_build *b, enum status st, struct corpus **out)
{
    for (uint32_t i = 0; st == ST_OK && i < b->c->nsubject; i++)
        if (b->c->subject[i].population == CORPUS_NONE)
            st = corpus_build_population(b, "", &b->c->subject[i].population);
    *out = st == ST_OK ? b->c : NULL;
    if (st != ST_OK)
        corpus_free(b->c);
    free(b->dir);
    free(b->hash);
    return st;
}

/* ---- once it is read (corpus.h) */

/* Are both of one session? */
static bool one_session(const struct corpus *c, const struct corpus_scan *a,
                        const struct corpus_scan *b)
{
    const char *p = c->kind[a->kind], *q = c->kind[b->kind];
    const char *end = strrchr(p, '-'), *other = strrchr(q, '-');

    return a->subject == b->subject && end != NULL && other != NULL &&
           end - p == other - q && memcmp(p, q, (size_t)(end - p)) == 0;
}

/* Scan b becomes a frame of a, or goes if a has enough. */
static bool add_frame(struct corpus_scan *a, struct corpus_scan *b, uint32_t n)
{
    if (a->nframe + 1 < n) {
        char **more = realloc(a->frame, (a->nframe + 1) * sizeof *more);

        if (more == NULL)
            return false;
        a->frame = more;
        a->frame[a->nframe++] = b->path;
        b->path = NULL;
    }
    a->enrolled = a->enrolled || b->enrolled;
    free(b->path);
    free(b->file);
    *b = (struct corpus_scan){.file = NULL};
    return true;
}

enum status corpus_sessions(struct corpus *c, uint32_t n, struct errinfo *e)
{
    uint32_t kept = 0;
    enum status st = ST_OK;

    for (uint32_t i = 0; i < c->nscan; i++) {
        struct corpus_scan *one = &c->scan[i],
                           *last = kept > 0 ? &c->scan[kept - 1] : NULL;
        struct corpus_subject *of = &c->subject[one->subject];

        if (st == ST_OK && last != NULL && one_session(c, last, one)) {
            of->nscan--;
            if (of->enrolled == i)
                of->enrolled = kept - 1;
            if (!add_frame(last, one, n))
                st = corpus_build_no_memory(e);
            if (st == ST_OK)
                continue;
        }
        if (of->enrolled == i)
            of->enrolled = kept;
        if (kept < i) {
            c->scan[kept] = *one;
            *one = (struct corpus_scan){.file = NULL};
        }
        kept++;
    }
    c->nscan = kept;
    return st;
}

/* The kinds that there are, for a message. */
static void list_kinds(const struct corpus *c, char *text, size_t room)
{
    size_t n = 0;

    for (uint32_t i = 0; i < c->nkind && n < room; i++)
        n += (size_t)snprintf(text + n, room - n, "%s%s", i > 0 ? ", " : "",
                              c->kind[i][0] != '\0' ? c->kind[i] : "\"\"");
    if (n >= room)
        memcpy(text + room - 4, "...", 4);
}

enum status corpus_enroll(struct corpus *c, const char *kind, struct errinfo *e)
{
    char kinds[160];
    uint32_t k = 0;

    while (k < c->nkind && strcmp(c->kind[k], kind) != 0)
        k++;
    if (k == c->nkind) {
        list_kinds(c, kinds, sizeof kinds);
        return errinfo_set(e, ST_EINVAL, "no scan is of the kind %.60s: there are %s",
                           kind, kinds);
    }
    for (uint32_t i = 0; i < c->nsubject; i++)
        c->subject[i].enrolled = CORPUS_NONE;
    for (uint32_t i = 0; i < c->nscan; i++) {
        uint32_t *enrolled = &c->subject[c->scan[i].subject].enrolled;

        c->scan[i].enrolled = *enrolled == CORPUS_NONE && c->scan[i].kind == k;
        if (c->scan[i].enrolled)
            *enrolled = i;
    }
    return ST_OK;
}

bool corpus_is_scan(const char *path)
{
    const char *ending = cloudformat_ending(path);
    struct stat info;

    return ending != NULL && strcasecmp(ending, ".csv") != 0 &&
           strcasecmp(ending, ".txt") != 0 && stat(path, &info) == 0 &&
           S_ISREG(info.st_mode);
}

void corpus_free(struct corpus *c)
{
    if (c == NULL)
        return;
    for (uint32_t i = 0; i < c->nscan; i++) {
        free(c->scan[i].file);
        free(c->scan[i].path);
        for (uint32_t k = 0; k < c->scan[i].nframe; k++)
            free(c->scan[i].frame[k]);
        free(c->scan[i].frame);
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
    free(c->listed);
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

void corpus_left_json(const struct corpus *c, struct json *j)
{
    for (uint32_t i = 0; i < c->nleft; i++) {
        json_object(j, NULL);
        json_text(j, "file", c->left[i].file);
        json_text(j, "reason", c->left[i].why);
        json_close(j);
    }
    json_close(j);
}

void corpus_left_print(const struct corpus *c, const char *program)
{
    for (uint32_t i = 0; i < c->nleft; i++)
        (void)fprintf(stderr, "%s: %s: %s\n", program, c->left[i].file, c->left[i].why);
}
