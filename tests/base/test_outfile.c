/* What is printed arrives whole, or the end of the output is an error. */
#define _GNU_SOURCE /* fopencookie(), pipe2() */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <time.h>
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

/* ---- a reader that is slower than the writer, of a pipe that does not block */

#define MUCH 300000 /* bytes, several times a pipe's buffer */

static void *read_slowly(void *arg)
{
    static char part[4096];
    const int fd = *(const int *)arg;
    size_t all = 0;
    ssize_t n;

    while ((n = read(fd, part, sizeof part)) > 0) {
        all += (size_t)n;
        (void)nanosleep(&(struct timespec){0, 1000000}, NULL);
    }
    return (void *)(uintptr_t)all;
}

TEST(test_a_slow_reader)
{
    const int saved = dup(STDOUT_FILENO);
    int ends[2];
    pthread_t reader;
    void *all;
    bool whole;

    (void)fflush(stdout);
    assert_int_equal(pipe2(ends, O_CLOEXEC | O_NONBLOCK), 0);
    assert_int_equal(fcntl(ends[0], F_SETFL, 0), 0);
    assert_true(saved >= 0 && dup2(ends[1], STDOUT_FILENO) >= 0);
    (void)close(ends[1]);
    assert_int_equal(pthread_create(&reader, NULL, read_slowly, &ends[0]), 0);
    outfile_wait();
    for (int i = 0; i < MUCH / 10; i++)
        (void)fputs("123456789\n", stdout);
    whole = outfile_flush(stdout);
    assert_true(dup2(saved, STDOUT_FILENO) >= 0);
    (void)close(saved);
    assert_int_equal(pthread_join(reader, &all), 0);
    (void)close(ends[0]);
    assert_true(whole);
    assert_int_equal((uintptr_t)all, MUCH);
}
