/* surfacectl -- administer a template database from the command line, beside a running
 * daemon or without one. */
#include "surfacectl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "keyfile.h"

enum { /* options that not every command takes */
       OPT_DB = 1,
       OPT_UNITS = 2,
       OPT_LABEL = 4,
       OPT_FORCE = 8,
       OPT_THRESHOLD = 16,
       OPT_YES = 32,
       OPT_OUT = 64,
       OPT_IMPOSTORS = 128,
       OPT_THREADS = 256,
       OPT_FMR = 512,
       OPT_GENUINE = 1024,
       OPT_DRY_RUN = 2048,
       OPT_LIST = 4096,
       OPT_RESET = 8192,
       OPT_MODEL = 16384,
       OPT_SCOPE = 32768,
       OPT_EXPIRES = 65536,
       OPT_GRACE = 131072,
       OPT_TOLERANCE = 262144,
       OPT_MEAN = 524288,
       OPT_INIT = 1048576,
       OPT_KEY = 2097152,
       OPT_NEW_KEY = 4194304,
       OPT_KEEP_OLD = 8388608
};

struct command {
    const char *name, *args, *summary, *help, *example;
    int min, max; /* arguments */
    unsigned options;
    int (*run)(struct surfacectl *c);
};

static const struct command commands[] = {
    {"init", "", "make a new database",
     "What it says of people is sealed with a key in the file PATH.key, or --key, which is\n"
     "made: keep a copy of it elsewhere, since without it nothing in the database can be\n"
     "read.  --passphrase asks for one instead; --plaintext leaves the key in the database.\n"
     "A database that is there already is left as it is.",
     "surfacectl --db faces.db init", 0, 0, OPT_DB | OPT_INIT, surfacectl_admin_init},
    {"migrate", "", "upgrade a database of an older version",
     "In one transaction.  What it says of people is sealed from then on, as with init.  A\n"
     "verified copy of the old database is kept as PATH.v3.bak: what stood open in it still\n"
     "does there.  Delete it when all is well.",
     "surfacectl --db faces.db migrate --dry-run", 0, 0, OPT_DB | OPT_INIT | OPT_DRY_RUN,
     surfacectl_admin_migrate},
    {"enroll", "SUBJECT FILE...", "enroll scans of a subject",
     "Each FILE (PLY, OBJ or XYZ; - is standard input) becomes a template.  The same scan\n"
     "again changes nothing.  A scan that matches none of the subject's others, or has too\n"
     "little in common with them to tell, is refused, unless --force is given.  A bad scan\n"
     "does not stop the others.",
     "surfacectl --db faces.db enroll alice alice-1.ply alice-2.ply", 2, 1 << 30,
     OPT_DB | OPT_UNITS | OPT_LABEL | OPT_FORCE | OPT_MODEL, surfacectl_face_enroll},
    {"verify", "SUBJECT FILE", "compare a scan with a subject's templates",
     "The template with the lowest disparity decides.  Exit: 0 match, 1 no match,\n"
     "2 inconclusive.",
     "surfacectl --db faces.db verify alice probe.ply", 2, 2,
     OPT_DB | OPT_UNITS | OPT_THRESHOLD | OPT_MODEL, surfacectl_face_verify},
    {"compare", "A B", "compare two scans; no database is needed",
     "B is moved onto A.  Exit: 0 match, 1 no match, 2 inconclusive.",
     "surfacectl compare monday.ply tuesday.ply", 2, 2,
     OPT_UNITS | OPT_THRESHOLD | OPT_MODEL, surfacectl_face_compare},
    {"explain", "A B", "compare two scans and show where they differ",
     "B is moved onto A.  With --db, A is a subject or a template; else a scan.  Writes\n"
     "into a directory: explain.txt and explain.json, gap.ply (the points of B, coloured\n"
     "by the signed gap), and by gnuplot gap.png and histogram.png.  They are biometric\n"
     "data: readable by their owner alone.  Exit: 0 match, 1 no match, 2 inconclusive.",
     "surfacectl explain monday.ply tuesday.ply --out why", 2, 2,
     OPT_UNITS | OPT_THRESHOLD | OPT_OUT | OPT_MODEL, surfacectl_explain},
    {"asymmetry", "FILE", "measure a scan against its own mirror image",
     "The symmetry plane is corrected until the gap between the face and its mirror image is\n"
     "least; that gap is the asymmetry.  Nothing is stored.  Exit: 0, or 2 where too little\n"
     "of the face lies over its mirror image to say.",
     "surfacectl asymmetry alice.ply", 1, 1, OPT_UNITS | OPT_MODEL,
     surfacectl_shape_asymmetry},
    {"simplify", "FILE", "keep the points that a scan's surface needs",
     "Points are taken out one by one, the least needed first, as long as the surface of the\n"
     "others stays within --tolerance of the scan's at each of its points; with --mean, in\n"
     "the mean over its area.  What is left is written to the file --out (PLY, with the\n"
     "triangles).  Spikes are laid flat first.",
     "surfacectl simplify alice.ply --tolerance 0.3 --out small.ply", 1, 1,
     OPT_UNITS | OPT_OUT | OPT_MODEL | OPT_TOLERANCE | OPT_MEAN,
     surfacectl_shape_simplify},
    {"evaluate", "DIR|MANIFEST", "how well a collection of scans is told apart",
     "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table,\n"
     "with columns file and subject.  Of each subject the scan of kind `enroll`, or else\n"
     "the first, is enrolled in memory and compared with the others and with other\n"
     "subjects'.  Writes into a directory: report.md, report.json, scores.csv (every\n"
     "comparison), rates.csv, and by gnuplot det and scores as .svg and .png.  With --db\n"
     "its calibration decides.  surfacectl(1) says more.",
     "surfacectl evaluate scans --out evaluation", 1, 1,
     OPT_UNITS | OPT_THRESHOLD | OPT_OUT | OPT_IMPOSTORS | OPT_THREADS | OPT_MODEL,
     surfacectl_evaluate},
    {"train", "DIR|MANIFEST", "learn a model from a collection of scans",
     "DIR or MANIFEST as for evaluate.  Learns the mean face, what a face does between two\n"
     "scans of one person, and the weight of each place; tells the error rates before and\n"
     "after, the latter on people it was not learned from, and writes the model to the file\n"
     "--out (./faces.model), for --model of the other commands and of surfaced.  It takes\n"
     "20 subjects and 250 scans besides the enrolled ones, at least; hundreds of subjects\n"
     "are better.  --label names the model; --model is the one to begin with.",
     "surfacectl train scans/ --label 'door scanner' --out door.model", 1, 1,
     OPT_UNITS | OPT_LABEL | OPT_OUT | OPT_THREADS | OPT_MODEL, surfacectl_train},
    {"list", "", "list the subjects", "In order of their ids.",
     "surfacectl --db faces.db list", 0, 0, OPT_DB, surfacectl_admin_list},
    {"show", "ID", "describe a subject or a template",
     "ID is a subject's, or else a template's.", "surfacectl --db faces.db show alice", 1,
     1, OPT_DB, surfacectl_admin_show},
    {"delete", "ID", "delete a subject with all its templates, or one template",
     "ID is a subject's, or else a template's.  Asks for the id again on a terminal;\n"
     "elsewhere --yes is needed.",
     "surfacectl --db faces.db --yes delete alice", 1, 1, OPT_DB | OPT_YES,
     surfacectl_admin_delete},
    {"check", "", "read everything and verify it; changes nothing",
     "The database's integrity, references and schema; of each template the checksum,\n"
     "triangulation (Delaunay), spanning tree (minimal), digest and counts.\n"
     "Exit: 0 all is well, 1 problems were found.",
     "surfacectl --db faces.db check", 0, 0, OPT_DB, surfacectl_admin_check},
    {"calibrate", "[--list | --reset]", "a threshold from the database's own faces",
     "Templates of different subjects are compared with each other; the threshold is where\n"
     "the wanted share of them would be accepted.  Subjects with several templates, and the\n"
     "scans of --genuine (a folder or a CSV file: file, subject), tell how many of the right\n"
     "people are refused.  A running daemon decides by it at once.  --list shows what was in\n"
     "force when, --reset goes back to the table that comes with the program.",
     "surfacectl --db faces.db calibrate --fmr 0.01 --dry-run", 0, 0,
     OPT_DB | OPT_UNITS | OPT_THREADS | OPT_FMR | OPT_GENUINE | OPT_DRY_RUN | OPT_LIST |
         OPT_RESET | OPT_MODEL,
     surfacectl_calibrate},
    {"backup", "FILE", "copy the database, also while the daemon runs",
     "A copy of one moment, verified before it gets its name: every page, every subject and\n"
     "template opened with the key, the end of the events.  FILE is whole or not there; an\n"
     "older backup of that name is replaced.  The key is not in it.",
     "surfacectl --db faces.db backup faces-monday.db", 1, 1, OPT_DB, surfacectl_backup},
    {"restore", "FILE", "put a backup in the place of the database",
     "FILE is verified first.  Whoever was erased since is erased in it too; tokens keep the\n"
     "secrets that they have now, and revoked ones stay revoked.  The database that is there\n"
     "is kept as PATH.before-restore.  Stop the daemon first.  --dry-run says what would\n"
     "change.",
     "surfacectl --db faces.db restore faces-monday.db --dry-run", 1, 1,
     OPT_DB | OPT_DRY_RUN, surfacectl_backup_restore},
    {"rekey", "", "another key for the database",
     "A new random key takes the place of the old one in PATH.key, or --key; or the one in the\n"
     "file --new-key does.  With --passphrase it is a passphrase, asked for or in --new-key;\n"
     "with --plaintext it lies in the database.  A running daemon reads it from the file by\n"
     "itself.  Backups are still opened by the key that they were made with: --keep-old.",
     "surfacectl --db faces.db rekey", 0, 0,
     OPT_DB | OPT_INIT | OPT_NEW_KEY | OPT_KEEP_OLD, surfacectl_rekey},
    {"stats", "", "how much there is of everything", "Counts and sizes.",
     "surfacectl --db faces.db stats", 0, 0, OPT_DB, surfacectl_admin_stats},
    {"token", "create [NAME] | list | rotate ID | revoke ID",
     "Bearer tokens for the daemon",
     "The token is printed once, on standard output; only a hash of it is kept.  It may do\n"
     "everything, for ever, unless --scope and --expires say otherwise.  rotate gives the\n"
     "same token another secret; the old one counts no more, or not after --grace.  A\n"
     "running daemon sees every change at once.",
     "surfacectl --db faces.db token create --scope verify --expires 90d front-door", 1,
     2, OPT_DB | OPT_SCOPE | OPT_EXPIRES | OPT_GRACE, surfacectl_token},
    {"attempts", "list | reset SUBJECT",
     "failed verifications, which make the daemon wait",
     "After some that failed in a row the daemon takes no verification of the subject for a\n"
     "while.  list shows how many there are; reset forgets them, so that the next one is\n"
     "taken at once.",
     "surfacectl --db faces.db attempts reset alice", 1, 2, OPT_DB, surfacectl_attempts},
};

