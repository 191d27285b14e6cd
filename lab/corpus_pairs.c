#include "corpus_pairs.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "command.h"
#include "corpus.h"
#include "csv.h"

#define MAX_PAIRS 10000000
#define MAX_PATH  4095

enum label { LABEL_NONE, LABEL_MATED, LABEL_NON_MATED };

/* A side of a pair. */
struct mention {
    char *file;
    unsigned line;
    bool probe;
    size_t pair;
};

struct corpus_pairs_list {
    struct corpus_build *b;
    const char *path;
    struct mention *mention; /* [2 * n]: the template, the probe */
    unsigned char *label;    /* [n] enum label */
    size_t n;
    uint32_t *person; /* [nscan] another scan of the person, or itself: a forest */
};

/* ---- the file */

static enum label read_label(const char *word)
{
    static const char *const name[2][4] = {{"mated", "genuine", "same", "1"},
                                           {"non-mated", "impostor", "different", "0"}};

    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 4; k++)
            if (strcasecmp(word, name[i][k]) == 0)
                return i == 0 ? LABEL_MATED : LABEL_NON_MATED;
    return LABEL_NONE;
}

static bool make_room(struct corpus_pairs_list *l)
{
    void *mention = command_grow(l->mention, l->n, 2 * sizeof *l->mention);
    void *label = command_grow(l->label, l->n, sizeof *l->label);

    l->mention = mention != NULL ? mention : l->mention;
    l->label = label != NULL ? label : l->label;
    return mention != NULL && label != NULL;
}

static enum status corpus_pairs_read_row(struct corpus_pairs_list *l, const struct csv *t)
{
    struct errinfo *e = l->b->e;
    enum label label = LABEL_NONE;
    const char *why;

    if (csv_fields(t) < 2 || csv_fields(t) > 3)
        return csv_bad(t, -1, e,
                       "a line must have a template, a probe and perhaps a "
                       "label");
    for (int i = 0; i < 2; i++)
        if (csv_field(t, i)[0] == '\0')
            return csv_bad(t, i, e, "empty");
        else if ((why = corpus_build_bad_name(csv_field(t, i), MAX_PATH)) != NULL)
            return csv_bad(t, i, e, why);
    if (strcmp(csv_field(t, 0), csv_field(t, 1)) == 0)
        return csv_bad(t, -1, e, "a scan is paired with itself");
    if (csv_fields(t) == 3 && (label = read_label(csv_field(t, 2))) == LABEL_NONE)
        return csv_bad(t, 2, e,
                       "a label is mated or non-mated (genuine or impostor, same or "
                       "different, 1 or 0)");
    if (l->n > 0 && (label == LABEL_NONE) != (l->label[0] == LABEL_NONE))
        return csv_bad(t, -1, e, "a label is missing: give every pair a label, or none");
    if (l->n == MAX_PAIRS)
        return errinfo_set(e, ST_ELIMIT, "%.160s: more than %d pairs", l->path,
                           MAX_PAIRS);
    if (!make_room(l))
        return corpus_build_no_memory(e);
    l->label[l->n++] = (unsigned char)label;
    for (int i = 0; i < 2; i++) {
        struct mention *m = &l->mention[2 * (l->n - 1) + (size_t)i];

        *m = (struct mention){NULL, csv_line(t), i == 1, l->n - 1};
        if ((m->file = strdup(csv_field(t, i))) == NULL) {
            l->n -= i == 0; /* the probe's place is not filled */
            return corpus_build_no_memory(e);
        }
    }
    return ST_OK;
}

static bool is_heading(const struct csv *t)
{
    return strcasecmp(csv_field(t, 0), "template") == 0 &&
           strcasecmp(csv_field(t, 1), "probe") == 0;
}

static enum status read_list(struct corpus_pairs_list *l)
{
    struct csv *t;
    bool more;
    enum status st = csv_open(l->path, true, &t, l->b->e);

    for (bool first = true;
         st == ST_OK && (st = csv_next(t, &more, l->b->e)) == ST_OK && more;
         first = false)
        if (!first || !is_heading(t))
            st = corpus_pairs_read_row(l, t);
    csv_close(t);
    if (st == ST_OK && l->n == 0)
        st = errinfo_set(l->b->e, ST_EINVAL, "%.160s: no pairs", l->path);
    return st;
}

/* ---- the scans */

static int by_file(const void *a, const void *b)
{
    const struct mention *x = a, *y = b;
    const int order = strcmp(x->file, y->file);

    return order != 0 ? order : (x->line > y->line) - (x->line < y->line);
}

static enum status bad_mention(const struct corpus_pairs_list *l, const struct mention *m,
                               enum status st, const char *why)
{
    return errinfo_set(l->b->e, st, "%.100s, line %u: %.120s: %s", l->path, m->line,
                       m->file, why);
}

