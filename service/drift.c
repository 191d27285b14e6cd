#include "drift.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ident.h"
#include "mem.h"
#include "utc.h"

#define DAY_MS INT64_C(86400000)

/* A mean noise below this is as good as none, mm. */
#define NOISE_LEAST_MM 0.02

/* The least spread of days, of the noise's logarithm and of the quality: by hand. */
#define SPREAD_NOISE   0.05
#define SPREAD_QUALITY 0.02

struct store_scans drift_sum(const struct store_scans *day, size_t n)
{
    struct store_scans sum = day[0];

    for (size_t i = 1; i < n; i++) {
        sum.n += day[i].n;
        sum.unusable += day[i].unusable;
        sum.noise_um += day[i].noise_um;
        sum.quality += day[i].quality;
    }
    return sum;
}

/* ---- one figure */

/* A figure of the days: its mean of each, and the scans that this is of. */
struct figure {
    enum drift_of of;
    size_t n;
    int64_t day[STORE_SCAN_DAYS + 1];
    double value[STORE_SCAN_DAYS + 1], weight[STORE_SCAN_DAYS + 1];
};

static double value_of(enum drift_of of, const struct store_scans *s, double weight)
{
    switch (of) {
    case DRIFT_NOISE:
        return log(fmax((double)s->noise_um / 1000 / weight, NOISE_LEAST_MM));
    case DRIFT_QUALITY:
        return (double)s->quality / 1000 / weight;
    default:
        return (double)s->unusable / weight;
    }
}

static struct figure figure_of(enum drift_of of, const struct store_scans *day, size_t n,
                               int64_t today)
{
    struct figure f = {.of = of};

    for (size_t i = 0; i < n && f.n <= STORE_SCAN_DAYS; i++) {
        const double weight =
            (double)day[i].n + (of == DRIFT_UNUSABLE ? (double)day[i].unusable : 0);

        if (weight <= 0 || day[i].day > today)
            continue;
        f.day[f.n] = day[i].day;
        f.value[f.n] = value_of(of, &day[i], weight);
        f.weight[f.n++] = weight;
    }
    return f;
}

/* Of the days from first to before end. */
struct mean {
    double mean, scans, days;
};

static struct mean mean_of(const struct figure *f, size_t first, size_t end)
{
    struct mean m = {.days = (double)(end - first)};

    for (size_t i = first; i < end; i++) {
        m.scans += f->weight[i];
        m.mean += f->weight[i] * f->value[i];
    }
    m.mean /= m.scans;
    return m;
}

/* The variance of a usual day's mean. */
static double variance(const struct figure *f, size_t first, size_t end,
                       const struct mean *before, const struct mean *after)
{
    const double least = f->of == DRIFT_NOISE ? SPREAD_NOISE : SPREAD_QUALITY;
    const double all = (before->mean * before->scans + after->mean * after->scans) /
                       (before->scans + after->scans);
    double sum = 0, by_chance = least * least;

    for (size_t i = first; i < end; i++)
        sum += f->weight[i] * (f->value[i] - before->mean) * (f->value[i] - before->mean);
    if (f->of == DRIFT_UNUSABLE)
        by_chance = all * (1 - all) * before->days / before->scans;
    return fmax(by_chance, sum / before->scans * before->days / (before->days - 1));
}

/* Is the difference as large as a change must be? */
static bool is_large(enum drift_of of, double by)
{
    switch (of) {
    case DRIFT_NOISE:
        return fabs(by) >= log(DRIFT_NOISE_RATIO);
    case DRIFT_QUALITY:
        return by <= -DRIFT_QUALITY_FALL;
    default:
        return by >= DRIFT_UNUSABLE_RISE;
    }
}

/* Returns how many standard errors the change at day `at` is; 0: it is none. */
static double sureness(const struct figure *f, size_t at, struct drift *out)
{
    struct mean before, after, last;
    size_t first = at, tail = f->n;
    double usual;

    while (first > 0 && f->day[first - 1] >= f->day[at] - DRIFT_WINDOW)
        first--;
    if (at - first < DRIFT_BEFORE_DAYS || f->n - at < DRIFT_SINCE_DAYS)
        return 0;
    before = mean_of(f, first, at);
    after = mean_of(f, at, f->n);
    if (before.scans < DRIFT_BEFORE || after.scans < DRIFT_SINCE)
        return 0;
    do
        last = mean_of(f, --tail, f->n);
    while (last.scans < DRIFT_SINCE);
    if (!is_large(f->of, f->value[at] - before.mean) ||
        !is_large(f->of, after.mean - before.mean) ||
        !is_large(f->of, last.mean - before.mean))
        return 0;
    usual = before.scans / before.days;
    *out = (struct drift){.of = f->of,
                          .since = f->day[at],
                          .before = f->of == DRIFT_NOISE ? exp(before.mean) : before.mean,
                          .after = f->of == DRIFT_NOISE ? exp(after.mean) : after.mean};
    return fabs(after.mean - before.mean) /
           sqrt(variance(f, first, at, &before, &after) *
                (1 / before.days + 1 / fmin(after.days, after.scans / usual)));
}

