/* An export of the audit log, verified with the public key alone: only where its last change is
 * signed by the key given, whatever key the file names. */
#include <sodium.h>
#include <unistd.h>

#include "crypt.h"
#include "ctl_review.h"
#include "fixed_keys.h"
#include "log_entry.h"
#include "unit.h"

#define CHANGES  5
#define ACCESSES 4

static struct crypt *keys, *others;
static char path[] = "/tmp/test_review.XXXXXX", hex_key[65], hex_other[65];
static struct log_entry change[CHANGES + 1], access_to[ACCESSES + 1];

static void chain(struct log_entry *entry, const struct log_entry *before)
{
    static const unsigned char start[LOG_HASH];

    log_hash(before != NULL ? before->hash : start, entry, entry->hash);
}

/* As many as there are, and one more of each, which no key has authenticated. */
static void make(void)
{
    for (int i = 0; i <= ACCESSES; i++) {
        access_to[i] = (struct log_entry){.log = LOG_ACCESSES,
                                          .seq = (uint64_t)i + 1,
                                          .at = "2026-11-23T20:00:00.000Z",
                                          .kind = "verify",
                                          .outcome = "match"};
        chain(&access_to[i], i > 0 ? &access_to[i - 1] : NULL);
    }
    for (int i = 0; i <= CHANGES; i++) {
        change[i] = (struct log_entry){.log = LOG_CHANGES,
                                       .seq = (uint64_t)i + 1,
                                       .at = "2026-11-23T20:00:00.000Z",
                                       .kind = "add_subject",
                                       .accesses = {.seq = ACCESSES}};
        memset(change[i].uid, i + 1, LOG_UID);
        memcpy(change[i].accesses.hash, access_to[ACCESSES - 1].hash, LOG_HASH);
        chain(&change[i], i > 0 ? &change[i - 1] : NULL);
    }
    log_sign(keys, &change[1]);
    log_sign(keys, &change[CHANGES - 1]);
}

static void put(FILE *f, const struct log_entry *entry)
{
    char hash[65], uid[33], digest[2 * CRYPT_WRAPPED + 1], bound[65];
    char signature[2 * CRYPT_SIGN + 1] = "";

    (void)sodium_bin2hex(hash, sizeof hash, entry->hash, LOG_HASH);
    (void)sodium_bin2hex(uid, sizeof uid, entry->uid, LOG_UID);
    (void)fprintf(
        f,
        "{\"log\":\"%s\",\"daemon\":0,\"seq\":%d,\"at\":\"%s\",\"kind\":\"%s\",\"actor\":\"%s\","
        "\"subject_uid\":\"%s\",\"object\":null,\"outcome\":\"%s\",\"hash\":\"%s\"",
        log_word(entry->log), (int)entry->seq, entry->at, entry->kind, entry->actor, uid,
        entry->outcome, hash);
    if (entry->log == LOG_CHANGES) {
        (void)sodium_bin2hex(digest, sizeof digest, entry->digest, CRYPT_WRAPPED);
        (void)sodium_bin2hex(bound, sizeof bound, entry->accesses.hash, LOG_HASH);
        if (entry->is_signed)
            (void)sodium_bin2hex(signature, sizeof signature, entry->signature,
                                 CRYPT_SIGN);
        (void)fprintf(f,
                      ",\"digest\":\"%s\",\"access_seq\":%d,\"access_hash\":\"%s\","
                      "\"signature\":\"%s\"",
                      digest, (int)entry->accesses.seq, bound, signature);
    }
    (void)fprintf(f, "}\n");
}

static void write_file(int changes, int accesses, const char *named)
{
    FILE *f = fopen(path, "w");

    assert_non_null(f);
    (void)fprintf(f, "{\"surface_audit\":2,\"public_key\":\"%s\",\"changes\":%d}\n",
                  named, changes);
    for (int i = 0; i < changes; i++)
        put(f, &change[i]);
    for (int i = 0; i < accesses; i++)
        put(f, &access_to[i]);
    assert_int_equal(fclose(f), 0);
}

static char said[600];

static void note(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    const size_t n = strlen(said);

    (void)arg;
    (void)snprintf(said + n, sizeof said - n, "%s %d: %s\n", log_word(log), (int)seq,
                   line);
}

static const struct ctl_review how = {.report = note};

static struct log_walk review(const char *key)
{
    char *args[] = {path};
    struct ctl c = {.nargs = 1, .args = args, .public_key = key};
    struct log_walk w;

