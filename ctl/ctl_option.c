#include "ctl_option.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ctl.h"

#define AT(field) offsetof(struct ctl, field)

/* ---- values */

static bool set_flag(void *field, const char *value)
{
    (void)value;
    *(bool *)field = true;
    return true;
}

static bool set_text(void *field, const char *value)
{
    *(const char **)field = value;
    return true;
}

static bool set_units(void *field, const char *value)
{
    *(const char **)field = value;
    return strcmp(value, "mm") == 0 || strcmp(value, "cm") == 0 ||
           strcmp(value, "m") == 0;
}

static bool set_number(double *to, const char *value, double most)
{
    char *end;

    *to = strtod(value, &end);
    return end != value && *end == '\0' && isfinite(*to) && *to > 0 && *to <= most;
}

static bool set_mm(void *field, const char *value)
{
    return set_number(field, value, 999);
}

static bool set_rate(void *field, const char *value)
{
    return set_number(field, value, 0.5);
}

static bool set_whole(void *field, const char *value)
{
    char *end;
    const long n = strtol(value, &end, 10);

    *(uint32_t *)field = (uint32_t)n;
    return end != value && *end == '\0' && n >= 1 && n <= 1000000;
}

static bool set_scopes(void *field, const char *value)
{
    return store_scopes_read(value, field);
}

/* "90d", "12h", "30m", "20s" in seconds. */
static bool set_duration(void *field, const char *value)
{
    static const struct {
        char unit;
        int64_t s;
    } units[] = {{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86400}};
    int64_t *out = field;
    char *end;
    long n;

    *out = 0;
    if (*value < '0' || *value > '9')
        return false;
    n = strtol(value, &end, 10);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (end[0] == units[i].unit && end[1] == '\0') {
            if (n < 1 || n > STORE_LIFE_MAX / units[i].s)
                return false;
            *out = n * units[i].s;
            return true;
        }
    return false;
}

static bool set_expires(void *field, const char *value)
{
    struct ctl_expires *x = field;
    const int64_t now = time(NULL);
    int64_t ms;

    x->given = true;
    x->life_s = x->at_s = 0;
    if (strcmp(value, "never") == 0)
        return true;
    if (store_time_read(value, &ms)) {
        x->at_s = ms / 1000;
        x->life_s = x->at_s - now;
        return true;
    }
    if (!set_duration(&x->life_s, value))
        return false;
    x->at_s = now + x->life_s;
    return true;
}

/* ---- the table */

