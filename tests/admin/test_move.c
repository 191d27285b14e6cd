/* admin_move(): a store in another place, file or server, is the same store; killed at any of its round
 * trips up to its commit it has left nothing there, and nothing has changed where it came from. */
/* link: -Wl,--wrap=PQpipelineSync */
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "admin_restore.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

#define TOKENS 150 /* more statements than may be on their way to a server */

static struct errinfo e;
static unsigned
    kill_at; /* what is sent for the n-th time is the last that this process does */
static char file[64];
static struct store_key key = {.make = CRYPT_FILE};

int __real_PQpipelineSync(void *pg);
int __wrap_PQpipelineSync(void *pg);
int __wrap_PQpipelineSync(void *pg)
{
    const int done = __real_PQpipelineSync(pg);

    if (kill_at > 0 && --kill_at == 0) {
        (void)nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
        (void)raise(SIGKILL);
    }
    return done;
}

struct state {
    unsigned char bytes[1 << 16];
    size_t n;
};

static void add(void *arg, const char *data, size_t n)
{
    struct state *s = arg;

    assert_true(n <= sizeof s->bytes - s->n);
    memcpy(s->bytes + s->n, data, n);
    s->n += n;
}

/* What must be the same, whichever engine has it. */
static void read_state(const char *where, struct state *s)
{
    static const char *const text[] = {
        "SELECT hash FROM change_log ORDER BY seq",
        "SELECT mac FROM change_log ORDER BY seq",
        "SELECT digest FROM change_log ORDER BY seq DESC LIMIT 1",
        "SELECT hash FROM access_log ORDER BY seq",
        "SELECT mac FROM subjects ORDER BY subject_key",
        "SELECT seen FROM subjects ORDER BY subject_key",
        "SELECT mac FROM templates ORDER BY template_key",
        "SELECT mac FROM tokens ORDER BY token_key",
        "SELECT mac FROM calibrations ORDER BY calibration_key",
        "SELECT s.uid FROM attempts a JOIN subjects s USING (subject_key) ORDER BY s.uid",
        "SELECT nonce FROM nonces ORDER BY nonce",
        "SELECT noise_um FROM scans ORDER BY token, day"};
    struct rawdb *d;

    s->n = 0;
    must(rawdb_open(where, &d, &e));
    for (size_t i = 0; i < sizeof text / sizeof *text; i++)
        must(rawdb_each(d, text[i], add, s, &e));
    rawdb_close(d);
}

static void problem(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    (void)arg, (void)log, (void)seq;
    fail_msg("%s", line);
}

static void same_state(const char *where, const struct state *wanted)
{
    static struct state is;
    struct log_walk walk;
    struct store *s;

    read_state(where, &is);
    assert_int_equal(is.n, wanted->n);
    assert_memory_equal(is.bytes, wanted->bytes, is.n);
    must(store_open(where, STORE_WRITE, &key, &s, &e));
    must(store_verify(s, NULL, NULL, &e));
    must(store_audit_verify(s, problem, NULL, &walk, &e));
    store_close(s);
}

static void fill(const char *where)
{
    struct store_calibration k = tempdb_calibration(8);
    struct store_template t;
    struct store_token token;
    struct store *s;
    char secret[65], name[24];

    must(store_open(where, STORE_CREATE, &key, &s, &e));
    for (int i = 0; i < TOKENS; i++) {
        (void)snprintf(name, sizeof name, "token %d", i);
        must(store_token_create(s, "test", name, STORE_SCOPE_VERIFY, "", tempdb_in(60),
                                secret, &token, &e));
    }
    tempdb_enroll(s, "alice", "first", &tempdb_face[0], &t);
    tempdb_enroll(s, "bob", "", &tempdb_face[1], &t);
    tempdb_enroll(s, "alice", "", &tempdb_face[2], &t);
    tempdb_add(s, "carol");
    must(tempdb_record(s, "bob", STORE_RECORD_FAILED, &e));
    must(tempdb_erase(s, "test", "carol", &e));
    must(store_calibration_add(s, "test", &k, &e));
    store_close(s);
}

static enum status move(const char *from, const char *to)
{
    struct admin_copied found;
    struct store *s;
    enum status st;

    must(store_open(from, STORE_READ, &key, &s, &e));
    st = admin_move(s, to, &key, &found, &e);
    store_close(s);
    if (st == ST_OK)
        assert_int_equal(found.templates, 3);
    return st;
}

BEFORE_ALL(begin)
{
    static char path[64];

    (void)snprintf(file, sizeof file, "%s/from", tempdb_dir);
    (void)snprintf(path, sizeof path, "%s/from.key", tempdb_dir);
    key.path = path;
}

TEST(test_to_a_file)
{
    static struct state was;
    char there[64], back[64];

    tempdb_remove();
    fill(file);
    read_state(file, &was);
    (void)snprintf(there, sizeof there, "%s/there", tempdb_dir);
    (void)snprintf(back, sizeof back, "%s/back", tempdb_dir);
    must(move(file, tempdb_server ? tempdb_path : there));
    same_state(tempdb_server ? tempdb_path : there, &was);
    fails(move(file, tempdb_server ? tempdb_path : there), ST_EEXISTS);
    must(move(tempdb_server ? tempdb_path : there, back));
    same_state(back, &was);
    same_state(file, &was);
}

/* A row that is not as it was written, or is missing, is not copied. */
TEST(test_not_as_it_was_written)
{
    struct rawdb *d;

    tempdb_remove();
    fill(file);
    must(rawdb_open(file, &d, &e));
    must(rawdb_run(d, "UPDATE templates SET points = points - 1 WHERE template_key = 2",
                   &e));
    fails(move(file, tempdb_path), ST_ECORRUPT);
    must(rawdb_run(d, "UPDATE templates SET points = points + 1 WHERE template_key = 2",
                   &e));
    must(rawdb_run(d, "DELETE FROM tokens WHERE token_key = 7", &e));
    fails(move(file, tempdb_path), ST_EREFUSED);
    rawdb_close(d);
    fails(store_open(tempdb_path, STORE_READ, &key, &(struct store *){NULL}, &e),
          ST_ENOTFOUND);
}

TEST(test_killed)
{
    static struct state was;
    unsigned killed = 0;
    bool done = false;

    if (!tempdb_server)
        skip();
    tempdb_remove();
    fill(file);
    read_state(file, &was);
    for (unsigned n = 1; !done; n++) {
        enum crypt_kind kind;
        const pid_t child = fork();
        int how;

        assert_true(child >= 0);
        if (child == 0) {
            kill_at = n;
            _exit(move(file, tempdb_path) == ST_OK);
        }
        assert_int_equal(waitpid(child, &how, 0), child);
        assert_true(WIFSIGNALED(how) && WTERMSIG(how) == SIGKILL);
        done = store_kind(tempdb_path, &kind, &e) == ST_OK;
        same_state(done ? tempdb_path : file, &was);
        killed += !done;
    }
    same_state(file, &was);
    assert_in_range(killed, 3, 1000);
}
