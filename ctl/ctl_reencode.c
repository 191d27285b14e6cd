/* template reencode: the templates that another engine made, encoded by this one. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pool.h"
#include "ctl_command.h"

enum result { UNDONE, REENCODED, CURRENT, GONE, FAILED, RESULTS };

struct outcome { /* of a template */
    enum result result;
    struct errinfo e; /* FAILED: why */
};

struct batch {
    struct ctl *c;
    char (*id)[STORE_ID_LEN + 1];
    size_t n;
    struct outcome *outcome; /* [n] */
};

/* As store_reencode(), but that nothing is written. */
static enum status try_one(const struct batch *b, const char *id, struct face_work *w,
                           struct face *f, struct store_template *t, bool *done,
                           struct errinfo *e)
{
    const enum status st = store_template_load(b->c->store, id, t, w, f, e);

    *done = st == ST_OK && store_template_outdated(b->c->store, t);
    return st;
}

static enum status do_one(void *arg, size_t i, struct face_work *w, struct errinfo *e)
{
    const struct batch *b = arg;
    struct outcome *o = &b->outcome[i];
    struct store_template t;
    struct face f = {0};
    bool done = false;
    enum status st = b->c->dry_run ? try_one(b, b->id[i], w, &f, &t, &done, &o->e)
                                   : store_reencode(b->c->store, b->c->actor, b->id[i], w,
                                                    &f, &t, &done, &o->e);

    face_free(&f);
    if (st == ST_OK)
        o->result = done ? REENCODED : CURRENT;
    else if (st == ST_ENOTFOUND)
        o->result = GONE;
    else if (st == ST_EVERSION || st == ST_ECORRUPT)
        o->result = FAILED;
    else
        return errinfo_set(e, st, "%s", o->e.msg);
    return ST_OK;
}

/* Those that the command line names: all there, or nothing is done. */
static enum status take_ids(struct batch *b)
{
    struct ctl *c = b->c;
    struct store_template t;
    enum status st = ST_OK;

    b->n = (size_t)c->nargs;
    if ((b->id = calloc(b->n, sizeof *b->id)) == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    for (size_t i = 0; i < b->n && st == ST_OK; i++)
        if ((st = store_template_get(b->c->store, c->args[i], &t, &c->e)) == ST_OK)
            memcpy(b->id[i], t.id, sizeof t.id);
    return st;
}

/* Returns how many failed. */
static size_t report(const struct batch *b)
{
    struct ctl *c = b->c;
    size_t count[RESULTS] = {0};

    json_text(c->out, "engine", c->engine);
    json_array(c->out, "failures");
    for (size_t i = 0; i < b->n; i++) {
        const struct outcome *o = &b->outcome[i];

        count[o->result]++;
        if (o->result != FAILED)
            continue;
        json_object(c->out, NULL);
        json_text(c->out, "template_id", b->id[i]);
        json_text(c->out, "detail", o->e.msg);
        json_close(c->out);
        (void)fprintf(stderr, "surfacectl: %s\n", o->e.msg);
    }
    json_close(c->out);
    json_number(c->out, "templates", (double)b->n);
    json_number(c->out, "reencoded", (double)count[REENCODED]);
    json_number(c->out, "current", (double)count[CURRENT]);
    json_number(c->out, "gone", (double)count[GONE]);
    json_number(c->out, "failed", (double)count[FAILED]);
    json_number(c->out, "undone", (double)count[UNDONE]);
    json_flag(c->out, "dry_run", c->dry_run);
    ctl_say(c, "%" PRIu64 " template%s: %zu %s by %s, %zu current, %zu failed\n",
            CTL_COUNT(b->n), count[REENCODED],
            c->dry_run ? "can be re-encoded" : "re-encoded", c->engine, count[CURRENT],
            count[FAILED]);
    if (count[GONE] > 0)
        ctl_say(c, "%zu were deleted meanwhile\n", count[GONE]);
    if (count[UNDONE] > 0)
        ctl_say(c, "%zu were not tried\n", count[UNDONE]);
    return count[FAILED];
}

static enum status reencode(struct batch *b, size_t *failed)
{
    struct ctl *c = b->c;
    enum status st = c->nargs > 0 ? take_ids(b)
                                  : store_reencode_due(b->c->store, &b->id, &b->n, &c->e);

    if (st != ST_OK)
        return st;
    if ((b->outcome = calloc(b->n + 1, sizeof *b->outcome)) == NULL)
        return errinfo_set(&c->e, ST_ENOMEM, "out of memory");
    if (b->n > 0)
        st = pool_run("re-encoding", c->threads, c->model, b->n, do_one, b, &c->e);
    *failed = report(b);
    return st;
}

static enum status run(struct ctl *c)
{
    struct batch b = {.c = c};
    size_t failed = 0;
    enum status st = reencode(&b, &failed);

    free(b.id);
    free(b.outcome);
    if (st == ST_OK && failed > 0)
        st = errinfo_set(&c->e, ST_EVERSION,
                         "%zu of %" PRIu64 " template%s not re-encoded", failed,
                         CTL_COUNT(b.n));
    return st;
}

const struct ctl_command ctl_reencode = {
    .name = "template reencode",
    .args = "[ID...]",
    .takes = {0, CTL_MANY},
    .database = CTL_WRITES_DATABASE,
    .shared = CTL_MODEL | CTL_THREADS | CTL_DRY_RUN,
    .exits = {"every one of these templates is of this engine"},
    .run = run,
    .summary = "encode templates of another engine again",
    .help =
        "Every template, or each of these, that another engine or model made is computed again\n"
        "from its stored points, by this engine and --model.  It keeps its id, label, time and\n"
        "digest.  Until then whoever loads it does the same, which costs some milliseconds and\n"
        "gives the same decisions.  A running daemon is not disturbed; if this is stopped and\n"
        "started again, it goes on where it was.  A template whose points are no face to this\n"
        "engine stays as it is and is listed: delete it, and enroll another scan.",
    .example = "surfacectl --db faces.db template reencode --dry-run"};
