#include "row_check.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "row_calibration.h"
#include "row_device.h"
#include "row_subject.h"
#include "row_template.h"
#include "row_token.h"
#include "store_latest.h"

struct row_check_left { /* by an entry */
    unsigned char object[STORE_CHAIN_OBJECT], mac[VAULT_HASH];
    uint64_t seq;
    bool gone, seen;
};

enum status row_check_add(struct row_check *c, const struct row_entry *r,
                          struct errinfo *e)
{
    struct row_check_left *one;

    if (r->nobject == 0 || memcmp(r->object, row_event_uses, sizeof r->object) == 0 ||
        memcmp(r->object, store_chain_key, sizeof r->object) == 0)
        return ST_OK;
    if (c->n == c->room) {
        const size_t room = c->room != 0 ? 2 * c->room : 1024;
        struct row_check_left *more = realloc(c->left, room * sizeof *more);

        if (more == NULL)
            return errinfo_set(e, ST_ENOMEM, "out of memory");
        c->left = more;
        c->room = room;
    }
    one = &c->left[c->n++];
    memcpy(one->object, r->object, sizeof one->object);
    memcpy(one->mac, r->row, sizeof one->mac);
    one->seq = r->seq;
    one->gone = r->nrow == 0;
    one->seen = false;
    return ST_OK;
}

bool row_check_latest(const struct row_check *c, struct store_latest *l)
{
    bool done = store_latest_begin(l);

    for (size_t i = 0; i < c->n && done; i++)
        done = store_latest_add(l, c->left[i].object, c->left[i].seq,
                                c->left[i].gone ? NULL : c->left[i].mac);
    return done;
}

void row_check_free(struct row_check *c)
{
    free(c->left);
    c->left = NULL;
}

/* The entries of an object together, the latest last. */
static int by_object(const void *a, const void *b)
{
    const struct row_check_left *x = a, *y = b;
    const int order = memcmp(x->object, y->object, sizeof x->object);

    return order != 0 ? order : (x->seq > y->seq) - (x->seq < y->seq);
}

static bool is_latest(const struct row_check *c, size_t i)
{
    return i + 1 == c->n || memcmp(c->left[i].object, c->left[i + 1].object,
                                   sizeof c->left[i].object) != 0;
}

/* The first entry of an object; c->n: it has none. */
static size_t find(const struct row_check *c, const unsigned char object[])
{
    size_t low = 0, high = c->n;

    while (low < high) {
        const size_t mid = low + (high - low) / 2;

        if (memcmp(c->left[mid].object, object, STORE_CHAIN_OBJECT) < 0)
            low = mid + 1;
        else
            high = mid;
    }
    return low < c->n && memcmp(c->left[low].object, object, STORE_CHAIN_OBJECT) == 0
               ? low
               : c->n;
}

static void tell(struct row_check *c, uint64_t seq, const char *name, const char *what)
{
    char line[160];

    (void)snprintf(line, sizeof line, "%s: %s", name, what);
    c->report(c->arg, seq, line);
}

static bool is_same(const struct row_check_left *left, const struct row_event_row *now)
{
    return !left->gone && memcmp(left->mac, now->mac, sizeof now->mac) == 0;
}

/* A row against the entries of its object; an object may have kept rows that it had before. */
static void hold(struct row_check *c, const struct row_event_row *now, const char *name,
                 bool keeps)
{
    size_t i = now->gone ? c->n : find(c, now->object);
    struct row_check_left *latest;
    bool before = false;

    if (i == c->n) {
        tell(c, c->last, name, "its row was written by nobody");
        return;
    }
    for (; !is_latest(c, i); i++)
        before = before || is_same(&c->left[i], now);
    latest = &c->left[i];
    if (keeps && before)
        return;
    if (latest->gone)
        tell(c, latest->seq, name, "its row was deleted, and is there");
    else if (latest->seen)
        tell(c, latest->seq, name, "its row is there twice");
    else if (!is_same(latest, now))
        tell(c, latest->seq, name,
             before ? "its row is an older one, which was put back"
                    : "its row is not what was written");
    latest->seen = true;
}

static enum status see(void *arg, const struct row_event_row *now, const char *name,
                       struct errinfo *e)
{
    (void)e;
    hold(arg, now, name, false);
    return ST_OK;
}

static enum status see_calibration(void *arg, const struct row_event_row *now,
                                   const char *name, struct errinfo *e)
{
    (void)e;
    hold(arg, now, name, true);
    return ST_OK;
}

enum status row_check_rows(struct row_check *c, struct store_txn *t,
                           void (*report)(void *arg, uint64_t seq, const char *line),
                           void *arg, struct errinfo *e)
{
    enum status st;

    c->report = report;
    c->arg = arg;
    if (c->n > 0)
        qsort(c->left, c->n, sizeof *c->left, by_object);
    if ((st = row_subject_each(t, see, c, e)) != ST_OK ||
        (st = row_template_see(t, see, c, e)) != ST_OK ||
        (st = row_token_each(t, see, c, e)) != ST_OK ||
        (st = row_device_each(t, see, c, e)) != ST_OK ||
        (st = row_calibration_each(t, see_calibration, c, e)) != ST_OK)
        return st;
    for (size_t i = 0; i < c->n; i++)
        if (is_latest(c, i) && !c->left[i].gone && !c->left[i].seen)
            report(arg, c->left[i].seq, "the row that this entry left is missing");
    return ST_OK;
}
