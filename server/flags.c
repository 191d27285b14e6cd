#include "flags.h"

#include <getopt.h>
#include <stddef.h>

#include "libsurface.h"
#include "options.h"

enum { HELP = OPTIONS_ROWS, VERSION, CONFIG, CHECK, PRINT, CREATE, FLAGS };

static const char *const command[FLAGS - OPTIONS_ROWS] = {
    "help", "version", "config", "check-config", "print-config", "create"};

static void usage(void)
{
    (void)fputs("Usage: surfaced --db PATH [OPTION]...\n"
                "Verify faces by the shape of their surface, over HTTP.\n"
                "\n",
                stdout);
    settings_help(options_table, OPTIONS_ROWS, stdout);
    (void)fputs(
        "  --create             make the database and its key if neither exists\n"
        "  --config FILE        read the settings from FILE (" OPTIONS_FILE ")\n"
        "  --check-config       check the settings, and exit\n"
        "  --print-config       print the settings as a file, and exit\n"
        "  --help, --version    print this, or the version, and exit\n"
        "\n"
        "The file has settings as NAME = VALUE, the environment as SURFACED_NAME:\n"
        "SURFACED_MAX_BODY=1M, SURFACED_NO_AUTH=1.  An option overrides the environment,\n"
        "and the environment the file.  On SIGTERM or SIGINT the daemon finishes the\n"
        "running requests and stops.  Exit status: 0 after a clean stop, 1 if it could not\n"
        "start or continue, 64 for a bad setting.\n",
        stdout);
}

/* The command line: value[i] of each flag that is there. */
static void read_flags(int argc, char **argv, struct settings *s,
                       const char *value[FLAGS])
{
    struct option longopts[FLAGS + 1] = {{0}};
    int flag;

    for (int i = 0; i < FLAGS; i++) {
        const bool wants = i < OPTIONS_ROWS ? options_table[i].arg != NULL : i == CONFIG;

        longopts[i] = (struct option){i < OPTIONS_ROWS ? options_table[i].name
                                                       : command[i - OPTIONS_ROWS],
                                      wants ? required_argument : no_argument, NULL, i};
    }
    opterr = 0;
    optind = 1;
    while ((flag = getopt_long_only(argc, argv, ":", longopts, NULL)) != -1) {
        if (flag == '?')
            settings_wrong(s, "%s: no such option; see --help", argv[optind - 1]);
        else if (flag == ':')
            settings_wrong(s, "%s: its value is missing", argv[optind - 1]);
        else if (value[flag] != NULL)
            settings_wrong(s, "--%s is given twice", longopts[flag].name);
        else
            value[flag] = optarg != NULL ? optarg : "1";
    }
    for (; optind < argc; optind++)
        settings_wrong(s, "%s: not an option; see --help", argv[optind]);
    if (value[CHECK] != NULL && value[PRINT] != NULL)
        settings_wrong(s, "use either --check-config or --print-config");
}

enum flags_outcome flags_read(int argc, char **argv, FILE *errors, struct options *out)
{
    const char *value[FLAGS] = {NULL};
    struct settings *s;

    if (!options_new(errors, out)) {
        (void)fputs("surfaced: out of memory\n", errors);
        return FLAGS_BAD;
    }
    s = out->settings;
    read_flags(argc, argv, s, value);
    if (settings_problems(s) > 0)
        return FLAGS_BAD;
    if (value[HELP] != NULL) {
        usage();
        return FLAGS_DONE;
    }
    if (value[VERSION] != NULL) {
        (void)puts(SURFACE_ENGINE);
        return FLAGS_DONE;
    }
    options_load(out, value[CONFIG], value);
    out->create = value[CREATE] != NULL;
    if (value[CHECK] != NULL)
        options_check_files(out);
    if (settings_problems(s) > 0)
        return FLAGS_BAD;
    if (value[CHECK] != NULL)
        return FLAGS_CHECK;
    if (value[PRINT] == NULL)
        return FLAGS_RUN;
    settings_print(s, stdout);
    return FLAGS_DONE;
}
