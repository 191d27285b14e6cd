/* Keys and what they encrypt: only the right key decrypts, only the bytes that were
 * encrypted, only in their place. */
#include <sodium.h>
#include <sys/stat.h>
#include <unistd.h>

#include "errinfo.h"
#include "crypt_file.h"
#include "crypt.h"
#include "unit.h"

static char dir[64], path[96];
static struct errinfo e;
static const unsigned char master[CRYPT_KEY] = "a key of thirty-two bytes, not";

static const char label[16] = "a subject's key";

static void make(struct crypt_root *root, struct crypt **v)
{
    must(crypt_make(CRYPT_FILE, master, sizeof master, root, v, &e));
}

/* Each bit of the key, of the associated data and of the encrypted bytes counts. */
TEST(test_encrypted)
{
    const char text[] = "the volume between two surfaces";
    unsigned char about[] = "row 7, column 3", key[CRYPT_KEY], out[sizeof text];
    unsigned char in[sizeof text + CRYPT_OVER], other[sizeof in];
    const struct {
        unsigned char *bytes;
        size_t n;
    } part[] = {{key, sizeof key}, {about, sizeof about}, {in, sizeof in}};

    randombytes_buf(key, sizeof key);
    crypt_encrypt(key, about, sizeof about, text, sizeof text, in);
    assert_true(crypt_decrypt(key, about, sizeof about, in, sizeof in, out));
    assert_memory_equal(out, text, sizeof text);
    crypt_encrypt(key, about, sizeof about, text, sizeof text, other);
    assert_memory_not_equal(in, other, sizeof in); /* another nonce */
    for (size_t i = 0; i < sizeof part / sizeof *part; i++)
        for (size_t bit = 0; bit < 8 * part[i].n; bit++) {
            part[i].bytes[bit / 8] ^= (unsigned char)(1U << bit % 8);
            assert_false(crypt_decrypt(key, about, sizeof about, in, sizeof in, out));
            part[i].bytes[bit / 8] ^= (unsigned char)(1U << bit % 8);
        }
    for (size_t n = 0; n < sizeof in; n++)
        assert_false(crypt_decrypt(key, about, sizeof about, in, n, out));
}

TEST(test_root)
{
    struct crypt_root root, bad;
    struct crypt *v, *again;
    unsigned char uid[16] = "somebody", key[CRYPT_KEY] = "their key", got[CRYPT_KEY];
    unsigned char wrapped[CRYPT_WRAPPED], a[CRYPT_HASH], b[CRYPT_HASH];

    make(&root, &v);
    crypt_wrap(v, label, uid, key, wrapped);
    crypt_lookup(v, "subject", "alice", 5, a);
    must(crypt_open(&root, master, sizeof master, &again, &e));
    assert_true(crypt_unwrap(again, label, uid, wrapped, got));
    assert_memory_equal(got, key, sizeof key);
    crypt_lookup(again, "subject", "alice", 5, b);
    assert_memory_equal(a, b, sizeof a);
    crypt_lookup(again, "event", "alice", 5, b); /* another use */
    assert_memory_not_equal(a, b, sizeof a);
    crypt_free(again);
    assert_false(crypt_unwrap(v, "another label...", uid, wrapped, got));
    uid[0] ^= 1; /* another subject's */
    assert_false(crypt_unwrap(v, label, uid, wrapped, got));

    got[0] = (unsigned char)(master[0] ^ 1);
    memcpy(got + 1, master + 1, sizeof master - 1);
    fails(crypt_open(&root, got, sizeof got, &again, &e), ST_EDENIED);
    assert_null(again);
    fails(crypt_open(&root, master, 31, &again, &e), ST_EINVAL);
    /* Nothing of the root can be changed: not even to one that needs no key.  It has no padding. */
    for (size_t i = 0; i < sizeof root; i++) {
        enum status st;

        bad = root;
        ((unsigned char *)&bad)[i] ^= 1;
        st = crypt_open(&bad, master, sizeof master, &again, &e);
        assert_true(st == ST_EDENIED || st == ST_ECORRUPT);
        assert_null(again);
    }
    bad = root;
    bad.kind = CRYPT_PLAINTEXT;
    memcpy(bad.plaintext, master, sizeof master);
    fails(crypt_open(&bad, NULL, 0, &again, &e), ST_EDENIED);
    crypt_free(v);
}