#define COMMANDS (sizeof commands / sizeof *commands)

static const char exit_help[] =
    "Exit codes:\n"
    "   0  done; verify, compare, explain: match\n"
    "   1  verify, compare, explain: no match; check: problems found\n"
    "   2  verify, compare, explain, asymmetry: inconclusive (too little in common)\n"
    "  64  the command line is wrong\n"
    "  65  a scan, a model or the database is malformed or cannot be used\n"
    "  66  no such file, model, subject, template, token or database\n"
    "  70  a defect of this program or an error of the database engine\n"
    "  71  out of memory\n"
    "  74  reading or writing failed, disk full\n"
    "  75  the database is locked by another process; try again\n"
    "  77  not permitted\n";

static const struct {
    unsigned option;
    const char *text;
} option_help[] = {
    {OPT_DB, "  --db PATH           the database; or set SURFACED_DB\n"},
    {OPT_DB,
     "  --key FILE          the database's key or passphrase (PATH.key); or set SURFACED_KEY\n"},
    {OPT_UNITS, "  --units mm|cm|m     of the scans' coordinates (mm)\n"},
    {OPT_LABEL,
     "  --label TEXT        a note kept with each template; of train, the model's name\n"},
    {OPT_FORCE,
     "  --force             enroll scans that do not fit the subject's others\n"},
    {OPT_THRESHOLD,
     "  --threshold-mm MM   decide by another threshold than the default\n"},
    {OPT_OUT,
     "  --out DIR|FILE      where the files go (./explanation, ./evaluation); of train,\n"
     "                      the model's file (./faces.model); of simplify, the scan's\n"},
    {OPT_MODEL,
     "  --model FILE        judge by a model that surfacectl train wrote; or set\n"
     "                      SURFACED_MODEL\n"},
    {OPT_IMPOSTORS,
     "  --impostors N       compare each probe with N other subjects (all, up to 200,000\n"
     "                      comparisons)\n"},
    {OPT_THREADS, "  --threads N         work on N threads (one a core)\n"},
    {OPT_FMR, "  --fmr RATE          the false match rate that is wanted (0.001)\n"},
    {OPT_GENUINE, "  --genuine MANIFEST  further scans of the subjects\n"},
    {OPT_DRY_RUN, "  --dry-run           show, store nothing\n"},
    {OPT_LIST, "  --list              list the calibrations\n"},
    {OPT_RESET, "  --reset             back to the shipped table\n"},
    {OPT_TOLERANCE, "  --tolerance MM      the largest gap that may open\n"},
    {OPT_MEAN,
     "  --mean              the tolerance is for the mean gap, the disparity\n"},
    {OPT_YES, "  --yes               do not ask\n"},
    {OPT_INIT,
     "  --passphrase        seal with a passphrase: asked for, or the line in --key FILE\n"
     "  --plaintext         leave the key in the database: whoever has the file can read it\n"},
    {OPT_NEW_KEY,
     "  --new-key FILE      the new key, or passphrase, is this file's line\n"},
    {OPT_KEEP_OLD, "  --keep-old          keep the old key's file, as FILE.old\n"},
    {OPT_SCOPE,
     "  --scope LIST        what a token may do: enroll,verify,identify,read,delete (all)\n"},
    {OPT_EXPIRES,
     "  --expires TIME      how long it is good for: 90d, 12h, 30m, never (never)\n"},
    {OPT_GRACE,
     "  --grace TIME        of rotate: how long the old secret still counts\n"},
};

