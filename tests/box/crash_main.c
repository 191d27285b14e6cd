/* crash -- runs a command that changes a database many times, ends it at a random moment, and
 * checks the state that is left.
 * Usage: crash SHIM BASE WORK kill|power SEED TRIALS COMMAND...
 *   SHIM   crash_shim.so          BASE  a folder with the state before (db, db.key, ...)
 *   WORK   a folder of its own    in COMMAND an argument @NAME is the file NAME of the trial's
 * kill   the command is killed when it begins a change to the folder, or in the middle of a write
 * power  the command ran to its end; the folder is in the state of the disk after some of its
 *        changes, with none or some of those that were not synced
 * Afterwards the database must be intact, with the contents from before the command or, if the
 * command succeeded, those of an undisturbed run.  Running the command again must give the
 * latter, and no bytes of deleted keys and templates may be left.
 * Trial i of seed S is trial 0 of seed S + i.  Exit status 1: a trial failed; WORK is kept. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "brute.h"
#include "crash.h"

#define ARGS_MAX    32
#define SECRETS_MAX 256
#define LOG_EVERY                                                                        \
    200 /* trials of one log: another one has other random bytes and times */

static const char *shim, *base, *work;
static char **command;
static char dir[CRASH_PATH], log_path[CRASH_PATH];
static char before[CRASH_TEXT], after[CRASH_TEXT];
static struct crash_secret gone[SECRETS_MAX]; /* those that the command deletes */
static size_t ngone;

struct tally {
    unsigned trials, ended, old, new; /* ended: the command succeeded */
};

/* ---- the command */

static char **arguments(void)
{
    static char *args[ARGS_MAX + 1];
    static char path[ARGS_MAX][CRASH_PATH];
    size_t n = 0;

    for (; command[n] != NULL && n < ARGS_MAX; n++) {
        args[n] = command[n];
        if (command[n][0] == '@') {
            crash_join(path[n], dir, command[n] + 1);
            args[n] = path[n];
        }
    }
    args[n] = NULL;
    return args;
}

static void number(const char *name, size_t n)
{
    char text[32];

    (void)snprintf(text, sizeof text, "%zu", n);
    (void)setenv(name, text, 1);
}

/* at: the number of the change at which the command is killed; 0: none.  Returns its exit status;
 * -1: killed. */
static int run(bool logged, size_t at, bool torn)
{
    char **args = arguments();
    const pid_t child = fork();
    int status, null;

    if (child == 0) {
        if ((null = open("/dev/null", O_RDWR)) < 0 || dup2(null, 0) < 0 ||
            dup2(null, 1) < 0 || dup2(null, 2) < 0)
            _exit(126);
        (void)setenv("CRASH_DIR", dir, 1);
        if (logged)
            (void)setenv("CRASH_LOG", log_path, 1);
        if (at > 0)
            number("CRASH_AT", at);
        if (torn)
            (void)setenv("CRASH_TORN", "1", 1);
        (void)setenv("LD_PRELOAD", shim, 1);
        (void)execv(args[0], args);
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) != child) {
        perror("fork");
        exit(2);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static struct crash_log *record(void)
{
    struct crash_log *l;
    int rc;

    crash_copy(base, dir);
    l = crash_log_new(dir);
    if ((rc = run(true, 0, false)) != 0) {
        (void)fprintf(stderr, "%s ends with %d without being killed\n", command[0], rc);
        exit(2);
    }
    crash_log_read(l, log_path);
    return l;
}

/* Runs the command undisturbed and records the contents before and after it. */
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

/* ---- one trial */

static bool fail(const char *what, const char *text)
{
    (void)printf("FAIL: %s: %s\n", what, text);
    return false;
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

static bool trial_kill(size_t n, struct brute_rng *rng, struct tally *t)
{
    /* Failed changes are counted and are not in the log. */
    const size_t at = 1 + (size_t)(brute_rand(rng) % (n + n / 8 + 2));
    const bool torn = brute_rand(rng) % 2 == 0;
    int rc;

    crash_copy(base, dir);
    rc = run(false, at, torn);
    if (rc > 0)
        return fail("the command", "ends with an error");
    if (settled(t, rc == 0))
        return true;
    (void)printf("killed at change %zu of about %zu%s\n", at, n, torn ? ", torn" : "");
    return false;
}

static bool trial_power(const struct crash_log *l, struct brute_rng *rng, struct tally *t)
{
    const size_t n = crash_log_n(l);
    const size_t at = brute_rand(rng) % 4 == 0 ? n : (size_t)(brute_rand(rng) % (n + 1));
    const enum crash_loss loss = brute_rand(rng) % 3 == 0 ? CRASH_LOSE : CRASH_SOME;

    crash_log_state(l, at, loss, rng, dir);
    if (settled(t, at == n))
        return true;
    (void)printf("power lost after change %zu of %zu, %s of the rest is kept\n", at, n,
                 loss == CRASH_LOSE ? "nothing" : "some");
    return false;
}

int main(int argc, char **argv)
{
    struct tally t = {0};
    struct crash_log *l = NULL;
    unsigned long long seed;
    unsigned long trials;
    bool power, ok = true;

    if (argc < 8 || argc - 7 > ARGS_MAX) {
        (void)fprintf(stderr, "crash SHIM BASE WORK kill|power SEED TRIALS COMMAND...\n");
        return 2;
    }
    shim = argv[1];
    base = argv[2];
    work = argv[3];
    power = strcmp(argv[4], "power") == 0;
    seed = strtoull(argv[5], NULL, 10);
    trials = strtoul(argv[6], NULL, 10);
    command = argv + 7;
    crash_join(dir, work, "trial");
    crash_join(log_path, work, "log");
    for (unsigned long i = 0; i < trials && ok; i++) {
        struct brute_rng rng = {seed + i};

        if (i % LOG_EVERY == 0) {
            crash_log_free(l);
            l = record();
            if (i == 0)
                learn();
        }
        t.trials++;
        ok = power ? trial_power(l, &rng, &t) : trial_kill(crash_log_n(l), &rng, &t);
        if (!ok)
            (void)printf("seed %llu\n", seed + i);
    }
    (void)printf("%u trials, %zu changes: %u ended well, %u as before, %u done\n",
                 t.trials, l != NULL ? crash_log_n(l) : 0, t.ended, t.old, t.new);
    crash_log_free(l);
    if (ok)
        crash_remove(dir);
    return ok ? 0 : 1;
}
