/* surfacelab -- what researchers do with scans, off the daemon's path: models are learned, error
 * rates measured, comparisons drawn, the papers' studies recomputed. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "command.h"
#include "json.h"
#include "lab.h"
#include "model.h"
#include "modelfile.h"
#include "nodump.h"
#include "outfile.h"

enum { /* a bit for each command */
       ASYMMETRY = 1,
       EVALUATE = 2,
       EXPLAIN = 4,
       FILL = 8,
       SIMPLIFY = 16,
       STUDY = 32,
       TRAIN = 64,
       ALL = 127,
       SCANS = ALL & ~STUDY, /* commands that read scans */
};

static const struct command {
    unsigned bit;
    const char *name, *args;
    int least, most; /* arguments */
    enum status (*run)(struct lab *c);
    const char *summary, *help;
} command[] = {
    {EVALUATE, "evaluate", "DIR|MANIFEST...", 0, INT_MAX, lab_evaluate,
     "measure error rates on collections of scans",
     "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table, with\n"
     "the columns file and subject.  One scan of each subject is enrolled in memory and\n"
     "compared with the subject's other scans and with other subjects'.  The folder --out\n"
     "(./evaluation) gets report.json, scores.csv (each comparison and each refusal),\n"
     "rates.csv, det.csv and, if wanted, matrix.csv; with several collections a folder for\n"
     "each, and sets.csv.  scripts/plot_evaluation draws them."},
    {TRAIN, "train", "[DIR|MANIFEST]", 0, 1, lab_train,
     "adapt a model to scans, or calibrate it",
     "The base model (--model, or the shipped one) is adapted to a collection of scans, named\n"
     "as for evaluate: of 20 subjects with two scans or more.  The error rates of the new model\n"
     "are cross-validated.  A model that is worse than the base model is written only with\n"
     "--force (exit code 1)."},
    {EXPLAIN, "explain", "A B", 2, 2, lab_explain,
     "compare two scans and write where they differ",
     "B is moved onto A.  The folder --out (./explanation) gets explain.html (for a\n"
     "browser: both faces, and what decided), explain.json, points.csv (the gap and its part of\n"
     "the score at each point of B) and cells.csv (the gap and the part of each cell)."},
    {ASYMMETRY, "asymmetry", "FILE", 1, 1, lab_asymmetry,
     "measure a scan against its own mirror image",
     "The symmetry plane is corrected until the gap between the face and its mirror image is\n"
     "least; that gap is the asymmetry."},
    {SIMPLIFY, "simplify", "FILE", 1, 1, lab_simplify,
     "keep the points that a scan's surface needs",
     "Points are removed one by one, the least needed first, as long as the surface of the\n"
     "others stays within --tolerance of the scan's at each of its points.  The others are\n"
     "written with their triangles to --out (PLY; -: standard output).  Spikes are flattened\n"
     "first."},
    {FILL, "fill", "FILE", 1, 1, lab_fill,
     "restore the points that are missing in a scan's holes",
     "A hole is filled with points as dense as those around it, on the triangles that bridge\n"
     "it.  The scan's own points and the restored ones, marked by the property\n"
     "\"restored\", are written to --out (PLY; -: standard output).  Do not enroll a filled\n"
     "scan: restored points would count as measured ones."},
    {STUDY, "study", "NAME", 0, 1, lab_study,
     "recompute tables and figures of the papers",
     "The numbers are written as CSV into the folder --out (the current one).  Without NAME\n"
     "the studies are listed.  scripts/studies runs them and draws the figures."},
};
#define COMMANDS (sizeof command / sizeof *command)

/* ---- options */

static const char *read_weight(const char *text, void *value)
{
    return command_number(text, 0, 1, value) ? NULL : "a number from 0 to 1";
}

static const char *read_mm(const char *text, void *value)
{
    return command_number(text, 1e-9, 999, value) ? NULL : "millimetres above 0";
}

static const char *read_seed(const char *text, void *value)
{
    char *end;

    *(uint64_t *)value = strtoull(text, &end, 10);
    return *text >= '0' && *text <= '9' && *end == '\0' ? NULL : "a whole number";
}

#define IN(field) .at = offsetof(struct lab, field)

