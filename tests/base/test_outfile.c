/* What is printed arrives whole, or the end of the output is an error. */
#define _GNU_SOURCE /* fopencookie(), pipe2() */
#include <errno.h>
#include <fcntl.h>
#include <unistd.h>

#include "command.h"
#include "errinfo.h"
#include "outfile.h"
#include "unit.h"

static struct errinfo e;

/* ---- a file whose first write fails, as on a disk that has room again later */

static int writes;

static ssize_t fail_first(void *none, const char *data, size_t n)
{
    (void)none;
    (void)data;
    return writes++ == 0 ? 0 : (ssize_t)n;
}

static FILE *open_failing(void)
{
    FILE *f = fopencookie(NULL, "w", (cookie_io_functions_t){.write = fail_first});

    assert_non_null(f);
    writes = 0;
    return f;
}

TEST(test_an_earlier_failure)
{
    FILE *f = open_failing();

    (void)fputs("lost\n", f);
    assert_int_equal(fflush(f), EOF);
    (void)fputs("written\n", f);
    assert_int_equal(fflush(f), 0);
    assert_false(outfile_flush(f));
    (void)fclose(f);
    assert_non_null(f = open_failing());
    writes = 1;
    (void)fputs("written\n", f);
    assert_true(outfile_flush(f));
    (void)fclose(f);
}

static enum status write_twice(FILE *to, const void *arg, struct errinfo *x)
{
    (void)arg;
    (void)x;
    (void)fputs("lost\n", to);
    (void)fflush(to);
    (void)fputs("written\n", to);
    return ST_OK;
}

/* Both ends of a command ask for it. */
TEST(test_standard_output)
{
    FILE *const real = stdout;
    enum status st;
    int code;

    stdout = open_failing();
    st = outfile_write(NULL, false, write_twice, NULL, &e);
    code = command_end("test", NULL, false, &e, EXIT_FINE);
    (void)fclose(stdout);
    stdout = real;
    assert_int_equal(st, ST_EIO);
    assert_int_equal(code, EXIT_IOERR);
}

/* ---- standard output that another process has made non-blocking */

TEST(test_waits)
{
    const int saved = dup(STDOUT_FILENO);
    int ends[2], flags;

    (void)fflush(stdout);
    assert_int_equal(pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
    assert_true(saved >= 0 && dup2(ends[1], STDOUT_FILENO) >= 0);
    outfile_wait();
    flags = fcntl(STDOUT_FILENO, F_GETFL);
    assert_true(dup2(saved, STDOUT_FILENO) >= 0);
    (void)close(saved);
    (void)close(ends[0]);
    (void)close(ends[1]);
    assert_int_equal(flags & O_NONBLOCK, 0);
}
