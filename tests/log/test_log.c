/* Both logs: what an entry's hash, MAC and signature are made of, by values that another program
 * computed from db/FORMAT.md and by each field; and a walk along both, which reports what was
 * changed, removed, moved, doubled or cut off where it begins, with the database's keys and, of an
 * export, with the public key alone. */
#include <sodium.h>

#include "fixed_keys.h"
#include "log_walk.h"
#include "unit.h"

static struct crypt *keys;
static unsigned char public[CRYPT_KEY];
static unsigned char start[LOG_HASH]; /* the hash before */

/* ---- an entry */

static struct log_entry example(enum log_name log)
{
    struct log_entry entry = {.log = log,
                              .daemon = 3,
                              .seq = 5,
                              .at = "2026-11-23T20:00:00.000Z",
                              .kind = "enroll",
                              .actor = "gate",
                              .object = "0123456789abcdef0123456789abcdef",
                              .outcome = "created",
                              .accesses = {.seq = 9}};

    for (size_t i = 0; i < sizeof entry.uid; i++)
        entry.uid[i] = (unsigned char)i;
    for (size_t i = 0; i < sizeof entry.digest; i++)
        entry.digest[i] = (unsigned char)i;
    memset(entry.accesses.hash, 9, LOG_HASH);
    log_hash(start, &entry, entry.hash);
    log_mac(keys, entry.hash, entry.mac);
    return entry;
}

static void assert_hex(const void *bytes, size_t n, const char *wanted)
{
    char hex[2 * CRYPT_SIGN + 1];

    assert_string_equal(sodium_bin2hex(hex, sizeof hex, bytes, n), wanted);
}

TEST(test_golden)
{
    struct log_entry change = example(LOG_CHANGES), access = example(LOG_ACCESSES);

    assert_hex(change.hash, LOG_HASH,
               "9da30bb4801fd01ff9df309cffb28cbc25a46954934c752cb109ba220fba3666");
    assert_hex(access.hash, LOG_HASH,
               "138a7fcd074623a633f3c448d9bf564cb1e6f1332a023abf82f1cae8468f1753");
    assert_hex(change.mac, CRYPT_HASH,
               "46074d360e8b8b502e2504e04fc0ee86a51a88e6e25c54d551c85d95a9843ff1");
    log_sign(keys, &change, "");
    assert_hex(change.signature, CRYPT_SIGN,
               "532061f47b65dabac0bdbf34ca5890ea400512de30781bb236b97197ade5bec6"
               "dc8d37a7bd93bf1fc5b7ead02d910cfd214b8f26aa51f840661308285f1a7500");
}

/* Every byte of an entry counts, and a text's end: no two entries have the same hash. */
TEST(test_hash)
{
    const struct log_entry was = example(LOG_CHANGES);
    const struct {
        size_t at, n;
    } field[] = {
        {offsetof(struct log_entry, log), 1},
        {offsetof(struct log_entry, daemon), sizeof was.daemon},
        {offsetof(struct log_entry, seq), sizeof was.seq},
        {offsetof(struct log_entry, at), strlen(was.at)},
        {offsetof(struct log_entry, kind), strlen(was.kind)},
        {offsetof(struct log_entry, actor), strlen(was.actor)},
        {offsetof(struct log_entry, uid), sizeof was.uid},
        {offsetof(struct log_entry, object), strlen(was.object)},
        {offsetof(struct log_entry, outcome), strlen(was.outcome)},
        {offsetof(struct log_entry, digest), sizeof was.digest},
        {offsetof(struct log_entry, accesses.seq), sizeof was.accesses.seq},
        {offsetof(struct log_entry, accesses.hash), LOG_HASH},
    };
    struct log_entry entry;
    unsigned char hash[LOG_HASH];

    for (size_t i = 0; i < sizeof field / sizeof *field; i++)
        for (size_t k = 0; k < field[i].n; k++) {
            entry = was;
            ((unsigned char *)&entry)[field[i].at + k] ^= 1;
            log_hash(start, &entry, hash);
            if (memcmp(hash, was.hash, sizeof hash) == 0)
                fail_msg("field %zu, byte %zu is not in the hash", i, k);
        }
    for (size_t k = 0; k < LOG_HASH; k++) {
        start[k] ^= 1;
        log_hash(start, &was, hash);
        start[k] ^= 1;
        assert_memory_not_equal(hash, was.hash, sizeof hash);
    }
    entry = was;
    (void)snprintf(entry.kind, sizeof entry.kind, "enrollg");
    (void)snprintf(entry.actor, sizeof entry.actor, "ate");
    log_hash(start, &entry, hash);
    assert_memory_not_equal(hash, was.hash, sizeof hash);
    memcpy(hash, start, sizeof hash);
    log_hash(hash, &was, hash); /* in place */
    assert_memory_equal(hash, was.hash, sizeof hash);
}

