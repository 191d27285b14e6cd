#include "stats.h"

#include <math.h>

#include "describe.h"
#include "findings.h"
#include "store.h"
#include "json.h"
#include "show.h"

static void describe_counts(struct json *j, const struct store_stats *all)
{
    json_object(j, "counts");
    json_number(j, "subjects", (double)all->subjects);
    json_number(j, "templates", (double)all->templates);
    json_number(j, "tokens", (double)all->tokens);
    json_number(j, "devices", (double)all->devices);
    json_close(j);
}

/* The model's own calibration names neither an interval nor the comparisons that it was made from: null. */
static void describe_in_force(struct json *j, const struct store_calibration *k)
{
    const double none = (double)NAN;

    json_object(j, "calibration");
    json_text(j, "source", k->shipped ? "shipped" : "calibrated");
    json_rate(j, "fmr", k->shipped ? none : k->fmr);
    json_text(j, "made_at", k->shipped ? NULL : k->created);
    json_score(j, "low", k->shipped ? none : k->low);
    json_score(j, "high", k->shipped ? none : k->high);
    json_number(j, "subjects", k->shipped ? none : (double)k->subjects);
    json_number(j, "non_mated", k->shipped ? none : (double)k->impostors);
    json_number(j, "mated", k->shipped ? none : (double)k->genuine);
    show_calibration(j, &k->table);
    json_close(j);
}

static void stats_tell(void *arg, const struct finding *f)
{
    struct json *j = arg;

    json_object(j, NULL);
    findings_describe(j, f);
    json_close(j);
}

static void describe_day(struct json *j, const struct store_day *d, bool scores)
{
    double n = 0;

    for (int i = 0; i < STORE_DAY_BINS; i++)
        n += d->bin[i];
    json_object(j, NULL);
    json_text(j, "day", d->day);
    json_text(j, "decision", d->decision);
    json_number(j, "n", n);
    if (scores) {
        json_array(j, "bins");
        for (int i = 0; i < STORE_DAY_BINS; i++)
            json_number(j, NULL, d->bin[i]);
        json_close(j);
    } else {
        json_text(j, "bins", NULL);
    }
    json_close(j);
}

enum status stats_describe(struct json *j, struct store *s, const struct store_day *days,
                           size_t n, bool scores, struct errinfo *e)
{
    struct findings found = {.tell = stats_tell, .arg = j};
    struct store_calibration k;
    struct store_stats all;
    enum status st;

    if ((st = store_stats(s, false, &all, e)) != ST_OK ||
        (st = store_calibration_current(s, &k, e)) != ST_OK)
        return st;
    describe_counts(j, &all);
    json_text(j, "engine", store_made_by(s));
    describe_in_force(j, &k);
    json_array(j, "findings");
    findings_store(&found, s);
    json_close(j);
    json_array(j, "days");
    for (size_t i = 0; i < n; i++)
        describe_day(j, &days[i], scores);
    json_close(j);
    return ST_OK;
}