static const struct taken {
    unsigned of; /* commands */
    struct command_option o;
} option[] = {
    {ALL & ~ASYMMETRY,
     {"out", "DIR|FILE", command_text, NULL, "the folder or the file that is written",
      IN(out), .letter = 'o'}},
    {ALL & ~ASYMMETRY,
     {"force", NULL, command_flag, NULL, "replace files that exist; write a worse model",
      IN(force)}},
    {SCANS,
     {"model", "FILE", command_text, NULL,
      "a model that train wrote; or set SURFACED_MODEL", IN(model_path)}},
    {SCANS,
     {"units", "auto|mm|cm|m|in|um", cloudfile_option_units, NULL,
      "the unit of the scans' coordinates; a unit stated in the file\n"
      "takes precedence",
      IN(unit_mm)}},
    {SCANS & ~FILL,
     {"axes", "auto|scanner", cloudfile_option_axes, NULL,
      "auto: the face is found, in any orientation; scanner: x to the\n"
      "image's right, y up, z towards the scanner, nothing but the face",
      IN(frontal)}},
    {SCANS,
     {"camera", "FX,FY,CX,CY", cloudfile_option_camera, NULL,
      "of depth images: focal length and centre in pixels", IN(camera)}},
    {EVALUATE | TRAIN,
     {"threads", "N", command_whole, NULL, "compute on N threads (one per core)",
      IN(threads)}},
    {EVALUATE,
     {"threshold", "SCORE", command_score, NULL, "decide by this threshold (the model's)",
      IN(threshold)}},
    {EVALUATE,
     {"pairs", "FILE", command_text, NULL,
      "compare the pairs in this list instead of DIR: a template and\n"
      "a probe a line, and perhaps a label (mated or non-mated)",
      IN(pairs)}},
    {EVALUATE,
     {"scores", "FILE", command_text, NULL,
      "judge other methods' scores of the same comparisons too: a table\n"
      "with template, probe, score or distance, and perhaps method",
      IN(scores)}},
    {EVALUATE,
     {"enroll-kind", "KIND", command_text, NULL,
      "enroll each subject's first scan of this kind (enroll, or else\n"
      "the first scan)",
      IN(enroll_kind)}},
    {EVALUATE,
     {"non-mated", "N", command_whole, NULL,
      "compare each probe with N other subjects (all, up to 200,000\n"
      "comparisons)",
      IN(non_mated)}},
    {EVALUATE,
     {"burst", "N", command_whole, NULL,
      "fuse up to N frames of a session: scans whose names differ in\n"
      "what is behind the last '-' (alice_smile-1.ply, ...-2.ply)",
      IN(burst)}},
    {EVALUATE,
     {"minimal", NULL, command_flag, NULL,
      "measure the minimal disparity of each comparison too", IN(minimal)}},
    {EVALUATE,
     {"regions", NULL, command_flag, NULL, "give each region's part of each score too",
      IN(regions)}},
    {EVALUATE,
     {"matrix", NULL, command_flag, NULL,
      "compare every template with every probe, and write the scores\n"
      "as a matrix",
      IN(matrix)}},
    {TRAIN,
     {"name", "TEXT", command_text, NULL, "the model's name (the base model's)",
      IN(name)}},
    {TRAIN,
     {"weight", "W", read_weight, NULL,
      "of the scans, 0 to 1 (N subjects: N / (N + 200))", IN(weight)}},
    {TRAIN,
     {"calibrate", "FILE", command_text, NULL,
      "threshold and rates by the scores.csv of an evaluation", IN(calibrate)}},
    {SIMPLIFY,
     {"tolerance", "MM", read_mm, NULL, "the largest gap that may open; required",
      IN(tolerance_mm)}},
    {SIMPLIFY,
     {"mean", NULL, command_flag, NULL, "the tolerance is for the mean gap over the area",
      IN(mean)}},
    {STUDY, {"seed", "N", read_seed, NULL, "of everything random (20261121)", IN(seed)}},
    {STUDY,
     {"reduced", NULL, command_flag, NULL, "small sizes and few draws", IN(reduced)}},
    {SCANS & ~EXPLAIN,
     {"json", NULL, command_flag, NULL, "print the result as JSON", IN(json)}},
    {ALL, {"help", NULL, command_flag, NULL, "print this text", IN(help), .letter = 'h'}},
    {ALL, {"version", NULL, command_flag, NULL, "print the version", IN(version)}},
};
#define OPTIONS (sizeof option / sizeof *option)

