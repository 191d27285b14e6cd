#include "ctl_option.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudunit.h"
#include "ctl.h"
#include "number.h"
#include "store.h"
#include "utc.h"

/* ---- values */

const char *ctl_option_flag(const char *text, void *value)
{
    (void)text;
    *(bool *)value = true;
    return NULL;
}

const char *ctl_option_text(const char *text, void *value)
{
    *(const char **)value = text;
    return NULL;
}

static const char *read_units(const char *text, void *value)
{
    return cloudunit_or_auto(text, value) ? NULL : "auto, " CLOUDUNIT_NAMES;
}

static const char *read_axes(const char *text, void *value)
{
    const bool scanner = strcmp(text, "scanner") == 0;

    *(bool *)value = scanner;
    return scanner || strcmp(text, "auto") == 0 ? NULL : "auto or scanner";
}

static const char *read_camera(const char *text, void *value)
{
    return clouddepth_camera_read(text, value)
               ? NULL
               : "FX,FY,CX,CY[,SCALE[,WIDTH,HEIGHT]], pixels";
}

static bool read_number(const char *text, double *to, double most)
{
    char *end;

    *to = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*to) && *to > 0 && *to <= most;
}

const char *ctl_option_score(const char *text, void *value)
{
    double *to = value;
    char *end;

    *to = strtod(text, &end);
    return end != text && *end == '\0' && fabs(*to) < 1e4
               ? NULL
               : "a score between -10000 and 10000";
}

const char *ctl_option_rate(const char *text, void *value)
{
    return read_number(text, value, 0.5) ? NULL : "a rate above 0 and at most 0.5";
}

const char *ctl_option_whole(const char *text, void *value)
{
    char *end;
    const long n = strtol(text, &end, 10);

    *(uint32_t *)value = (uint32_t)n;
    return end != text && *end == '\0' && n >= 1 && n <= 1000000 ? NULL : "1 to 1000000";
}

const char *ctl_option_scopes(const char *text, void *value)
{
    return rows_scopes_read(text, value)
               ? NULL
               : "a list of enroll,verify,identify,read,delete,manage,detail";
}

const char *ctl_option_duration(const char *text, void *value)
{
    static const struct {
        char unit;
        int64_t s;
    } units[] = {{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86400}};
    static const char wanted[] = "a time like 1d, 12h or 30m";
    char *end;
    long n;

    if (*text < '0' || *text > '9')
        return wanted;
    n = strtol(text, &end, 10);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (end[0] == units[i].unit && end[1] == '\0' && n >= 1 &&
            n <= STORE_LIFE_MAX / units[i].s) {
            *(int64_t *)value = n * units[i].s;
            return NULL;
        }
    return wanted;
}

static const char *read_expires(const char *text, void *value)
{
    struct ctl_expires *x = value;
    int64_t now = 0;

    *x = (struct ctl_expires){.given = true};
    if (strcmp(text, "never") == 0)
        return NULL;
    (void)utc_now(&now);
    if (utc_read_end(text, &x->at_ms)) {
        x->life_s = (x->at_ms - now) / 1000;
        return x->life_s > 0 ? NULL : "a time to come";
    }
    if (ctl_option_duration(text, &x->life_s) != NULL)
        return "a time like 90d, 12h, 30m, 2027-01-31 or never";
    x->at_ms = now + x->life_s * 1000;
    return NULL;
}

/* ---- the shared ones, in the order of their bits */

#define SHARED(name, arg, read, field, letter, help)                                     \
    {                                                                                    \
        name, arg, read, NULL, help, offsetof(struct ctl, field), letter                 \
    }
#define NSHARED (sizeof shared_options / sizeof *shared_options)

