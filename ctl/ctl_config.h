/* ctl_config.h -- the database that the daemon's settings name. */
#ifndef CTL_CONFIG_H
#define CTL_CONFIG_H
#include <stdbool.h>
#include "status.h"

struct ctl; /* ctl.h */

/* ctl_config_database(c, model): c->db where it is NULL by SURFACED_DB; where that is not
 * set, or --config is given, by the daemon's configuration, as c->key and, if model,
 * c->model_path then too.  ST_EINVAL: none is named; c->e says why. */
enum status ctl_config_database(struct ctl *c, bool model);

void ctl_config_free(struct ctl *c); /* the settings, to which the paths belong */

#endif
