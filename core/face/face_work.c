#include "face_work.h"

#include <stdio.h>
#include <string.h>

#include "model.h"
#include "model_digest.h"

/* surface_work_wipe() frees blocks of more than these bytes: faces of up to 10,000 points are
 * worked on without allocating again. */
#define FACE_WORK_KEEP ((size_t)4 << 20)

enum surface_status surface_model_parse(const char *text, size_t length,
                                        struct surface_model **out, uint32_t *line)
{
    struct surface_model *m = mem_array(1, sizeof *m);
    const enum status st = m != NULL ? model_parse(text, length, m, line) : ST_ENOMEM;

    if (st != ST_OK)
        mem_free(m);
    *out = st == ST_OK ? m : NULL;
    return status_to(st);
}

void surface_model_free(struct surface_model *model)
{
    mem_free(model);
}

const struct surface_calibration *
surface_model_calibration(const struct surface_model *model)
{
    return model != NULL ? &model->calibration : &model_default.calibration;
}

void surface_engine(const struct surface_model *m, char out[SURFACE_ENGINE_SIZE])
{
    const uint64_t digest = model_digest(m != NULL ? m : &model_default);

    (void)snprintf(out, SURFACE_ENGINE_SIZE, "%s model/%08x", SURFACE_ENGINE,
                   (unsigned)(digest >> 32));
}

int surface_same_engine(const char *a, const char *b)
{
    /* "surfaced/VERSION measure/N model/HHHHHHHH" */
    const char *x = strchr(a, ' '), *y = strchr(b, ' ');

    return x != NULL && y != NULL && strcmp(x, y) == 0;
}

/* How well each place separates people: the variance of identity over that of all. */
static void weigh_places(const struct surface_model *m, float weight[GRID_N])
{
    double sum = 0;
    uint32_t n = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        double identity = 0, change = m->noise_floor_mm * m->noise_floor_mm;

        weight[i] = 0.0f;
        if (!(m->change.rest[i] > 0.0f))
            continue;
        for (uint32_t k = 0; k < m->identity.n; k++)
            identity += (double)m->identity.mode[i][k] * (double)m->identity.mode[i][k];
        for (uint32_t k = 0; k < m->change.n; k++)
            change += (double)m->change.mode[i][k] * (double)m->change.mode[i][k];
        weight[i] = (float)(identity / (identity + change));
        sum += (double)weight[i];
        n++;
    }
    for (uint32_t i = 0; i < GRID_N && sum > 0; i++)
        weight[i] = (float)((double)weight[i] * n / sum);
}

struct surface_work *surface_work_new(const struct surface_model *m)
{
    struct surface_work *w = mem_array(1, sizeof *w);

    if (w == NULL)
        return NULL;
    memset(w, 0, sizeof *w);
    w->model = m != NULL ? m : &model_default;
    w->calibration = w->model->calibration;
    if (frame_mean_make(w->model, &w->mean) != ST_OK) {
        surface_work_free(w);
        return NULL;
    }
    fit_prepare(&w->model->change, &w->change);
    encode_prepare(w->model, &w->encode);
    shape_work_prepare(w->model, &w->shape);
    weigh_places(w->model, w->weight);
    return w;
}

enum surface_status surface_work_calibrate(struct surface_work *w,
                                           const struct surface_calibration *by)
{
    if (by != NULL && !surface_calibration_valid(by))
        return SURFACE_EINVAL;
    w->calibration = by != NULL ? *by : w->model->calibration;
    return SURFACE_OK;
}

const struct surface_calibration *surface_work_calibration(const struct surface_work *w)
{
    return &w->calibration;
}

void surface_work_clock(struct surface_work *w, double (*clock_ms)(void))
{
    w->clock_ms = clock_ms;
}

void surface_work_free(struct surface_work *w)
{
    if (w == NULL)
        return;
    measure_work_free(&w->measure);
    align_work_free(&w->align);
    surface_free(&w->upright);
    scratch_free(&w->normal);
    shape_work_free(&w->shape);
    mem_free(w->search);
    mem_free(w);
}

void surface_work_wipe(struct surface_work *w)
{
    measure_work_wipe(&w->measure, FACE_WORK_KEEP);
    align_work_wipe(&w->align, FACE_WORK_KEEP);
    surface_free(&w->upright);
    scratch_wipe(&w->normal, FACE_WORK_KEEP);
    shape_work_wipe(&w->shape, FACE_WORK_KEEP);
}
