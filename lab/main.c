/* surfacelab -- what researchers do with scans, off the daemon's path: models are learned, error
 * rates measured, comparisons drawn, the papers' studies recomputed. */
#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudunit.h"
#include "lab.h"
#include "model.h"
#include "modelfile.h"
#include "nodump.h"

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
     "rates.csv and, if wanted, matrix.csv; with several collections a folder for each, and\n"
     "sets.csv.  scripts/plot_evaluation draws them."},
    {TRAIN, "train", "[DIR|MANIFEST]", 0, 1, lab_train,
     "learn a model from a morphable model and from scans",
     "The model comes from a morphable model or from the base model (--model, or the shipped\n"
     "one), and is adapted to a collection of scans, named as for evaluate: of 20 subjects\n"
     "with two scans or more.  Before and after are both cross-validated.  A model that is\n"
     "worse than the base model is written only with --force (exit code 1)."},
    {EXPLAIN, "explain", "A B", 2, 2, lab_explain,
     "compare two scans and write where they differ",
     "B is moved onto A.  The folder --out (./explanation) gets explain.json, points.csv (the\n"
     "gap and its part of the score at each point of B) and cells.csv (the gap and the part\n"
     "of each cell).  scripts/plot_explanation draws them."},
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
     "A hole is filled with points as dense as those round it, on the triangles that bridge\n"
     "it.  The scan's points as they are, and the restored ones, marked by the property\n"
     "\"restored\", are written to --out (PLY; -: standard output).  Do not enroll a filled\n"
     "scan: restored points would be taken for measured ones."},
    {STUDY, "study", "NAME", 0, 1, lab_study,
     "recompute tables and figures of the papers",
     "The numbers are written as CSV into the folder --out (the current one).  Without NAME\n"
     "the studies are listed.  scripts/studies runs them and draws the figures."},
};
#define COMMANDS (sizeof command / sizeof *command)

/* ---- values: each reader returns NULL, or what the option takes */

static const char *read_flag(const char *text, void *value)
{
    (void)text;
    *(bool *)value = true;
    return NULL;
}

static const char *read_text(const char *text, void *value)
{
    *(const char **)value = text;
    return NULL;
}

static const char *read_units(const char *text, void *value)
{
    return cloudunit_or_auto(text, value) ? NULL : "auto, " CLOUDUNIT_NAMES;
}

static const char *read_axes(const char *text, void *value)
{
    const bool scanner = strcmp(text, "scanner") == 0;

    *(enum scan_axes *)value = scanner ? SCAN_AXES_SCANNER : SCAN_AXES_AUTO;
    return scanner || strcmp(text, "auto") == 0 ? NULL : "auto or scanner";
}

static const char *read_camera(const char *text, void *value)
{
    return clouddepth_camera_read(text, value)
               ? NULL
               : "FX,FY,CX,CY[,SCALE[,WIDTH,HEIGHT]], pixels";
}

/* A number from low to high, and nothing behind it. */
static bool read_number(const char *text, double low, double high, double *to)
{
    char *end;

    *to = strtod(text, &end);
    return end != text && *end == '\0' && *to >= low && *to <= high;
}

static const char *read_score(const char *text, void *value)
{
    return read_number(text, -9999.99, 9999.99, value)
               ? NULL
               : "a score between -10000 and 10000";
}

static const char *read_weight(const char *text, void *value)
{
    return read_number(text, 0, 1, value) ? NULL : "a number from 0 to 1";
}

static const char *read_mm(const char *text, void *value)
{
    return read_number(text, 1e-9, 999, value) ? NULL : "millimetres above 0";
}

static const char *read_count(const char *text, void *value)
{
    double x;

    if (!read_number(text, 1, 1e6, &x) || x != floor(x))
        return "1 to 1000000";
    *(uint32_t *)value = (uint32_t)x;
    return NULL;
}

static const char *read_seed(const char *text, void *value)
{
    char *end;

    *(uint64_t *)value = strtoull(text, &end, 10);
    return *text >= '0' && *text <= '9' && *end == '\0' ? NULL : "a whole number";
}

#define AT(field) offsetof(struct lab, field)