/* A passphrase; two databases of one passphrase have nothing in common. */
TEST(test_passphrase)
{
    struct crypt_root root, next;
    struct crypt *v, *w, *again;
    unsigned char a[CRYPT_HASH], b[CRYPT_HASH], sign[CRYPT_SIGN], public[CRYPT_KEY];

    must(crypt_make(CRYPT_PASSPHRASE, "open sesame", 11, &root, &v, &e));
    must(crypt_make(CRYPT_PASSPHRASE, "open sesame", 11, &next, &w, &e));
    crypt_lookup(v, "subject", "alice", 5, a);
    crypt_lookup(w, "subject", "alice", 5, b);
    assert_memory_not_equal(a, b, sizeof a);
    crypt_mac(v, "here", 4, a);
    crypt_mac(w, "here", 4, b);
    assert_memory_not_equal(a, b, sizeof a);
    crypt_free(w);
    crypt_sign(v, "here", 4, sign);
    crypt_public(v, public);
    assert_memory_equal(root.public, public, sizeof public);
    assert_true(crypt_verify(public, "here", 4, sign));
    assert_false(crypt_verify(public, "herf", 4, sign));
    assert_false(crypt_verify(next.public, "here", 4, sign));
    must(crypt_open(&root, "open sesame", 11, &again, &e));
    crypt_mac(again, "here", 4, b);
    crypt_mac(v, "here", 4, a);
    assert_memory_equal(a, b, sizeof a);
    crypt_free(again);
    fails(crypt_open(&root, "open Sesame", 11, &again, &e), ST_EDENIED);
    fails(crypt_open(&root, "", 0, &again, &e), ST_EINVAL);
    root.mib = 1 << 20; /* a hostile root does not eat the memory */
    fails(crypt_open(&root, "open sesame", 11, &again, &e), ST_ECORRUPT);
    crypt_free(v);
}

static enum status read_key(const char *text, size_t n, mode_t mode,
                            struct crypt_file **k)
{
    FILE *f;

    (void)unlink(path);
    assert_non_null(f = fopen(path, "wb"));
    assert_int_equal(fwrite(text, 1, n, f), n);
    assert_int_equal(fclose(f), 0);
    assert_int_equal(chmod(path, mode), 0);
    return crypt_file_read(path, k, &e);
}

TEST(test_keyfile)
{
    static char line[CRYPT_SECRET_MAX + 2];
    static const struct {
        const char *text;
        size_t n;
        mode_t mode;
        enum status st;
    } file[] = {
        {line, CRYPT_SECRET_MAX, 0600, ST_OK},
        {line, CRYPT_SECRET_MAX + 1, 0600, ST_EINVAL},
        {"\n", 1, 0600, ST_EINVAL},
        {"two\nlines\n", 10, 0600, ST_EINVAL},
        {"a\0b", 3, 0600, ST_EINVAL},
        {"secret", 6, 0601, ST_EDENIED}, /* permissions of others */
        {"secret", 6, 0602, ST_EDENIED},
        {"secret", 6, 0604, ST_EDENIED},
        {"secret", 6, 0620, ST_EDENIED},
        {"secret", 6, 0610, ST_OK},
    };
    unsigned char key[CRYPT_KEY];
    struct crypt_file *k;
    struct stat sb;

    fails(crypt_file_read(path, &k, &e), ST_ENOTFOUND);
    must(crypt_file_make(path, &e));
    assert_int_equal(stat(path, &sb), 0);
    assert_int_equal(sb.st_mode & 0777, 0600);
    must(crypt_file_read(path, &k, &e));
    must(crypt_file_key(k, path, key, &e));
    crypt_file_free(k);
    fails(crypt_file_make(path, &e), ST_EEXISTS); /* it is never overwritten */
    fails(crypt_file_make("/nowhere/at/all", &e), ST_EIO);
    memset(line, 'x', sizeof line);
    for (size_t i = 0; i < sizeof file / sizeof *file; i++) {
        assert_int_equal(read_key(file[i].text, file[i].n, file[i].mode, &k), file[i].st);
        if (k != NULL) {
            assert_int_equal(k->len, file[i].n);
            fails(crypt_file_key(k, path, key, &e), ST_EINVAL);
        }
        crypt_file_free(k);
    }
    if (geteuid() == 0) { /* another user's */
        assert_int_equal(chown(path, 65534, 65534), 0);
        fails(crypt_file_read(path, &k, &e), ST_EDENIED);
        assert_non_null(strstr(e.msg, "belongs to user 65534"));
        /* root's, for a group: as credentials are */
        assert_int_equal(chown(path, 0, 65534) + chmod(path, 0440), 0);
        must(crypt_file_read(path, &k, &e));
        crypt_file_free(k);
    }
    fails(crypt_file_read(dir, &k, &e), ST_EIO);
    (void)unlink(path);
}

BEFORE_ALL(set_up)
{
    (void)snprintf(dir, sizeof dir, "/tmp/test_crypt.XXXXXX");
    assert_false(mkdtemp(dir) == NULL || sodium_init() < 0);
    (void)snprintf(path, sizeof path, "%s/key", dir);
}

AFTER_ALL(tear_down)
{
    assert_int_equal(rmdir(dir), 0);
}