TEST(test_signature)
{
    static const struct {
        size_t at;
        unsigned char bits;
    } change[] = {
        {0, 0},
        {offsetof(struct log_entry, seq), 1},
        {offsetof(struct log_entry, at), 1},
        {offsetof(struct log_entry, hash) + 31, 1},
        {offsetof(struct log_entry, is_signed), 1},
        {offsetof(struct log_entry, signature), 1},
    };
    unsigned char other[CRYPT_KEY], secret[crypto_sign_SECRETKEYBYTES];
    struct log_entry entry = example(LOG_CHANGES);

    (void)crypto_sign_seed_keypair(other, secret, (const unsigned char[32]){1});
    assert_false(log_signed(public, &entry, ""));
    log_sign(keys, &entry, "");
    assert_false(log_signed(other, &entry, ""));
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        struct log_entry changed = entry;

        ((unsigned char *)&changed)[change[i].at] ^= change[i].bits;
        assert_int_equal(log_signed(public, &changed, ""), i == 0);
    }
}

TEST(test_trimmed)
{
    struct log_entry entry = {.log = LOG_CHANGES, .kind = LOG_TRIM, .outcome = "120"};
    struct log_end to;

    memset(entry.object, 'a', 2 * LOG_HASH);
    assert_true(log_trimmed(&entry, &to));
    assert_int_equal(to.seq, 120);
    assert_int_equal(to.hash[31], 0xaa);
    entry.object[63] = '\0';
    assert_false(log_trimmed(&entry, &to));
    entry.object[63] = 'a';
    entry.log = LOG_ACCESSES;
    assert_false(log_trimmed(&entry, &to));
    entry.log = LOG_CHANGES;
    entry.kind[0] = 'T';
    assert_false(log_trimmed(&entry, &to));
}

TEST(test_act)
{
    struct log_act by;
    char longest[LOG_TEXT + 2];

    memset(longest, 'x', sizeof longest);
    longest[LOG_TEXT + 1] = '\0';
    assert_int_equal(log_act(&by, longest, NULL), ST_EINVAL);
    longest[LOG_TEXT] = '\0';
    assert_int_equal(log_act(&by, longest, NULL), ST_OK);
    assert_int_equal(log_act(&by, "a\nb", NULL), ST_EINVAL);
    assert_int_equal(log_act(&by, "", NULL), ST_OK);
    assert_int_equal(strlen(by.at), 24);
}

/* ---- a walk */

#define CHANGES  7 /* the fourth is signed, and the last */
#define ACCESSES 9 /* the first three were cut off before change 6 */
#define CUT      3
#define ROOM     12

struct logs {
    struct log_entry entry[LOGS][ROOM];
    size_t n[LOGS];
};

struct found {
    struct log_walk w;
    char lines[600];
};

static void note(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    struct found *f = arg;
    const size_t n = strlen(f->lines);

    (void)snprintf(f->lines + n, sizeof f->lines - n, "%s %llu: %s\n", log_word(log),
                   (unsigned long long)seq, line);
}

static struct found walk(const struct logs *l, bool with_keys)
{
    struct found f = {.lines = ""};

    log_walk_begin(&f.w, with_keys ? keys : NULL, public, note, &f);
    for (size_t i = 0; i < l->n[LOG_CHANGES]; i++)
        log_walk_step(&f.w, &l->entry[LOG_CHANGES][i]);
    log_walk_accesses(&f.w);
    for (size_t i = 0; i < l->n[LOG_ACCESSES]; i++)
        log_walk_step(&f.w, &l->entry[LOG_ACCESSES][i]);
    log_walk_end(&f.w);
    return f;
}

/* An entry gets its hash and its MAC after the one before it. */
static void chain(struct log_entry *entry, const struct log_entry *before, bool with_mac)
{
    static const unsigned char none[LOG_HASH];

    log_hash(before != NULL ? before->hash : none, entry, entry->hash);
    if (with_mac)
        log_mac(keys, entry->hash, entry->mac);
}

