/* ctl_model.h -- the model that a command judges by, and the database opened for it. */
#ifndef CTL_MODEL_H
#define CTL_MODEL_H
#include "store.h"

struct ctl;   /* ctl.h */
struct model; /* model.h */

/* ctl_model_read(c, owned): set c->model and c->engine by c->model_path; *owned is for the
 * caller to free() when c is done.  c->e is filled on failure.
 * ctl_model_open(c, mode): open the database as c->store, for that model; says on standard
 * error where its calibration is not used with it. */
enum status ctl_model_read(struct ctl *c, struct model **owned);
enum status ctl_model_open(struct ctl *c, enum store_mode mode);

#endif
