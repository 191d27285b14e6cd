/* Settings by name: which member each fills, which source wins, and the message for each
 * bad value. */
#include "address.h"
#include "settings.h"
#include "unit.h"

struct all {
    const char *text, *file, *path, *address;
    unsigned number, choice;
    size_t bytes;
    bool yes;
};

enum { TEXT, KEY, PATH, LISTEN, NUMBER, BYTES, YES, LOG };
static const struct setting table[] = {
    {"text", SETTING_TEXT, NULL, offsetof(struct all, text), 0, 0, "TEXT", "a word"},
    {"key", SETTING_FILE, NULL, offsetof(struct all, file), 0, 0, "FILE", "a file"},
    {"db", SETTING_PATH, NULL, offsetof(struct all, path), 0, 0, "PATH", "a path"},
    {"listen", SETTING_ADDRESS, "127.0.0.1:1", offsetof(struct all, address), 0, 0,
     "ADDRESS:PORT", "an address,\nor more"},
    {"some-number", SETTING_NUMBER, "4", offsetof(struct all, number), 2, 256, "N", "n"},
    {"bytes", SETTING_BYTES, "64M", offsetof(struct all, bytes), 1, 1UL << 30, "N", "n"},
    {"yes", SETTING_BOOL, "0", offsetof(struct all, yes), 0, 0, NULL, "yes"},
    {"log", SETTING_CHOICE, "logfmt", offsetof(struct all, choice), 0, 0, "logfmt|json",
     "how"},
};
#define ROWS (sizeof table / sizeof table[0])

static struct settings *s;
static FILE *errors;
static char *said;
static size_t said_len;

BEFORE_EACH(begin)
{
    (void)unsetenv("CREDENTIALS_DIRECTORY");
    errors = open_memstream(&said, &said_len);
    assert_non_null(errors);
    assert_true(settings_new(table, ROWS, errors, &s));
}

AFTER_EACH(end)
{
    settings_free(s);
    (void)fclose(errors);
    free(said);
}

static void read_text(const char *text)
{
    FILE *in = tmpfile();

    assert_non_null(in);
    assert_int_equal(fputs(text, in) < 0, 0);
    rewind(in);
    settings_read(s, in, "the.conf");
    (void)fclose(in);
}

/* The problems so far are exactly these lines. */
static void assert_said(unsigned n, const char *lines)
{
    (void)fflush(errors);
    assert_string_equal(said, lines);
    assert_int_equal(settings_problems(s), n);
}

TEST(test_fill)
{
    struct all a = {.text = "before", .choice = 7};

    settings_fill(s, &a);
    assert_string_equal(a.text, "before"); /* it is unset */
    assert_string_equal(a.address, "127.0.0.1:1");
    assert_int_equal(a.number, 4);
    assert_int_equal(a.bytes, 64 << 20);
    assert_int_equal(a.choice, 0);
    assert_false(a.yes);
    read_text("text = a ;b # c\nkey=/k\ndb = x y\nlisten=[::1]:2\nsome-number=256\n"
              "bytes=3K\nyes=1\nlog=json");
    assert_said(0, "");
    settings_fill(s, &a);
    assert_string_equal(a.text, "a ;b # c");
    assert_string_equal(a.file, "/k");
    assert_string_equal(a.path, "x y");
    assert_string_equal(a.address, "[::1]:2");
    assert_int_equal(a.number, 256);
    assert_int_equal(a.bytes, 3072);
    assert_int_equal(a.choice, 1);
    assert_true(a.yes);
}

