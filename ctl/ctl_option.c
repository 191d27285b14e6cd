#include "ctl_command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "store.h"
#include "utc.h"

/* ---- values */

const char *ctl_option_scopes(const char *text, void *value)
{
    return rows_scopes_read(text, value)
               ? NULL
               : "a list of verify,enroll,identify,read,delete,manage,tokens,audit,events,score,detail";
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
    int64_t now = 0, s;

    *x = (struct ctl_expires){.given = true};
    if (strcmp(text, "never") == 0)
        return NULL;
    (void)utc_now(&now);
    if (utc_read_end(text, &x->end_ms))
        return x->end_ms > now ? NULL : "a time in the future";
    if (ctl_option_duration(text, &s) != NULL)
        return "a time like 90d, 12h, 30m, 2027-01-31 or never";
    x->end_ms = now + s * 1000;
    return NULL;
}

/* ---- the shared ones, in the order of their bits */

#define SHARED(name, arg, read, field, letter, help)                                     \
    {                                                                                    \
        name, arg, read, NULL, help, offsetof(struct ctl, field), letter                 \
    }
#define NSHARED (sizeof shared_options / sizeof *shared_options)

static const struct command_option shared_options[] = {
    SHARED("db", "PATH", command_text, db, 0,
           "the database, a file or postgresql://USER@HOST/NAME; or set\n"
           "SURFACED_DB (default: the daemon's, by its configuration)"),
    SHARED("config", "FILE", command_text, config, 0,
           "the daemon's configuration (/etc/surfaced.conf); or set\n"
           "SURFACED_CONFIG"),
    SHARED("key", "FILE", command_text, key, 0,
           "the database's key or passphrase (PATH.key); or set SURFACED_KEY"),
    SHARED("anchor", "FILE", command_text, anchor, 0,
           "records the newest state of the database, on another disk or host;\n"
           "or none; or set SURFACED_ANCHOR"),
    SHARED("plaintext-database", NULL, command_flag, plaintext, 0,
           "the database has no key: anyone with the file can read it; or set\n"
           "SURFACED_PLAINTEXT_DATABASE=1"),
    SHARED("units", "auto|mm|cm|m|in|um", cloudfile_option_units, scans.unit_mm, 0,
           "the unit of the scans' coordinates (auto: detected); a unit\n"
           "stated in the file takes precedence"),
    SHARED("axes", "auto|scanner", cloudfile_option_axes, scans.frontal, 0,
           "auto: the face is found, in any orientation; scanner: x to the\n"
           "image's right, y up, z towards the scanner, nothing but the face"),
    SHARED("camera", "FX,FY,CX,CY", cloudfile_option_camera, scans.camera, 0,
           "for depth images: focal length and centre in pixels; add \",SCALE\"\n"
           "if the unit is not a millimetre, and \",WIDTH,HEIGHT\" for a file\n"
           "without a header (see the manual)"),
    SHARED("model", "FILE", command_text, model_path, 0,
           "a model that surfacelab train wrote; or set SURFACED_MODEL"),
    SHARED("out", "DIR|FILE", command_text, dir, 'o',
           "the folder or the file that is written"),
    SHARED("threads", "N", command_whole, threads, 0,
           "compute on N threads (one per core)"),
    SHARED("passphrase", NULL, command_flag, passphrase, 0,
           "encrypt with a passphrase: it is asked for, or read from --key"),
    SHARED("short-passphrase", NULL, command_flag, short_passphrase, 0,
           "accept a new passphrase of fewer than 12 characters"),
    SHARED("archive-key", "FILE", command_text, archive_key, 0,
           "a file with the archive's key or passphrase, instead of asking"),
    SHARED("expires", "TIME", read_expires, expires, 0,
           "the end: 90d, 12h or 30m from now, the end of 2027-01-31 (UTC),\n"
           "2027-01-31T14:30:00Z, or never"),
    SHARED("dry-run", NULL, command_flag, dry_run, 0,
           "show what would be done, without doing it"),
    SHARED("yes", NULL, command_flag, yes, 0, "do not ask for confirmation"),
    SHARED("force", NULL, command_flag, force, 0, "replace files that exist"),
    SHARED("json", NULL, command_flag, json, 0, "print the result as JSON"),
    SHARED("help", NULL, command_flag, help, 'h', "print this text"),
    SHARED("version", NULL, command_flag, version, 0, "print the version"),
};

const struct command_option *ctl_option_at(unsigned shared,
                                           const struct command_option *own, size_t i)
{
    for (size_t k = 0; k < NSHARED; k++)
        if ((shared >> k & 1) != 0 && i-- == 0)
            return &shared_options[k];
    for (; own != NULL && own->name != NULL; own++)
        if (i-- == 0)
            return own;
    return NULL;
}

const struct command_option *
ctl_option_find(unsigned shared, const struct command_option *own, const char *name)
{
    const struct command_option *o;

    for (size_t i = 0; (o = ctl_option_at(shared, own, i)) != NULL; i++)
        if (strcmp(o->name, name) == 0)
            return o;
    return NULL;
}
