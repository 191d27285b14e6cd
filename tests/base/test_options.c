/* link: -Wl,--wrap=calloc -Wl,--wrap=strdup */
/* The daemon's settings: the table, the defaults, settings that exclude each other, and
 * failed allocations. */
#include <unistd.h>

#include "fail_alloc.h"
#include "options.h"
#include "unit.h"

static struct options o;
static char path[] = "/tmp/options.XXXXXX", *said;

/* Loads the settings from a file of this text; `said` gets the problems. */
static bool load(const char *text, bool files)
{
    FILE *out = fopen(path, "w"), *errors;
    size_t len;

    assert_non_null(out);
    (void)fputs(text, out);
    (void)fclose(out);
    free(said);
    said = NULL;
    errors = open_memstream(&said, &len);
    assert_non_null(errors);
    options_free(&o);
    if (options_new(errors, &o)) {
        options_load(&o, path, NULL);
        if (files)
            options_check_files(&o);
    }
    (void)fclose(errors);
    return o.settings != NULL && settings_problems(o.settings) == 0;
}

static void refused(const char *text, const char *why)
{
    assert_false(load(text, false));
    if (strstr(said, why) == NULL)
        fail_msg("%s, not: %s", said, why);
}

BEFORE_ALL(begin)
{
    const int fd = mkstemp(path);

    for (size_t i = 0; i < OPTIONS_ROWS; i++) {
        char name[64] = "SURFACED_";

        for (const char *c = options_table[i].name; *c != '\0'; c++)
            (void)snprintf(name + strlen(name), 2, "%c",
                           *c == '-' ? '_' : *c - 'a' + 'A');
        (void)unsetenv(name);
    }
    assert_true(fd >= 0 && close(fd) == 0);
}

AFTER_ALL(end)
{
    options_free(&o);
    free(said);
    assert_int_equal(unlink(path), 0);
}

TEST(test_table)
{
    for (size_t i = 0; i < OPTIONS_ROWS; i++) {
        assert_non_null(options_table[i].name);
        assert_non_null(options_table[i].help);
        assert_true(options_table[i].offset < offsetof(struct options, listen));
        for (size_t k = 0; k < i; k++) {
            assert_string_not_equal(options_table[i].name, options_table[k].name);
            assert_true(options_table[i].offset != options_table[k].offset);
        }
    }
}

TEST(test_defaults)
{
    assert_true(load("db = /x/faces.db\nqueue = 9\n", false));
    assert_string_equal(o.db, "/x/faces.db");
    assert_null(o.key);
    assert_null(o.model);
    assert_string_equal(o.listen_text, "127.0.0.1:8787");
    assert_true(o.listen_len > 0);
    assert_int_equal(o.queue, 9);
    assert_int_equal(o.attempts, 3);
    assert_int_equal(o.attempt_wait, 30);
    assert_in_range(o.workers, 1, 256);
    assert_true(o.max_body == 64U << 20);
    assert_int_equal(o.max_connections_per_address, OPTIONS_UNSET);
    assert_false(o.no_auth || o.plaintext);
}

TEST(test_together)
{
    refused("queue = 9\n", "no database: give --db PATH");
    refused("db = postgresql://u:secret@h/f\n", "the URL of the database has a password");
    refused("db = postgresql://u@h/f?password=secret\n",
            "the URL of the database has a password");
    refused("db = x\ntls-cert = c\n", "--tls-cert and --tls-key go together");
    refused("db = x\ntls-client-ca = c\n", "--tls-client-ca needs --tls-cert");
    refused("db = x\nplaintext = 1\ntls-cert = c\ntls-key = k\n",
            "--plaintext contradicts");
    refused("db = x\nlisten = 0.0.0.0:1\n", "listen = 0.0.0.0:1: not a loopback address");
    refused("db = x\nlisten = 0.0.0.0:1\nplaintext = 1\nno-auth = 1\n",
            "--no-auth is for loopback only");
    assert_true(load("db = x\nlisten = 0.0.0.0:1\nplaintext = 1\n", false));
    assert_true(load("db = x\nno-auth = 1\n", false));
    refused("db = x\nproxy-protocol = 10.0.0.1/8\n",
            "proxy-protocol = 10.0.0.1/8: not addresses like 192.0.2.1");
    assert_true(load("db = x\nproxy-protocol = 10.0.0.0/8,::1,unix\n", false));
}

TEST(test_files)
{
    char text[200];

    (void)snprintf(text, sizeof text, "db = /tmp/none.db\nmodel = %s\n", path);
    assert_true(load(text, false));
    assert_false(load(text, true)); /* the file of the settings is no model */
    assert_non_null(strstr(said, "line 1: not a model"));
    assert_true(load("db = /tmp/none.db\nmodel = core/face/default.model\n", true));
    assert_false(load("db = /nowhere/none.db\n", true));
}

TEST(test_memory)
{
    unsigned long failing;
    bool good;

    for (failing = 1;; failing++) {
        fail_alloc_at(failing);
        good = load("db = x\n", false);
        if (fail_alloc_count() < failing)
            break;
        assert_false(good);
        assert_true(o.settings == NULL || strstr(said, "out of memory") != NULL);
    }
    assert_true(good && failing > OPTIONS_ROWS / 2);
    fail_alloc_at(0);
}
