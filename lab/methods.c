#include "methods.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "command.h"
#include "csv.h"
#include "report.h"

struct methods_entry { /* a comparison by its files */
    const char *template, *probe;
    size_t trial;
};

struct methods_reading {
    const struct trials *t;
    struct methods_entry *entry; /* [t->n], sorted */
    struct report_method *method;
    size_t n;
    char *name; /* of the method, if the table has no column for it */
    int template, probe, value, method_column;
    double sign; /* -1: the value is a distance */
    struct csv *csv;
    struct errinfo *e;
};

static int by_files(const void *a, const void *b)
{
    const struct methods_entry *x = a, *y = b;
    const int order = strcmp(x->template, y->template);

    return order != 0 ? order : strcmp(x->probe, y->probe);
}

/* The file's name without folder and extension. */
static char *name_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *name = strdup(slash != NULL ? slash + 1 : path);
    char *dot = name != NULL ? strrchr(name, '.') : NULL;

    if (dot != NULL && dot != name)
        *dot = '\0';
    return name;
}

static enum status methods_begin(struct methods_reading *r, const char *path)
{
    const struct corpus *c = r->t->corpus;
    enum status st;

    r->entry = malloc((r->t->n + 1) * sizeof *r->entry);
    r->name = name_of(path);
    if (r->entry == NULL || r->name == NULL)
        return errinfo_memory(r->e);
    for (size_t i = 0; i < r->t->n; i++)
        r->entry[i] = (struct methods_entry){c->scan[r->t->trial[i].template].file,
                                             c->scan[r->t->trial[i].probe].file, i};
    qsort(r->entry, r->t->n, sizeof *r->entry, by_files);
    if ((st = csv_open(path, false, &r->csv, r->e)) != ST_OK ||
        (st = csv_need(r->csv, "template", &r->template, r->e)) != ST_OK ||
        (st = csv_need(r->csv, "probe", &r->probe, r->e)) != ST_OK)
        return st;
    r->method_column = csv_column(r->csv, "method");
    r->value = csv_column(r->csv, "distance");
    r->sign = -1;
    if (r->value >= 0)
        return ST_OK;
    r->sign = 1;
    return csv_need(r->csv, "score", &r->value, r->e);
}

/* The method of the current row, which is added if it is new. */
static struct report_method *method_of(struct methods_reading *r)
{
    const char *name =
        r->method_column >= 0 ? csv_field(r->csv, r->method_column) : r->name;
    struct report_method *m;
    void *larger;

    for (size_t i = 0; i < r->n; i++)
        if (strcmp(r->method[i].name, name) == 0)
            return &r->method[i];
    if ((larger = command_grow(r->method, r->n, sizeof *r->method)) == NULL)
        return NULL;
    r->method = larger;
    m = &r->method[r->n];
    *m = (struct report_method){.name = strdup(name),
                                .score = malloc((r->t->n + 1) * sizeof *m->score)};
    r->n++;
    for (size_t i = 0; m->score != NULL && i < r->t->n; i++)
        m->score[i] = (double)NAN;
    return m->name != NULL && m->score != NULL ? m : NULL;
}

static enum status methods_read_row(struct methods_reading *r)
{
    const struct methods_entry key = {csv_field(r->csv, r->template),
                                      csv_field(r->csv, r->probe), 0};
    const struct methods_entry *found =
        bsearch(&key, r->entry, r->t->n, sizeof *r->entry, by_files);
    struct report_method *m;
    double value;
    enum status st;

    if (csv_field(r->csv, r->value)[0] == '\0')
        return ST_OK;
    if ((m = method_of(r)) == NULL)
        return errinfo_memory(r->e);
    if ((st = csv_number(r->csv, r->value, &value, r->e)) != ST_OK || found == NULL)
        return st;
    if (!isnan(m->score[found->trial]))
        return csv_bad(r->csv, r->probe, r->e, "this pair has a score already");
    m->score[found->trial] = r->sign * value;
    return ST_OK;
}

enum status methods_read(const char *path, const struct trials *t,
                         struct report_method **out, size_t *n, struct errinfo *e)
{
    struct methods_reading r = {.t = t, .e = e};
    enum status st = methods_begin(&r, path);
    bool more;

    while (st == ST_OK && (st = csv_next(r.csv, &more, e)) == ST_OK && more)
        st = methods_read_row(&r);
    for (size_t i = 0; i < r.n && st == ST_OK; i++) {
        st = report_measure_method(&r.method[i], t);
        if (st != ST_OK)
            (void)errinfo_set(e, st, "the rates: %s", status_message(st));
        else if (r.method[i].scored == 0)
            st = errinfo_set(
                e, ST_EINVAL,
                "%.160s: no pair of %.60s is compared here: template and probe "
                "are files as scores.csv names them",
                path, r.method[i].name);
    }
    if (st == ST_OK && r.n == 0)
        st = errinfo_set(e, ST_EINVAL, "%.160s: no row has a score", path);
    csv_close(r.csv);
    free(r.entry);
    free(r.name);
    if (st != ST_OK) {
        methods_free(r.method, r.n);
        r.method = NULL;
        r.n = 0;
    }
    *out = r.method;
    *n = r.n;
    return st;
}

void methods_free(struct report_method *m, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        free(m[i].name);
        free(m[i].score);
        rates_free(m[i].curve.rates);
    }
    free(m);
}