static void written(struct logs *l)
{
    struct log_entry all[ACCESSES];

    memset(l, 0, sizeof *l);
    for (size_t i = 0; i < ACCESSES; i++) {
        all[i] = (struct log_entry){.log = LOG_ACCESSES,
                                    .seq = i + 1,
                                    .at = "2026-11-23T20:00:00.000Z",
                                    .kind = "verify",
                                    .outcome = "match"};
        chain(&all[i], i > 0 ? &all[i - 1] : NULL, true);
    }
    l->n[LOG_ACCESSES] = ACCESSES - CUT;
    memcpy(l->entry[LOG_ACCESSES], all + CUT, (ACCESSES - CUT) * sizeof *all);
    l->n[LOG_CHANGES] = CHANGES;
    for (size_t i = 0; i < CHANGES; i++) {
        struct log_entry *const entry = &l->entry[LOG_CHANGES][i];
        const struct log_entry *const last =
            i < CHANGES - 1 ? &all[i] : &all[ACCESSES - 1];

        *entry = (struct log_entry){.log = LOG_CHANGES,
                                    .seq = i + 1,
                                    .at = "2026-11-23T20:00:00.000Z",
                                    .accesses = {.seq = last->seq}};
        memcpy(entry->accesses.hash, last->hash, LOG_HASH);
        (void)snprintf(entry->kind, sizeof entry->kind, "%s",
                       i == 5 ? LOG_TRIM : "add_subject");
        if (i == 5) {
            (void)snprintf(entry->outcome, sizeof entry->outcome, "%d", CUT);
            (void)sodium_bin2hex(entry->object, sizeof entry->object, all[CUT - 1].hash,
                                 LOG_HASH);
        }
        chain(entry, i > 0 ? entry - 1 : NULL, true);
        if (i == 3 || i == CHANGES - 1)
            log_sign(keys, entry, "");
    }
}

static void drop(struct logs *l, enum log_name log, size_t at, size_t n)
{
    memmove(&l->entry[log][at], &l->entry[log][at + n],
            (l->n[log] - at - n) * sizeof l->entry[log][0]);
    l->n[log] -= n;
}

static void put(struct logs *l, enum log_name log, size_t at, struct log_entry entry)
{
    memmove(&l->entry[log][at + 1], &l->entry[log][at],
            (l->n[log] - at) * sizeof l->entry[log][0]);
    l->entry[log][at] = entry;
    l->n[log]++;
}

static void edit(struct log_entry *entry)
{
    (void)snprintf(entry->actor, sizeof entry->actor, "nobody");
}

/* Hashes that fit, from an entry on that is not the first, as who has no key can make them. */
static void rehash(struct logs *l, enum log_name log, size_t from)
{
    for (size_t i = from; i < l->n[log]; i++)
        chain(&l->entry[log][i], &l->entry[log][i - 1], false);
}

static void assert_found(const struct logs *l, bool with_keys, enum log_name log,
                         uint64_t first, const char *line)
{
    const struct found f = walk(l, with_keys);

    if (f.w.problems == 0 || f.w.first_log != log || f.w.first != first ||
        strstr(f.lines, line) == NULL)
        fail_msg("%s, not %s %llu: %s", f.lines, log_word(log), (unsigned long long)first,
                 line);
}

TEST(test_as_written)
{
    struct logs l;
    struct found f;

    written(&l);
    for (int with_keys = 0; with_keys < 2; with_keys++) {
        f = walk(&l, with_keys != 0);
        if (f.w.problems != 0)
            fail_msg("%s", f.lines);
        assert_int_equal(f.w.entries, CHANGES + ACCESSES - CUT);
        assert_int_equal(f.w.checkpoints, 2);
        assert_int_equal(f.w.signed_to, CHANGES);
    }
}

