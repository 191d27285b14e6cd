/* surfacelab study: one study of the papers, its numbers as CSV in a folder. */
#include <stdio.h>
#include <string.h>

#include "lab.h"
#include "study.h"

static const struct {
    const char *name, *what;
    void (*run)(const struct study *study);
} study[] = {
    {"method", "disparity: walks, trees, interpolation, sign cases (figures 1-9)",
     method_run},
    {"cost", "disparity: tables 1-4, a stored template", cost_run},
    {"faces", "disparity: two faces before and after alignment (figures 10-11)",
     faces_run},
    {"missing", "missing points: 36 points, six functions, removal and error",
     missing_run},
};
#define STUDIES (sizeof study / sizeof *study)

enum status lab_study(struct lab *c)
{
    const struct study how = {
        .dir = c->out != NULL ? c->out : ".", .seed = c->seed, .reduced = c->reduced};
    size_t i = 0;

    if (c->nargs == 0) {
        for (i = 0; i < STUDIES; i++)
            (void)printf("%-8s %s\n", study[i].name, study[i].what);
        return ST_OK;
    }
    while (i < STUDIES && strcmp(study[i].name, c->args[0]) != 0)
        i++;
    if (i == STUDIES)
        return lab_usage(c, "there is no study %.40s (surfacelab study lists them)",
                         c->args[0]);
    (void)printf("%s: seed %llu%s\n", study[i].name, (unsigned long long)how.seed,
                 how.reduced ? ", reduced" : "");
    study[i].run(&how);
    return ST_OK;
}
