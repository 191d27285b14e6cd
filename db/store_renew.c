/* store_renew() of store.h: templates of another engine, stored as this one makes them. */
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "errinfo.h"
#include "mesh.h"
#include "store_engine.h"
#include "store_rules.h"

enum status store_renew(struct store *s, const char *actor, const char *id,
                        struct face_work *w, struct face *f, struct store_template *t,
                        bool *renewed, struct errinfo *e)
{
    struct store_act by;
    unsigned char *model;
    size_t len;
    enum status st;

    *renewed = false;
    if ((st = store_rules_act(&by, actor, e)) != ST_OK ||
        (st = store_template_load(s, id, t, w, f, e)) != ST_OK || !store_stale(s, t))
        return st;
    (void)snprintf(t->engine, sizeof t->engine, "%s", s->made_by);
    t->triangles = mesh_real(&f->surface.mesh);
    t->quality = f->quality;
    len = codec_size(&f->surface.mesh);
    if ((model = malloc(len)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    codec_encode(f, model);
    st = s->engine->template_renew(s, &by, t, model, len, renewed, e);
    sodium_memzero(model, len);
    free(model);
    return st;
}

enum status store_renew_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                            struct errinfo *e)
{
    return s->engine->template_stale(s, s->made_by, out, n, e);
}

enum status store_renew_count(struct store *s, uint64_t *n, struct errinfo *e)
{
    size_t count = 0;
    const enum status st = s->engine->template_stale(s, s->made_by, NULL, &count, e);

    *n = count;
    return st;
}