/* Each entry of each log, with keys and without, changed in each way. */
static void tamper(const struct logs *was, enum log_name log, size_t at, bool k)
{
    const uint64_t seq = at + 1 + (log == LOG_ACCESSES ? CUT : 0);
    char wrong[60], missing[60];
    struct logs l = *was;

    (void)snprintf(wrong, sizeof wrong, "entry %d is not what was written", (int)seq);
    (void)snprintf(missing, sizeof missing, "entry %d is missing", (int)seq);
    edit(&l.entry[log][at]);
    assert_found(&l, k, log, seq, wrong);
    l = *was;
    l.entry[log][at].hash[0] ^= 1;
    assert_found(&l, k, log, seq, "not what was written");
    l = *was;
    l.entry[log][at].mac[0] ^= 1; /* which an export has not */
    if (k)
        assert_found(&l, k, log, seq, wrong);
    l = *was;
    put(&l, log, at + 1, l.entry[log][at]); /* doubled */
    assert_found(&l, k, log, seq, "not in its place");
    if (at == was->n[log] - 1)
        return;
    l = *was;
    drop(&l, log, at, 1);
    assert_found(&l, k, log, seq, missing);
    l = *was;
    edit(&l.entry[log][at]);
    edit(&l.entry[log][at + 1]);
    (void)snprintf(wrong, sizeof wrong, "entries %d to %d are not", (int)seq,
                   (int)seq + 1);
    assert_found(&l, k, log, seq, wrong); /* a run is one report */
    l = *was;
    put(&l, log, at, l.entry[log][was->n[log] - 1]); /* moved ahead */
    l.n[log]--;
    assert_found(&l, k, log, seq, at + 2 == was->n[log] ? "missing" : "are missing");
}

TEST(test_tampered)
{
    struct logs was;

    written(&was);
    for (int i = 0; i < 2 * LOGS; i++)
        for (size_t at = 0; at < was.n[i / 2]; at++)
            tamper(&was, (enum log_name)(i / 2), at, i % 2 != 0);
}

/* The ends: by the last change of the accesses, and by nothing of the changes but an anchor. */
TEST(test_cut_off)
{
    struct logs l, was;
    struct found f;

    written(&was);
    l = was;
    l.n[LOG_ACCESSES] -= 2;
    assert_found(&l, true, LOG_ACCESSES, ACCESSES - 1,
                 "entries 8 to 9 are cut off the end");
    l.n[LOG_ACCESSES] = 0;
    assert_found(&l, true, LOG_ACCESSES, CUT + 1, "entries 4 to 9 are cut off the end");
    l = was;
    drop(&l, LOG_ACCESSES, 0, 2); /* more than the trim says */
    assert_found(&l, true, LOG_ACCESSES, CUT + 1, "entries 4 to 5 are missing");
    l = was;
    l.n[LOG_CHANGES]--;
    f = walk(&l, false);
    assert_int_equal(f.w.signed_to, 4); /* not the last */
    assert_int_equal(f.w.entries, CHANGES - 1 + ACCESSES - CUT);
}

/* Three accesses each of the daemons 0 and 2, and two changes, one of each, that name the second. */
struct fleet {
    struct log_entry change[2], access[6];
    size_t n; /* of accesses */
};

static void fleet(struct fleet *f)
{
    *f = (struct fleet){.n = 6};
    for (size_t i = 0; i < 6; i++) {
        f->access[i] = (struct log_entry){.log = LOG_ACCESSES,
                                          .daemon = i < 3 ? 0 : 2,
                                          .seq = i % 3 + 1,
                                          .at = "2026-11-23T20:00:00.000Z",
                                          .kind = "verify"};
        chain(&f->access[i], i % 3 > 0 ? &f->access[i - 1] : NULL, true);
    }
    for (size_t i = 0; i < 2; i++) {
        const struct log_entry *const last = &f->access[3 * i + 1];

        f->change[i] = (struct log_entry){.log = LOG_CHANGES,
                                          .daemon = last->daemon,
                                          .seq = i + 1,
                                          .at = "2026-11-23T20:00:00.000Z",
                                          .kind = "add_subject",
                                          .accesses = {.seq = last->seq}};
        memcpy(f->change[i].accesses.hash, last->hash, LOG_HASH);
        chain(&f->change[i], i > 0 ? &f->change[0] : NULL, true);
    }
    log_sign(keys, &f->change[1], "");
}

static struct found walk_fleet(const struct fleet *l, bool with_keys)
{
    struct found f = {.lines = ""};

    log_walk_begin(&f.w, with_keys ? keys : NULL, public, note, &f);
    for (size_t i = 0; i < 2; i++)
        log_walk_step(&f.w, &l->change[i]);
    log_walk_accesses(&f.w);
    for (size_t i = 0; i < l->n; i++)
        log_walk_step(&f.w, &l->access[i]);
    log_walk_end(&f.w);
    return f;
}

static void assert_fleet(const struct fleet *l, bool with_keys, const char *lines)
{
    const struct found f = walk_fleet(l, with_keys);

    assert_string_equal(f.lines, lines);
}

