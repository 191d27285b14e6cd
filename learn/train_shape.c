#include "train_shape.h"

#include <math.h>
#include <stdlib.h>

#include "corpus.h"
#include "errinfo.h"
#include "face.h"
#include "learn.h"
#include "model.h"
#include "train_mean.h"
#include "train_set.h"

/* mm about the mean face, where a height is cut off: of 600 scans 1 cell in 6,000 is. */
#define MOST 25.0

enum status train_shape(const struct train_set *set, struct model *m, struct errinfo *e)
{
    const uint32_t nscan = set->corpus->nscan;
    float *about = malloc((size_t)nscan * GRID_N * sizeof *about);
    enum status st = ST_ENOMEM;
    size_t n = 0;

    if (about != NULL) {
        for (uint32_t i = 0; i < nscan; i++) {
            const struct face *f = &set->face[i];
            float *z = about + n * GRID_N;

            if (f->surface.mesh.nv == 0)
                continue;
            train_mean_map(&f->surface, &f->frame.pose, z);
            for (uint32_t c = 0; c < GRID_N; c++)
                z[c] -= m->mean[c]; /* NAN off either */
            n++;
        }
        st = learn_modes(about, n, TRAIN_SHAPE_MODES, MOST, &m->shape);
    }
    free(about);
    return st == ST_OK ? ST_OK
                       : errinfo_set(e, st, "the basis of shape: %s", status_message(st));
}