static void print_help(const struct command *k)
{
    if (k == NULL) {
        (void)printf("Usage: surfacelab COMMAND [ARGUMENT...]\n\n"
                     "Commands (surfacelab COMMAND --help says more):\n");
        for (size_t i = 0; i < COMMANDS; i++)
            (void)printf("  %-10s %s\n", command[i].name, command[i].summary);
        return;
    }
    (void)printf("Usage: surfacelab %s %s [OPTION...]\n\n%s\n\nOptions:\n", k->name,
                 k->args, k->help);
    for (size_t i = 0; i < OPTIONS; i++)
        if ((option[i].of & k->bit) != 0)
            command_print_option(&option[i].o);
    (void)printf("\nExit codes: 0 done, 1 and 2 as surfacelab(1) says, 64 and above an "
                 "error.\n");
}

/* ---- the command line */

static enum status find_command(struct lab *c, const char *word, const struct command **k)
{
    for (size_t i = 0; i < COMMANDS; i++) {
        if (strcmp(command[i].name, word) == 0) {
            *k = &command[i];
            return ST_OK;
        }
    }
    return lab_usage(c, "there is no command %.80s (surfacelab --help)", word);
}

/* Values are read into *c, which also a wrong one may change. */
static bool lab_read_values(const struct command_line *typed, struct lab *c,
                            const struct command *k)
{
    for (int i = 0; i < typed->noption; i++) {
        const struct command_option *o = &option[i].o;

        if (typed->given[i] &&
            !command_line_take(
                typed, i, (option[i].of & (k != NULL ? k->bit : ALL)) != 0 ? o : NULL,
                k != NULL ? k->name : "", c, &c->e))
            return false;
    }
    return true;
}

static bool lab_read_line(int argc, char **argv, struct command_line *typed,
                          struct lab *c, const struct command **k)
{
    for (size_t i = 0; i < OPTIONS; i++)
        command_line_add(typed, &option[i].o);
    if (!command_line_read(typed, argc, argv, &c->e) ||
        (optind < argc && find_command(c, argv[optind], k) != ST_OK) ||
        !lab_read_values(typed, c, *k))
        return false;
    if (c->help || c->version)
        return true;
    if (*k == NULL)
        return lab_usage(c, "a command is missing (surfacelab --help)") == ST_OK;
    c->command = (*k)->name;
    c->args = argv + optind + 1;
    c->nargs = argc - optind - 1;
    return (c->nargs >= (*k)->least && c->nargs <= (*k)->most) ||
           lab_usage(c, "usage: surfacelab %s %s [OPTION...]", (*k)->name, (*k)->args) ==
               ST_OK;
}

/* ---- running */

static enum status lab_run(struct lab *c, const struct command *k)
{
    const char *path = getenv("SURFACED_MODEL");
    struct surface_model *model = NULL;
    enum status st = ST_OK;

    if (c->model_path == NULL && path != NULL && path[0] != '\0' && (k->bit & SCANS) != 0)
        c->model_path = path;
    if (c->model_path != NULL)
        st = modelfile_read(c->model_path, &model, &c->e);
    c->model = model != NULL ? model : &model_default;
    if (st == ST_OK && (c->work = surface_work_new(c->model)) == NULL)
        st = errinfo_memory(&c->e);
    if (st == ST_OK && c->json && (c->report = json_new()) == NULL)
        st = errinfo_memory(&c->e);
    if (st == ST_OK) {
        surface_engine(c->model, c->engine);
        st = k->run(c);
    }
    surface_work_free(c->work);
    surface_model_free(model);
    return st;
}

int main(int argc, char **argv)
{
    struct lab c = {.threshold = (double)NAN, .weight = -1, .seed = 20261121};
    struct command_line typed = {.program = "surfacelab"};
    const struct command *k = NULL;
    enum status st = ST_EINVAL;
    int code = EXIT_USAGE;

    nodump_begin();
    outfile_wait();
    if (lab_read_line(argc, argv, &typed, &c, &k)) {
        if (c.version)
            (void)printf("surfacelab (%s)\n", SURFACE_ENGINE);
        else if (c.help)
            print_help(k);
        st = c.version || c.help ? ST_OK : lab_run(&c, k);
        code = st == ST_OK || c.code == EXIT_USAGE ? c.code : command_exit(st);
    }
    if (code > EXIT_INCONCLUSIVE && command_line_given(&typed, "json")) {
        json_discard(c.report);
        c.report = json_new(); /* the error alone; of a wrong command line too */
    }
    return command_end("surfacelab", c.report, code == EXIT_USAGE, &c.e, code);
}
