#include "filled.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "tempdb.h"

static struct errinfo e;

static void must(enum status st)
{
    if (st != ST_OK)
        fail_msg("%s", e.msg);
}

static void add_devices(struct store *s)
{
    static const char text[] = "a capture";
    unsigned char public[32], key[crypto_sign_SECRETKEYBYTES];
    char nonce[STORE_NONCE_TEXT + 1], expires[32];
    struct store_capture c = {.device = "door-2", .nonce = nonce, .text = text, .len = 9};
    enum store_captured is;
    struct store_device d;

    for (int i = 1; i < 3; i++) {
        (void)crypto_sign_keypair(public, key);
        must(store_device_add(s, "test", i == 1 ? "door-1" : "door-2", public, &d, &e));
    }
    must(store_capture_nonce(s, nonce, expires, &e));
    (void)crypto_sign_detached(c.signature, NULL, (const unsigned char *)text, 9, key);
    must(store_capture_take(s, &c, &is, &e));
    assert_int_equal(is, STORE_CAPTURED);
}

static void add_tokens(struct store *s, struct filled *f)
{
    struct store_token t;
    char secret[65];

    must(store_token_create(s, "test", "gate", STORE_SCOPE_ALL, "", tempdb_in(3600),
                            f->gate, &t, &e));
    memcpy(f->gate_id, t.id, sizeof f->gate_id);
    must(store_token_create(s, "test", "door", STORE_SCOPE_VERIFY, "east", 0, secret, &t,
                            &e));
    memcpy(f->door_id, t.id, sizeof f->door_id);
    must(store_token_rotate(s, "test", f->door_id, 3600, 0, f->door, &t, &e));
    must(store_token_check(s, f->door, &t, &e));
    must(store_token_create(s, "test", "lost", STORE_SCOPE_ALL, "", 0, secret, &t, &e));
    must(store_token_revoke(s, "test", t.id, &e));
}

struct store *filled_fresh(struct filled *f)
{
    static const bool yes = true, no = false;
    struct store *s = tempdb_fresh();
    struct store_subject carol = {.id = "carol",
                                  .identify = true,
                                  .groups = "east,west",
                                  .reference = "C-17",
                                  .purpose = "the door",
                                  .expires = "2090-01-01"};
    struct store_calibration k = {
        .fmr = 0.001,
        .low = 0,
        .high = 2,
        .table = {.threshold = 1, .n = 2, .knot = {{-50, 1}, {1, 0.001}}}};
    struct store_template t;

    tempdb_enroll(s, "alice", "left", &tempdb_face[0], &t);
    tempdb_enroll(s, "alice", "right", &tempdb_face[1], &t);
    tempdb_enroll(s, "bob", "", &tempdb_face[2], &t);
    must(store_subject_add(s, "test", &carol, &e));
    must(store_subject_set(
        s, "test", "alice",
        &(struct store_subject_change){.hold = &yes, .expires = "2080-01-01"}, &e));
    must(store_subject_set(
        s, "test", "carol",
        &(struct store_subject_change){.disabled = &yes, .identify = &no}, &e));
    must(tempdb_record(s, "bob", STORE_RECORD_FAILED, &e));
    add_devices(s);
    add_tokens(s, f);
    must(store_calibration_add(s, "test", &k, &e));
    k.shipped = true;
    must(store_calibration_add(s, "test", &k, &e));
    must(store_event(s, "verify", "door", "alice", "", "match", &e));
    return s;
}

/* ---- what it tells */

__attribute__((format(printf, 2, 3))) static void say(char out[FILLED_TEXT],
                                                      const char *form, ...)
{
    const size_t n = strlen(out);
    va_list args;
    int more;

    va_start(args, form);
    more = vsnprintf(out + n, FILLED_TEXT - n, form, args);
    va_end(args);
    assert_true(more >= 0 && (size_t)more < FILLED_TEXT - n);
}

static void say_templates(struct store *s, const char *subject, char *out)
{
    struct store_template *list, got;
    struct surface_face *f = NULL;
    size_t n;

    must(store_template_list(s, "", subject, &list, &n, &e));
    for (size_t i = 0; i < n; i++) {
        must(store_template_load(s, "", list[i].id, &got, tempdb_work, &f, &e));
        say(out, " template %s %s %s %u %d %g %g\n", list[i].id, list[i].label,
            list[i].digest, f->surface.mesh.nv, list[i].manager, list[i].first_score,
            list[i].quality.noise_mm);
    }
    free(list);
    surface_face_free(f);
}

static void say_subjects(struct store *s, char *out)
{
    struct store_subject *list;
    size_t n;

    must(store_subject_list(s, 0, 100, &list, &n, &e));
    for (size_t i = 0; i < n; i++) {
        say(out, "subject %s %s %s %u %s %d\n", list[i].id, list[i].reference,
            list[i].purpose, list[i].templates, list[i].groups, list[i].identify);
        say_templates(s, list[i].id, out);
    }
    free(list);
}

static void say_line(void *out, const char *data, size_t n)
{
    (void)n;
    say(out, "%s\n", data);
}

/* A query's only column, a line each. */
static void say_query(const char *text, char *out)
{
    struct rawdb *d = tempdb_raw();

    must(rawdb_each(d, text, say_line, out, &e));
    rawdb_close(d);
}

/* What no key encrypts; the revision and the MAC of a row are the copy's own. */
void filled_look(struct store *s, char out[FILLED_TEXT])
{
    static const char *const plain[] = {
        "SELECT json_array(hex(uid), created, expires, seen, hold, disabled) FROM subjects",
        "SELECT json_array(hex(uid), id, created, engine, points, triangles) "
        "FROM templates",
        "SELECT json_array(id, name, hex(hash), created, revoked, scopes, groups, "
        "expires, hex(old_hash), old_until, used) FROM tokens",
        "SELECT json_array(id, name, created, hex(public)) FROM devices",
        "SELECT json_array(calibration_key, created, actor, engine, shipped, fmr, low, "
        "high, subjects, impostors, genuine, threshold, hex(knots), hex(det)) FROM calibrations",
        "SELECT json_array(hex(uid), token, failures, at_ms, suspicion) FROM attempts "
        "JOIN subjects USING (subject_key)",
        "SELECT json_array(until_ms, hex(nonce)) FROM nonces",
        "SELECT json_array(day, decision, hex(bins)) FROM days",
        "SELECT json_array(day, token, n, unusable, noise_um, quality) FROM scans",
    };
    char query[300];

    out[0] = '\0';
    say_subjects(s, out);
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++) {
        (void)snprintf(query, sizeof query, "%s ORDER BY 1", plain[i]);
        say_query(query, out);
    }
}

void filled_hashes(char out[FILLED_TEXT])
{
    out[0] = '\0';
    say_query("SELECT 'change ' || seq || ' ' || hex(hash) FROM change_log ORDER BY seq",
              out);
    say_query("SELECT 'access ' || seq || ' ' || hex(hash) FROM access_log ORDER BY seq",
              out);
}
