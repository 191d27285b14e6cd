/* Tables as spreadsheets write them, and malformed ones. */
#include <unistd.h>

#include "csv.h"
#include "unit.h"

static char path[] = "/tmp/test_csv.XXXXXX";
static struct errinfo e;

static void write_table(const char *text, size_t len)
{
    FILE *f = fopen(path, "wb");

    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, len, f), len);
    assert_int_equal(fclose(f), 0);
}

static struct csv *opened(const char *text, bool without_heading)
{
    struct csv *t;

    write_table(text, strlen(text));
    if (csv_open(path, without_heading, &t, &e) != ST_OK)
        fail_msg("%s", e.msg);
    return t;
}

static struct csv *table(const char *text)
{
    return opened(text, false);
}

static struct csv *list(const char *text)
{
    return opened(text, true);
}

/* Reads all of a table that has an error; the message must contain `words`. */
static void refuse(const char *text, size_t len, enum status want, const char *words)
{
    struct csv *t;
    bool more = true;
    enum status st;

    write_table(text, len);
    st = csv_open(path, false, &t, &e);
    while (st == ST_OK && more)
        st = csv_next(t, &more, &e);
    csv_close(t);
    assert_int_equal(st, want);
    assert_int_equal(e.code, want);
    if (strstr(e.msg, words) == NULL)
        fail_msg("'%s' lacks '%s'", e.msg, words);
}

static void row(struct csv *t, const char *a, const char *b)
{
    bool more;

    assert_int_equal(csv_next(t, &more, &e), ST_OK);
    assert_true(more);
    assert_string_equal(csv_field(t, 0), a);
    assert_string_equal(csv_field(t, 1), b);
}

static void end(struct csv *t)
{
    bool more;

    assert_int_equal(csv_next(t, &more, &e), ST_OK);
    assert_false(more);
    csv_close(t);
}

TEST(test_plain)
{
    struct csv *t = table("File,id\na.ply,7\n\n b.ply ,\t8 \n,\n");

    assert_int_equal(csv_column(t, "file"), 0);
    assert_int_equal(csv_column(t, "ID"), 1);
    assert_int_equal(csv_column(t, "kind"), -1);
    row(t, "a.ply", "7");
    assert_string_equal(csv_field(t, -1), "");
    row(t, "b.ply", "8");
    row(t, "", "");
    end(t);
}

TEST(test_spreadsheet)
{
    struct csv *t = table("\xEF\xBB\xBF\"file\",id\r\n\"a, b\" ,\"say \"\"yes\"\"\"\r\n"
                          "\"two\nlines\",\"\"\r\nx\ry,z");

    assert_int_equal(csv_column(t, "file"), 0);
    row(t, "a, b", "say \"yes\"");
    row(t, "two\nlines", "");
    row(t, "x\ry", "z"); /* a lone CR does not end a line; the last line needs no end */
    end(t);
}

TEST(test_lines)
{
    struct csv *t = table("a,b\n\"1\n2\",x\n3,y\n");

    row(t, "1\n2", "x");
    row(t, "3", "y");
    assert_int_equal(csv_bad(t, 1, &e, "odd"), ST_EINVAL);
    assert_non_null(strstr(e.msg, "line 4, column b: odd"));
    end(t);
}

TEST(test_numbers)
{
    struct csv *t = table("a,b\n1.5e1,x\n,1e999\n3 4,\n");
    double x;
    bool more;

    assert_int_equal(csv_next(t, &more, &e), ST_OK);
    assert_int_equal(csv_number(t, 0, &x, &e), ST_OK);
    assert_true(x == 15);
    assert_int_equal(csv_number(t, 1, &x, &e), ST_EINVAL);
    assert_non_null(strstr(e.msg, "line 2, column b: not a number"));
    assert_int_equal(csv_next(t, &more, &e), ST_OK);
    assert_int_equal(csv_number(t, 0, &x, &e), ST_EINVAL);
    assert_int_equal(csv_number(t, 1, &x, &e), ST_EINVAL);
    assert_int_equal(csv_next(t, &more, &e), ST_OK);
    assert_int_equal(csv_number(t, 0, &x, &e), ST_EINVAL);
    end(t);
}

