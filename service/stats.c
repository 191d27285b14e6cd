#include "stats.h"

#include <math.h>

#include "describe.h"
#include "drift.h"
#include "findings.h"
#include "store.h"
#include "json.h"
#include "show.h"
#include "utc.h"

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
    describe_det(j, "det", k->shipped ? NULL : &k->det);
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

/* ---- scans */

#define DAY_MS INT64_C(86400000)

/* The Monday of a day; 1970 began with a Thursday. */
static int64_t week(int64_t day)
{
    return day - (day + 3) % 7;
}

/* The days from day[0] on that are of one week.  Returns their number. */
static size_t describe_week(struct json *j, const struct store_scans *day, size_t n)
{
    const int64_t from = week(day[0].day);
    struct store_scans sum;
    char text[UTC_TEXT];
    size_t i = 0;
    double scans;

    while (i < n && week(day[i].day) == from)
        i++;
    sum = drift_sum(day, i);
    scans = sum.n > 0 ? (double)sum.n : (double)NAN;
    utc_print(from * DAY_MS, text);
    text[STORE_DAY] = '\0';
    json_object(j, NULL);
    json_text(j, "from", text);
    json_number(j, "n", (double)sum.n);
    json_number(j, "unusable", (double)sum.unusable);
    json_number(j, "noise_mm", (double)sum.noise_um / 1000 / scans);
    json_number(j, "quality", (double)sum.quality / 1000 / scans);
    json_close(j);
    return i;
}

static void describe_scans(void *arg, const struct drift_token *t)
{
    struct json *j = arg;
    char text[DRIFT_TEXT];

    drift_say(&t->drift, text);
    json_object(j, NULL);
    json_text(j, "token", t->name);
    json_text_or_null(j, "token_id", t->id);
    json_text_or_null(j, "change", text);
    json_array(j, "weeks");
    for (size_t i = 0; i < t->n;)
        i += describe_week(j, &t->day[i], t->n - i);
    json_close(j);
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
    json_array(j, "scans");
    st = drift_each(s, describe_scans, j, e);
    json_close(j);
    return st;
}
