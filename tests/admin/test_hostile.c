/* Every byte of a small database is changed in turn, by an attacker without the key.  Each call
 * returns the truth or an error: never another face, subject, token or threshold, never a crash.
 * Many changes at once, and rows: tests/fuzz/fuzz_database.c and tests/box/store-attacks.sh. */
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "expect.h"
#include "face.h"
#include "facegen.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define POINTS    110
#define THRESHOLD 8.4321
#define READS     4
#define PROCESSES 3

/* A sanitizer makes a byte cost three times as much: it sees every third, and the plain
 * run all of them. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define EVERY 3
#else
#define EVERY 1
#endif

static char path[64], key[64];
static const struct store_key by_key = {.path = key, .make = CRYPT_FILE};
static unsigned char *file; /* as it was written */
static size_t size;
static struct surface_work *work;
static struct surface_face face, *loaded;
static struct store_template tmpl;
static char secret[65], revoked[65];
static struct errinfo e;

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

static void read_file(void)
{
    struct stat sb;
    FILE *f = fopen(path, "rb");

    assert_non_null(f);
    assert_int_equal(fstat(fileno(f), &sb), 0);
    size = (size_t)sb.st_size;
    assert_non_null(file = malloc(size));
    assert_int_equal(fread(file, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

/* ---- one of everything */

static void fill(struct store *s)
{
    struct store_calibration k = {
        .fmr = 0.001,
        .low = 0,
        .high = 9,
        .subjects = 80,
        .impostors = 6320,
        .table = {.threshold = THRESHOLD, .n = 2, .knot = {{-50, 1}, {THRESHOLD, 0.001}}},
    };
    struct store_token t;

    tempdb_enroll(s, "alice", "front", &face, &tmpl);
    must(store_calibration_add(s, "test", &k, &e));
    must(store_token_create(s, "test", "lost", STORE_SCOPE_ALL, 0, revoked, &t, &e));
    must(store_token_revoke(s, "test", t.id, &e));
    must(store_token_create(s, "test", "gate", STORE_SCOPE_VERIFY, 0, secret, &t, &e));
}

/* ---- what reads may return */

/* Ends the process, which may be a child. */
#define MUST(what) ((what) ? (void)0 : broken(#what, __LINE__))

static void broken(const char *what, int line)
{
    (void)fprintf(stderr, "test_hostile.c:%d: not %s\n", line, what);
    abort();
}

static void check_template(struct store *s, const struct store_template *t)
{
    struct store_template got;

    MUST(memcmp(t, &tmpl, sizeof tmpl) == 0);
    if (store_template_load(s, t->id, &got, work, &loaded, &e) != ST_OK)
        return;
    MUST(memcmp(&got, &tmpl, sizeof tmpl) == 0);
    MUST(loaded->surface.mesh.nv == face.surface.mesh.nv &&
         loaded->surface.mesh.nt == face.surface.mesh.nt);
    MUST(memcmp(loaded->surface.mesh.xy, face.surface.mesh.xy,
                face.surface.mesh.nv * sizeof *face.surface.mesh.xy) == 0);
    MUST(memcmp(loaded->surface.mesh.z, face.surface.mesh.z,
                face.surface.mesh.nv * sizeof *face.surface.mesh.z) == 0);
}

/* Reads all that decisions depend on.  Returns how many reads succeeded. */
static unsigned ask(struct store *s)
{
    struct store_template *list;
    struct store_subject one;
    struct store_calibration k;
    struct store_token t;
    unsigned answers = 0;
    size_t n;

    if (store_token_check(s, secret, &t, &e) == ST_OK) {
        MUST(t.scopes == STORE_SCOPE_VERIFY && t.expires[0] == '\0');
        answers++;
    }
    MUST(store_token_check(s, revoked, &t, &e) != ST_OK);
    if (store_calibration_get(s, &k, &e) == ST_OK) {
        MUST(!k.shipped && k.table.threshold == THRESHOLD);
        answers++;
    }
    if (store_subject_get(s, "alice", &one, &e) == ST_OK) {
        MUST(strcmp(one.id, "alice") == 0 && !one.disabled);
        answers++;
    }
    MUST(store_subject_get(s, "bob", &one, &e) != ST_OK);
    if (store_template_list(s, "alice", &list, &n, &e) == ST_OK) {
        for (size_t i = 0; i < n; i++)
            check_template(s, &list[i]);
        free(list);
        answers += n == 1;
    }
    MUST(store_template_list(s, "bob", &list, &n, &e) != ST_OK);
    return answers;
}

struct tally {
    unsigned files, refused, whole; /* not opened; every read succeeded */
};

static void try_file(struct tally *t)
{
    struct store *s;

    t->files++;
    if (store_open(path, STORE_READ, &by_key, &s, &e) != ST_OK) {
        t->refused++;
        MUST(e.msg[0] != '\0');
        return;
    }
    (void)ask(s);
    if (store_verify(s, NULL, NULL, &e) == ST_OK) {
        MUST(ask(s) == READS);
        t->whole++;
    } else if (e.code == ST_EREFUSED) {
        MUST(ask(s) == 0); /* it refuses everything from then on */
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
    static struct dvec3 pts[POINTS];
    struct facegen_scan scan;
    struct store *s;

    assert_int_equal(tempdb_begin(NULL), 0);
    (void)snprintf(path, sizeof path, "%s", tempdb_path);
    (void)snprintf(key, sizeof key, "%s.key", tempdb_path);
    facegen_default(&scan);
    scan.points = POINTS;
    assert_false((work = surface_work_new(NULL)) == NULL ||
                 face_build(pts, facegen_sample(&scan, pts), work, &face, NULL) != ST_OK);
    s = tempdb_fresh();
    fill(s);
    store_close(s);
    /* Small pages leave few bytes that mean nothing. */
    tempdb_sql("PRAGMA journal_mode=DELETE; PRAGMA page_size=512; VACUUM;"
               "PRAGMA journal_mode=WAL");
    read_file();
    print_message("%zu bytes\n", size);
}

AFTER_ALL(tear_down)
{
    free(file);
    face_free(&face);
    surface_face_free(loaded);
    surface_work_free(work);
    assert_int_equal(tempdb_end(NULL), 0);
}