#define REFUSE(text, st, words) refuse(text, sizeof text - 1, st, words)

TEST(test_hostile)
{
    const size_t size = CSV_MAX_LINE + 100;
    char *text = malloc(size);

    REFUSE("", ST_EINVAL, "empty");
    REFUSE("\r\n\n", ST_EINVAL, "empty");
    REFUSE("a,b\n1\n", ST_EINVAL, "line 2: 1 fields, the heading has 2");
    REFUSE("a,b\n1,2\n1,2,3\n", ST_EINVAL, "line 3: 3 fields");
    REFUSE("a,A\n", ST_EINVAL, "two columns are named A");
    REFUSE("a,b\n1,\"2\n3\n", ST_EINVAL, "a quotation is not closed");
    REFUSE("a,b\n1,\"2\" 3\n", ST_EINVAL, "line 2, field 2: text after");
    REFUSE("a,b\n1,\0\n", ST_EINVAL, "line 2, field 2: a NUL");
    REFUSE("a,b\n\0,1\n", ST_EINVAL, "a NUL");
    REFUSE("a,b\n1,\"\0\"\n", ST_EINVAL, "a NUL");
    REFUSE("a,b\n1,\"2\"\0\n", ST_EINVAL, "text after");
    assert_non_null(text);
    memset(text, 'x', size);
    memcpy(text, "a\n", 2);
    refuse(text, size, ST_ELIMIT, "line 2: longer than");
    memset(text, ',', size);
    refuse(text, size, ST_ELIMIT, "line 1: more than 256 fields");
    memset(text, '"', size);
    refuse(text, size - 1, ST_EINVAL, "not closed");
    free(text);
}

TEST(test_absent)
{
    struct csv *t;

    assert_int_equal(csv_open("/nowhere/x.csv", false, &t, &e), ST_ENOTFOUND);
    assert_null(t);
    assert_int_equal(csv_open("/", false, &t, &e), ST_EIO);
    csv_close(NULL);
}

/* Without a heading: what separates is what the first row has. */
TEST(test_list)
{
    struct csv *t =
        list("# with, commas\n\n  a.ply \t b.ply  \r\nc,1 d 0 x\n #\n\"e f\"\tg");
    bool more;

    row(t, "a.ply", "b.ply");
    assert_int_equal(csv_line(t), 3);
    assert_int_equal(csv_fields(t), 2);
    assert_string_equal(csv_field(t, 2), "");
    row(t, "c,1", "d");
    assert_int_equal(csv_fields(t), 4);
    assert_int_equal(csv_bad(t, 1, &e, "no such file"), ST_EINVAL);
    assert_non_null(strstr(e.msg, ", line 4, field 2: no such file"));
    assert_int_equal(csv_bad(t, -1, &e, "no"), ST_EINVAL);
    assert_non_null(strstr(e.msg, ", line 4: no"));
    row(t, "e f", "g");
    end(t);
    t = list("\xEF\xBB\xBF a b , c d\n\"e, f\" ,g,\n");
    row(t, "a b", "c d");
    row(t, "e, f", "g");
    assert_int_equal(csv_fields(t), 3);
    end(t);
    t = list("a \"b\"c\n");
    assert_int_equal(csv_next(t, &more, &e), ST_EINVAL);
    assert_non_null(strstr(e.msg, "line 1, field 2: text after a closing"));
    csv_close(t);
    end(list(""));
    end(list("# nothing\n \n"));
}

BEFORE_ALL(create)
{
    const int fd = mkstemp(path);

    assert_true(fd >= 0);
    (void)close(fd);
}

AFTER_ALL(remove_table)
{
    (void)unlink(path);
}
