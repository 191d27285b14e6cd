/* Log lines: no value can break the line or add fields. */
#include <unistd.h>

#include "logger.h"
#include "unit.h"

static char line[2 * LOG_LINE_MAX];
static int saved, out[2];

static void catch_stderr(void)
{
    assert_int_equal(pipe(out), 0);
    saved = dup(STDERR_FILENO);
    assert_true(saved >= 0);
    assert_true(dup2(out[1], STDERR_FILENO) >= 0);
}

/* The line written since catch_stderr(), from the text `from` on (it follows the time). */
static const char *caught(const char *from)
{
    ssize_t n;
    const char *p;

    assert_true(dup2(saved, STDERR_FILENO) >= 0);
    (void)close(saved);
    (void)close(out[1]);
    n = read(out[0], line, sizeof line - 1);
    (void)close(out[0]);
    assert_true(n > 0);
    line[n] = '\0';
    assert_ptr_equal(strchr(line, '\n'),
                     line + n - 1); /* a single line feed, at the end */
    line[n - 1] = '\0';
    p = strstr(line, from);
    assert_non_null(p);
    return p;
}

static const char *logged(const char *value)
{
    struct logger_line l;

    catch_stderr();
    logger_begin(&l, "info", "m");
    logger_text(&l, "key", value);
    logger_count(&l, "n", 18446744073709551615u);
    logger_real(&l, "ms", 1.0 / 3, 3);
    logger_end(&l);
    return caught("level");
}

#define REST " n=18446744073709551615 ms=0.333"

TEST(test_logfmt)
{
    logger_use(LOGGER_LOGFMT);
    assert_string_equal(logged("a-b/c"), "level=info msg=\"m\" key=a-b/c" REST);
    assert_string_equal(logged(""), "level=info msg=\"m\" key=\"\"" REST);
    assert_string_equal(logged("a b"), "level=info msg=\"m\" key=\"a b\"" REST);
    assert_string_equal(logged("a=b"), "level=info msg=\"m\" key=\"a=b\"" REST);
    assert_string_equal(logged("x\" level=\"error"),
                        "level=info msg=\"m\" key=\"x\\\" level=\\\"error\"" REST);
    assert_string_equal(logged("x\nts=1\r\t\x1b[2J\x7f"),
                        "level=info msg=\"m\" key=\"x\\u000ats=1\\u000d\\u0009\\u001b[2J"
                        "\\u007f\"" REST);
    assert_string_equal(logged("\\"), "level=info msg=\"m\" key=\"\\\\\"" REST);
}

#define JREST ",\"n\":18446744073709551615,\"ms\":0.333}"

TEST(test_json)
{
    logger_use(LOGGER_JSON);
    assert_string_equal(logged("a-b"),
                        "level\":\"info\",\"msg\":\"m\",\"key\":\"a-b\"" JREST);
    assert_memory_equal(line, "{\"ts\":\"20", 9);
    assert_string_equal(logged("\",\"level\":\"error\n"),
                        "level\":\"info\",\"msg\":\"m\",\"key\":"
                        "\"\\\",\\\"level\\\":\\\"error\\u000a\"" JREST);
    logger_use(LOGGER_LOGFMT);
}

/* Valid UTF-8 stays; each other byte is replaced. */
TEST(test_utf8)
{
    static const struct {
        const char *in, *want;
    } known[] = {
        {"\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80", "\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80"},
        {"\xff", "\\ufffd"},
        {"\xc0\xaf", "\\ufffd\\ufffd"},            /* overlong */
        {"\xed\xa0\x80", "\\ufffd\\ufffd\\ufffd"}, /* a surrogate */
        {"\xf4\x90\x80\x80", "\\ufffd\\ufffd\\ufffd\\ufffd"},
        {"\xc3", "\\ufffd"}, /* ends in the middle */
        {"\xc3\"", "\\ufffd\\\""},
        {"\xc2\x9b", "\\ufffd\\ufffd"}, /* a terminal's CSI */
    };
    char want[128];

    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        (void)snprintf(want, sizeof want, "level=info msg=\"m\" key=\"%s\"" REST,
                       known[i].want);
        assert_string_equal(logged(known[i].in), want);
    }
}

/* A long value is truncated; a field that does not fit at all is omitted. */
TEST(test_long)
{
    static char value[LOG_LINE_MAX + 1];
    struct logger_line l;
    const char *p;

    memset(value, '"', LOG_LINE_MAX);
    for (enum logger_format f = LOGGER_LOGFMT; f <= LOGGER_JSON; f++) {
        logger_use(f);
        catch_stderr();
        logger_begin(&l, "info", "m");
        logger_text(&l, "a", value);
        logger_text(&l, "b", value);
        logger_count(&l, "c", 1);
        logger_end(&l);
        p = caught("level");
        assert_true(strlen(line) < LOG_LINE_MAX);
        assert_null(strstr(p, "b="));
        assert_null(strstr(p, "\"b\""));
        assert_non_null(
            strstr(p, f == LOGGER_JSON ? ",\"c\":1,\"cut\":true}" : "c=1 cut=true"));
    }
    logger_use(LOGGER_LOGFMT);
}

TEST(test_line)
{
    catch_stderr();
    logger_line("warn", "it is", "n", "3");
    assert_string_equal(caught("level"), "level=warn msg=\"it is\" n=3");
    catch_stderr();
    logger_line("warn", "it is", NULL, NULL);
    assert_string_equal(caught("level"), "level=warn msg=\"it is\"");
}

/* The first is told at once, the others together a minute later. */
TEST(test_seldom)
{
    struct logger_seldom s = {0};

    assert_int_equal(logger_seldom(&s, 1.0), 1);
    for (int i = 0; i < 99; i++)
        assert_int_equal(logger_seldom(&s, LOG_SELDOM_MS), 0);
    assert_int_equal(logger_seldom(&s, LOG_SELDOM_MS + 1.0), 100);
    assert_int_equal(logger_seldom(&s, LOG_SELDOM_MS + 2.0), 0);
}