static void print_options(unsigned options)
{
    (void)printf("Options (before or after the command):\n");
    for (size_t i = 0; i < sizeof option_help / sizeof *option_help; i++)
        if (options & option_help[i].option)
            (void)printf("%s", option_help[i].text);
    (void)printf("  --json              print JSON\n"
                 "  --help              this text\n"
                 "  --version           the version\n\n");
}

static void print_help(const struct command *cmd)
{
    if (cmd == NULL) {
        (void)printf("Usage: surfacectl [--db PATH] [--json] COMMAND [ARGUMENT...]\n\n"
                     "Commands (surfacectl COMMAND --help says more):\n");
        for (size_t i = 0; i < COMMANDS; i++)
            (void)printf("  %-9s %-15s %s\n", commands[i].name,
                         strlen(commands[i].args) > 15 ? "..." : commands[i].args,
                         commands[i].summary);
        (void)printf("\n");
        print_options(~0U);
        (void)printf("Example:\n  surfacectl --db faces.db init\n"
                     "  surfacectl --db faces.db enroll alice alice.ply\n"
                     "  surfacectl --db faces.db verify alice probe.ply\n\n%s",
                     exit_help);
        return;
    }
    (void)printf("Usage: surfacectl %s%s %s\n\n%c%s.\n%s\n\n", cmd->name,
                 cmd->options & OPT_DB ? " --db PATH" : "", cmd->args,
                 cmd->summary[0] >= 'a' ? cmd->summary[0] - 'a' + 'A' : cmd->summary[0],
                 cmd->summary + 1, cmd->help);
    print_options(cmd->options);
    (void)printf("Example:\n  %s\n\n%s", cmd->example, exit_help);
}