TEST(test_strength)
{
    struct all a = {0};
    char *out;
    size_t len;
    FILE *to = open_memstream(&out, &len);

    read_text("some-number = 5\nbytes = 1\nlog = json\n");
    assert_int_equal(setenv("SURFACED_BYTES", "2", 1), 0);
    assert_int_equal(setenv("SURFACED_SOME_NUMBER", "6", 1), 0);
    assert_int_equal(setenv("SURFACED_LOG", "", 1), 0);
    settings_environment(s);
    (void)unsetenv("SURFACED_BYTES");
    (void)unsetenv("SURFACED_SOME_NUMBER");
    (void)unsetenv("SURFACED_LOG");
    settings_flag(s, NUMBER, "7");
    settings_fill(s, &a);
    assert_int_equal(a.number, 7);
    assert_int_equal(a.bytes, 2);
    assert_int_equal(a.choice, 1);
    settings_print(s, to);
    (void)fclose(to);
    assert_string_equal(out, "# not set\n#text =\n"
                             "# not set\n#key =\n"
                             "# not set\n#db =\n"
                             "# default\nlisten = 127.0.0.1:1\n"
                             "# --some-number\nsome-number = 7\n"
                             "# SURFACED_BYTES\nbytes = 2\n"
                             "# default\nyes = 0\n"
                             "# the.conf:3\nlog = json\n");
    free(out);
    assert_said(0, "");
}

TEST(test_refused)
{
    struct all a = {0};

    read_text("text =\nsome-number = 1\nbytes = 1T\nyes = yes\nlog = xml\nlisten = 1\n");
    settings_flag(s, BYTES, "17179869184G"); /* 2^64 */
    settings_flag(s, LOG, "logfm");
    settings_flag(s, LOG, "");
    settings_flag(s, LOG, "logfmt|json");
    settings_flag(s, NUMBER, "4K");
    settings_flag(s, TEXT, "a\nb");
    settings_wrong_value(s, "listen", "not here");
    settings_wrong(s, "%s", "nor there");
    assert_said(14,
                "surfaced: the.conf:1: text = : an empty value\n"
                "surfaced: the.conf:2: some-number = 1: not a number from 2 to 256\n"
                "surfaced: the.conf:3: bytes = 1T: not a number of bytes from 1 to "
                "1073741824\n"
                "surfaced: the.conf:4: yes = yes: neither 0 nor 1\n"
                "surfaced: the.conf:5: log = xml: not one of logfmt|json\n"
                "surfaced: the.conf:6: listen = 1: not an address like 127.0.0.1:8787, "
                "[::1]:8787 or unix:/run/x/socket\n"
                "surfaced: --bytes 17179869184G: not a number of bytes from 1 to "
                "1073741824\n"
                "surfaced: --log logfm: not one of logfmt|json\n"
                "surfaced: --log : not one of logfmt|json\n"
                "surfaced: --log logfmt|json: not one of logfmt|json\n"
                "surfaced: --some-number 4K: not a number from 2 to 256\n"
                "surfaced: --text a?b: a control character\n"
                "surfaced: --listen 127.0.0.1:1: not here\n"
                "surfaced: nor there\n");
    settings_fill(s, &a); /* bad values replace nothing */
    assert_int_equal(a.number, 4);
    assert_int_equal(a.choice, 0);
    assert_null(a.text);
}

TEST(test_malformed)
{
    read_text("yes = 1\nyes = 1\nno = 1\n[x]\nyes = 1\n[surfaced]\ntext");
    assert_said(4, "surfaced: the.conf:2: yes is given twice, first on line 1\n"
                   "surfaced: the.conf:3: no such setting: no\n"
                   "surfaced: the.conf:5: a section other than [surfaced]\n"
                   "surfaced: the.conf:7: neither NAME = VALUE nor a comment\n");
}

/* A line of 4,000 bytes is accepted, with or without a line feed; a longer one is not. */
TEST(test_long_lines)
{
    char line[4100] = "text = ";
    struct all a = {0};

    memset(line + 7, 'x', 4001 - 7);
    line[4000] = '\0';
    read_text(line);
    assert_said(0, "");
    settings_fill(s, &a);
    assert_int_equal(strlen(a.text), 4000 - 7);
    line[4000] = '\n';
    line[4001] = '\0';
    read_text(line);
    assert_said(1, "surfaced: the.conf:1: text is given twice, first on line 1\n");
    line[4000] = 'x';
    read_text(line);
    assert_said(2, "surfaced: the.conf:1: text is given twice, first on line 1\n"
                   "surfaced: the.conf:1: a line of more than 4000 bytes\n");
}

