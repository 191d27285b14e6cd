#include "replay.h"

#include <string.h>

#include "digest.h"
#include "store.h"

/* The codec's digest takes time, and points of another number are no template's. */
enum status replay_look(const struct session *s, const struct surface_face *face,
                        const struct templates *t, size_t index, struct store_probe *out,
                        struct errinfo *e)
{
    *out = (struct store_probe){.read = {NULL}};
    memcpy(out->read, s->digest, s->ndigest * sizeof *out->read);
    if (surface_face_points(face, NULL) == t->of.t[index].points &&
        digest_face(face, out->used) != ST_OK)
        return errinfo_set(e, ST_ENOMEM, "no memory for the probe's digest");
    return ST_OK;
}

bool replay_is(const struct templates *t, const struct store_probe *probe)
{
    for (size_t i = 0; i < t->of.n; i++)
        for (size_t k = 0; probe->read[k] != NULL; k++)
            if (digest_read_has(t->of.t[i].read, probe->read[k]))
                return true;
    return false;
}

enum status replay_refused(struct errinfo *e)
{
    return errinfo_set(
        e, ST_EREPLAYED,
        "the scan was used before: a template of the subject was made from these "
        "points; scan again");
}