static struct drift figure_drift(const struct figure *f, int64_t today)
{
    struct drift best = {.of = DRIFT_NONE}, one = best;
    double most = DRIFT_SURE;

    for (size_t i = f->n; i-- > 0 && f->day[i] > today - DRIFT_WINDOW;) {
        const double sure = sureness(f, i, &one);

        if (sure >= most) {
            most = sure;
            best = one;
        }
    }
    return best;
}

/* Unusable scans are not among those whose noise is known, and noise lowers the quality: in this order. */
struct drift drift_find(const struct store_scans *day, size_t n, int64_t today)
{
    static const enum drift_of order[] = {DRIFT_UNUSABLE, DRIFT_NOISE, DRIFT_QUALITY};
    struct drift found = {.of = DRIFT_NONE};

    for (size_t i = 0; i < 3 && found.of == DRIFT_NONE; i++) {
        const struct figure f = figure_of(order[i], day, n, today);

        found = figure_drift(&f, today);
    }
    return found;
}

/* ---- in words */

/* "doubled" */
static void say_ratio(double ratio, char out[32])
{
    if (ratio >= 2.5)
        (void)snprintf(out, 32, "is %.0f times as high", ratio);
    else if (ratio >= 1.8)
        (void)snprintf(out, 32, "doubled");
    else if (ratio > 1)
        (void)snprintf(out, 32, "rose by %.0f %%", 100 * (ratio - 1));
    else if (ratio > 0.4 && ratio <= 1 / 1.8)
        (void)snprintf(out, 32, "halved");
    else
        (void)snprintf(out, 32, "fell by %.0f %%", 100 * (1 - ratio));
}

void drift_say(const struct drift *d, char out[DRIFT_TEXT])
{
    static const char *const weekday[] = {"Thursday", "Friday",  "Saturday", "Sunday",
                                          "Monday",   "Tuesday", "Wednesday"};
    const char *on = weekday[d->since % 7]; /* 1970 began with a Thursday */
    char day[UTC_TEXT], how[32];

    out[0] = '\0';
    utc_print(d->since * DAY_MS, day);
    day[STORE_DAY] = '\0';
    switch (d->of) {
    case DRIFT_NOISE:
        say_ratio(d->after / d->before, how);
        (void)snprintf(out, DRIFT_TEXT, "noise %s since %s, %s: %.2f mm, before %.2f mm",
                       how, on, day, d->after, d->before);
        break;
    case DRIFT_QUALITY:
        (void)snprintf(out, DRIFT_TEXT, "quality fell since %s, %s: %.2f, before %.2f",
                       on, day, d->after, d->before);
        break;
    case DRIFT_UNUSABLE:
        (void)snprintf(
            out, DRIFT_TEXT,
            "more scans are unusable since %s, %s: %.0f of 100, before %.0f of 100", on,
            day, 100 * d->after, 100 * d->before);
        break;
    default:;
    }
}

/* ---- all tokens */

static int by_name(const void *a, const void *b)
{
    const struct drift_token *x = a, *y = b;
    const int order = strcmp(x->name, y->name);

    return order != 0 ? order : strcmp(x->day->token, y->day->token);
}

static void name_it(struct drift_token *t, const struct store_token *token, size_t n)
{
    t->id = ident_id_valid(t->day->token) ? t->day->token : "";
    t->name = t->day->token;
    for (size_t i = 0; i < n; i++)
        if (strcmp(token[i].id, t->id) == 0)
            t->name = token[i].name;
}

static enum status tell_all(const struct store_scans *day, size_t n,
                            const struct store_token *token, size_t tokens,
                            void (*tell)(void *arg, const struct drift_token *t),
                            void *arg, struct errinfo *e)
{
    struct drift_token *all = mem_array(n + 1, sizeof *all);
    size_t found = 0;
    int64_t now;

    if (all == NULL)
        return errinfo_memory(e);
    (void)utc_now(&now);
    for (size_t i = 0; i < n; i += all[found++].n) {
        all[found] = (struct drift_token){.day = &day[i], .n = 1};
        while (i + all[found].n < n &&
               strcmp(day[i + all[found].n].token, day[i].token) == 0)
            all[found].n++;
        all[found].drift = drift_find(&day[i], all[found].n, now / DAY_MS);
        name_it(&all[found], token, tokens);
    }
    qsort(all, found, sizeof *all, by_name);
    for (size_t i = 0; i < found; i++)
        tell(arg, &all[i]);
    mem_free(all);
    return ST_OK;
}

enum status drift_each(struct store *s,
                       void (*tell)(void *arg, const struct drift_token *t), void *arg,
                       struct errinfo *e)
{
    struct store_scans *day = NULL;
    struct store_token *token = NULL;
    size_t n = 0, tokens = 0;
    enum status st = store_scans(s, &day, &n, e);

    if (st == ST_OK && n > 0)
        st = store_token_list(s, "", &token, &tokens, e);
    if (st == ST_OK)
        st = tell_all(day, n, token, tokens, tell, arg, e);
    free(day);
    free(token);
    return st;
}
