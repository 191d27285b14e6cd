/* A walk along both logs: what was changed, removed, moved, doubled or cut off is reported where it
 * begins, with the database's keys and, of an export, with the public key alone. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "fixed_keys.h"
#include "log_walk.h"

#define CHANGES  7 /* the fourth is signed, and the last */
#define ACCESSES 9 /* the first three were cut off before change 6 */
#define CUT      3
#define ROOM     12

struct logs {
    struct log_entry entry[LOGS][ROOM];
    size_t n[LOGS];
};

static struct crypt *keys;
static unsigned char public[CRYPT_KEY];

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
    static const unsigned char start[LOG_HASH];

    log_hash(before != NULL ? before->hash : start, entry, entry->hash);
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
            log_sign(keys, entry);
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

/* Hashes that fit, from an entry on, as who has no key can make them. */
static void rehash(struct logs *l, enum log_name log, size_t from)
{
    for (size_t i = from; i < l->n[log]; i++)
        chain(&l->entry[log][i], i > 0 ? &l->entry[log][i - 1] : NULL, false);
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

static void test_as_written(void **state)
{
    struct logs l;
    struct found f;

    (void)state;
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

static void test_tampered(void **state)
{
    (void)state;
    for (int with_keys = 0; with_keys < 2; with_keys++)
        for (int i = 0; i < LOGS; i++) {
            const enum log_name log = (enum log_name)i;
            const uint64_t skip = log == LOG_ACCESSES ? CUT : 0;
            const bool k = with_keys != 0;
            char line[60];
            struct logs l, was;

            written(&l);
            was = l;
            for (size_t at = 0; at < l.n[log]; at++) {
                edit(&l.entry[log][at]);
                (void)snprintf(line, sizeof line, "entry %llu is not what was written",
                               (unsigned long long)(at + 1 + skip));
                assert_found(&l, k, log, at + 1 + skip, line);
                l = was;
                l.entry[log][at].hash[0] ^= 1;
                assert_found(&l, k, log, at + 1 + skip, "not what was written");
                l = was;
                l.entry[log][at].mac[0] ^= 1; /* which an export has not */
                if (k)
                    assert_found(&l, k, log, at + 1 + skip, line);
                l = was;
                if (at < l.n[log] - 1) {
                    drop(&l, log, at, 1);
                    (void)snprintf(line, sizeof line, "entry %llu is missing",
                                   (unsigned long long)(at + 1 + skip));
                    assert_found(&l, k, log, at + 1 + skip, line);
                    l = was;
                }
                put(&l, log, at + 1, l.entry[log][at]); /* doubled */
                assert_found(&l, k, log, at + 1 + skip, "not in its place");
                l = was;
            }
            edit(&l.entry[log][1]);
            edit(&l.entry[log][2]);
            (void)snprintf(line, sizeof line, "entries %llu to %llu are not",
                           (unsigned long long)(2 + skip),
                           (unsigned long long)(3 + skip));
            assert_found(&l, k, log, 2 + skip, line); /* a run is one report */
            l = was;
            put(&l, log, 1, l.entry[log][3]); /* moved ahead */
            drop(&l, log, 4, 1);
            assert_found(&l, k, log, 2 + skip, "are missing");
        }
}

/* The ends: by the last change of the accesses, and by nothing of the changes but an anchor. */
static void test_cut_off(void **state)
{
    struct logs l, was;
    struct found f;

    (void)state;
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
    assert_int_equal(f.w.at.seq, ACCESSES);
}

/* Entries replaced and added with hashes that fit, without the keys. */
static void test_forged(void **state)
{
    unsigned char mine[CRYPT_KEY], secret[crypto_sign_SECRETKEYBYTES];
    struct log_entry more;
    struct logs l, was;

    (void)state;
    (void)crypto_sign_keypair(mine, secret);
    written(&was);
    l = was;
    edit(&l.entry[LOG_CHANGES][4]);
    rehash(&l, LOG_CHANGES, 4);
    assert_found(&l, true, LOG_CHANGES, 5, "entries 5 to 7 are not what was written");
    assert_int_equal(walk(&l, false).w.signed_to, 4);
    l = was;
    edit(&l.entry[LOG_ACCESSES][1]);
    for (size_t i = 1; i < l.n[LOG_ACCESSES]; i++)
        chain(&l.entry[LOG_ACCESSES][i], &l.entry[LOG_ACCESSES][i - 1], false);
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

static void test_damaged(void **state)
{
    struct found f = {.lines = ""};
    struct logs l;

    (void)state;
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

static int begin(void **state)
{
    (void)state;
    if ((keys = fixed_keys()) == NULL)
        return 1;
    crypt_public(keys, public);
    return 0;
}

static int end(void **state)
{
    (void)state;
    crypt_free(keys);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_as_written), cmocka_unit_test(test_tampered),
        cmocka_unit_test(test_cut_off),    cmocka_unit_test(test_forged),
        cmocka_unit_test(test_damaged),
    };

    return cmocka_run_group_tests_name("log_walk", tests, begin, end);
}
