/* Keys and what they encrypt: only the right key decrypts, only the bytes that were
 * encrypted, only in their place. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "keyfile.h"
#include "store_chain.h"
#include "row_crypt.h"
#include "vault.h"

static char dir[64], path[96];
static struct errinfo e;
static const unsigned char master[VAULT_KEY] = "a key of thirty-two bytes, not";

static void make(struct vault_root *root, struct vault **v)
{
    assert_int_equal(vault_make(VAULT_FILE, master, sizeof master, root, v, &e), ST_OK);
}

/* Each bit of the key, of the associated data and of the encrypted bytes counts. */
static void test_encrypted(void **state)
{
    const char text[] = "the volume between two surfaces", about[] = "row 7, column 3";
    unsigned char key[VAULT_KEY], in[sizeof text + VAULT_OVER], out[sizeof text];
    unsigned char other[sizeof in];
    char elsewhere[sizeof about];

    (void)state;
    randombytes_buf(key, sizeof key);
    vault_encrypt(key, about, sizeof about, text, sizeof text, in);
    assert_true(vault_decrypt(key, about, sizeof about, in, sizeof in, out));
    assert_memory_equal(out, text, sizeof text);
    vault_encrypt(key, about, sizeof about, text, sizeof text, other);
    assert_memory_not_equal(in, other, sizeof in); /* another nonce */
    for (size_t bit = 0; bit < 8 * sizeof in; bit++) {
        memcpy(other, in, sizeof in);
        other[bit / 8] ^= (unsigned char)(1U << bit % 8);
        assert_false(vault_decrypt(key, about, sizeof about, other, sizeof in, out));
    }
    for (size_t bit = 0; bit < 8 * sizeof about; bit++) {
        memcpy(elsewhere, about, sizeof about);
        elsewhere[bit / 8] ^= (char)(1U << bit % 8);
        assert_false(vault_decrypt(key, elsewhere, sizeof about, in, sizeof in, out));
    }
    for (size_t bit = 0; bit < 8 * sizeof key; bit++) {
        key[bit / 8] ^= (unsigned char)(1U << bit % 8);
        assert_false(vault_decrypt(key, about, sizeof about, in, sizeof in, out));
        key[bit / 8] ^= (unsigned char)(1U << bit % 8);
    }
    for (size_t n = 0; n < sizeof in; n++)
        assert_false(vault_decrypt(key, about, sizeof about, in, n, out));
}

static void test_root(void **state)
{
    struct vault_root root, bad;
    struct vault *v, *again;
    unsigned char uid[16] = "somebody", key[VAULT_KEY] = "their key", got[VAULT_KEY];
    unsigned char wrapped[VAULT_WRAPPED], a[VAULT_HASH], b[VAULT_HASH];

    (void)state;
    make(&root, &v);
    vault_wrap(v, uid, key, wrapped);
    vault_lookup(v, "subject", "alice", 5, a);
    assert_int_equal(vault_open(&root, master, sizeof master, &again, &e), ST_OK);
    assert_true(vault_unwrap(again, uid, wrapped, got));
    assert_memory_equal(got, key, sizeof key);
    vault_lookup(again, "subject", "alice", 5, b);
    assert_memory_equal(a, b, sizeof a);
    vault_lookup(again, "event", "alice", 5, b); /* another use */
    assert_memory_not_equal(a, b, sizeof a);
    vault_free(again);
    uid[0] ^= 1; /* another subject's */
    assert_false(vault_unwrap(v, uid, wrapped, got));

    got[0] = (unsigned char)(master[0] ^ 1);
    memcpy(got + 1, master + 1, sizeof master - 1);
    assert_int_equal(vault_open(&root, got, sizeof got, &again, &e), ST_EDENIED);
    assert_null(again);
    assert_int_equal(vault_open(&root, master, 31, &again, &e), ST_EINVAL);
    /* Nothing of the root can be changed: not even to one that needs no key. */
    for (size_t i = 0; i < sizeof root; i++) {
        enum status st;

        bad = root;
        ((unsigned char *)&bad)[i] ^= 1;
        if (memcmp(&bad.kind, &root.kind, sizeof bad.kind) == 0 &&
            bad.version == root.version && bad.passes == root.passes &&
            bad.mib == root.mib && memcmp(bad.salt, root.salt, sizeof bad.salt) == 0 &&
            memcmp(bad.plaintext, root.plaintext, sizeof bad.plaintext) == 0 &&
            memcmp(bad.public, root.public, sizeof bad.public) == 0 &&
            memcmp(bad.secrets, root.secrets, sizeof bad.secrets) == 0)
            continue; /* padding */
        st = vault_open(&bad, master, sizeof master, &again, &e);
        assert_true(st == ST_EDENIED || st == ST_ECORRUPT);
        assert_null(again);
    }
    bad = root;
    bad.kind = VAULT_PLAINTEXT;
    memcpy(bad.plaintext, master, sizeof master);
    assert_int_equal(vault_open(&bad, NULL, 0, &again, &e), ST_EDENIED);
    vault_free(v);
}

