/* crash -- runs a command, or a daemon with clients, many times, ends it at a random moment, and
 * checks the state that is left.
 * Usage: crash SHIM BASE WORK kill|power SEED TRIALS [--clients SCAN PROBE] COMMAND...
 *   SHIM   crash_shim.so          BASE  a folder with the state before (db, db.key, ...)
 *   WORK   a folder of its own    in COMMAND an argument @NAME is the file NAME of the trial's
 *   --clients: COMMAND is a daemon on the Unix socket WORK/socket; clients enroll the face SCAN as
 *          many subjects at once, verify some by PROBE, and erase them
 * kill   the program is killed when it begins a change to the folder, or in the middle of a write
 * power  the program ran to its end; the folder is in the state of the disk after some of its
 *        changes, with none or some of those that were not synced
 * Afterwards the database must be intact.  After a command it has the contents from before or, if
 * the command succeeded, those of an undisturbed run; running the command again must give the
 * latter, and no bytes of deleted keys and templates may be left.  After a daemon it agrees with
 * all responses that were received.
 * Trial i of seed S is trial 0 of seed S + i, except for the timing of a daemon's threads.  Exit
 * status 1: a trial failed; WORK is kept. */
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "brute.h"
#include "crash.h"

#define ARGS_MAX     32
#define SECRETS_MAX  256
#define LOG_EVERY    50 /* trials of one log: another one has other random bytes and times */
#define CLIENTS      4
#define SUBJECTS_MAX 25 /* of each client */
#define SCAN_MAX     (1 << 20)
#define RESPONSE_MAX (64 << 10)
#define NEVER        UINT64_MAX

static const char *shim, *base, *work;
static char **command;
static char dir[CRASH_PATH], log_path[CRASH_PATH];
static char before[CRASH_TEXT], after[CRASH_TEXT];
static struct crash_secret gone[SECRETS_MAX]; /* those that the command deletes */
static size_t ngone;

struct tally {
    unsigned trials;
    unsigned ended, old, new; /* of a command; ended: it succeeded */
    unsigned confirmed;       /* responses of a daemon */
};

static bool fail(const char *what, const char *text)
{
    (void)printf("FAIL: %s: %s\n", what, text);
    return false;
}

static void setenv_number(const char *name, size_t n)
{
    char text[32];

    (void)snprintf(text, sizeof text, "%zu", n);
    (void)setenv(name, text, 1);
}

/* Starts the command.  at: the number of the change at which it is killed; 0: none. */
static pid_t start(bool logged, size_t at, bool torn)
{
    static char path[ARGS_MAX][CRASH_PATH];
    char *args[ARGS_MAX + 1] = {NULL};
    pid_t child;
    int null;

    for (size_t i = 0; command[i] != NULL; i++) {
        args[i] = command[i];
        if (command[i][0] == '@') {
            crash_join(path[i], dir, command[i] + 1);
            args[i] = path[i];
        }
    }
    (void)unlink(log_path);
    if ((child = fork()) < 0) {
        perror("fork");
        exit(2);
    }
    if (child > 0)
        return child;
    if ((null = open("/dev/null", O_RDWR)) < 0 || dup2(null, 0) < 0 ||
        dup2(null, 1) < 0 || dup2(null, 2) < 0)
        _exit(126);
    (void)setenv("CRASH_DIR", dir, 1);
    if (logged)
        (void)setenv("CRASH_LOG", log_path, 1);
    if (at > 0)
        setenv_number("CRASH_AT", at);
    if (torn)
        (void)setenv("CRASH_TORN", "1", 1);
    (void)setenv("LD_PRELOAD", shim, 1);
    (void)execv(args[0], args);
    _exit(127);
}

/* ---- a command */

