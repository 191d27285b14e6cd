/* The anchor: what was said last is found, whatever a write or a loss of power leaves of what is
 * said next; it never goes back by itself.  A database that has not the change it says is refused,
 * and one whose anchor cannot be written is not. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "fixed_keys.h"
#include "log_anchor.h"
#include "tempdb.h"

#define STEP 512
#define LINE                                                                             \
    (18 + 1 + 1 + 64 + 1 + 64 + 1 - 1) /* of a number below 10, with its newline */

static struct errinfo e;
static struct crypt *keys;
static char path[64];

static struct log_end at(uint64_t seq)
{
    struct log_end a = {.seq = seq};

    memset(a.hash, (int)seq, sizeof a.hash);
    return a;
}

static void say(uint64_t seq, bool force)
{
    const struct log_end a = at(seq);

    if (log_anchor_write(path, keys, &a, force, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

static void assert_says(uint64_t seq)
{
    const struct log_end wanted = at(seq);
    struct log_end a;

    if (log_anchor_read(path, keys, &a, &e) != ST_OK)
        fail_msg("%s", e.msg);
    assert_int_equal(a.seq, seq);
    assert_memory_equal(a.hash, wanted.hash, sizeof a.hash);
}

static size_t read_file(const char *name, char *bytes, size_t size)
{
    const int fd = open(name, O_RDONLY);
    const ssize_t n = read(fd, bytes, size);

    assert_true(n >= 0);
    assert_int_equal(close(fd), 0);
    return (size_t)n;
}

static void write_file(const char *name, const char *bytes, size_t n)
{
    const int fd = open(name, O_WRONLY | O_CREAT | O_TRUNC, 0600);

    assert_int_equal(write(fd, bytes, n), n);
    assert_int_equal(close(fd), 0);
}

static void test_order(void **state)
{
    static const char line[] =
        "surface anchor 2 5 "
        "e42b80e59c7d3b9403241f49ec8e56ff522ad15ead77a35c1a75580d8c2be8fd "
        "89bf173600fd48259374617272ea2325f7de67ad708057702030a48f6c54a4c6\n";
    static const unsigned char hash[] = {0xe4, 0x2b, 0x80, 0xe5, 0x9c, 0x7d, 0x3b, 0x94,
                                         0x03, 0x24, 0x1f, 0x49, 0xec, 0x8e, 0x56, 0xff,
                                         0x52, 0x2a, 0xd1, 0x5e, 0xad, 0x77, 0xa3, 0x5c,
                                         0x1a, 0x75, 0x58, 0x0d, 0x8c, 0x2b, 0xe8, 0xfd};
    static char bytes[2 * STEP];
    struct log_end a;
    struct stat sb;

    (void)state;
    tempdb_remove();
    assert_int_equal(log_anchor_read(path, keys, &a, &e), ST_ENOTFOUND);
    say(3, false);
    assert_int_equal(stat(path, &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    assert_says(3);
    say(2, false); /* by a process that came late */
    assert_says(3);
    for (uint64_t n = 4; n < 20; n++) {
        say(n, false);
        assert_says(n);
    }
    say(5, true); /* back, on purpose */
    assert_says(5);
    /* As db/FORMAT.md says. */
    a.seq = 5;
    memcpy(a.hash, hash, sizeof hash);
    assert_int_equal(log_anchor_write(path, keys, &a, true, &e), ST_OK);
    assert_int_equal(read_file(path, bytes, sizeof bytes), 2 * STEP);
    assert_string_equal(bytes + STEP, line);
}

/* A write that ends anywhere, or leaves a wrong byte in its place: what was before, or after. */
static void test_torn(void **state)
{
    static char before[2 * STEP], after[2 * STEP], torn[2 * STEP];

    (void)state;
    tempdb_remove();
    say(1, false);
    say(2, false);
    for (uint64_t n = 3; n < 7; n++) {
        const size_t place = (size_t)(n % 2) * STEP;

        assert_int_equal(read_file(path, before, sizeof before), sizeof before);
        say(n, false);
        assert_int_equal(read_file(path, after, sizeof after), sizeof after);
        assert_memory_equal(before + STEP - place, after + STEP - place, STEP);
        for (size_t k = 0; k < LINE; k++) {
            memcpy(torn, before, sizeof torn);
            memcpy(torn + place, after + place, k); /* the first k bytes */
            write_file(path, torn, sizeof torn);
            assert_says(k == LINE - 1 ? n : n - 1); /* all but the newline */
            memcpy(torn, after, sizeof torn);
            torn[place + k] ^= 1;
            write_file(path, torn, sizeof torn);
            assert_says(n - 1);
        }
        write_file(path, after, sizeof after);
    }
    for (size_t n = 0; n < STEP + LINE; n += 7) { /* cut off */
        struct log_end a;

        write_file(path, after, n);
        assert_int_equal(log_anchor_read(path, keys, &a, &e),
                         n < LINE - 1 ? ST_EREFUSED : ST_OK);
    }
}

static struct store_key with_anchor(void)
{
    return (struct store_key){.make = CRYPT_FILE, .anchor = path};
}

static enum status open_with(const struct store_key *key, struct store **s)
{
    return store_open(tempdb_path, STORE_WRITE, key, s, &e);
}

static void add(struct store *s, const char *id)
{
    struct store_subject one = {.reference = ""};

    (void)snprintf(one.id, sizeof one.id, "%s", id);
    if (store_subject_add(s, "test", &one, &e) != ST_OK)
        fail_msg("%s", e.msg);
}

/* The file as a whole, closed. */
static void keep(const char *from, const char *to)
{
    static char bytes[1 << 20];

    write_file(to, bytes, read_file(from, bytes, sizeof bytes));
}

/* A whole older database, with every MAC right, and no anchor or another one. */
static void test_older(void **state)
{
    const struct store_key key = with_anchor();
    char old[80], now[80], before[80], aside[80];
    struct store *s, *other;

    (void)state;
    tempdb_remove();
    (void)snprintf(old, sizeof old, "%s-old", tempdb_path);
    (void)snprintf(now, sizeof now, "%s-now", tempdb_path);
    (void)snprintf(before, sizeof before, "%s-old", path);
    (void)snprintf(aside, sizeof aside, "%s-aside", path);
    assert_int_equal(store_open(tempdb_path, STORE_CREATE, &key, &s, &e), ST_OK);
    add(s, "alice");
    store_close(s);
    keep(tempdb_path, old);
    keep(path, before);
    assert_int_equal(open_with(&key, &s), ST_OK);
    add(s, "bob");
    store_close(s);
    keep(tempdb_path, now);

    keep(old, tempdb_path);
    assert_int_equal(open_with(&key, &s), ST_EREFUSED);
    assert_non_null(strstr(e.msg, "older than its anchor says"));
    /* With the older anchor too, nobody knows better. */
    keep(path, aside);
    keep(before, path);
    assert_int_equal(open_with(&key, &s), ST_OK);
    add(s, "carol"); /* another branch, which is as long */
    store_close(s);
    keep(aside, path);
    assert_int_equal(open_with(&key, &s), ST_EREFUSED);

    keep(now, tempdb_path);
    assert_int_equal(open_with(&key, &s), ST_OK); /* the newest */
    store_close(s);
    keep(before, path); /* it lags */
    assert_int_equal(open_with(&key, &s), ST_OK);
    store_close(s);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(open_with(&key, &s), ST_EREFUSED);
    assert_non_null(strstr(e.msg, "there is no anchor"));
    say(3, true); /* of other keys */
    assert_int_equal(open_with(&key, &s), ST_EREFUSED);
    assert_non_null(strstr(e.msg, "damaged, or another database's"));
    assert_int_equal(open_with(NULL, &s), ST_OK); /* nothing without asking for it */
    store_close(s);
    assert_int_equal(unlink(tempdb_path), 0); /* an anchor is not made anew */
    assert_int_equal(store_open(tempdb_path, STORE_CREATE, &key, &other, &e), ST_EEXISTS);
}

/* It cannot be written: changes go on, and it is told. */
static void test_fault(void **state)
{
    const struct store_key key = with_anchor();
    struct store *s;

    (void)state;
    tempdb_remove();
    assert_int_equal(store_open(tempdb_path, STORE_CREATE, &key, &s, &e), ST_OK);
    add(s, "alice");
    assert_false(store_anchor_fault(s, &e));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkdir(path, 0700), 0);
    add(s, "bob");
    assert_true(store_anchor_fault(s, &e));
    assert_non_null(strstr(e.msg, path));
    assert_int_equal(rmdir(path), 0);
    add(s, "carol"); /* and it is there again */
    store_close(s);
    assert_int_equal(open_with(&key, &s), ST_OK);
    store_close(s);
}

static int begin(void **state)
{
    (void)tempdb_begin(state);
    (void)snprintf(path, sizeof path, "%s/anchor", tempdb_dir);
    return (keys = fixed_keys()) != NULL ? 0 : 1;
}

static int end(void **state)
{
    crypt_free(keys);
    return tempdb_end(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),
        cmocka_unit_test(test_torn),
        cmocka_unit_test(test_older),
        cmocka_unit_test(test_fault),
    };

    return cmocka_run_group_tests_name("anchor", tests, begin, end);
}
