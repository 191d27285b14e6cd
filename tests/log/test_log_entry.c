/* What an entry's hash, MAC and signature are made of: by values that were computed from
 * db/FORMAT.md with another program, and by each field of it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "fixed_keys.h"
#include "log_entry.h"

static struct crypt *keys;
static unsigned char before[LOG_HASH];

static struct log_entry example(enum log_name log)
{
    struct log_entry entry = {.log = log,
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
    log_hash(before, &entry, entry.hash);
    log_mac(keys, entry.hash, entry.mac);
    return entry;
}

static void assert_hex(const void *bytes, size_t n, const char *wanted)
{
    char hex[2 * CRYPT_SIGN + 1];

    assert_string_equal(sodium_bin2hex(hex, sizeof hex, bytes, n), wanted);
}

static void test_golden(void **state)
{
    struct log_entry change = example(LOG_CHANGES), access = example(LOG_ACCESSES);

    (void)state;
    assert_hex(change.hash, LOG_HASH,
               "e42b80e59c7d3b9403241f49ec8e56ff522ad15ead77a35c1a75580d8c2be8fd");
    assert_hex(access.hash, LOG_HASH,
               "8ac7088a91cb76624a4f8b2492936dba863a25ce15b3632b39883fe382195295");
    assert_hex(change.mac, CRYPT_HASH,
               "721ea9485881bf86f9948ee2a88d6abad245326cce308c762e62d3becc030222");
    log_sign(keys, &change);
    assert_hex(change.signature, CRYPT_SIGN,
               "fcb7a812c637cb48cfe6d726482ba985f739c0e33fd0d7578d33d26f67d595fc"
               "109eab1e79c07224f52fcd3c30bbad1b1191847fc2a21c705e82c37774b8770a");
}

/* Every byte of an entry counts, and a text's end: no two entries have the same hash. */
static void test_hash(void **state)
{
    const struct log_entry was = example(LOG_CHANGES);
    const struct {
        size_t at, n;
    } field[] = {
        {offsetof(struct log_entry, log), 1},
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

    (void)state;
    for (size_t i = 0; i < sizeof field / sizeof *field; i++)
        for (size_t k = 0; k < field[i].n; k++) {
            entry = was;
            ((unsigned char *)&entry)[field[i].at + k] ^= 1;
            log_hash(before, &entry, hash);
            if (memcmp(hash, was.hash, sizeof hash) == 0)
                fail_msg("field %zu, byte %zu is not in the hash", i, k);
        }
    for (size_t k = 0; k < LOG_HASH; k++) {
        before[k] ^= 1;
        log_hash(before, &was, hash);
        before[k] ^= 1;
        assert_memory_not_equal(hash, was.hash, sizeof hash);
    }
    entry = was;
    (void)snprintf(entry.kind, sizeof entry.kind, "enrollg");
    (void)snprintf(entry.actor, sizeof entry.actor, "ate");
    log_hash(before, &entry, hash);
    assert_memory_not_equal(hash, was.hash, sizeof hash);
    memcpy(hash, before, sizeof hash);
    log_hash(hash, &was, hash); /* in place */
    assert_memory_equal(hash, was.hash, sizeof hash);
}

static void test_signature(void **state)
{
    unsigned char public[CRYPT_KEY], other[CRYPT_KEY], secret[crypto_sign_SECRETKEYBYTES];
    struct log_entry entry = example(LOG_CHANGES);

    (void)state;
    crypt_public(keys, public);
    (void)crypto_sign_seed_keypair(other, secret, (const unsigned char[32]){1});
    assert_false(log_signed(public, &entry));
    log_sign(keys, &entry);
    assert_true(log_signed(public, &entry));
    assert_false(log_signed(other, &entry));
    entry.seq++;
    assert_false(log_signed(public, &entry));
    entry.seq--;
    entry.at[0]++;
    assert_false(log_signed(public, &entry));
    entry.at[0]--;
    entry.hash[31] ^= 1;
    assert_false(log_signed(public, &entry));
    entry.hash[31] ^= 1;
    entry.is_signed = false;
    assert_false(log_signed(public, &entry));
}

static void test_trimmed(void **state)
{
    struct log_entry entry = {.log = LOG_CHANGES, .kind = LOG_TRIM, .outcome = "120"};
    struct log_end to;

    (void)state;
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

static void test_act(void **state)
{
    struct log_act by;
    char longest[LOG_TEXT + 2];

    (void)state;
    memset(longest, 'x', sizeof longest);
    longest[LOG_TEXT + 1] = '\0';
    assert_int_equal(log_act(&by, longest, NULL), ST_EINVAL);
    longest[LOG_TEXT] = '\0';
    assert_int_equal(log_act(&by, longest, NULL), ST_OK);
    assert_int_equal(log_act(&by, "a\nb", NULL), ST_EINVAL);
    assert_int_equal(log_act(&by, "", NULL), ST_OK);
    assert_int_equal(strlen(by.at), 24);
}

static int begin(void **state)
{
    (void)state;
    memset(before, 7, sizeof before);
    return (keys = fixed_keys()) != NULL ? 0 : 1;
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
        cmocka_unit_test(test_golden),    cmocka_unit_test(test_hash),
        cmocka_unit_test(test_signature), cmocka_unit_test(test_trimmed),
        cmocka_unit_test(test_act),
    };

    return cmocka_run_group_tests_name("log_entry", tests, begin, end);
}
