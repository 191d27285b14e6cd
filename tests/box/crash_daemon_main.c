/* crash_daemon -- several clients enrol, verify and erase subjects at once; the daemon is killed
 * or loses power at a random moment; then the database must agree with all responses it sent.
 * Usage: crash_daemon SHIM BASE WORK kill|power SEED TRIALS SCAN COMMAND...
 *   as crash; SCAN  a PLY file to enroll; COMMAND  listens on the Unix socket WORK/socket
 * kill   the daemon is killed when it begins a change to the folder, or in the middle of a write
 * power  the folder is in the state of the disk after some of the daemon's changes
 * Trial i of seed S is trial 0 of seed S + i, except for the timing of the threads.  Exit status
 * 1: an enrolled subject is lost, an erased one is still there, or the database is damaged. */
#include <errno.h>
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

#define CLIENTS      4
#define SUBJECTS_MAX 60 /* of each client */
#define ARGS_MAX     32
#define SCAN_MAX     (1 << 20)
#define RESPONSE_MAX (64 << 10)
#define SECRETS_MAX  1024
#define LOG_EVERY    50
#define NEVER        UINT64_MAX

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

static const char *shim, *base, *work;
static char **command;
static char dir[CRASH_PATH], log_path[CRASH_PATH];
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

/* ---- the daemon */

static pid_t start(bool logged, size_t at, bool torn)
{
    char *args[ARGS_MAX + 1], path[CRASH_PATH], text[32];
    size_t n = 0;
    pid_t child;
    int null;

    for (; command[n] != NULL; n++)
        args[n] = command[n];
    args[n] = NULL;
    for (size_t i = 0; i < n; i++)
        if (args[i][0] == '@') {
            crash_join(path, dir, args[i] + 1);
            args[i] = path;
        }
    (void)unlink(address.sun_path);
    (void)unlink(log_path);
    if ((child = fork()) != 0)
        return child;
    if ((null = open("/dev/null", O_RDWR)) < 0 || dup2(null, 0) < 0 ||
        dup2(null, 1) < 0 || dup2(null, 2) < 0)
        _exit(126);
    (void)setenv("CRASH_DIR", dir, 1);
    if (logged)
        (void)setenv("CRASH_LOG", log_path, 1);
    (void)snprintf(text, sizeof text, "%zu", at);
    if (at > 0)
        (void)setenv("CRASH_AT", text, 1);
    if (torn)
        (void)setenv("CRASH_TORN", "1", 1);
    (void)setenv("LD_PRELOAD", shim, 1);
    (void)execv(args[0], args);
    _exit(127);
}

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
static void run(bool logged, size_t at, bool torn, int clients, uint64_t seed)
{
    const pid_t daemon = start(logged, at, torn);
    int status;

    dead = false;
    busy = clients;
    for (int i = 0; i < clients; i++) {
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
    for (int i = 0; i < clients; i++)
        (void)pthread_join(client[i].thread, NULL);
    for (int i = clients; i < CLIENTS; i++)
        client[i].n = 0;
}

/* ---- what is left */

static bool in_text(const char *text, const char *id)
{
    char line[40];

    (void)snprintf(line, sizeof line, "\n%s ", id);
    return strstr(text, line) != NULL;
}

/* Whether the database agrees with the responses received before length `at` of the log. */
static bool kept(uint64_t at, unsigned *confirmed)
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
            *confirmed += p->enrolled <= at ? 1 : 0;
            *confirmed += p->erased <= at ? 1 : 0;
        }
    return true;
}

static size_t changes_at(const struct crash_log *l, uint64_t bytes)
{
    size_t n = 0;

    while (n < crash_log_n(l) && crash_log_bytes(l, n + 1) <= bytes)
        n++;
    return n;
}

