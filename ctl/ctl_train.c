/* The command train: a model from a collection of scans (docs/model.md). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model.h"
#include "modelfile.h"
#include "corpus.h"
#include "pool.h"
#include "ctl_command.h"
#include "ctl_corpus.h"
#include "train.h"
#include "train_set.h"

/* The scans of a collection as faces. */
struct scans {
    const struct ctl *c;
    const struct corpus *corpus;
    struct face *face;
    char **refused; /* [nscan] why, or NULL */
};

static enum status read_scan(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    const struct scans *s = arg;
    struct scan_found found;

    return ctl_corpus_face(s->c, &s->corpus->scan[i], false, w, &s->face[i], &found,
                           &s->refused[i], e);
}

static void list_refused(struct ctl *c, const struct scans *s)
{
    json_array(c->out, "refused");
    for (uint32_t i = 0; i < s->corpus->nscan; i++)
        if (s->refused[i] != NULL) {
            json_object(c->out, NULL);
            json_text(c->out, "file", s->corpus->scan[i].file);
            json_text(c->out, "reason", s->refused[i]);
            json_close(c->out);
            (void)fprintf(stderr, "surfacectl: not used: %s\n", s->refused[i]);
        }
    ctl_corpus_left(c->out, s->corpus);
    ctl_corpus_tell(s->corpus);
}

static void say(void *arg, const char *line)
{
    (void)arg;
    (void)fprintf(stderr, "surfacectl: %s\n", line);
}

static void print_figures(struct ctl *c, const char *key, const struct rates_figures *f)
{
    json_object(c->out, key);
    json_rate(c->out, "eer", f->eer);
    json_number(c->out, "tar_at_fmr_1e-2", f->tar[0]);
    json_number(c->out, "tar_at_fmr_1e-3", f->tar[1]);
    json_close(c->out);
    ctl_say(c, "%-12s EER %.2f %%; accepted %.1f %% at FMR 1 %%, %.1f %% at 0.1 %%\n",
            key, 100 * f->eer, 100 * f->tar[0], 100 * f->tar[1]);
}

static void print_report(struct ctl *c, const char *path, const struct model *m,
                         const struct train_report *r)
{
    char engine[FACE_ENGINE_MAX + 1];

    face_engine(m, engine);
    json_text(c->out, "model", path);
    json_text(c->out, "name", m->name);
    json_text(c->out, "engine", engine);
    json_number(c->out, "mated", (double)r->genuine);
    json_number(c->out, "non_mated", (double)r->impostor);
    json_number(c->out, "threshold_mm", r->threshold_mm);
    ctl_say(c, "pairs        %zu of one subject, %zu of different ones\n", r->genuine,
            r->impostor);
    print_figures(c, "before", &r->before);
    print_figures(c, "after", &r->after);
    ctl_say(c,
            "             (after: each half of the subjects judged by what the "
            "other taught)\n"
            "threshold    %.4f mm for a false match rate of 0.1 %%\n"
            "model        %s: %s\n",
            r->threshold_mm, path, strchr(engine, ' ') + 1);
}

/* A name that the file can hold? */
static bool valid_name(const char *name)
{
    const size_t n = strlen(name);

    for (size_t i = 0; i < n; i++)
        if (n > MODEL_NAME_MAX || name[i] < ' ' || name[i] > '~')
            return false;
    return true;
}

/* The learning and the file, when the scans have been found. */
static enum status train(struct ctl *c, struct scans *s, const char *path,
                         const char *name)
{
    const struct train_set set = {s->corpus, s->face};
    struct model *m = malloc(sizeof *m);
    struct train_report report;
    enum status st;

    if (m == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    st = pool_run("reading", c->threads, c->model, s->corpus->nscan, read_scan, s, &c->e);
    if (st == ST_OK) {
        list_refused(c, s);
        st = train_model(&set, c->model, name, c->threads, say, NULL, m, &report, &c->e);
    }
    if (st == ST_OK)
        st = modelfile_write(path, m, &c->e);
    if (st == ST_OK)
        print_report(c, path, m, &report);
    free(m);
    return st;
}

static enum status run(struct ctl *c)
{
    const char *path = c->dir != NULL ? c->dir : "faces.model";
    const char *name = c->label != NULL ? c->label : "a collection of scans";
    struct scans s = {.c = c};
    struct corpus *corpus = NULL;
    enum status st;

    if (!valid_name(name))
        return ctl_usage(c, "a model's label is up to %d printable ASCII characters",
                         MODEL_NAME_MAX);
    if ((st = corpus_read(c->args[0], &corpus, &c->e)) != ST_OK)
        return st;
    s.corpus = corpus;
    s.face = calloc(corpus->nscan, sizeof *s.face);
    s.refused = calloc(corpus->nscan, sizeof *s.refused);
    if (s.face == NULL || s.refused == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    else
        st = train(c, &s, path, name);
    for (uint32_t i = 0; i < corpus->nscan; i++) {
        if (s.face != NULL)
            face_free(&s.face[i]);
        if (s.refused != NULL)
            free(s.refused[i]);
    }
    free(s.face);
    free(s.refused);
    corpus_free(corpus);
    return st;
}

const struct ctl_command ctl_train = {
    .name = "train",
    .args = "DIR|MANIFEST",
    .takes = {1, 1},
    .shared = CTL_SCANS | CTL_MODEL | CTL_LABEL | CTL_OUT | CTL_THREADS,
    .run = run,
    .summary = "learn a model from a collection of scans",
    .help =
        "DIR or MANIFEST is as for evaluate.  The model has the mean face, how a face changes\n"
        "between two scans of one person, and the weight of each place.  It is written to the\n"
        "file --out (./faces.model), for --model of other commands and of surfaced.  The error\n"
        "rates before and after are printed, the latter of subjects that it did not learn from.\n"
        "It takes 20 subjects and 250 scans besides the enrolled ones at least; hundreds of\n"
        "subjects are better.  --label names the model; --model is the one to begin with.",
    .example = "surfacectl train scans/ --label 'door scanner' --out door.model"};
