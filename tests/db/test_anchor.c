/* The anchor: what was said last is found, whatever a write or a loss of power leaves of what is
 * said next; it never goes back by itself; a store whose anchor fails is not refused for it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "anchor.h"
#include "errinfo.h"
#include "store_serve.h"
#include "store_token.h"
#include "tempdb.h"
#include "vault.h"

#define STEP  4096
#define BYTES (2 * STEP)
#define PLACE 144

static struct errinfo e;
static struct vault *vault, *other;
static char path[64];

static int begin(void **state)
{
    static const unsigned char master[VAULT_KEY] = "a key",
                               another[VAULT_KEY] = "another";
    struct vault_root root;

    (void)tempdb_begin(state);
    assert_true(sodium_init() >= 0);
    (void)snprintf(path, sizeof path, "%s/anchor", tempdb_dir);
    assert_int_equal(vault_make(VAULT_FILE, master, sizeof master, &root, &vault, &e),
                     ST_OK);
    assert_int_equal(vault_make(VAULT_FILE, another, sizeof another, &root, &other, &e),
                     ST_OK);
    return 0;
}

static int end(void **state)
{
    vault_free(vault);
    vault_free(other);
    return tempdb_end(state);
}

static struct anchor_end at(uint64_t seq)
{
    struct anchor_end a = {.seq = seq, .uses = 10 * seq};

    memset(a.hash, (int)seq, sizeof a.hash);
    return a;
}

static void read_bytes(unsigned char bytes[BYTES])
{
    const int fd = open(path, O_RDONLY);

    assert_int_equal(read(fd, bytes, BYTES), BYTES);
    assert_int_equal(close(fd), 0);
}

static void write_bytes(const unsigned char bytes[BYTES])
{
    const int fd = open(path, O_WRONLY | O_CREAT, 0600);

    assert_int_equal(write(fd, bytes, BYTES), BYTES);
    assert_int_equal(close(fd), 0);
}

static void set(uint64_t seq, bool served)
{
    const struct anchor_end a = at(seq);

    if (anchor_set(path, vault, &a, served, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

static void advance(uint64_t seq)
{
    const struct anchor_end a = at(seq);

    if (anchor_advance(path, vault, &a, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

static void announce(uint64_t seq)
{
    const struct anchor_end a = at(seq);

    if (anchor_announce(path, vault, &a, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

/* last, next: 0 for none. */
static void assert_says(uint64_t last, uint64_t next)
{
    struct anchor a;

    if (anchor_read(path, vault, &a, &e) != ST_OK)
        fail_msg("%s", e.msg);
    assert_true(a.said == (last > 0) && a.announced == (next > 0));
    if (last > 0) {
        const struct anchor_end wanted = at(last);

        assert_memory_equal(&a.last, &wanted, sizeof wanted);
    }
    if (next > 0) {
        const struct anchor_end wanted = at(next);

        assert_memory_equal(&a.next, &wanted, sizeof wanted);
    }
}