static void print_version(void)
{
    const char *version = strchr(FACE_ENGINE, '/') + 1;

    (void)printf("surfacectl %.*s (%s)\n", (int)strcspn(version, " "), version,
                 FACE_ENGINE);
}

/* ---- command line */

struct line {
    struct surfacectl c;
    const struct command *cmd;
    unsigned given; /* options */
    bool help, version;
};

static bool usage(struct errinfo *e, const char *what, const char *which)
{
    (void)errinfo_set(e, ST_EINVAL, "%s %.80s (surfacectl --help)", what, which);
    return false;
}

/* Does argument i name the option, with its value in *value (the next argument's or that
 * after "=")?  *i moves on. */
static bool valued(int argc, char **argv, int *i, const char *name, const char **value)
{
    const size_t n = strlen(name);

    if (strncmp(argv[*i], name, n) != 0)
        return false;
    if (argv[*i][n] == '=') {
        *value = argv[*i] + n + 1;
        return true;
    }
    if (argv[*i][n] != '\0')
        return false;
    *value = *i + 1 < argc ? argv[++*i] : NULL;
    return true;
}

static bool number(const char *text, double most, double *out)
{
    char *end;

    *out = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*out) && *out > 0 && *out <= most;
}

static bool whole(const char *text, uint32_t *out)
{
    char *end;
    const long n = strtol(text, &end, 10);

    *out = (uint32_t)n;
    return end != text && *end == '\0' && n >= 1 && n <= 1000000;
}