TEST(test_credentials)
{
    struct all a = {0};

    settings_flag(s, KEY, "credential:tls.key");
    settings_fill(s, &a);
    assert_string_equal(a.file, "/run/credentials/surfaced.service/tls.key");
    assert_int_equal(setenv("CREDENTIALS_DIRECTORY", "/run/c", 1), 0);
    settings_flag(s, KEY, "credential:tls.key");
    settings_flag(s, TEXT, "credential:tls.key"); /* not a path: taken literally */
    settings_fill(s, &a);
    assert_string_equal(a.file, "/run/c/tls.key");
    assert_string_equal(a.text, "credential:tls.key");
    settings_flag(s, KEY, "credential:");
    settings_flag(s, KEY, "credential:..");
    settings_flag(s, KEY, "credential:a/b");
    assert_int_equal(settings_problems(s), 3);
}

TEST(test_files)
{
    settings_flag(s, KEY, "/dev/null");
    settings_flag(s, PATH, "/dev/null/x");
    settings_check_files(s);
    assert_said(1, "surfaced: --db /dev/null/x: Not a directory\n");
    settings_flag(s, KEY, "/nowhere/x");
    settings_flag(s, PATH, "not-there-but-the-folder-is");
    settings_check_files(s);
    assert_int_equal(settings_problems(s), 2);
    settings_file(s, "/nowhere/x", true);
    assert_int_equal(settings_problems(s), 2);
    settings_file(s, "/nowhere/x", false);
    assert_int_equal(settings_problems(s), 3);
}

TEST(test_help)
{
    char *out;
    size_t len;
    FILE *to = open_memstream(&out, &len);

    settings_help(table + LISTEN, 2, to);
    (void)fclose(to);
    assert_string_equal(out, "  --listen ADDRESS:PORT\n"
                             "                       an address,\n"
                             "                       or more (127.0.0.1:1)\n"
                             "  --some-number N      n (4)\n");
    free(out);
}

TEST(test_addresses)
{
    static const char *const good[] = {"127.0.0.1:0", "localhost:8787",  "[::1]:65535",
                                       "0.0.0.0:1",   "[2001:db8::1]:1", "unix:/run/x"};
    static const bool near[] = {true, true, true, false, false, true};
    static const char *const bad[] = {
        "",          ":1",          "1.2.3:1",         "[::1]", "::1:",
        "[::1:1",    "127.0.0.1:x", "127.0.0.1:65536", "[]:1",  "[x]:1",
        "127.0.0.1", "host:1",      "[::1]:+1",        "unix:"};
    char path[120];
    struct sockaddr_storage ss;
    socklen_t len;

    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_true(address_read(good[i], &ss, &len));
        assert_int_equal(address_is_local((const struct sockaddr *)&ss), near[i]);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(address_read(bad[i], &ss, &len));

    /* a path of 107 bytes is the longest */
    memset(path, 'x', sizeof path);
    memcpy(path, "unix:", 5);
    path[5 + 107] = '\0';
    assert_true(address_read(path, &ss, &len));
    assert_string_equal(address_path(&ss), path + 5);
    path[5 + 107] = 'x';
    path[5 + 108] = '\0';
    assert_false(address_read(path, &ss, &len));
}

TEST(test_urls)
{
    static const char *const text[] = {"127.0.0.1:80", "[::1]:80", "unix:/run/x"};
    static const char *const plain[] = {"http://127.0.0.1:80", "http://[::1]:80",
                                        "unix:/run/x"};
    static const char *const tls[] = {"https://127.0.0.1:80", "https://[::1]:80",
                                      "unix:/run/x"};
    struct sockaddr_storage ss;
    socklen_t len;
    char url[ADDRESS_URL_MAX];

    for (size_t i = 0; i < sizeof text / sizeof text[0]; i++) {
        assert_true(address_read(text[i], &ss, &len));
        address_url(&ss, false, url);
        assert_string_equal(url, plain[i]);
        address_url(&ss, true, url);
        assert_string_equal(url, tls[i]);
    }
}