static void test_order(void **state)
{
    struct anchor a;
    struct stat sb;
    const struct anchor_end one = at(1);

    (void)state;
    assert_int_equal(anchor_read(path, vault, &a, &e), ST_ENOTFOUND);
    assert_int_equal(anchor_advance(path, vault, &one, &e), ST_ENOTFOUND);
    assert_false(anchor_used(path));
    set(3, true);
    assert_int_equal(stat(path, &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    assert_true(anchor_used(path));
    assert_says(3, 0);
    advance(3);
    advance(2); /* by a process that came late */
    assert_says(3, 0);
    for (uint64_t n = 4; n < 20; n++) {
        advance(n);
        assert_says(n, 0);
    }
    assert_int_equal(anchor_read(path, vault, &a, &e), ST_OK);
    assert_true(a.served); /* still */
    assert_int_equal(anchor_mark(path, vault, false, &e), ST_OK);
    assert_says(19, 0);
    assert_int_equal(anchor_read(path, vault, &a, &e), ST_OK);
    assert_false(a.served);
    set(5, false); /* back, on purpose */
    assert_says(5, 0);
    assert_int_equal(anchor_read(path, other, &a, &e), ST_EREFUSED);
    tempdb_remove();
}

static void test_announced(void **state)
{
    (void)state;
    announce(1); /* of a database that is made */
    assert_says(0, 1);
    assert_false(anchor_used(path));
    announce(2); /* again, after it was killed */
    assert_says(0, 2);
    set(2, false);
    assert_says(2, 0);
    advance(9);
    announce(4); /* a restore */
    assert_says(9, 4);
    advance(12); /* not meanwhile */
    assert_says(9, 4);
    announce(5); /* again, after it was killed: what is there is not forgotten */
    assert_says(9, 5);
    set(5, false);
    assert_says(5, 0);
    advance(6);
    announce(7);
    set(6, false); /* it was not made */
    assert_says(6, 0);
    tempdb_remove();
}

/* A write that ends anywhere, or leaves any garbage in its place: what was before, or after. */
static void test_torn(void **state)
{
    static unsigned char before[BYTES], after[BYTES], torn[BYTES];

    (void)state;
    set(1, false);
    for (uint64_t n = 2; n < 6; n++) {
        size_t place;

        read_bytes(before);
        advance(n);
        read_bytes(after);
        place = memcmp(before, after, STEP) == 0 ? STEP : 0;
        assert_memory_equal(before + STEP - place, after + STEP - place, STEP);
        for (size_t k = 0; k < PLACE; k++) {
            memcpy(torn, before, BYTES);
            memcpy(torn + place, after + place, k); /* the first k bytes */
            write_bytes(torn);
            assert_says(n - 1, 0);
            memcpy(torn, after, BYTES);
            memcpy(torn + place, before + place, k); /* all but these */
            write_bytes(torn);
            assert_says(memcmp(torn, after, BYTES) == 0 ? n : n - 1, 0);
            memcpy(torn, after, BYTES);
            torn[place + k] ^= 1; /* a bit of them */
            write_bytes(torn);
            assert_says(n - 1, 0);
        }
        /* Told again from there it goes on. */
        advance(n);
        assert_says(n, 0);
        write_bytes(after);
    }
    tempdb_remove();
}

static void limit_files(rlim_t n)
{
    struct rlimit l;

    assert_int_equal(getrlimit(RLIMIT_NOFILE, &l), 0);
    l.rlim_cur = n;
    assert_int_equal(setrlimit(RLIMIT_NOFILE, &l), 0);
}

/* Each opening of a file fails: the database is opened, or it is not, and nothing is lost. */
static void test_files(void **state)
{
    struct store_token t;
    struct rlimit was;
    struct store *s = tempdb_fresh();
    char secret[65];
    unsigned failed = 0;
    enum status st = ST_EIO;

    (void)state;
    store_close(s);
    assert_int_equal(getrlimit(RLIMIT_NOFILE, &was), 0);
    for (rlim_t n = 3; n < 64 && st != ST_OK; n++) {
        limit_files(n);
        st = store_open(tempdb_path, STORE_WRITE, NULL, &s, &e);
        limit_files(was.rlim_cur);
        failed += st != ST_OK;
        assert_true((s != NULL) == (st == ST_OK));
    }
    assert_int_equal(st, ST_OK);
    assert_true(failed > 3);
    limit_files(3); /* the database is open, its anchor is not */
    st = store_token_create(s, "test", "a", STORE_SCOPE_READ, 0, secret, &t, &e);
    limit_files(was.rlim_cur);
    assert_int_equal(st, ST_OK);
    assert_true(store_anchor_fault(s, &e));
    store_close(s);
    s = tempdb_open(STORE_WRITE); /* it lags */
    assert_false(store_anchor_fault(s, &e));
    store_close(s);
}

/* An anchor that cannot be written: changes go on, and it is told. */
static void test_fault(void **state)
{
    struct store *s = tempdb_fresh();
    struct store_token t;
    char anchor[64], secret[65];

    (void)state;
    (void)snprintf(anchor, sizeof anchor, "%s.key.anchor", tempdb_path);
    assert_int_equal(unlink(anchor), 0);
    assert_int_equal(mkdir(anchor, 0700), 0);
    assert_false(store_anchor_fault(s, &e));
    assert_int_equal(
        store_token_create(s, "test", "a", STORE_SCOPE_READ, 0, secret, &t, &e), ST_OK);
    assert_true(store_anchor_fault(s, &e));
    assert_non_null(strstr(e.msg, anchor));
    assert_int_equal(rmdir(anchor), 0);
    assert_int_equal(
        store_token_create(s, "test", "b", STORE_SCOPE_READ, 0, secret, &t, &e), ST_OK);
    assert_int_equal(access(anchor, F_OK), 0); /* made again */
    store_close(s);
    store_close(tempdb_open(STORE_WRITE));
}

static double cpu_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* What telling costs a change; docs/database.md has the figures. */
static void test_cost(void **state)
{
    enum { CHANGES = 200 };
    struct store *s = tempdb_fresh(), *copy = tempdb_copy(STORE_WRITE);
    double with = 0, without = 0, start, one;
    struct store_token t;
    char secret[65];

    (void)state;
    for (int i = 0; i < 2 * CHANGES; i++) {
        start = cpu_ms();
        assert_int_equal(store_token_create(i % 2 != 0 ? s : copy, "test", "a",
                                            STORE_SCOPE_READ, 0, secret, &t, &e),
                         ST_OK);
        *(i % 2 != 0 ? &with : &without) += cpu_ms() - start;
    }
    print_message("  %.4f ms of CPU for a change, %.4f without an anchor\n",
                  with / CHANGES, without / CHANGES);
    store_close(s);
    store_close(copy);
    tempdb_remove();
    set(1, false);
    start = cpu_ms();
    for (uint64_t n = 2; n < 1002; n++)
        advance(n);
    one = (cpu_ms() - start) / 1000;
    print_message("  %.4f ms of CPU to tell it\n", one);
    assert_true(one < 0.5); /* 0.003 on an idle machine without sanitizers */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order), cmocka_unit_test(test_announced),
        cmocka_unit_test(test_torn),  cmocka_unit_test(test_files),
        cmocka_unit_test(test_fault), cmocka_unit_test(test_cost),
    };

    return cmocka_run_group_tests_name("anchor", tests, begin, end);
}