static const struct taken {
    const char *name, *arg; /* arg NULL: a flag */
    const char *(*read)(const char *text, void *value);
    size_t at;
    unsigned of; /* commands */
    const char *help;
} option[] = {
    {"out", "DIR|FILE", read_text, AT(out), ALL & ~ASYMMETRY,
     "the folder or the file that is written"},
    {"force", NULL, read_flag, AT(force), ALL & ~ASYMMETRY,
     "replace files that exist; write a worse model"},
    {"model", "FILE", read_text, AT(model_path), SCANS,
     "a model that train wrote; or set SURFACED_MODEL"},
    {"units", "auto|mm|cm|m|in|um", read_units, AT(unit_mm), SCANS,
     "the unit of the scans' coordinates; what a file says wins"},
    {"axes", "auto|scanner", read_axes, AT(axes), SCANS & ~FILL,
     "scanner: x to the image's right, y up, z towards the scanner,\n"
     "and all of it face; auto: the face is found"},
    {"camera", "FX,FY,CX,CY", read_camera, AT(camera), SCANS,
     "of depth images: focal length and centre in pixels"},
    {"threads", "N", read_count, AT(threads), EVALUATE | TRAIN,
     "compute on N threads (one a core)"},
    {"threshold", "SCORE", read_score, AT(threshold), EVALUATE,
     "decide by this threshold (the model's)"},
    {"pairs", "FILE", read_text, AT(pairs), EVALUATE,
     "compare the pairs in this list instead of DIR: a template and\n"
     "a probe a line, and perhaps a label (mated or non-mated)"},
    {"enroll-kind", "KIND", read_text, AT(enroll_kind), EVALUATE,
     "enroll each subject's first scan of this kind (enroll, or else\n"
     "the first scan)"},
    {"non-mated", "N", read_count, AT(non_mated), EVALUATE,
     "compare each probe with N other subjects (all, up to 200,000\n"
     "comparisons)"},
    {"minimal", NULL, read_flag, AT(minimal), EVALUATE,
     "measure the minimal disparity of each comparison too"},
    {"regions", NULL, read_flag, AT(regions), EVALUATE,
     "give each region's part of each score too"},
    {"matrix", NULL, read_flag, AT(matrix), EVALUATE,
     "compare every template with every probe, and write the scores\n"
     "as a matrix"},
    {"name", "TEXT", read_text, AT(name), TRAIN, "the model's name (the base model's)"},
    {"morphable", "DIR", read_text, AT(morphable), TRAIN,
     "a morphable model's OBJ files (the base model's population)"},
    {"weight", "W", read_weight, AT(weight), TRAIN,
     "of the scans, 0 to 1 (N subjects: N / (N + 200))"},
    {"calibrate", "FILE", read_text, AT(calibrate), TRAIN,
     "threshold and rates by the scores.csv of an evaluation"},
    {"tolerance", "MM", read_mm, AT(tolerance_mm), SIMPLIFY,
     "the largest gap that may open; required"},
    {"mean", NULL, read_flag, AT(mean), SIMPLIFY,
     "the tolerance is for the mean gap over the area"},
    {"seed", "N", read_seed, AT(seed), STUDY, "of everything random (20261121)"},
    {"reduced", NULL, read_flag, AT(reduced), STUDY, "small sizes and few draws"},
    {"faces", "DIR", read_text, AT(faces), STUDY,
     "scans, SUBJECT_enroll.ply and SUBJECT_p1.ply to p4.ply, for\n"
     "several and minimal"},
    {"json", NULL, read_flag, AT(json), SCANS & ~EXPLAIN, "print the result as JSON"},
    {"help", NULL, read_flag, AT(help), ALL, "print this text"},
    {"version", NULL, read_flag, AT(version), ALL, "print the version"},
};
#define OPTIONS ((int)(sizeof option / sizeof *option))

/* ---- help */

static void print_lines(const char *text, int indent)
{
    for (size_t n; (n = strcspn(text, "\n")), text[n] != '\0'; text += n + 1)
        (void)printf("%.*s\n%*s", (int)n, text, indent, "");
    (void)printf("%s\n", text);
}

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
    for (int i = 0; i < OPTIONS; i++) {
        char name[48];

        if ((option[i].of & k->bit) == 0)
            continue;
        (void)snprintf(name, sizeof name, "%s--%s %s", i == 0 ? "-o, " : "",
                       option[i].name, option[i].arg != NULL ? option[i].arg : "");
        (void)printf(strlen(name) > 20 ? "  %s\n%23s" : "  %-20s %s", name, "");
        print_lines(option[i].help, 23);
    }
    (void)printf("\nExit codes: 0 done, 1 and 2 as surfacelab(1) says, 64 and above an "
                 "error.\n");
}

/* ---- the command line */

/* Reads the options; a value is read into *c, which also a wrong one may change.  given: bits of
 * the options. */