/* "90d", "12h", "30m", "20s" in seconds; "never" is 0. */
static bool duration(const char *text, bool never, int64_t *out)
{
    static const struct {
        char unit;
        int64_t s;
    } units[] = {{'s', 1}, {'m', 60}, {'h', 3600}, {'d', 86400}};
    char *end;
    long n;

    *out = 0;
    if (never && strcmp(text, "never") == 0)
        return true;
    if (*text < '0' || *text > '9')
        return false;
    n = strtol(text, &end, 10);
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (end[0] == units[i].unit && end[1] == '\0') {
            if (n < 1 || n > STORE_LIFE_MAX / units[i].s)
                return false;
            *out = n * units[i].s;
            return true;
        }
    return false;
}

/* Options of tokens, with a value; false where it is none that can be. */
static bool read_token_option(unsigned option, const char *value, struct line *l)
{
    if (option == OPT_SCOPE)
        return store_scopes_read(value, &l->c.scopes) ||
               usage(&l->c.e, "scopes are enroll,verify,identify,read,delete, not",
                     value);
    if (option == OPT_EXPIRES)
        return duration(value, true, &l->c.life_s) ||
               usage(&l->c.e, "--expires is like 90d, 12h, 30m or never, not", value);
    return duration(value, false, &l->c.grace_s) ||
           usage(&l->c.e, "--grace is like 1d, 12h or 30m, not", value);
}

