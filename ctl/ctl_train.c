/* The command train: a model from a morphable model and from scans (docs/model.md). */
#include <dirent.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "corpus.h"
#include "corpus_read.h"
#include "ctl_command.h"
#include "ctl_corpus.h"
#include "ctl_dir.h"
#include "model.h"
#include "modelfile.h"
#include "pool.h"
#include "train.h"

static const char *morphable, *name, *scores; /* options of its own */
static double weight = -1;

/* The scans of a collection as faces. */
struct scans {
    const struct ctl *c;
    struct corpus *corpus;
    struct face *face;
    char **refused; /* [nscan] why, or NULL */
};

static enum status read_scan(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    const struct scans *s = arg;
    struct scan_found found;

    return ctl_corpus_face(s->c, &s->corpus->scan[i], false, w, &s->face[i], &found, NULL,
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

static enum status read_scans(struct ctl *c, struct scans *s)
{
    enum status st = corpus_read(c->args[0], &s->corpus, &c->e);

    if (st == ST_OK)
        st = ctl_corpus_not_read(c, s->corpus, c->args[0], c->dir);
    if (st != ST_OK)
        return st;
    s->face = calloc(s->corpus->nscan, sizeof *s->face);
    s->refused = calloc(s->corpus->nscan, sizeof *s->refused);
    if (s->face == NULL || s->refused == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
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

static void print_figures(struct ctl *c, const char *key, const char *title,
                          const struct rates_figures *f)
{
    json_object(c->out, key);
    json_rate(c->out, "eer", f->eer);
    json_number(c->out, "tar_at_fmr_1e-2", f->tar[0]);
    json_number(c->out, "tar_at_fmr_1e-3", f->tar[1]);
    json_close(c->out);
    ctl_say(c, "%-12s EER %.2f %%; accepted %.1f %% at FMR 1 %%, %.1f %% at 0.1 %%\n",
            title, 100 * f->eer, 100 * f->tar[0], 100 * f->tar[1]);
}

static void print_scans(struct ctl *c, const struct train_report *r)
{
    json_number(c->out, "subjects", r->nsubject);
    json_number(c->out, "scans", r->nscan);
    json_number(c->out, "weight", r->weight);
    json_number(c->out, "mated", (double)r->mated);
    json_number(c->out, "non_mated", (double)r->non_mated);
    ctl_say(c,
            "scans        %u of %u subjects, with a weight of %.2f\n"
            "comparisons  %zu mated, %zu non-mated; the same for both models\n",
            r->nscan, r->nsubject, r->weight, r->mated, r->non_mated);
    print_figures(c, "base", "base model", &r->base);
    print_figures(c, "trained", "new model", &r->own);
    json_flag(c->out, "worse", r->worse);
    ctl_say(c, "             The new model's figures are of people that it had not "
               "learned from: each half of\n"
               "             the subjects by what the other half taught.  If the base "
               "model was learned from\n"
               "             these scans, its figures are in-sample, and flatter it.\n");
    if (r->worse)
        (void)fprintf(stderr, "surfacectl: warning: the new model is worse than the base "
                              "model on people that it has\n"
                              "not learned from: keep the base model\n");
}

static void print_model(struct ctl *c, const char *path, const struct model *m)
{
    char engine[FACE_ENGINE_MAX + 1];

    face_engine(m, engine);
    json_text(c->out, "model", path);
    json_text(c->out, "name", m->name);
    json_text(c->out, "engine", engine);
    json_number(c->out, "threshold", m->calibration.threshold);
    ctl_say(c, "threshold    %.3f, %s\nmodel        %s: %s\n", m->calibration.threshold,
            scores != NULL ? "by the scores given" : "of the base model's calibration",
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

/* None of the morphable model's files either.  A folder that cannot be read fails later. */
static enum status not_a_shape(struct ctl *c)
{
    DIR *const dir = opendir(morphable);
    const struct dirent *entry;
    char path[PATH_MAX];
    enum status st = ST_OK;

    while (dir != NULL && st == ST_OK && (entry = readdir(dir)) != NULL) {
        (void)snprintf(path, sizeof path, "%s/%s", morphable, entry->d_name);
        st = ctl_dir_not_read(c, c->dir, path);
    }
    if (dir != NULL)
        (void)closedir(dir);
    return st;
}

static enum status may_write(struct ctl *c)
{
    enum status st = ctl_dir_may_write(c, c->dir, c->nargs);

    if (st == ST_OK)
        st = ctl_dir_not_read(c, c->dir, scores);
    return st == ST_OK && morphable != NULL ? not_a_shape(c) : st;
}

static enum status check(struct ctl *c)
{
    if (c->dir == NULL)
        return ctl_usage(c, "--out FILE is needed: the model that is written");
    if (name != NULL && !valid_name(name))
        return ctl_usage(c, "a model's name is up to %d printable ASCII characters",
                         MODEL_NAME_MAX);
    if (morphable == NULL && scores == NULL && c->nargs == 0)
        return ctl_usage(c, "nothing to learn from: a collection of scans, --morphable "
                            "DIR or --calibrate FILE");
    if (weight >= 0 && c->nargs == 0)
        return ctl_usage(c, "--weight is that of scans, and there are none");
    return may_write(c);
}

static enum status run(struct ctl *c)
{
    struct train t = {.base = c->model,
                      .morphable = morphable,
                      .weight = weight,
                      .scores = scores,
                      .threads = c->threads};
    struct scans s = {.c = c};
    struct train_report report;
    struct model *m = NULL;
    enum status st = check(c);

    if (st != ST_OK)
        return st;
    if (c->nargs > 0)
        st = read_scans(c, &s);
    t.corpus = s.corpus;
    t.face = s.face;
    if (st == ST_OK && (m = malloc(sizeof *m)) == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if (st == ST_OK)
        st = train_model(&t, name != NULL ? name : c->model->name, m, &report, &c->e);
    if (st == ST_OK)
        st = modelfile_write(c->dir, c->force, m, &c->e);
    if (st == ST_OK) {
        if (s.corpus != NULL)
            print_scans(c, &report);
        print_model(c, c->dir, m);
        c->code = report.worse ? EXIT_NO : EXIT_FINE;
    }
    free(m);
    free_scans(&s);
    return st;
}

static const char *read_weight(const char *text, void *value)
{
    static const char wanted[] = "a number from 0 to 1";
    char *end;
    const double x = strtod(text, &end);

    if (end == text || *end != '\0' || !(x >= 0 && x <= 1))
        return wanted;
    *(double *)value = x;
    return NULL;
}

const struct ctl_command ctl_train = {
    .name = "train",
    .args = "[DIR|MANIFEST]",
    .takes = {0, 1},
    .shared = CTL_SCANS | CTL_MODEL | CTL_OUT | CTL_THREADS | CTL_FORCE,
    .options = {CTL_OPTION("name", "TEXT", ctl_option_text, &name,
                           "the model's name (the base model's)"),
                CTL_OPTION("morphable", "DIR", ctl_option_text, &morphable,
                           "a morphable model's OBJ files, as of ICT-FaceKit (the base\n"
                           "model's population)"),
                CTL_OPTION("weight", "W", read_weight, &weight,
                           "of the scans, 0 to 1 (N subjects: N / (N + 200))"),
                CTL_OPTION("calibrate", "FILE", ctl_option_text, &scores,
                           "threshold and rates by the scores.csv of an evaluation (the\n"
                           "base model's)")},
    .exits = {"the model was written",
              "it was, but is worse than the base model on people "
              "that it has not learned from"},
    .run = run,
    .summary = "learn a model from a morphable model and from scans",
    .help =
        "What is learned is one Gaussian model of faces: the mean face, how a face changes\n"
        "between two scans of a person, and how people differ.  It comes from a morphable\n"
        "model or from the base model (--model, or the shipped one), and is adapted to a\n"
        "collection of scans, named as for evaluate: of 20 subjects with two scans or more.\n"
        "Error rates are printed for the base model and for the new one, on the same pairs of\n"
        "people that the new one did not learn from.  The file --out is for --model of other\n"
        "commands and of surfaced.",
    .example = "surfacectl train scans/ --name 'door scanner' --out door.model"};
