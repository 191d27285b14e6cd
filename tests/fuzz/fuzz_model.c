/* Model texts: an accepted model survives writing and reading, has only finite numbers, and
 * its mean face can be used for alignment or is rejected. */
#define FUZZ_ROUNDS 400 /* texts are long */
#include "fuzz.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "frame.h"
#include "model.h"

static void check_numbers(const struct surface_model *m)
{
    require(m->kinship >= 0 && m->kinship < 1 && m->noise_floor_mm > 0 &&
            m->noise_factor >= 0 && surface_calibration_valid(&m->calibration));
    require(m->change.n <= MODEL_MODES && m->identity.n <= MODEL_MODES &&
            m->shape.n <= MODEL_MODES);
    require(memchr(m->name, '\0', sizeof m->name) != NULL);
    for (uint32_t i = 0; i < GRID_N; i++) {
        require(isnan(m->mean[i]) || fabsf(m->mean[i]) < 1e4f);
        require(m->change.rest[i] >= 0.0f && isfinite(m->change.rest[i]));
        require(m->shape.rest[i] >= 0.0f && isfinite(m->shape.rest[i]));
        for (uint32_t k = 0; k < MODEL_MODES; k++)
            require(isfinite(m->change.mode[i][k]) && isfinite(m->identity.mode[i][k]) &&
                    isfinite(m->shape.mode[i][k]));
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct surface_model model, again;
    struct frame_mean mean;
    uint32_t line = 0;
    const enum status st = model_parse((const char *)data, size, &model, &line);
    size_t len;
    char *text, *second = NULL;

    require(line >= 1);
    if (st != ST_OK) {
        require(st == ST_ECORRUPT || st == ST_EVERSION);
        return 0;
    }
    check_numbers(&model);
    len = surface_model_write(&model, NULL, 0);
    require((text = malloc(len + 1)) != NULL && (second = malloc(len + 1)) != NULL);
    require(surface_model_write(&model, text, len + 1) == len);
    require(model_parse(text, len, &again, NULL) == ST_OK);
    require(surface_model_write(&again, second, len + 1) == len &&
            memcmp(text, second, len) == 0);
    free(text);
    free(second);
    (void)frame_mean_make(&model, &mean);
    return 0;
}