/* Options with a value.  Returns the option, 0 when it is none. */
static unsigned read_valued(int argc, char **argv, int *i, struct line *l, bool *ok)
{
    static const struct {
        const char *name;
        unsigned option;
    } options[] = {{"--db", OPT_DB},
                   {"--key", OPT_KEY},
                   {"--new-key", OPT_NEW_KEY},
                   {"--units", OPT_UNITS},
                   {"--label", OPT_LABEL},
                   {"--out", OPT_OUT},
                   {"-o", OPT_OUT},
                   {"--tolerance", OPT_TOLERANCE},
                   {"--impostors", OPT_IMPOSTORS},
                   {"--threads", OPT_THREADS},
                   {"--fmr", OPT_FMR},
                   {"--genuine", OPT_GENUINE},
                   {"--model", OPT_MODEL},
                   {"--scope", OPT_SCOPE},
                   {"--expires", OPT_EXPIRES},
                   {"--grace", OPT_GRACE},
                   {"--threshold-mm", OPT_THRESHOLD}};
    const char *value, *name = argv[*i];

    for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
        if (!valued(argc, argv, i, options[k].name, &value))
            continue;
        if (value == NULL) {
            *ok = usage(&l->c.e, "a value is missing after", name);
        } else if (options[k].option == OPT_DB) {
            l->c.db = value;
        } else if (options[k].option == OPT_KEY) {
            l->c.key = value;
        } else if (options[k].option == OPT_NEW_KEY) {
            l->c.new_key = value;
        } else if (options[k].option == OPT_TOLERANCE) {
            if (!number(value, 999, &l->c.tolerance_mm))
                *ok = usage(&l->c.e, "a tolerance is millimetres above 0, not", value);
        } else if (options[k].option >= OPT_SCOPE) {
            *ok = read_token_option(options[k].option, value, l);
        } else if (options[k].option == OPT_LABEL) {
            l->c.label = value;
        } else if (options[k].option == OPT_OUT) {
            l->c.dir = value;
        } else if (options[k].option == OPT_IMPOSTORS) {
            if (!whole(value, &l->c.impostors))
                *ok = usage(&l->c.e, "impostors are 1 to 1000000, not", value);
        } else if (options[k].option == OPT_THREADS) {
            if (!whole(value, &l->c.threads))
                *ok = usage(&l->c.e, "threads are 1 to 1000000, not", value);
        } else if (options[k].option == OPT_GENUINE) {
            l->c.genuine = value;
        } else if (options[k].option == OPT_MODEL) {
            l->c.model_path = value;
        } else if (options[k].option == OPT_FMR) {
            if (!number(value, 0.5, &l->c.fmr))
                *ok = usage(&l->c.e, "a rate is above 0 and at most 0.5, not", value);
        } else if (options[k].option == OPT_UNITS) {
            l->c.units = value;
            if (strcmp(value, "mm") != 0 && strcmp(value, "cm") != 0 &&
                strcmp(value, "m") != 0)
                *ok = usage(&l->c.e, "units are mm, cm or m, not", value);
        } else if (!number(value, 999, &l->c.threshold_mm)) {
            *ok = usage(&l->c.e, "a threshold is millimetres above 0, not", value);
        }
        return options[k].option;
    }
    return 0;
}

static bool read_option(int argc, char **argv, int *i, struct line *l)
{
    const struct {
        const char *name;
        unsigned option; /* 0: every command takes it */
        bool *flag;
    } flags[] = {{"--json", 0, &l->c.json},
                 {"--yes", OPT_YES, &l->c.yes},
                 {"--force", OPT_FORCE, &l->c.force},
                 {"--dry-run", OPT_DRY_RUN, &l->c.dry_run},
                 {"--list", OPT_LIST, &l->c.list},
                 {"--reset", OPT_RESET, &l->c.reset},
                 {"--mean", OPT_MEAN, &l->c.mean},
                 {"--keep-old", OPT_KEEP_OLD, &l->c.keep_old},
                 {"--plaintext", OPT_INIT, &l->c.plaintext},
                 {"--passphrase", OPT_INIT, &l->c.passphrase}};
    const char *name = argv[*i];
    bool ok = true, *flag = NULL;
    unsigned option = 0;

    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        l->help = true;
        return true;
    }
    if (strcmp(name, "--version") == 0) {
        l->version = true;
        return true;
    }
    for (size_t k = 0; k < sizeof flags / sizeof *flags && flag == NULL; k++)
        if (strcmp(name, flags[k].name) == 0) {
            flag = flags[k].flag;
            option = flags[k].option;
        }
    if (flag == NULL && (option = read_valued(argc, argv, i, l, &ok)) == 0)
        return usage(&l->c.e, "there is no option", name);
    if (ok && ((flag != NULL && *flag) || (l->given & option)))
        return usage(&l->c.e, "given twice:", name);
    if (flag != NULL)
        *flag = true;
    l->given |= option;
    return ok;
}