/* Whether dir has no bytes left of the last subject that the only client had erased by then. */
static bool gone(const struct crash_log *l, uint64_t at)
{
    static struct crash_secret had[SECRETS_MAX], has[SECRETS_MAX];
    const struct subject *last = NULL;
    char then[CRASH_PATH];
    size_t n = 0, nhad, nhas, k, found;

    for (size_t i = 0; i < client[0].n; i++)
        if (client[0].subject[i].erased <= at &&
            (last == NULL || client[0].subject[i].erased > last->erased))
            last = &client[0].subject[i];
    if (last == NULL)
        return true;
    crash_join(then, work, "then");
    crash_log_state(l, changes_at(l, last->erase_sent), CRASH_KEEP, NULL, then);
    nhad = crash_secrets(then, had, SECRETS_MAX);
    crash_log_state(l, changes_at(l, last->erased), CRASH_KEEP, NULL, then);
    nhas = crash_secrets(then, has, SECRETS_MAX);
    crash_remove(then);
    for (size_t i = 0; i < nhad; i++) {
        for (k = 0; k < nhas && memcmp(&had[i], &has[k], sizeof *had) != 0;)
            k++;
        if (k == nhas)
            had[n++] = had[i];
    }
    if (n < 2) { /* a key and a template */
        (void)printf("FAIL: no secrets of %s to look for\n", last->id);
        return false;
    }
    if ((found = crash_found(had, n, dir)) > 0)
        (void)printf("FAIL: %s was erased, and %zu of its %zu secrets are still there\n",
                     last->id, found, n);
    return found == 0;
}

/* ---- trials */

static bool trial_kill(struct brute_rng *rng, uint64_t seed, unsigned *confirmed)
{
    const size_t at = 1 + (size_t)(brute_rand(rng) % 700);
    const bool torn = brute_rand(rng) % 2 == 0;

    crash_copy(base, dir);
    run(false, at, torn, CLIENTS, seed);
    if (!wrong &&
        kept(0, confirmed)) /* without a log all responses count as received at 0 */
        return true;
    (void)printf("killed at change %zu%s\n", at, torn ? ", torn" : "");
    return false;
}

static struct crash_log *record(uint64_t seed, int clients)
{
    struct crash_log *l;

    crash_copy(base, dir);
    l = crash_log_new(dir);
    run(true, 0, false, clients, seed);
    crash_log_read(l, log_path);
    return l;
}

static bool trial_power(const struct crash_log *l, int clients, struct brute_rng *rng,
                        unsigned *confirmed)
{
    const size_t at = (size_t)(brute_rand(rng) % (crash_log_n(l) + 1));
    const enum crash_loss loss = brute_rand(rng) % 3 == 0 ? CRASH_LOSE : CRASH_SOME;
    const uint64_t bytes = crash_log_bytes(l, at);

    crash_log_state(l, at, loss, rng, dir);
    if ((clients > 1 || gone(l, bytes)) && kept(bytes, confirmed))
        return true;
    (void)printf("power lost after change %zu of %zu, %s of the rest is kept\n", at,
                 crash_log_n(l), loss == CRASH_LOSE ? "nothing" : "some");
    return false;
}

int main(int argc, char **argv)
{
    struct crash_log *l = NULL;
    unsigned long long seed;
    unsigned long trials, done = 0;
    unsigned confirmed = 0;
    bool power, ok = true;
    int clients = CLIENTS;
    FILE *f;

    if (argc < 10 || argc - 9 > ARGS_MAX) {
        (void)fprintf(stderr,
                      "crash_daemon SHIM BASE WORK kill|power SEED TRIALS SCAN PROBE "
                      "COMMAND...\n");
        return 2;
    }
    shim = argv[1];
    base = argv[2];
    work = argv[3];
    power = strcmp(argv[4], "power") == 0;
    seed = strtoull(argv[5], NULL, 10);
    trials = strtoul(argv[6], NULL, 10);
    for (int i = ENROLLED; i <= PROBE; i++) {
        if ((f = fopen(argv[7 + i], "rb")) == NULL ||
            (scan[i].len = fread(scan[i].bytes, 1, SCAN_MAX, f)) == 0) {
            perror(argv[7 + i]);
            return 2;
        }
        (void)fclose(f);
    }
    command = argv + 9;
    crash_join(dir, work, "trial");
    crash_join(log_path, work, "log");
    if (snprintf(address.sun_path, sizeof address.sun_path, "%s/socket", work) >=
        (int)sizeof address.sun_path)
        return 2;
    for (; done < trials && ok; done++) {
        struct brute_rng rng = {seed + done};

        if (power && done % LOG_EVERY == 0) {
            crash_log_free(l);
            clients = done / LOG_EVERY % 2 == 0 ? 1 : CLIENTS;
            l = record(seed + done, clients);
        }
        ok = !wrong && (power ? trial_power(l, clients, &rng, &confirmed)
                              : trial_kill(&rng, seed + done, &confirmed));
        if (!ok)
            (void)printf("seed %llu\n", seed + done);
    }
    (void)printf("%lu trials: %u responses confirmed\n", done, confirmed);
    crash_log_free(l);
    if (ok)
        crash_remove(dir);
    return ok ? 0 : 1;
}
