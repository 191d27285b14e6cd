/* gnuplot draws what the script says; a bad script, an end before the script's and a missing
 * gnuplot are told apart. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "plot.h"

static void write_text(FILE *to, const void *arg)
{
    (void)fputs(arg, to);
}

/* More than a pipe holds, after gnuplot has gone. */
static void write_on(FILE *to, const void *arg)
{
    (void)fputs(arg, to);
    for (int i = 0; i < 100000; i++)
        (void)fputs("# and so on\n", to);
}

static FILE *picture(void)
{
    FILE *f = tmpfile();

    assert_non_null(f);
    return f;
}

static void need_gnuplot(void)
{
    FILE *out = picture();
    const enum status st = plot_run(fileno(out), write_text, "", NULL);

    (void)fclose(out);
    if (st == ST_ENOTFOUND) {
        print_message("SKIP: gnuplot is not installed\n");
        skip();
    }
    assert_int_equal(st, ST_OK);
}

static void test_picture(void **state)
{
    static const unsigned char png[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    unsigned char head[8];
    struct errinfo e = {0};
    FILE *out;

    (void)state;
    need_gnuplot();
    out = picture();
    assert_int_equal(plot_run(fileno(out), write_text,
                              "set terminal pngcairo size 200,100\n$d << EOD\n1 2\n3 4\n"
                              "EOD\nplot $d with points\n",
                              &e),
                     ST_OK);
    rewind(out);
    assert_int_equal(fread(head, 1, sizeof head, out), sizeof head);
    assert_memory_equal(head, png, sizeof png);
    (void)fclose(out);
}

static void test_bad_script(void **state)
{
    struct errinfo e = {0};
    FILE *out;

    (void)state;
    need_gnuplot();
    out = picture();
    assert_int_equal(plot_run(fileno(out), write_text, "plot nosuchthing\n", &e),
                     ST_EINVAL);
    assert_int_equal(e.code, ST_EINVAL);
    assert_non_null(strstr(e.msg, "nosuchthing"));
    assert_int_equal(plot_run(fileno(out), write_on, "exit status 3\n", &e), ST_EINVAL);
    assert_non_null(strstr(e.msg, "did not say"));
    assert_int_equal(plot_run(fileno(out), write_on, "exit\n", &e), ST_OK);
    (void)fclose(out);
}

static void test_missing(void **state)
{
    struct errinfo e = {0};
    FILE *out = picture();

    (void)state;
    assert_int_equal(setenv("PATH", "/nonexistent", 1), 0); /* so this test is the last */
    assert_int_equal(plot_run(fileno(out), write_text, "", &e), ST_ENOTFOUND);
    assert_non_null(strstr(e.msg, "not installed"));
    assert_int_equal(plot_run(fileno(out), write_text, "", NULL), ST_ENOTFOUND);
    (void)fclose(out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_picture),
        cmocka_unit_test(test_bad_script),
        cmocka_unit_test(test_missing),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
