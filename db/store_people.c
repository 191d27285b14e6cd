#include "store_people.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "log_row.h"
#include "rows_calibration.h"
#include "rows_template.h"
#include "store_template.h"
#include "store_txn.h"

/* More changes are not worth a list: reading all people takes less time than looking for each of these. */
#define STORE_PEOPLE_CHANGES 20000

struct store_people {
    struct store *store;
    struct log_txn t;
    int64_t calibration; /* that the caller decides by */
    struct store_calibration newest;
    /* The receiver of the templates that are read at present. */
    store_people_use *use;
    store_report *report;
    void *arg;
};

static enum status read_begin(void *arg, struct errinfo *e)
{
    struct store_people *p = arg;
    enum status st = store_actor_may(&p->t, e);

    if (sql_goes_on(p->t.sql, st))
        st = rows_calibration_get(&p->t, &p->newest, e);
    if (st != ST_ENOTFOUND)
        return st;
    p->newest = (struct store_calibration){.version = 0};
    return ST_OK;
}

enum status store_people_begin(struct store *s, const char *actor, int64_t calibration,
                               struct store_people **out, struct errinfo *e)
{
    struct store_people *p = calloc(1, sizeof *p);
    enum status st;

    *out = NULL;
    if (p == NULL)
        return errinfo_memory(e);
    p->store = s;
    p->calibration = calibration;
    if ((st = store_start(s, actor, SQL_READ, NULL, &p->t, e)) == ST_OK) {
        store_read_ahead(&p->t, read_begin, p);
        st = store_check(s, &p->t, e);
    }
    if (st != ST_OK) {
        free(p);
        return st;
    }
    if ((st = read_begin(p, e)) != ST_OK)
        return store_people_end(p, st, e);
    *out = p;
    return ST_OK;
}

enum status store_people_end(struct store_people *p, enum status st, struct errinfo *e)
{
    if (p == NULL)
        return st;
    st = store_end(p->store, &p->t, st, e);
    free(p);
    return st;
}

uint64_t store_people_seq(const struct store_people *p)
{
    return p->t.changes.seq;
}

const char *store_people_bound(const struct store_people *p)
{
    return p->t.groups;
}

int64_t store_people_calibration(const struct store_people *p,
                                 struct store_calibration *k)
{
    *k = p->newest.version != p->calibration ? p->newest
                                             : (struct store_calibration){.version = 0};
    return p->newest.version;
}

struct log_txn *store_people_txn(struct store_people *p)
{
    return &p->t;
}

/* ---- descriptors */

static enum status use_row(void *arg, const struct rows_template *row,
                           const struct rows_subject *of, const void *face, size_t len,
                           struct errinfo *e)
{
    const struct store_people *p = arg;
    unsigned char descriptor[SURFACE_DESCRIPTOR];
    enum status st;

    (void)face, (void)len;
    if (store_template_outdated(p->store, &row->one))
        return p->use(p->arg, &of->one, &row->one, NULL, e);
    if ((st = rows_template_descriptor(row, of, descriptor, e)) == ST_OK)
        st = p->use(p->arg, &of->one, &row->one,
                    descriptor[0] != SURFACE_UNDESCRIBED ? descriptor : NULL, e);
    sodium_memzero(descriptor, sizeof descriptor);
    return st;
}

static void report_row(void *arg, const char *line)
{
    const struct store_people *p = arg;

    p->report(p->arg, line);
}

enum status store_people_all(struct store_people *p, store_people_use *use,
                             store_report *report, void *arg, struct errinfo *e)
{
    p->use = use;
    p->report = report;
    p->arg = arg;
    return rows_template_each(&p->t, 0, 1, false, use_row, report_row, p, e);
}

enum status store_people_of(struct store_people *p, const unsigned char uid[STORE_UID],
                            store_people_use *use, void *arg, struct errinfo *e)
{
    struct rows_template *row = NULL;
    struct rows_subject of;
    size_t n = 0;
    enum status st = rows_subject_get(&p->t, uid, &of, e);

    p->use = use;
    p->arg = arg;
    if (st == ST_ENOTFOUND)
        return ST_OK;
    if (st == ST_OK)
        st = rows_template_list(&p->t, &of, &row, &n, e);
    for (size_t i = 0; st == ST_OK && i < n; i++)
        st = use_row(p, &row[i], &of, NULL, 0, e);
    free(row);
    sodium_memzero(&of, sizeof of);
    return st;
}

/* ---- changes */

/* Names the entry no subject because it concerns none?  Of a kind that is not known here: all. */
static bool concerns_all(const struct log_entry *entry)
{
    static const char *const none[] = {
        "create_database", "create_token", "rotate_token",   "revoke_token", "add_device",
        "remove_device",   "calibrate",    "reset_attempts", LOG_CHECKPOINT, LOG_EXPORT,
        LOG_TRIM,          LOG_JOIN,       LOG_FOUND};

    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        if (strcmp(entry->kind, none[i]) == 0)
            return false;
    return true;
}

enum status store_people_changed(struct store_people *p, uint64_t after,
                                 unsigned char (**uid)[STORE_UID], size_t *n, bool *all,
                                 struct errinfo *e)
{
    struct log_entry *entry = NULL;
    size_t entries = 0;
    enum status st;

    *uid = NULL;
    *n = 0;
    *all = p->t.changes.seq - after > STORE_PEOPLE_CHANGES;
    if (*all)
        return ST_OK;
    if ((st = log_list(p->t.sql, NULL, after, &entry, &entries, e)) != ST_OK)
        return st;
    if ((*uid = malloc((entries + 1) * sizeof **uid)) == NULL)
        st = errinfo_memory(e);
    for (size_t i = 0; st == ST_OK && i < entries; i++)
        if (!sodium_is_zero(entry[i].uid, STORE_UID))
            memcpy((*uid)[(*n)++], entry[i].uid, STORE_UID);
        else
            *all = *all || concerns_all(&entry[i]);
    free(entry);
    return st;
}
