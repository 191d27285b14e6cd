/* The command train: a model adapted to scans, or calibrated by scores (docs/model.md). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lab.h"
#include "outfile.h"
#include "corpus.h"
#include "corpus_read.h"
#include "model.h"
#include "modelfile.h"
#include "pool.h"
#include "train.h"

/* The scans of a collection as faces. */
struct scans {
    const struct lab *c;
    struct corpus *corpus;
    struct surface_face *face;
    char **refused; /* [nscan] why, or NULL */
};

static enum status read_scan(void *arg, size_t i, struct surface_work *w,
                             struct errinfo *e)
{
    const struct scans *s = arg;
    struct surface_found found;

    return lab_scan_of(s->c, &s->corpus->scan[i], false, w, &s->face[i], &found, NULL,
                       &s->refused[i], e);
}

static void list_refused(struct lab *c, const struct scans *s)
{
    json_array(c->report, "refused");
    for (uint32_t i = 0; i < s->corpus->nscan; i++)
        if (s->refused[i] != NULL) {
            json_object(c->report, NULL);
            json_text(c->report, "file", s->corpus->scan[i].file);
            json_text(c->report, "reason", s->refused[i]);
            json_close(c->report);
            (void)fprintf(stderr, "surfacelab: not used: %s\n", s->refused[i]);
        }
    corpus_left_json(s->corpus, c->report);
    corpus_left_print(s->corpus, "surfacelab");
}

static enum status read_scans(struct lab *c, struct scans *s)
{
    enum status st = corpus_read(c->args[0], &s->corpus, &c->e);

    if (st == ST_OK)
        st = lab_scan_not_read(c, s->corpus, c->args[0], c->out);
    if (st != ST_OK)
        return st;
    s->face = calloc(s->corpus->nscan, sizeof *s->face);
    s->refused = calloc(s->corpus->nscan, sizeof *s->refused);
    if (s->face == NULL || s->refused == NULL)
        return errinfo_memory(&c->e);
    st = pool_run("reading", c->threads, c->model, s->corpus->nscan, read_scan, s, &c->e);
    if (st == ST_OK)
        list_refused(c, s);
    return st;
}

static void free_scans(struct scans *s)
{
    for (uint32_t i = 0; s->corpus != NULL && i < s->corpus->nscan; i++) {
        if (s->face != NULL)
            face_free(&s->face[i]);
        if (s->refused != NULL)
            free(s->refused[i]);
    }
    free(s->face);
    free(s->refused);
    corpus_free(s->corpus);
}

static void print_figures(struct lab *c, const char *key, const char *title,
                          const struct rates_figures *f)
{
    json_object(c->report, key);
    json_rate(c->report, "eer", f->eer);
    json_number(c->report, "tar_at_fmr_1e-2", f->tar[0]);
    json_number(c->report, "tar_at_fmr_1e-3", f->tar[1]);
    json_close(c->report);
    lab_say(c, "%-12s EER %.2f %%; accepted %.1f %% at FMR 1 %%, %.1f %% at 0.1 %%\n",
            title, 100 * f->eer, 100 * f->tar[0], 100 * f->tar[1]);
}

static void print_scans(struct lab *c, const struct train_report *r)
{
    json_number(c->report, "subjects", r->nsubject);
    json_number(c->report, "scans", r->nscan);
    json_number(c->report, "weight", r->weight);
    json_number(c->report, "mated", (double)r->mated);
    json_number(c->report, "non_mated", (double)r->non_mated);
    lab_say(c,
            "scans        %u of %u subjects, with a weight of %.2f\n"
            "comparisons  %zu mated, %zu non-mated; the same for both models\n",
            r->nscan, r->nsubject, r->weight, r->mated, r->non_mated);
    print_figures(c, "base", "before", &r->base);
    print_figures(c, "trained", "after", &r->own);
    json_flag(c->report, "worse", r->worse);
    lab_say(c,
            "             After: each half of the subjects by a model of the other half "
            "(cross-validated).\n"
            "             Before: the base model, which has learned from none of these "
            "scans, unless you\n"
            "             trained it on them: then its figures are in-sample, and too "
            "good.\n");
}

static void print_model(struct lab *c, const char *path, const struct surface_model *m)
{
    char engine[SURFACE_ENGINE_SIZE];

    surface_engine(m, engine);
    json_text(c->report, "model", path);
    json_text(c->report, "name", m->name);
    json_text(c->report, "engine", engine);
    json_number(c->report, "threshold", m->calibration.threshold);
    lab_say(c, "threshold    %.3f, %s\nmodel        %s: %s\n", m->calibration.threshold,
            c->calibrate != NULL ? "by the scores given"
                                 : "of the base model's calibration",
            path, strchr(engine, ' ') + 1);
}

/* A name that the file can hold? */
static bool valid_name(const char *text)
{
    const size_t n = strlen(text);

    for (size_t i = 0; i < n; i++)
        if (n > MODEL_NAME_MAX || text[i] < ' ' || text[i] > '~')
            return false;
    return true;
}

static enum status may_write(struct lab *c)
{
    const enum status st = lab_may_write(c, c->out);

    return st == ST_OK ? outfile_not_read(c->out, c->calibrate, &c->e) : st;
}

static enum status lab_train_check(struct lab *c)
{
    if (c->out == NULL)
        return lab_usage(c, "give --out FILE, the model to write");
    if (c->name != NULL && !valid_name(c->name))
        return lab_usage(c, "a model's name is up to %d printable ASCII characters",
                         MODEL_NAME_MAX);
    if (c->calibrate == NULL && c->nargs == 0)
        return lab_usage(c, "nothing to learn from: give a collection of scans, or "
                            "--calibrate FILE");
    if (c->weight >= 0 && c->nargs == 0)
        return lab_usage(c, "--weight is that of scans, and there are none");
    return may_write(c);
}

enum status lab_train(struct lab *c)
{
    struct train t = {.base = c->model,
                      .weight = c->weight,
                      .scores = c->calibrate,
                      .threads = c->threads};
    struct scans s = {.c = c};
    struct train_report report;
    struct surface_model *m = NULL;
    enum status st = lab_train_check(c);

    if (st != ST_OK)
        return st;
    if (c->nargs > 0)
        st = read_scans(c, &s);
    t.corpus = s.corpus;
    t.face = s.face;
    if (st == ST_OK && (m = malloc(sizeof *m)) == NULL)
        st = errinfo_memory(&c->e);
    if (st == ST_OK)
        st = train_model(&t, c->name != NULL ? c->name : c->model->name, m, &report,
                         &c->e);
    if (st == ST_OK && s.corpus != NULL)
        print_scans(c, &report);
    if (st == ST_OK && report.worse)
        (void)fprintf(stderr,
                      "surfacelab: the new model is worse than the base model on people "
                      "that it has not learned from: %s\n",
                      c->force ? "written nevertheless" : "not written without --force");
    if (st == ST_OK && report.worse && !c->force) {
        c->code = EXIT_NO;
    } else if (st == ST_OK &&
               (st = modelfile_write(c->out, c->force, m, &c->e)) == ST_OK) {
        print_model(c, c->out, m);
    }
    free(m);
    free_scans(&s);
    return st;
}