/* Options may stand anywhere; "--" ends them.  What is no option is moved to the front. */
static bool read_line(int argc, char **argv, struct line *l)
{
    bool options = true;
    int n = 0;

    for (int i = 1; i < argc; i++) {
        if (options && strcmp(argv[i], "--") == 0) {
            options = false;
        } else if (options && argv[i][0] == '-' && argv[i][1] != '\0') {
            if (!read_option(argc, argv, &i, l))
                return false;
        } else {
            argv[n++] = argv[i];
        }
    }
    l->c.args = argv + 1;
    l->c.nargs = n - 1;
    if (n == 0)
        return l->help || l->version || usage(&l->c.e, "which command?", "");
    for (size_t i = 0; i < COMMANDS; i++)
        if (strcmp(argv[0], commands[i].name) == 0)
            l->cmd = &commands[i];
    if (l->cmd == NULL)
        return usage(&l->c.e, "there is no command", argv[0]);
    if (l->help || l->version)
        return true;
    if (l->c.nargs < l->cmd->min || l->c.nargs > l->cmd->max) {
        (void)errinfo_set(&l->c.e, ST_EINVAL, "it is: surfacectl %s %s", l->cmd->name,
                          l->cmd->args);
        return false;
    }
    if (l->given & ~(l->cmd->options | OPT_DB | OPT_KEY)) {
        (void)errinfo_set(&l->c.e, ST_EINVAL,
                          "an option that %s does not take (surfacectl %s --help)",
                          l->cmd->name, l->cmd->name);
        return false;
    }
    return true;
}

static void print_error(struct surfacectl *c, int code)
{
    (void)fflush(stdout);
    (void)fprintf(stderr, "surfacectl: %s\n", c->e.msg);
    surfacectl_out_object(c->out, "error");
    surfacectl_out_text(c->out, "detail", c->e.msg);
    surfacectl_out_number(c->out, "exit", code);
    surfacectl_out_close(c->out);
}

/* NULL where it is not set, or empty. */
static const char *environment(const char *name)
{
    const char *value = getenv(name);

    return value != NULL && value[0] != '\0' ? value : NULL;
}

int main(int argc, char **argv)
{
    struct line l = {.c.life_s = -1};
    struct model *model = NULL;
    bool ok = read_line(argc, argv, &l);
    int code = EXIT_USAGE;

    if (ok && l.version) {
        print_version();
        return EXIT_FINE;
    }
    if (ok && l.help) {
        print_help(l.cmd);
        return EXIT_FINE;
    }
    if (ok && (l.cmd->options & OPT_DB) && l.c.db == NULL &&
        (l.c.db = environment("SURFACED_DB")) == NULL)
        ok = usage(&l.c.e, "which database?  --db PATH or SURFACED_DB", "");
    if ((l.c.out = surfacectl_out_new(l.c.json)) == NULL) {
        (void)fprintf(stderr, "surfacectl: out of memory\n");
        return EXIT_OSERR;
    }
    if (ok && (l.cmd->options & OPT_MODEL) && l.c.model_path == NULL)
        l.c.model_path = environment("SURFACED_MODEL");
    if (ok && l.c.key == NULL)
        l.c.key = environment("SURFACED_KEY");
    if (ok) {
        const enum status st = surfacectl_model_read(&l.c, &model);

        code = st == ST_OK ? l.cmd->run(&l.c) : surfacectl_fail(&l.c, st);
    }
    free(model);
    keyfile_free(l.c.asked);
    if (code > EXIT_INCONCLUSIVE)
        print_error(&l.c, code);
    if (!surfacectl_out_end(l.c.out, stdout)) {
        (void)fprintf(stderr, "surfacectl: the output cannot be written\n");
        return code > EXIT_INCONCLUSIVE ? code : EXIT_IOERR;
    }
    return code;
}