/* Returns its exit status; -1: killed. */
static int run(bool logged, size_t at, bool torn)
{
    const pid_t child = start(logged, at, torn);
    int status;

    if (waitpid(child, &status, 0) != child) {
        perror("waitpid");
        exit(2);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* After the command ran undisturbed: the contents before and after it. */
static void learn(void)
{
    struct crash_secret there[SECRETS_MAX];
    size_t had, has, k;

    if (!crash_look(dir, after)) {
        (void)fprintf(stderr, "after it: %s\n", after);
        exit(1);
    }
    has = crash_secrets(dir, there, SECRETS_MAX);
    crash_copy(base, dir);
    had = crash_secrets(dir, gone, SECRETS_MAX);
    ngone = 0;
    for (size_t i = 0; i < had; i++) {
        for (k = 0; k < has && memcmp(&gone[i], &there[k], sizeof *gone) != 0;)
            k++;
        if (k == has)
            gone[ngone++] = gone[i];
    }
    if (!crash_look(dir, before)) {
        (void)fprintf(stderr, "before it: %s\n", before);
        exit(1);
    }
}

/* Removes what the manual says to remove before running the command again: a key that is not the
 * database's, and an old one that was kept. */
static void make_way(void)
{
    char path[CRASH_PATH], text[CRASH_TEXT];

    crash_join(path, dir, "db.key.new");
    if (access(path, F_OK) == 0) {
        char kept[CRASH_PATH];

        crash_join(kept, dir, "kept");
        (void)rename(path, kept);
        if (crash_look(dir, text))
            (void)unlink(kept);
        else
            (void)rename(kept, path);
    }
    crash_join(path, dir, "db.key.old");
    (void)unlink(path);
}

static bool settled(struct tally *t, bool ended)
{
    char text[CRASH_TEXT];
    size_t left;
    bool old, new;

    if (ended && (left = crash_found(gone, ngone, dir)) > 0) {
        (void)snprintf(text, sizeof text, "%zu of %zu", left, ngone);
        return fail("deleted secrets are in the file", text);
    }
    if (!crash_look(dir, text))
        return fail("the database", text);
    old = strcmp(text, before) == 0;
    new = strcmp(text, after) == 0;
    if (!new && (ended || !old))
        return fail(ended ? "not the contents after" : "neither before nor after", text);
    t->ended += ended;
    t->old += old && !new;
    t->new += new;
    make_way();
    (void)run(false, 0, false);
    if (!crash_look(dir, text))
        return fail("run again: the database", text);
    if (strcmp(text, after) != 0)
        return fail("run again: not the contents after", text);
    if ((left = crash_found(gone, ngone, dir)) > 0)
        return fail("run again: deleted secrets are in the file", "");
    return true;
}

/* ---- a daemon */

/* When the requests were sent and their responses received, in bytes of the crash log. */
struct subject {
    char id[32];
    uint64_t enroll_sent, enrolled, erase_sent, erased; /* NEVER */
};

struct client {
    pthread_t thread;
    struct brute_rng rng;
    int number;
    size_t n;
    struct subject subject[SUBJECTS_MAX];
};

static struct sockaddr_un address = {.sun_family = AF_UNIX};
/* One that is enrolled, and another of the same face, to verify with. */
enum { NONE = -1, ENROLLED, PROBE };
static struct {
    char bytes[SCAN_MAX];
    size_t len;
} scan[2];
static struct client client[CLIENTS];
static atomic_bool dead, wrong;
static atomic_int busy; /* clients */

static uint64_t now(void)
{
    struct stat sb;

    return stat(log_path, &sb) == 0 ? (uint64_t)sb.st_size : 0;
}

/* ---- clients */

static void pause_ms(long ms)
{
    (void)nanosleep(&(struct timespec){.tv_nsec = ms * 1000000}, NULL);
}

static bool send_all(int fd, const char *data, size_t n)
{
    ssize_t rc;

    for (; n > 0; data += rc, n -= (size_t)rc)
        if ((rc = send(fd, data, n, MSG_NOSIGNAL)) <= 0)
            return false;
    return true;
}

/* Sends a request, once the daemon listens.  Returns the status; 0: no complete response. */
static int ask(const char *method, const char *path, int body, char *response)
{
    char head[256];
    int fd = -1, status = 0;
    size_t n = 0;
    ssize_t rc;

    (void)snprintf(head, sizeof head,
                   "%s %s HTTP/1.1\r\nHost: x\r\nConnection: close\r\n"
                   "Content-Type: model/x-ply\r\nContent-Length: %zu\r\n\r\n",
                   method, path, body != NONE ? scan[body].len : 0);
    while (!dead) {
        if ((fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) >= 0 &&
            connect(fd, (struct sockaddr *)&address, sizeof address) == 0)
            break;
        (void)close(fd);
        fd = -1;
        pause_ms(5);
    }
    if (fd < 0)
        return 0;
    if (send_all(fd, head, strlen(head)) &&
        (body == NONE || send_all(fd, scan[body].bytes, scan[body].len))) {
        while (n < RESPONSE_MAX - 1 &&
               (rc = recv(fd, response + n, RESPONSE_MAX - 1 - n, 0)) > 0)
            n += (size_t)rc;
        response[n] = '\0';
        if (strstr(response, "\r\n\r\n") == NULL ||
            sscanf(response, "HTTP/1.1 %d", &status) != 1)
            status = 0;
    }
    (void)close(fd);
    return status;
}

static bool expect(const char *what, int status, int wanted)
{
    if (status != 0 && status != wanted) {
        (void)printf("%s: status %d, not %d\n", what, status, wanted);
        wrong = true;
    }
    return status == wanted;
}

static void *be_client(void *arg)
{
    struct client *c = arg;
    char path[96];
    char *response = malloc(RESPONSE_MAX);

    for (c->n = 0; response != NULL && c->n < SUBJECTS_MAX && !dead;) {
        struct subject *p = &c->subject[c->n], *old;

        *p = (struct subject){"", now(), NEVER, NEVER, NEVER};
        (void)snprintf(p->id, sizeof p->id, "c%d-%zu", c->number, c->n++);
        (void)snprintf(path, sizeof path, "/v1/subjects/%s/templates", p->id);
        if (!expect(path, ask("POST", path, ENROLLED, response), 201))
            break;
        p->enrolled = now();
        old = &c->subject[brute_rand(&c->rng) % c->n];
        if (old->erased != NEVER || brute_rand(&c->rng) % 2 == 0)
            continue;
        (void)snprintf(path, sizeof path, "/v1/subjects/%s/verify", old->id);
        if (!expect(path, ask("POST", path, PROBE, response), 200))
            break;
        if (strstr(response, "\"match\"") == NULL) {
            (void)printf("%s: no match\n", old->id);
            wrong = true;
        }
        old->erase_sent = now();
        (void)snprintf(path, sizeof path, "/v1/subjects/%s", old->id);
        if (!expect(path, ask("DELETE", path, NONE, response), 200))
            break;
        old->erased = now();
    }
    free(response);
    busy--;
    return NULL;
}

/* Runs a daemon and its clients; ends the daemon when all clients are done. */
static void serve(bool logged, size_t at, bool torn, uint64_t seed)
{
    pid_t daemon;
    int status;

    (void)unlink(address.sun_path);
    daemon = start(logged, at, torn);
    dead = false;
    busy = CLIENTS;
    for (int i = 0; i < CLIENTS; i++) {
        client[i].number = i;
        client[i].rng.state = seed * CLIENTS + (uint64_t)i;
        if (pthread_create(&client[i].thread, NULL, be_client, &client[i]) != 0)
            exit(2);
    }
    while (waitpid(daemon, &status, WNOHANG) == 0) { /* until the shim or we kill it */
        if (busy == 0)
            (void)kill(daemon, at > 0 || seed % 2 == 0 ? SIGKILL : SIGTERM);
        pause_ms(2);
    }
    dead = true;
    if (WIFEXITED(status) && (at > 0 || WEXITSTATUS(status) != 0)) {
        (void)printf("the daemon ended with %d\n", WEXITSTATUS(status));
        wrong = true;
    }
    for (int i = 0; i < CLIENTS; i++)
        (void)pthread_join(client[i].thread, NULL);
}

static bool in_text(const char *text, const char *id)
{
    char line[40];

    (void)snprintf(line, sizeof line, "\n%s ", id);
    return strstr(text, line) != NULL;
}

/* Whether the database agrees with the responses received before length `at` of the log. */
static bool kept(uint64_t at, struct tally *t)
{
    static char text[CRASH_TEXT + 1] = "\n";

    if (!crash_look(dir, text + 1)) {
        (void)printf("FAIL: the database: %s\n", text + 1);
        return false;
    }
    for (int i = 0; i < CLIENTS; i++)
        for (size_t k = 0; k < client[i].n; k++) {
            const struct subject *p = &client[i].subject[k];
            const bool there = in_text(text, p->id);

            if (p->enrolled <= at && p->erase_sent > at && !there) {
                (void)printf("FAIL: %s is lost\n", p->id);
                return false;
            }
            if (p->erased <= at && there) {
                (void)printf("FAIL: %s was erased and is still there\n", p->id);
                return false;
            }
            t->confirmed += p->enrolled <= at ? 1 : 0;
            t->confirmed += p->erased <= at ? 1 : 0;
        }
    return true;
}

/* ---- trials */

static struct crash_log *record(bool daemon, uint64_t seed)
{
    struct crash_log *l;
    int rc = 0;

    crash_copy(base, dir);
    l = crash_log_new(dir);
    if (daemon)
        serve(true, 0, false, seed);
    else
        rc = run(true, 0, false);
    if (rc != 0) {
        (void)fprintf(stderr, "%s ends with %d without being killed\n", command[0], rc);
        exit(2);
    }
    crash_log_read(l, log_path);
    return l;
}

/* n: the changes of an undisturbed run. */
static bool trial_kill(bool daemon, size_t n, struct brute_rng *rng, struct tally *t)
{
    const uint64_t seed = rng->state;
    /* Failed changes are counted and are not in the log. */
    const size_t at = 1 + (size_t)(brute_rand(rng) % (n + n / 8 + 2));
    const bool torn = brute_rand(rng) % 2 == 0;
    bool ok;
    int rc;

    crash_copy(base, dir);
    if (daemon) {
        serve(false, at, torn, seed);
        ok = !wrong && kept(0, t); /* without a log responses count as received at 0 */
    } else {
        rc = run(false, at, torn);
        ok = rc > 0 ? fail("the command", "ends with an error") : settled(t, rc == 0);
    }
    if (!ok)
        (void)printf("killed at change %zu of about %zu%s\n", at, n,
                     torn ? ", torn" : "");
    return ok;
}

static bool trial_power(bool daemon, const struct crash_log *l, struct brute_rng *rng,
                        struct tally *t)
{
    const size_t n = crash_log_n(l);
    const size_t at = brute_rand(rng) % 4 == 0 ? n : (size_t)(brute_rand(rng) % (n + 1));
    const bool some = brute_rand(rng) % 3 != 0;

    crash_log_state(l, at, some, rng, dir);
    if (daemon ? !wrong && kept(crash_log_bytes(l, at), t) : settled(t, at == n))
        return true;
    (void)printf("power lost after change %zu of %zu, %s of the rest is kept\n", at, n,
                 some ? "some" : "nothing");
    return false;
}

static void read_scan(const char *path, int which)
{
    FILE *f = fopen(path, "rb");

    if (f == NULL || (scan[which].len = fread(scan[which].bytes, 1, SCAN_MAX, f)) == 0) {
        perror(path);
        exit(2);
    }
    (void)fclose(f);
}

int main(int argc, char **argv)
{
    const bool daemon = argc > 10 && strcmp(argv[7], "--clients") == 0;
    struct tally t = {0};
    struct crash_log *l = NULL;
    unsigned long long seed;
    unsigned long trials;
    bool power, ok = true;

    if (argc < 8 || argc - 7 > ARGS_MAX) {
        (void)fprintf(stderr, "crash SHIM BASE WORK kill|power SEED TRIALS "
                              "[--clients SCAN PROBE] COMMAND...\n");
        return 2;
    }
    shim = argv[1];
    base = argv[2];
    work = argv[3];
    power = strcmp(argv[4], "power") == 0;
    seed = strtoull(argv[5], NULL, 10);
    trials = strtoul(argv[6], NULL, 10);
    command = argv + (daemon ? 10 : 7);
    for (int i = ENROLLED; i <= PROBE && daemon; i++)
        read_scan(argv[8 + i], i);
    crash_join(dir, work, "trial");
    crash_join(log_path, work, "log");
    if (snprintf(address.sun_path, sizeof address.sun_path, "%s/socket", work) >=
        (int)sizeof address.sun_path)
        return 2;
    for (unsigned long i = 0; i < trials && ok; i++) {
        struct brute_rng rng = {seed + i};

        if (i % LOG_EVERY == 0) {
            crash_log_free(l);
            l = record(daemon, seed + i);
            if (i == 0 && !daemon)
                learn();
        }
        t.trials++;
        ok = power ? trial_power(daemon, l, &rng, &t)
                   : trial_kill(daemon, crash_log_n(l), &rng, &t);
        if (!ok)
            (void)printf("seed %llu\n", seed + i);
    }
    (void)printf("%u trials, %zu changes", t.trials, l != NULL ? crash_log_n(l) : 0);
    if (daemon)
        (void)printf(": %u responses confirmed\n", t.confirmed);
    else
        (void)printf(": %u ended well, %u as before, %u done\n", t.ended, t.old, t.new);
    crash_log_free(l);
    if (ok)
        crash_remove(dir);
    return ok ? 0 : 1;
}