static bool read_options(int argc, char **argv, struct lab *c, uint64_t *given)
{
    struct option list[OPTIONS + 1] = {{0}};
    int got;

    for (int i = 0; i < OPTIONS; i++)
        list[i] = (struct option){option[i].name,
                                  option[i].arg != NULL ? required_argument : no_argument,
                                  NULL, 256 + i};
    opterr = 0;
    while ((got = getopt_long(argc, argv, ":ho:", list, NULL)) != -1) {
        const char *wanted;
        int i;

        if (got == '?' || got == ':')
            return lab_usage(c, "%s %.80s (surfacelab --help)",
                             got == ':' ? "a value is missing after"
                                        : "there is no option",
                             argv[optind - 1]) == ST_OK;
        for (i = got - 256; i < 0 || i >= OPTIONS;)
            i = got == 'o' ? 0 : OPTIONS - 2; /* --out, --help */
        if ((*given >> i & 1) != 0)
            return lab_usage(c, "--%s is given twice", option[i].name) == ST_OK;
        *given |= UINT64_C(1) << i;
        if ((wanted = option[i].read(optarg, (char *)c + option[i].at)) != NULL)
            return lab_usage(c, "--%s takes %s, not '%.80s'", option[i].name, wanted,
                             optarg) == ST_OK;
    }
    return true;
}

static bool read_line(int argc, char **argv, struct lab *c, const struct command **k)
{
    uint64_t given = 0;

    *k = NULL;
    if (!read_options(argc, argv, c, &given))
        return false;
    for (size_t i = 0; optind < argc && i < COMMANDS; i++)
        if (strcmp(command[i].name, argv[optind]) == 0)
            *k = &command[i];
    if (*k == NULL && optind < argc)
        return lab_usage(c, "there is no command %.80s (surfacelab --help)",
                         argv[optind]) == ST_OK;
    if (c->help || c->version)
        return true;
    if (*k == NULL)
        return lab_usage(c, "a command is missing (surfacelab --help)") == ST_OK;
    for (int i = 0; i < OPTIONS; i++)
        if ((given >> i & 1) != 0 && (option[i].of & (*k)->bit) == 0)
            return lab_usage(c, "%s does not take --%s (surfacelab %s --help)",
                             (*k)->name, option[i].name, (*k)->name) == ST_OK;
    c->command = (*k)->name;
    c->args = argv + optind + 1;
    c->nargs = argc - optind - 1;
    return (c->nargs >= (*k)->least && c->nargs <= (*k)->most) ||
           lab_usage(c, "usage: surfacelab %s %s [OPTION...]", (*k)->name, (*k)->args) ==
               ST_OK;
}

/* ---- running */

static int exit_code(const struct lab *c, enum status st)
{
    static const int code[ST_COUNT] = {
        [ST_ENOMEM] = LAB_OSERR,   [ST_ENOTFOUND] = LAB_NOINPUT,
        [ST_EDENIED] = LAB_NOPERM, [ST_EIO] = LAB_IOERR,
        [ST_EBUSY] = LAB_IOERR,    [ST_EINTERNAL] = LAB_SOFTWARE};

    return st == ST_OK || c->code == LAB_USAGE ? c->code
           : code[st] != 0                     ? code[st]
                                               : LAB_DATA;
}

static enum status run(struct lab *c, const struct command *k)
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
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if (st == ST_OK && c->json && (c->report = json_new()) == NULL)
        st = errinfo_set(&c->e, ST_ENOMEM, "out of memory");
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
    const struct command *k;
    char *text;
    int code = LAB_USAGE;

    nodump_begin();
    if (read_line(argc, argv, &c, &k)) {
        if (c.version)
            (void)printf("surfacelab (%s)\n", SURFACE_ENGINE);
        else if (c.help)
            print_help(k);
        code = c.version || c.help ? LAB_FINE : exit_code(&c, run(&c, k));
    }
    if (code > LAB_INCONCLUSIVE) {
        (void)fflush(stdout);
        (void)fprintf(stderr, "surfacelab: %s\n", c.e.msg);
        json_discard(c.report);
    } else if (c.report != NULL) {
        text = json_pretty(c.report);
        if (text == NULL || puts(text) < 0)
            code = LAB_IOERR;
        free(text);
    }
    if (fflush(stdout) != 0) {
        (void)fprintf(stderr, "surfacelab: the output cannot be written\n");
        code = code > LAB_INCONCLUSIVE ? code : LAB_IOERR;
    }
    return code;
}