/* Each daemon's accesses begin at 1, and end where its own change says, or later. */
TEST(test_fleet)
{
    struct fleet l;

    fleet(&l);
    assert_fleet(&l, true, "");
    assert_fleet(&l, false,
                 "accesses 3: entry 3 is not signed by any change\n"
                 "accesses 3: entry 3 of daemon 2 is not signed by any change\n");
    l.n = 5; /* the last was not yet named */
    assert_fleet(&l, true, "");
    l.n = 4;
    assert_fleet(&l, true, "accesses 2: entry 2 of daemon 2 is cut off the end\n");
    l.n = 3;
    assert_fleet(&l, true,
                 "accesses 1: entries 1 to 2 of daemon 2 are cut off the end\n");
    fleet(&l);
    memmove(&l.access[1], &l.access[3],
            3 * sizeof *l.access); /* of the first, one is left */
    l.n = 4;
    assert_fleet(&l, true, "accesses 2: entry 2 is cut off the end\n");
    fleet(&l);
    l.access[4].daemon = 1; /* as if another's */
    assert_fleet(&l, true,
                 "accesses 2: entry 2 of daemon 1 is behind another daemon's\n"
                 "accesses 2: entry 2 of daemon 2 is missing\n");
}

/* Entries replaced and added with hashes that fit, without the keys. */
TEST(test_forged)
{
    unsigned char mine[CRYPT_KEY], secret[crypto_sign_SECRETKEYBYTES];
    struct log_entry more;
    struct logs l, was;

    (void)crypto_sign_keypair(mine, secret);
    written(&was);
    l = was;
    edit(&l.entry[LOG_CHANGES][4]);
    rehash(&l, LOG_CHANGES, 4);
    assert_found(&l, true, LOG_CHANGES, 5, "entries 5 to 7 are not what was written");
    assert_int_equal(walk(&l, false).w.signed_to, 4);
    l = was;
    edit(&l.entry[LOG_ACCESSES][1]);
    rehash(&l, LOG_ACCESSES, 1);
    assert_found(&l, true, LOG_ACCESSES, CUT + 2, "not what was written");
    assert_found(&l, false, LOG_ACCESSES, ACCESSES,
                 "not the one that was the last when the last change was made");
    /* One more change, also with a signature of another key. */
    l = was;
    more = l.entry[LOG_CHANGES][CHANGES - 1];
    more.seq++;
    more.is_signed = false;
    chain(&more, &l.entry[LOG_CHANGES][CHANGES - 1], false);
    put(&l, LOG_CHANGES, CHANGES, more);
    assert_found(&l, true, LOG_CHANGES, CHANGES + 1, "not what was written");
    assert_int_equal(walk(&l, false).w.signed_to, CHANGES);
    l.entry[LOG_CHANGES][CHANGES].is_signed = true;
    assert_int_equal(walk(&l, false).w.signed_to, CHANGES);
    /* One more access: nothing has signed it. */
    l = was;
    more = l.entry[LOG_ACCESSES][l.n[LOG_ACCESSES] - 1];
    more.seq++;
    chain(&more, &l.entry[LOG_ACCESSES][l.n[LOG_ACCESSES] - 1], false);
    put(&l, LOG_ACCESSES, l.n[LOG_ACCESSES], more);
    assert_found(&l, true, LOG_ACCESSES, ACCESSES + 1, "not what was written");
    assert_found(&l, false, LOG_ACCESSES, ACCESSES + 1, "not signed");
    log_mac(keys, more.hash, l.entry[LOG_ACCESSES][l.n[LOG_ACCESSES] - 1].mac);
    assert_int_equal(walk(&l, true).w.problems, 0); /* with the key it goes on */
}

TEST(test_damaged)
{
    struct found f = {.lines = ""};
    struct logs l;

    written(&l);
    log_walk_begin(&f.w, keys, public, note, &f);
    log_walk_step(&f.w, &l.entry[LOG_CHANGES][0]);
    log_walk_damaged(&f.w, 2);
    for (size_t i = 2; i < CHANGES; i++)
        log_walk_step(&f.w, &l.entry[LOG_CHANGES][i]);
    log_walk_end(&f.w);
    assert_string_equal(f.lines, "changes 2: entry 2 is not what was written\n");
    log_walk_problem(&f.w, 9, "of another sort");
    assert_int_equal(f.w.problems, 2);
    assert_int_equal(f.w.first, 2);
}

BEFORE_ALL(begin)
{
    memset(start, 7, sizeof start);
    assert_false((keys = fixed_keys()) == NULL);
    crypt_public(keys, public);
}

AFTER_ALL(end)
{
    crypt_free(keys);
}