    said[0] = '\0';
    if (ctl_review_file(&c, &how, &w, NULL) != ST_OK)
        fail_msg("%s", c.e.msg);
    return w;
}

TEST(test_signed)
{
    make();
    write_file(CHANGES, ACCESSES, hex_key);
    assert_int_equal(review(hex_key).checkpoints, 2);
    assert_string_equal(said, "");
    (void)review(hex_other); /* the key given, not the one that the file names */
    assert_string_equal(said,
                        "changes 1: entries from 1 on are not signed by the key given\n");
    /* Ends with a change that is not signed, or not by this key. */
    write_file(CHANGES + 1, ACCESSES, hex_key);
    (void)review(hex_key);
    assert_string_equal(said,
                        "changes 6: entries from 6 on are not signed by the key given\n");
    log_sign(others, &change[CHANGES]);
    write_file(CHANGES + 1, ACCESSES, hex_other);
    (void)review(hex_key);
    assert_string_equal(said,
                        "changes 6: entries from 6 on are not signed by the key given\n");
    /* The signed end is gone; nothing is there; accesses that no change names. */
    write_file(CHANGES - 1, ACCESSES, hex_key);
    assert_int_equal(review(hex_key).signed_to, 2);
    assert_non_null(strstr(said, "entries from 3 on are not signed"));
    write_file(0, 0, hex_key);
    (void)review(hex_key);
    assert_non_null(strstr(said, "not signed by the key given"));
    write_file(CHANGES, ACCESSES + 1, hex_key);
    (void)review(hex_key);
    assert_string_equal(said, "accesses 5: entry 5 is not signed by any change\n");
    write_file(CHANGES, ACCESSES - 1, hex_key);
    (void)review(hex_key);
    assert_string_equal(said, "accesses 4: entry 4 is cut off the end\n");
}

/* All made anew by somebody, under a key of their own: the finding that a file's own key is no key. */
TEST(test_made_anew)
{
    make();
    (void)snprintf(change[0].actor, sizeof change[0].actor, "mallory");
    for (int i = 0; i < CHANGES; i++)
        chain(&change[i], i > 0 ? &change[i - 1] : NULL);
    log_sign(others, &change[CHANGES - 1]);
    write_file(CHANGES, ACCESSES, hex_other);
    (void)review(hex_other);
    assert_string_equal(said, "");
    (void)review(hex_key);
    assert_non_null(strstr(said, "entries from 1 on are not signed by the key given"));
}

TEST(test_malformed)
{
    static const char *const line[] = {
        "nonsense\n", "{}\n", "{\"log\":\"changes\"}\n",
        "{\"log\":\"changes\",\"seq\":6}\n", /* a change behind the accesses */
    };
    struct ctl c = {.nargs = 1, .args = (char *[]){path}, .public_key = hex_key};
    struct log_walk w;

    for (size_t i = 0; i < sizeof line / sizeof *line; i++) {
        FILE *f;

        make();
        write_file(CHANGES, ACCESSES, hex_key);
        assert_non_null(f = fopen(path, "a"));
        (void)fputs(line[i], f);
        assert_int_equal(fclose(f), 0);
        (void)review(hex_key);
        assert_string_equal(said, "accesses 5: line 11 of the file is malformed\n");
    }
    c.public_key = "abc";
    assert_int_equal(ctl_review_file(&c, &how, &w, NULL), ST_EINVAL);
    c.public_key = hex_key;
    assert_int_equal(truncate(path, 0), 0);
    assert_int_equal(ctl_review_file(&c, &how, &w, NULL), ST_EINVAL);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(ctl_review_file(&c, &how, &w, NULL), ST_ENOTFOUND);
}

BEFORE_ALL(begin)
{
    static const unsigned char master[CRYPT_KEY] = "another";
    unsigned char public[CRYPT_KEY];
    struct crypt_root root;
    const int fd = mkstemp(path);

    assert_false(fd < 0 || close(fd) != 0 || (keys = fixed_keys()) == NULL ||
                 crypt_make(CRYPT_FILE, master, sizeof master, &root, &others, NULL) !=
                     ST_OK);
    crypt_public(keys, public);
    (void)sodium_bin2hex(hex_key, sizeof hex_key, public, CRYPT_KEY);
    (void)sodium_bin2hex(hex_other, sizeof hex_other, root.public, CRYPT_KEY);
}

AFTER_ALL(end)
{
    (void)unlink(path);
    crypt_free(keys);
    crypt_free(others);
}
