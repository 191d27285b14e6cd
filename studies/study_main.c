/* study -- one study of the papers: its numbers as CSV into a folder. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lab.h"
#include "study.h"

#define SEED 20261121

static const struct {
    const char *name, *what;
    void (*run)(const struct lab *lab);
} study[] = {
    {"method", "disparity: walks, trees, interpolation, sign cases (figures 1-9)",
     method_run},
    {"cost", "disparity: tables 1-4, growth to a million points, a stored template",
     cost_run},
    {"approx", "disparity: the general triangulation against the exact volume",
     approx_run},
    {"removal", "missing points: which removals hurt, holes left out or not",
     removal_run},
    {"cover", "missing points: faces with parts missing, and verification", cover_run},
    {"filled", "missing points: restored points, by the size of the hole", filled_run},
    {"faces", "disparity: two faces before and after alignment; the weight", faces_run},
    {"mirror", "disparity: asymmetry, planted and found", mirror_run},
    {"scans", "scans as scanners deliver them: heads, half profiles, covered faces",
     scans_run},
    {"several", "several templates: how often the best of n errs", several_run},
    {"minimal", "disparity: the minimal disparity against brute force", minimal_run},
    {"climb", "hill climbing: how like a face scores alone make a scan", climb_run},
    {"bound", "disparity: a sound lower bound of the minimum", bound_run},
    {"fewer", "disparity: simplified surfaces and templates", fewer_run},
    {"missing", "missing points: 36 points, six functions, removal and error",
     missing_run},
};
#define STUDIES (sizeof study / sizeof study[0])

static int usage(FILE *to)
{
    fprintf(
        to,
        "usage: study NAME [--seed N] [--reduced] [--faces DIR] [--raw DIR] [--out DIR]\n"
        "Run one study and write its numbers as CSV into DIR (the folder where "
        "one is).\n");
    for (size_t i = 0; i < STUDIES; i++)
        fprintf(to, "  %-14s %s\n", study[i].name, study[i].what);
    fprintf(
        to,
        "--seed     of everything random (%d)\n"
        "--reduced  few draws and small sizes: seconds instead of minutes\n"
        "--faces    a folder of scans, SUBJECT_enroll.ply and SUBJECT_p1.ply to p4.ply, "
        "which cover, fewer, minimal, bound, scans and several use\n"
        "--raw      with it: a folder of the same people's scans as delivered, "
        "SUBJECT_head.ply, bust, round, half, glasses, mask, other (scans)\n"
        "With scripts/studies: pictures and a report besides.\n",
        SEED);
    return to == stdout ? 0 : 64;
}

int main(int argc, char **argv)
{
    struct lab lab = {.dir = ".", .seed = SEED};
    size_t which = STUDIES;

    if (argc > 1 && strcmp(argv[1], "--help") == 0)
        return usage(stdout);
    for (size_t i = 0; argc > 1 && i < STUDIES; i++)
        if (strcmp(argv[1], study[i].name) == 0)
            which = i;
    if (which == STUDIES)
        return usage(stderr);
    for (int i = 2; i < argc; i++) {
        char *end = NULL;

        if (strcmp(argv[i], "--reduced") == 0) {
            lab.reduced = true;
        } else if (strcmp(argv[i], "--out") == 0 && i + 1 < argc) {
            lab.dir = argv[++i];
        } else if (strcmp(argv[i], "--faces") == 0 && i + 1 < argc) {
            lab.faces = argv[++i];
        } else if (strcmp(argv[i], "--raw") == 0 && i + 1 < argc) {
            lab.raw = argv[++i];
        } else if (strcmp(argv[i], "--seed") == 0 && i + 1 < argc) {
            errno = 0;
            lab.seed = strtoull(argv[++i], &end, 10);
            if (errno != 0 || *end != '\0' || end == argv[i] || argv[i][0] == '-')
                return usage(stderr);
        } else {
            return usage(stderr);
        }
    }
    printf("%s: seed %llu%s\n", study[which].name, (unsigned long long)lab.seed,
           lab.reduced ? ", reduced" : "");
    study[which].run(&lab);
    return 0;
}
