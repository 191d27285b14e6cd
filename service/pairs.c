#include "pairs.h"

#include <math.h>

#include "json.h"
#include "sample.h"

static enum status compare(struct pairs *p, const atomic_bool *stop, struct errinfo *e)
{
    struct templates *t = &p->templates;
    enum status st = ST_OK;

    for (uint32_t a = 0; a < t->of.n; a++)
        for (uint32_t b = a + 1; b < t->of.n && st == ST_OK; b++) {
            struct pairs_one *one = &p->one[p->n];

            if (t->face[a] == NULL || t->face[b] == NULL)
                continue;
            *one = (struct pairs_one){.a = a, .b = b};
            if ((st = sample_not_stopped(stop, e)) == ST_OK)
                st = templates_pair(t, a, b, &one->result, e);
            p->n++;
        }
    return st;
}

static void judge(struct pairs *p)
{
    uint32_t against[STORE_TEMPLATES_MAX] = {0};

    for (uint32_t i = 0; i < p->n; i++) {
        const struct pairs_one *one = &p->one[i];
        uint32_t *count = one->result.decision == SURFACE_MATCH      ? p->matches
                          : one->result.decision == SURFACE_NO_MATCH ? against
                                                                     : NULL;

        if (count != NULL) {
            count[one->a]++;
            count[one->b]++;
        }
    }
    for (size_t i = 0; i < p->templates.of.n; i++)
        p->fit[i] = p->matches[i] + against[i] == 0 ? PAIRS_UNKNOWN
                    : p->matches[i] < against[i]    ? PAIRS_MISFIT
                                                    : PAIRS_FITS;
}

enum status pairs_run(struct templates_context *c, const char *subject, const char *token,
                      const atomic_bool *stop, struct pairs *out, struct errinfo *e)
{
    const struct templates_of of = {
        .subject = subject, .token = token, .regardless = true};
    enum status st;

    *out = (struct pairs){.n = 0};
    st = templates_read(c, &of, &out->templates, e);
    if (st == ST_OK)
        st = compare(out, stop, e);
    if (st == ST_OK)
        judge(out);
    return st;
}

void pairs_free(struct pairs *p)
{
    templates_free(&p->templates);
}

/* ---- as JSON */

static void describe_one(struct json *j, const struct pairs *p, size_t i)
{
    const struct store_template *t = &p->templates.of.t[i];

    json_object(j, NULL);
    json_text(j, "template_id", t->id);
    json_text(j, "label", t->label);
    json_text(j, "created", t->created);
    json_flag(j, "compared", p->templates.face[i] != NULL);
    json_number(j, "matches", p->matches[i]);
    if (p->fit[i] == PAIRS_UNKNOWN)
        json_text(j, "fits", NULL);
    else
        json_flag(j, "fits", p->fit[i] == PAIRS_FITS);
    json_close(j);
}

void pairs_describe(struct json *j, const struct pairs *p, bool scores,
                    const char *engine)
{
    const struct store_snapshot *of = &p->templates.of;

    json_text(j, "subject", of->subject.id);
    json_score(j, "threshold",
               surface_work_calibration(p->templates.context->work)->threshold);
    json_array(j, "templates");
    for (size_t i = 0; i < of->n; i++)
        describe_one(j, p, i);
    json_close(j);
    json_array(j, "pairs");
    for (uint32_t i = 0; i < p->n; i++) {
        const struct pairs_one *one = &p->one[i];

        json_object(j, NULL);
        json_text(j, "a", of->t[one->a].id);
        json_text(j, "b", of->t[one->b].id);
        json_text(j, "decision", templates_decision(one->result.decision));
        json_score(j, "score", scores ? one->result.score : (double)NAN);
        json_close(j);
    }
    json_close(j);
    json_text(j, "engine", engine);
}