/* Another master key: lookups stay the same, wrapped keys do not. */
static void test_change(void **state)
{
    struct vault_root root, next, other;
    struct vault *v, *w, *again;
    unsigned char uid[16] = "somebody", key[VAULT_KEY] = "their key", got[VAULT_KEY];
    unsigned char wrapped[VAULT_WRAPPED], a[VAULT_HASH], b[VAULT_HASH], sign[VAULT_SIGN];

    (void)state;
    make(&root, &v);
    assert_int_equal(
        vault_change(v, &root, VAULT_PASSPHRASE, "open sesame", 11, &next, &w, &e),
        ST_OK);
    assert_int_equal(next.version, root.version + 1);
    vault_lookup(v, "subject", "alice", 5, a);
    vault_lookup(w, "subject", "alice", 5, b);
    assert_memory_equal(a, b, sizeof a);
    vault_wrap(v, uid, key, wrapped);
    assert_false(vault_unwrap(w, uid, wrapped, got));
    vault_sign(v, "here", 4, sign);
    assert_memory_equal(root.public, next.public, sizeof root.public);
    assert_true(vault_verify(next.public, "here", 4, sign));
    assert_false(vault_verify(next.public, "herf", 4, sign));
    assert_int_equal(vault_open(&next, "open sesame", 11, &again, &e), ST_OK);
    assert_true(vault_follows(v, &next) && vault_follows(w, &next));
    assert_true(vault_follows(v, &root));
    for (size_t i = 0; i < sizeof next.secrets; i++) {
        next.secrets[i] ^= 1;
        assert_false(vault_follows(v, &next));
        next.secrets[i] ^= 1;
    }
    next.passes++;
    assert_false(vault_follows(v, &next));
    next.passes--;
    vault_free(again);
    make(&other, &again); /* another database's */
    assert_false(vault_follows(v, &other) || vault_follows(again, &next));
    vault_free(again);
    assert_int_equal(vault_open(&next, "open Sesame", 11, &again, &e), ST_EDENIED);
    assert_int_equal(vault_open(&next, "", 0, &again, &e), ST_EINVAL);
    next.mib = 1 << 20; /* a hostile root does not eat the memory */
    assert_int_equal(vault_open(&next, "open sesame", 11, &again, &e), ST_ECORRUPT);
    vault_free(v);
    vault_free(w);
}

