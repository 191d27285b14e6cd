/* The anchor: what was said last is found, whatever a write or a loss of power leaves of what is
 * said next; it never goes back by itself.  What the store makes of it: tests/box/anchor.sh. */
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "fixed_keys.h"
#include "log_anchor.h"
#include "newfile.h"
#include "tempdb.h"
#include "unit.h"

#define STEP 512
#define LINE                                                                             \
    (16 + 1 + 1 + 1 + 1 + 1 + 64 + 1 + 64 + 1) /* of numbers below 10, with its newline */

static struct errinfo e;
static struct crypt *keys;
static char path[64];

static struct log_anchor at(uint64_t seq)
{
    struct log_anchor a = {.daemon = 7, .end = {.seq = seq}};

    memset(a.end.hash, (int)seq, sizeof a.end.hash);
    return a;
}

static void say(uint64_t seq)
{
    const struct log_anchor a = at(seq);

    must(log_anchor_advance(path, keys, &a, &e));
}

/* A new one, up to its part or with its name. */
static void make(const struct log_anchor *a, bool named)
{
    struct newfile n = NEWFILE_NONE;

    must(log_anchor_prepare(path, keys, a, &n, &e));
    if (named)
        must(newfile_commit(&n, &e));
    newfile_leave(&n);
}

static void assert_says(uint64_t seq)
{
    const struct log_anchor wanted = at(seq);
    struct log_anchor a;

    must(log_anchor_read(path, keys, &a, &e));
    assert_int_equal(a.daemon, 7);
    assert_int_equal(a.end.seq, seq);
    assert_memory_equal(a.end.hash, wanted.end.hash, sizeof a.end.hash);
}

static void read_file(char bytes[2 * STEP])
{
    const int fd = open(path, O_RDONLY);

    assert_int_equal(read(fd, bytes, 2 * STEP), 2 * STEP);
    assert_int_equal(close(fd), 0);
}

static void write_file(const char *bytes, size_t n)
{
    const int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);

    assert_int_equal(write(fd, bytes, n), n);
    assert_int_equal(close(fd), 0);
}

TEST(test_order)
{
    static const char line[] =
        "surface anchor 3 7 5 "
        "e42b80e59c7d3b9403241f49ec8e56ff522ad15ead77a35c1a75580d8c2be8fd "
        "2c963886da067df6dec0ed314de99923c4c4f46aae041998829a6a6243233ed7\n";
    static const unsigned char hash[] = {0xe4, 0x2b, 0x80, 0xe5, 0x9c, 0x7d, 0x3b, 0x94,
                                         0x03, 0x24, 0x1f, 0x49, 0xec, 0x8e, 0x56, 0xff,
                                         0x52, 0x2a, 0xd1, 0x5e, 0xad, 0x77, 0xa3, 0x5c,
                                         0x1a, 0x75, 0x58, 0x0d, 0x8c, 0x2b, 0xe8, 0xfd};
    static char bytes[2 * STEP];
    struct log_anchor a;
    struct stat sb;

    tempdb_remove();
    fails(log_anchor_read(path, keys, &a, &e), ST_ENOTFOUND);
    say(3);
    assert_int_equal(stat(path, &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    assert_says(3);
    say(2); /* by a process that came late */
    assert_says(3);
    for (uint64_t n = 4; n < 20; n++) {
        say(n);
        assert_says(n);
    }
    a = at(5);
    make(&a, true); /* back, on purpose */
    assert_says(5);
    assert_int_equal(stat(path, &sb), 0);
    assert_int_equal(sb.st_size, 2 * STEP); /* what follows allocates no block */
    /* As db/FORMAT.md says. */
    a = at(5);
    memcpy(a.end.hash, hash, sizeof hash);
    make(&a, true);
    read_file(bytes);
    assert_string_equal(bytes, line);
    assert_string_equal(bytes + STEP, line);
}

/* A write that ends anywhere, or leaves a wrong byte in its place: what was before, or after. */
TEST(test_torn)
{
    static char before[2 * STEP], after[2 * STEP], torn[2 * STEP];

    tempdb_remove();
    say(1);
    say(2);
    for (uint64_t n = 3; n < 7; n++) {
        const size_t place = (size_t)(n % 2) * STEP;

        read_file(before);
        say(n);
        read_file(after);
        assert_memory_equal(before + STEP - place, after + STEP - place, STEP);
        for (size_t k = 0; k < LINE; k++) {
            memcpy(torn, before, sizeof torn);
            memcpy(torn + place, after + place, k); /* the first k bytes */
            write_file(torn, sizeof torn);
            assert_says(k == LINE - 1 ? n : n - 1); /* all but the newline */
            memcpy(torn, after, sizeof torn);
            torn[place + k] ^= 1;
            write_file(torn, sizeof torn);
            assert_says(n - 1);
        }
        write_file(after, sizeof after);
    }
    for (size_t n = 0; n < STEP + LINE; n += 7) { /* cut off */
        struct log_anchor a;

        write_file(after, n);
        assert_int_equal(log_anchor_read(path, keys, &a, &e),
                         n < LINE - 1 ? ST_EREFUSED : ST_OK);
    }
}

/* A command that was killed behind its commit: the part is found, and given its name; not while the
 * command still writes it. */
TEST(test_left)
{
    const struct log_anchor a = at(3), b = at(2);
    struct newfile n = NEWFILE_NONE;
    struct log_anchor left;

    tempdb_remove();
    say(7);
    fails(log_anchor_left(path, keys, &left, &e), ST_ENOTFOUND);
    make(&a, false);
    assert_says(7);
    must(log_anchor_left(path, keys, &left, &e));
    assert_int_equal(left.end.seq, 3);
    must(log_anchor_adopt(path, &e));
    assert_says(3);
    fails(log_anchor_left(path, keys, &left, &e), ST_ENOTFOUND);
    must(log_anchor_adopt(path, &e)); /* there is none */
    assert_says(3);

    must(log_anchor_prepare(path, keys, &b, &n, &e));
    fails(log_anchor_adopt(path, &e), ST_EIO);
    assert_says(3);
    must(newfile_commit(&n, &e));
    newfile_close(&n);
    assert_says(2);
}

/* A symbolic link is followed, and stays. */
TEST(test_link)
{
    char target[80];
    struct stat sb;

    tempdb_remove();
    (void)snprintf(target, sizeof target, "%s-elsewhere", path);
    say(1);
    assert_int_equal(rename(path, target), 0);
    assert_int_equal(symlink(target, path), 0);
    say(2);
    make(&(struct log_anchor){.daemon = 7, .end = at(1).end}, true);
    assert_says(1);
    assert_int_equal(lstat(path, &sb), 0);
    assert_true(S_ISLNK(sb.st_mode));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(unlink(target), 0);
}

BEFORE_ALL(begin)
{
    (void)snprintf(path, sizeof path, "%s/anchor", tempdb_dir);
    assert_int_equal((keys = fixed_keys()) != NULL ? 0 : 1, 0);
}

AFTER_ALL(end)
{
    crypt_free(keys);
}