const struct ctl_option ctl_options[] = {
    {.name = "db",
     .arg = "PATH",
     .field = AT(db),
     .set = set_text,
     .common = true,
     .help = "the database; or set SURFACED_DB (the daemon's, by its configuration)"},
    {.name = "config",
     .arg = "FILE",
     .field = AT(config),
     .set = set_text,
     .common = true,
     .help = "the daemon's configuration, where that is not /etc/surfaced.conf"},
    {.name = "key",
     .arg = "FILE",
     .field = AT(key),
     .set = set_text,
     .common = true,
     .help = "the database's key or passphrase (PATH.key); or set SURFACED_KEY"},
    {.name = "units",
     .arg = "mm|cm|m",
     .field = AT(units),
     .set = set_units,
     .wrong = "units are mm, cm or m, not",
     .help = "of the scans' coordinates (mm)"},
    {.name = "label",
     .arg = "TEXT",
     .field = AT(label),
     .set = set_text,
     .help = "a note kept with each template; of train, the model's name"},
    {.name = "force",
     .field = AT(force),
     .set = set_flag,
     .help = "enroll scans that do not fit the subject's others"},
    {.name = "kind",
     .arg = "WORD",
     .field = AT(kind),
     .set = set_text,
     .help = "of a folder or table, only the scans of this kind; of audit show,\n"
             "the events"},
    {.name = "subject",
     .arg = "ID",
     .field = AT(subject),
     .set = set_text,
     .help = "only events about this subject, erased or not; of dedup, this one\n"
             "with all others"},
    {.name = "since",
     .arg = "TIME",
     .field = AT(since),
     .set = set_text,
     .help = "only events of 2026-11-21, or 2026-11-21T14:30, or later (UTC)"},
    {.name = "limit",
     .arg = "N",
     .field = AT(limit),
     .set = set_whole,
     .wrong = "a limit is 1 to 1000000, not",
     .help = "the newest N (100)"},
    {.name = "public-key",
     .arg = "HEX",
     .field = AT(public_key),
     .set = set_text,
     .help = "of the database that a FILE is from"},
    {.name = "threshold-mm",
     .arg = "MM",
     .field = AT(threshold_mm),
     .set = set_mm,
     .wrong = "a threshold is millimetres above 0, not",
     .help = "count by another threshold than the default"},
    {.name = "out",
     .also = "o",
     .arg = "DIR|FILE",
     .field = AT(dir),
     .set = set_text,
     .help = "where the files go (./explanation, ./evaluation); of train,\n"
             "the model's file (./faces.model); else the file that is written"},
    {.name = "model",
     .arg = "FILE",
     .field = AT(model_path),
     .set = set_text,
     .help = "judge by a model that surfacectl train wrote; or set\nSURFACED_MODEL"},
    {.name = "impostors",
     .arg = "N",
     .field = AT(impostors),
     .set = set_whole,
     .wrong = "impostors are 1 to 1000000, not",
     .help = "compare each probe with N other subjects (all, up to 200,000\n"
             "comparisons)"},
    {.name = "threads",
     .arg = "N",
     .field = AT(threads),
     .set = set_whole,
     .wrong = "threads are 1 to 1000000, not",
     .help = "work on N threads (one a core)"},
    {.name = "fmr",
     .arg = "RATE",
     .field = AT(fmr),
     .set = set_rate,
     .wrong = "a rate is above 0 and at most 0.5, not",
     .help = "the false match rate that is wanted (0.001)"},
    {.name = "genuine",
     .arg = "MANIFEST",
     .field = AT(genuine),
     .set = set_text,
     .help = "further scans of the subjects"},
    {.name = "dry-run",
     .field = AT(dry_run),
     .set = set_flag,
     .help = "show what would be done, change nothing"},
    {.name = "list", .field = AT(list), .set = set_flag, .help = "list the calibrations"},
    {.name = "reset",
     .field = AT(reset),
     .set = set_flag,
     .help = "back to the shipped table"},
    {.name = "tolerance",
     .arg = "MM",
     .field = AT(tolerance_mm),
     .set = set_mm,
     .wrong = "a tolerance is millimetres above 0, not",
     .help = "the largest gap that may open"},
    {.name = "mean",
     .field = AT(mean),
     .set = set_flag,
     .help = "the tolerance is for the mean gap, the disparity"},
    {.name = "yes", .field = AT(yes), .set = set_flag, .help = "do not ask"},
    {.name = "all", .field = AT(all), .set = set_flag, .help = "every subject"},
    {.name = "archive-key",
     .arg = "FILE",
     .field = AT(archive_key),
     .set = set_text,
     .help = "an archive's key or passphrase, instead of asking for it"},
    {.name = "due",
     .field = AT(due),
     .set = set_flag,
     .help = "the subjects that have expired"},
    {.name = "passphrase",
     .field = AT(passphrase),
     .set = set_flag,
     .help = "seal with a passphrase: asked for, or the line in --key FILE"},
    {.name = "plaintext",
     .field = AT(plaintext),
     .set = set_flag,
     .help = "leave the key in the database: whoever has the file can read it"},
    {.name = "new-key",
     .arg = "FILE",
     .field = AT(new_key),
     .set = set_text,
     .help = "the new key, or passphrase, is this file's line"},
    {.name = "keep-old",
     .field = AT(keep_old),
     .set = set_flag,
     .help = "keep the old key's file, as FILE.old"},
    {.name = "scope",
     .arg = "LIST",
     .field = AT(scopes),
     .set = set_scopes,
     .wrong = "scopes are enroll,verify,identify,read,delete,manage,detail, not",
     .help = "what a token may do: enroll,verify,identify,read,delete,manage,\n"
             "detail (all)"},
    {.name = "reference",
     .arg = "TEXT",
     .field = AT(reference),
     .set = set_text,
     .help = "of the consent: a number, a file; '' for none"},
    {.name = "purpose",
     .arg = "TEXT",
     .field = AT(purpose),
     .set = set_text,
     .help = "what the consent is for; '' for none"},
    {.name = "expires",
     .arg = "TIME",
     .field = AT(expires),
     .set = set_expires,
     .wrong = "--expires is like 90d, 12h, 30m, 2027-01-31 or never, not",
     .help = "until when: 90d, 12h, 30m from now, 2027-01-31, never"},
    {.name = "grace",
     .arg = "TIME",
     .field = AT(grace_s),
     .set = set_duration,
     .wrong = "--grace is like 1d, 12h or 30m, not",
     .help = "how long the old secret still counts"},
    {.name = "json",
     .field = AT(json),
     .set = set_flag,
     .common = true,
     .help = "print JSON"},
    {.name = "help",
     .also = "h",
     .field = AT(help),
     .set = set_flag,
     .common = true,
     .help = "this text"},
    {.name = "version",
     .field = AT(version),
     .set = set_flag,
     .common = true,
     .help = "the version"},
    {.name = NULL}};

const struct ctl_option *ctl_option_find(const char *text, size_t n)
{
    const struct ctl_option *o = ctl_options;

    for (; o->name != NULL; o++) {
        if (n == strlen(o->name) + 2 && memcmp(text, "--", 2) == 0 &&
            memcmp(text + 2, o->name, n - 2) == 0)
            return o;
        if (o->also != NULL && n == 2 && text[0] == '-' && text[1] == o->also[0])
            return o;
    }
    return NULL;
}

bool ctl_option_in(const struct ctl_option *o, const char *list)
{
    const size_t n = strlen(o->name);

    for (; list != NULL && *list != '\0'; list += strspn(list, " ")) {
        const size_t len = strcspn(list, " ");

        if (len == n && memcmp(list, o->name, n) == 0)
            return true;
        list += len;
    }
    return false;
}
