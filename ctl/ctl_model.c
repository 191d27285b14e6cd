/* The model that a command judges by, and the database opened for it. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "in_force.h"
#include "model.h"
#include "modelfile.h"
#include "ctl_command.h"
#include "ctl_key.h"
#include "ctl_model.h"

enum status ctl_model_read(struct ctl *c, struct model **owned)
{
    const char *path = c->model_path;
    enum status st = ST_OK;

    *owned = NULL;
    if (path != NULL)
        st = modelfile_read(path, owned, &c->e);
    c->model = *owned != NULL ? *owned : &model_default;
    if (st == ST_OK)
        face_engine(c->model, c->engine);
    return st;
}

enum status ctl_model_open(struct ctl *c, enum store_mode mode)
{
    struct store_calibration k;
    struct store_key key;
    enum status st = ctl_key(c, c->db, &key);

    if (st != ST_OK || (st = store_open(c->db, mode, &key, &c->store, &c->e)) != ST_OK)
        return st;
    store_use_model(c->store, c->model);
    if ((c->cmd->shared & CTL_MODEL) != 0 && in_force_get(c->store, &k, NULL) == ST_OK &&
        k.ignored)
        (void)fprintf(stderr,
                      "surfacectl: calibration %" PRId64
                      " is not used: it was made by %s, "
                      "and this is %s; the model's own decides\n",
                      k.version, k.engine, c->engine);
    return ST_OK;
}