static void write_key(const char *text, size_t n, mode_t mode)
{
    FILE *f;

    (void)unlink(path);
    assert_non_null(f = fopen(path, "wb"));
    assert_int_equal(fwrite(text, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
    assert_int_equal(chmod(path, mode), 0);
}

static void test_keyfile(void **state)
{
    static char line[VAULT_SECRET_MAX + 2];
    unsigned char key[VAULT_KEY];
    struct keyfile *k;
    struct stat sb;

    (void)state;
    assert_int_equal(keyfile_read(path, &k, &e), ST_ENOTFOUND);
    assert_int_equal(keyfile_make(path, &e), ST_OK);
    assert_int_equal(stat(path, &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    assert_int_equal(keyfile_read(path, &k, &e), ST_OK);
    assert_int_equal(keyfile_key(k, path, key, &e), ST_OK);
    keyfile_free(k);
    assert_int_equal(keyfile_make(path, &e), ST_EEXISTS); /* none is ever overwritten */
    assert_int_equal(keyfile_make("/nowhere/at/all", &e), ST_EIO);

    memset(line, 'x', sizeof line);
    write_key(line, VAULT_SECRET_MAX, 0600);
    assert_int_equal(keyfile_read(path, &k, &e), ST_OK);
    assert_int_equal(k->len, VAULT_SECRET_MAX);
    assert_int_equal(keyfile_key(k, path, key, &e), ST_EINVAL);
    keyfile_free(k);
    write_key(line, VAULT_SECRET_MAX + 1, 0600);
    assert_int_equal(keyfile_read(path, &k, &e), ST_EINVAL);
    write_key("\n", 1, 0600);
    assert_int_equal(keyfile_read(path, &k, &e), ST_EINVAL);
    write_key("two\nlines\n", 10, 0600);
    assert_int_equal(keyfile_read(path, &k, &e), ST_EINVAL);
    write_key("a\0b", 3, 0600);
    assert_int_equal(keyfile_read(path, &k, &e), ST_EINVAL);
    for (unsigned bit = 0; bit < 5; bit++) { /* permissions of others */
        static const mode_t loose[] = {0601, 0602, 0604, 0620, 0610};
        const bool harmless = loose[bit] == 0610;

        write_key("secret", 6, loose[bit]);
        assert_int_equal(keyfile_read(path, &k, &e), harmless ? ST_OK : ST_EDENIED);
        keyfile_free(k);
    }
    if (geteuid() == 0) { /* another user's */
        write_key("secret", 6, 0600);
        assert_int_equal(chown(path, 65534, 65534), 0);
        assert_int_equal(keyfile_read(path, &k, &e), ST_EDENIED);
        assert_non_null(strstr(e.msg, "belongs to user 65534"));
        assert_int_equal(chown(path, 0, 65534),
                         0); /* root's, for a group: as credentials are */
        assert_int_equal(chmod(path, 0440), 0);
        assert_int_equal(keyfile_read(path, &k, &e), ST_OK);
        keyfile_free(k);
    }
    assert_int_equal(keyfile_read(dir, &k, &e), ST_EIO);
    (void)unlink(path);
}

/* Descriptions are decrypted as they were, for their own row alone. */
static void test_rows(void **state)
{
    struct vault_root root;
    struct vault *v;
    struct row_crypt_key k, other;
    unsigned char wrapped[VAULT_WRAPPED], in[ROW_CRYPT_ABOUT], model[8 + VAULT_OVER],
        out[8];
    struct store_subject s = {.id = "alice",
                              .reference = "consent",
                              .purpose = "door",
                              .created = "2026-01-01T00:00:00.000Z"},
                         t;
    struct store_template f = {.id = "0123456789abcdef0123456789abcdef",
                               .created = "2026-01-01T00:00:00.000Z",
                               .engine = "engine",
                               .points = 3000,
                               .triangles = 5900,
                               .label = "left",
                               .quality = {.score = 0.5, .density_mm = 2.25}},
                          g;
    size_t n;

    (void)state;
    make(&root, &v);
    memset(s.id, 'a', STORE_SUBJECT_MAX);
    memset(s.reference, 'b', STORE_NOTE_MAX);
    memset(s.purpose, 'c', STORE_NOTE_MAX);
    memset(f.label, 'd', STORE_LABEL_MAX);
    memset(f.digest, '7', 64);
    f.manager = true;
    f.first_score = -12.5;
    row_crypt_new(v, NULL, &k, wrapped);
    assert_true(row_crypt_key(v, k.uid, wrapped, &other));
    assert_memory_equal(&k, &other, sizeof k);
    n = row_crypt_encrypt_subject(&k, &s, in);
    assert_true(n <= ROW_CRYPT_ABOUT);
    t = s;
    memset(t.id, 0, sizeof t.id);
    assert_true(row_crypt_decrypt_subject(&k, in, n, &t));
    assert_memory_equal(&s, &t, sizeof s);
    t.disabled = true;
    assert_false(row_crypt_decrypt_subject(&k, in, n, &t));
    for (size_t cut = 0; cut < n; cut++)
        assert_false(row_crypt_decrypt_subject(&k, in, cut, &s));

    n = row_crypt_encrypt_template(&k, &f, in);
    g = f;
    memset(g.label, 0, sizeof g.label);
    memset(g.digest, 0, sizeof g.digest);
    g.manager = false;
    g.first_score = 0;
    assert_true(row_crypt_decrypt_template(&k, in, n, &g));
    assert_string_equal(g.label, f.label);
    assert_string_equal(g.digest, f.digest);
    assert_true(g.quality.density_mm == f.quality.density_mm);
    assert_true(g.manager && g.first_score == -12.5);
    row_crypt_encrypt_model(&k, &f, "the face", 8, model);
    assert_true(row_crypt_decrypt_model(&k, &f, model, sizeof model, out));
    assert_false(
        row_crypt_decrypt_template(&k, model, sizeof model, &g)); /* the other part */
    g.points++;
    assert_false(row_crypt_decrypt_model(&k, &g, model, sizeof model, out));
    g = f;
    g.id[0] = '1';
    assert_false(row_crypt_decrypt_model(&k, &g, model, sizeof model, out));
    row_crypt_new(v, NULL, &other, wrapped);
    assert_false(row_crypt_decrypt_model(&other, &f, model, sizeof model, out));
    vault_free(v);
}

/* No two different entries have the same hash input. */
static void test_chain(void **state)
{
    const struct store_chain_entry a = {.seq = 1,
                                        .at = "at",
                                        .kind = "kind",
                                        .actor = "actor",
                                        .template_id = "",
                                        .outcome = "ok"};
    const struct store_chain_entry b = {.seq = 1,
                                        .at = "at",
                                        .kind = "kinda",
                                        .actor = "ctor",
                                        .template_id = "",
                                        .outcome = "ok"};
    unsigned char start[STORE_CHAIN_HASH] = {0}, x[STORE_CHAIN_HASH], y[STORE_CHAIN_HASH];
    struct vault_root root;
    struct vault *v, *w;

    (void)state;
    store_chain_next(start, &a, x);
    store_chain_next(start, &b, y);
    assert_memory_not_equal(x, y, sizeof x);
    start[5] = 1;
    store_chain_next(start, &a, y);
    assert_memory_not_equal(x, y, sizeof x);
    make(&root, &v);
    make(&root, &w);
    store_chain_end(v, STORE_CHAIN_CHANGES, 1, x, start);
    store_chain_end(v, STORE_CHAIN_CHANGES, 2, x, y);
    assert_memory_not_equal(start, y, sizeof y);
    store_chain_end(w, STORE_CHAIN_CHANGES, 1, x, y); /* another database's */
    assert_memory_not_equal(start, y, sizeof y);
    vault_free(v);
    vault_free(w);
}

static int set_up(void **state)
{
    (void)state;
    (void)snprintf(dir, sizeof dir, "/tmp/test_vault.XXXXXX");
    if (mkdtemp(dir) == NULL || sodium_init() < 0)
        return 1;
    (void)snprintf(path, sizeof path, "%s/key", dir);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    return rmdir(dir);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_encrypted), cmocka_unit_test(test_root),
        cmocka_unit_test(test_change),    cmocka_unit_test(test_keyfile),
        cmocka_unit_test(test_rows),      cmocka_unit_test(test_chain),
    };

    return cmocka_run_group_tests_name("vault", tests, set_up, tear_down);
}