static const struct ctl_option shared_options[] = {
    SHARED("db", "PATH", ctl_option_text, db, 0,
           "the database; or set SURFACED_DB (default: the daemon's, by its\n"
           "configuration)"),
    SHARED("config", "FILE", ctl_option_text, config, 0,
           "the daemon's configuration (/etc/surfaced.conf); or set\nSURFACED_CONFIG"),
    SHARED("key", "FILE", ctl_option_text, key, 0,
           "the database's key or passphrase (PATH.key); or set SURFACED_KEY"),
    SHARED("anchor", "FILE", ctl_option_text, anchor, 0,
           "records the newest state of the database, on another disk or host;\n"
           "or none; or set SURFACED_ANCHOR"),
    SHARED("plaintext-database", NULL, ctl_option_flag, plaintext, 0,
           "the database has no key: anyone with the file can read it; or set\n"
           "SURFACED_PLAINTEXT_DATABASE=1"),
    SHARED("units", "auto|mm|cm|m|in|um", read_units, scans.unit_mm, 0,
           "the unit of the scans' coordinates (auto: it is found); what a\n"
           "file says wins"),
    SHARED("axes", "auto|scanner", read_axes, scans.frontal, 0,
           "auto: the face is found, however the scan is turned; scanner: x to\n"
           "the image's right, y up, z towards the scanner, and all of it face"),
    SHARED("camera", "FX,FY,CX,CY", read_camera, scans.camera, 0,
           "of depth images: focal length and centre in pixels; and \",SCALE\" if\n"
           "a value is not a millimetre, and \",WIDTH,HEIGHT\" of files that have\n"
           "the values alone (see the manual)"),
    SHARED("model", "FILE", ctl_option_text, model_path, 0,
           "a model that surfacelab train wrote; or set SURFACED_MODEL"),
    SHARED("threshold", "SCORE", ctl_option_score, threshold, 0,
           "count by this threshold instead of the calibration's"),
    SHARED("fmr", "RATE", ctl_option_rate, fmr, 0,
           "the false match rate that the threshold is for"),
    SHARED("label", "TEXT", ctl_option_text, label, 0,
           "a note stored with each template, or a model's name"),
    SHARED("out", "DIR|FILE", ctl_option_text, dir, 'o',
           "the folder or the file that is written"),
    SHARED("threads", "N", ctl_option_whole, threads, 0,
           "compute on N threads (one a core)"),
    SHARED("passphrase", NULL, ctl_option_flag, passphrase, 0,
           "encrypt with a passphrase: it is asked for, or read from --key"),
    SHARED("short-passphrase", NULL, ctl_option_flag, short_passphrase, 0,
           "accept a new passphrase of fewer than 12 characters"),
    SHARED("archive-key", "FILE", ctl_option_text, archive_key, 0,
           "a file with the archive's key or passphrase, instead of asking"),
    SHARED("public-key", "HEX", ctl_option_text, public_key, 0,
           "the public key of the database that FILE is from"),
    SHARED(
        "expires", "TIME", read_expires, expires, 0,
        "the end: 90d, 12h or 30m from now, the end of 2027-01-31 (UTC),\n2027-01-31T14:30:00Z, or never"),
    SHARED("dry-run", NULL, ctl_option_flag, dry_run, 0,
           "show what would be done, change nothing"),
    SHARED("yes", NULL, ctl_option_flag, yes, 0, "do not ask for confirmation"),
    SHARED("force", NULL, ctl_option_flag, force, 0, "replace files that exist"),
    SHARED("json", NULL, ctl_option_flag, json, 0, "print the result as JSON"),
    SHARED("help", NULL, ctl_option_flag, help, 'h', "print this text"),
    SHARED("version", NULL, ctl_option_flag, version, 0, "print the version"),
};

const struct ctl_option *ctl_option_at(unsigned shared, const struct ctl_option *own,
                                       size_t i)
{
    for (size_t k = 0; k < NSHARED; k++)
        if ((shared >> k & 1) != 0 && i-- == 0)
            return &shared_options[k];
    for (; own != NULL && own->name != NULL; own++)
        if (i-- == 0)
            return own;
    return NULL;
}

const struct ctl_option *ctl_option_find(unsigned shared, const struct ctl_option *own,
                                         const char *name)
{
    const struct ctl_option *o;

    for (size_t i = 0; (o = ctl_option_at(shared, own, i)) != NULL; i++)
        if (strcmp(o->name, name) == 0)
            return o;
    return NULL;
}

/* How many letters are inserted, removed or replaced; of up to 39. */
static size_t edits_between(const char *a, const char *b)
{
    size_t row[40], before, was;
    const size_t n = strlen(b);

    for (size_t j = 0; j <= n; j++)
        row[j] = j;
    for (size_t i = 0; a[i] != '\0'; i++) {
        before = row[0]++;
        for (size_t j = 0; j < n; j++) {
            was = row[j + 1];
            row[j + 1] = before + (a[i] != b[j]);
            if (row[j + 1] > was + 1)
                row[j + 1] = was + 1;
            if (row[j + 1] > row[j] + 1)
                row[j + 1] = row[j] + 1;
            before = was;
        }
    }
    return row[n];
}

void ctl_near(struct ctl_near *near, const char *word, const char *before,
              const char *name)
{
    char whole[sizeof near->name];
    size_t edits;

    (void)snprintf(whole, sizeof whole, "%s%s", before, name);
    edits = strlen(word) > 2 && strncmp(whole, word, strlen(word)) == 0
                ? 1
                : edits_between(word, whole);
    if (3 * edits > strlen(whole) || (near->name[0] != '\0' && edits >= near->edits))
        return;
    (void)snprintf(near->name, sizeof near->name, "%s", whole);
    near->edits = edits;
}
