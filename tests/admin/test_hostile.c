/* Every byte of a small database is changed in turn, by an attacker without the key (of free room and
 * of an encrypted face every eighth).  Each call returns the truth or an error: never another face,
 * subject, token or threshold, never a crash.
 * Many changes at once, and rows: tests/fuzz/fuzz_database.c and tests/box/store-attacks.sh. */
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "errinfo.h"
#include "hostile.h"
#include "tempdb.h"
#include "unit.h"

#define PROCESSES 3
#define MUST      HOSTILE_MUST
#define PAGE      512 /* of hostile_make() */
#define AROUND    8

/* A sanitizer makes a byte cost three times as much: it sees every seventh, and the plain
 * run all of them. */
#ifdef SANITIZED
#define EVERY 7
#else
#define EVERY 1
#endif

static char path[64], key[64];
static const struct store_key by_key = {.path = key, .make = CRYPT_FILE};
static unsigned char *file; /* as it was written */
static size_t size;

static void remove_logs(void)
{
    static const char *const suffix[] = {"-wal", "-shm", "-journal"};
    char name[128];

    for (size_t i = 0; i < 3; i++) {
        (void)snprintf(name, sizeof name, "%s%s", path, suffix[i]);
        (void)unlink(name);
    }
}

static void write_file(const unsigned char *bytes, size_t n)
{
    FILE *f = fopen(path, "wb");

    assert_non_null(f);
    assert_int_equal(fwrite(bytes, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
}

struct tally {
    unsigned files, refused, whole; /* not opened; every read succeeded */
};

static void try_file(struct tally *t)
{
    struct store *s;

    t->files++;
    if (store_open(path, STORE_READ, &by_key, &s, &hostile_e) != ST_OK) {
        t->refused++;
        MUST(hostile_e.msg[0] != '\0');
        return;
    }
    (void)hostile_ask(s);
    if (store_verify(s, NULL, NULL, &hostile_e) == ST_OK) {
        MUST(hostile_ask(s) == hostile_reads());
        t->whole++;
    } else if (hostile_e.code == ST_EREFUSED) {
        MUST(hostile_ask(s) == 0); /* it refuses everything from then on */
    }
    store_close(s);
}

/* ---- the tests */

TEST(test_as_written)
{
    struct tally t = {0};

    try_file(&t);
    assert_int_equal(t.whole, 1);
}

/* Free room is zeros, and a page that begins with one has the rest of a long row, so of a face, whose
 * tag authenticates each byte alike. */
static bool is_alike(size_t i)
{
    static const unsigned char zeros[2 * AROUND + 1];
    const size_t page = i - i % PAGE;

    if (page > 0 && file[page] == 0)
        return i - page >= 4; /* the number of the next one */
    return i >= AROUND && i + AROUND < size &&
           memcmp(file + i - AROUND, zeros, sizeof zeros) == 0;
}

/* A process's share of the bytes, from the first on, in a copy of the file. */
static void flip(size_t first, struct tally *t)
{
    int fd;

    (void)snprintf(path + strlen(path), 8, "-%zu", first);
    write_file(file, size);
    MUST((fd = open(path, O_WRONLY)) >= 0);
    for (size_t i = first; i < size; i += (size_t)PROCESSES * EVERY) {
        const unsigned char flipped =
            (unsigned char)(file[i] ^ (i / PROCESSES % 2 == 0 ? 0xff : 1U << i % 8));

        if (is_alike(i) && i % 8 != 0)
            continue;
        MUST(pwrite(fd, &flipped, 1, (off_t)i) == 1);
        try_file(t);
        MUST(pwrite(fd, &file[i], 1, (off_t)i) == 1);
        remove_logs();
    }
    (void)close(fd);
    (void)unlink(path);
}

TEST(test_every_byte)
{
    pid_t child[PROCESSES];
    int status;

    for (size_t i = 0; i < PROCESSES; i++) {
        assert_true((child[i] = fork()) >= 0);
        if (child[i] == 0) {
            struct tally t = {0};

            flip(i, &t);
            print_message("%u files, %u not opened, %u read as a whole\n", t.files,
                          t.refused, t.whole);
            (void)fflush(stdout);
            _exit(t.refused > 0 && t.refused < t.files ? 0 : 1);
        }
    }
    for (size_t i = 0; i < PROCESSES; i++) {
        assert_int_equal(waitpid(child[i], &status, 0), child[i]);
        assert_int_equal(status, 0);
    }
}

BEFORE_ALL(set_up)
{
    (void)snprintf(path, sizeof path, "%s", tempdb_path);
    (void)snprintf(key, sizeof key, "%s.key", tempdb_path);
    file = hostile_make(path, &by_key, 1, &size);
    file[18] = file[19] = 2; /* WAL mode */
    write_file(file, size);
    print_message("%zu bytes\n", size);
}

AFTER_ALL(tear_down)
{
    free(file);
    hostile_end();
}