/* A scan by the file's name; with labels its subject is not known yet. */
static enum status add_scan(struct corpus_pairs_list *l, const struct mention *m)
{
    const bool labelled = l->label[0] != LABEL_NONE;
    const char *slash = strrchr(m->file, '/'), *why;
    char id[CORPUS_MAX_NAME + 1], kind[CORPUS_MAX_NAME + 1];
    enum status st;

    why = corpus_build_split(slash != NULL ? slash + 1 : m->file, id, kind);
    if (why != NULL && !labelled)
        return bad_mention(l, m, ST_EINVAL,
                           "not named SUBJECT_KIND.ply, and no third field says mated or "
                           "non-mated");
    if ((st = corpus_build_scan(l->b, m->file, labelled ? m->file : id,
                                why == NULL ? kind : "")) != ST_OK)
        return st;
    why = corpus_build_bad_file(l->b->c->scan[l->b->c->nscan - 1].path);
    return why != NULL ? bad_mention(l, m, ST_ENOTFOUND, why) : ST_OK;
}

static enum status add_scans(struct corpus_pairs_list *l)
{
    struct corpus *c = l->b->c;
    enum status st = ST_OK;

    if ((c->listed = malloc(l->n * sizeof *c->listed)) == NULL)
        return corpus_build_no_memory(l->b->e);
    c->nlisted = l->n;
    qsort(l->mention, 2 * l->n, sizeof *l->mention, by_file);
    for (size_t i = 0; i < 2 * l->n && st == ST_OK; i++) {
        const struct mention *m = &l->mention[i];
        struct corpus_listed *pair = &c->listed[m->pair];

        if (i == 0 || strcmp(m->file, m[-1].file) != 0)
            st = add_scan(l, m);
        *(m->probe ? &pair->probe : &pair->template) = c->nscan - 1;
        pair->line = m->line;
    }
    return st;
}

/* ---- the people, by the labels */

static uint32_t person(const struct corpus_pairs_list *l, uint32_t scan)
{
    while (l->person[scan] != scan)
        scan = l->person[scan] = l->person[l->person[scan]];
    return scan;
}

static enum status find_people(struct corpus_pairs_list *l)
{
    struct corpus *c = l->b->c;

    if ((l->person = malloc(c->nscan * sizeof *l->person)) == NULL)
        return corpus_build_no_memory(l->b->e);
    for (uint32_t i = 0; i < c->nscan; i++)
        l->person[i] = i;
    for (size_t i = 0; i < l->n; i++) {
        const uint32_t a = person(l, c->listed[i].template),
                       b = person(l, c->listed[i].probe);

        if (l->label[i] == LABEL_MATED) /* the first of them stands for all */
            l->person[a > b ? a : b] = a > b ? b : a;
    }
    for (size_t i = 0; i < l->n; i++)
        if (l->label[i] == LABEL_NON_MATED &&
            person(l, c->listed[i].template) == person(l, c->listed[i].probe))
            return errinfo_set(
                l->b->e, ST_EINVAL,
                "%.120s, line %u: a non-mated pair of two scans that the mated "
                "pairs say are of one person",
                l->path, c->listed[i].line);
    return ST_OK;
}

/* Of the subjects, a scan each, one for each person is left. */
static void merge_subjects(struct corpus_pairs_list *l)
{
    struct corpus *c = l->b->c;
    uint32_t n = 0;

    for (uint32_t i = 0; i < c->nscan;
         i++) /* the person's first scan is i, or came before */
        if (person(l, i) == i) {
            struct corpus_subject first = c->subject[i];

            first.nscan = 1;
            c->scan[i].subject = n;
            c->subject[n++] = first;
        } else {
            c->scan[i].subject = c->scan[person(l, i)].subject;
            c->subject[c->scan[i].subject].nscan++;
            free(c->subject[i].id);
        }
    c->nnamed = n;
}

/* ---- the whole */

enum status corpus_pairs_read(const char *path, struct corpus **out, struct errinfo *e)
{
    const char *slash = strrchr(path, '/');
    struct corpus_build b;
    struct corpus_pairs_list l = {.b = &b, .path = path};
    enum status st = corpus_build_begin(&b, e);

    if (st == ST_OK &&
        (b.dir = strndup(slash != NULL ? path : ".",
                         slash != NULL ? (size_t)(slash - path) + 1 : 1)) == NULL)
        st = corpus_build_no_memory(e);
    if (st == ST_OK && (st = read_list(&l)) == ST_OK && (st = add_scans(&l)) == ST_OK &&
        l.label[0] != LABEL_NONE && (st = find_people(&l)) == ST_OK)
        merge_subjects(&l);
    if (st == ST_OK)
        b.c->nsubject = b.c->nnamed;
    for (size_t i = 0; i < 2 * l.n; i++)
        free(l.mention[i].file);
    free(l.mention);
    free(l.label);
    free(l.person);
    return corpus_build_end(&b, st, out);
}
