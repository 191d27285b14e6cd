/* Goal: which entries are events, what they tell, and to whom; cursors as text, hostile ones too. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "event.h"
#include "place.h"
#include "unit.h"

#define TOKEN "0123456789abcdef0123456789abcdef"
#define OTHER "ffffffffffffffffffffffffffffffff"

static struct store_audit_entry entry_of(const char *kind, const char *outcome)
{
    struct store_audit_entry a = {
        .subject = "alice", .groups = "east,west", .actor_name = "door"};

    (void)snprintf(a.entry.at, sizeof a.entry.at, "2026-11-30T01:24:54.000Z");
    (void)snprintf(a.entry.kind, sizeof a.entry.kind, "%s", kind);
    (void)snprintf(a.entry.outcome, sizeof a.entry.outcome, "%s", outcome);
    (void)snprintf(a.entry.actor, sizeof a.entry.actor, TOKEN);
    (void)snprintf(a.entry.object, sizeof a.entry.object, "t1");
    return a;
}

/* "TYPE OUTCOME UNTIL"; "-": no event. */
static const char *told(const char *kind, const char *outcome)
{
    static char out[256];
    const struct store_audit_entry a = entry_of(kind, outcome);
    char *text = event_text(&a), type[64] = "", word[64] = "", until[64] = "";
    const char *at;

    assert_int_equal(text == NULL, event_type(&a.entry) == NULL);
    if (text == NULL)
        return "-";
    assert_null(strstr(text, "21.4")); /* no number of a comparison */
    assert_non_null(at = strstr(text, "\"type\":\""));
    (void)sscanf(at, "\"type\":\"%63[^\"]", type);
    assert_string_equal(type, event_type(&a.entry));
    assert_non_null(at = strstr(text, "\"outcome\":\""));
    (void)sscanf(at, "\"outcome\":\"%63[^\"]", word);
    if ((at = strstr(text, "\"until\":\"")) != NULL)
        (void)sscanf(at, "\"until\":\"%63[^\"]", until);
    (void)snprintf(out, sizeof out, "%s %s%s%s", type, word, until[0] != '\0' ? " " : "",
                   until);
    free(text);
    return out;
}

TEST(test_kinds)
{
    assert_string_equal(told("verify", "match"), "verify match");
    assert_string_equal(told("verify", "no_match capture=pass:door-1"),
                        "verify no_match");
    assert_string_equal(told("verify", "replayed"), "refused replayed");
    assert_string_equal(told("identify", "match 21.4 of 1000 staff"), "identify match");
    assert_string_equal(told("identify", "match 21.4 of 1000, enroll"),
                        "refused already_enrolled");
    assert_string_equal(told("identify", "no_match of 1000, enroll"), "-");
    assert_string_equal(told("identify", "replayed"), "refused replayed");
    assert_string_equal(told("enroll", "created capture=none:x"), "enroll enrolled");
    assert_string_equal(told("enroll_mismatch", "no_match, first sample"),
                        "enroll_mismatch no_match");
    assert_string_equal(told("refused", "low_quality verify"), "refused low_quality");
    assert_string_equal(told("capture", "liveness_failed capture=fail:x"),
                        "refused liveness_failed");
    assert_string_equal(told("locked_out", "3 failures until 2026-11-30T01:25:24.000Z"),
                        "locked_out locked_out 2026-11-30T01:25:24.000Z");
    assert_string_equal(told("delete_subject", "erased"), "subject_erased erased");
    assert_string_equal(told("candidate", "21.4 of 1000"), "-");
    assert_string_equal(told("create_token", "door"), "-");
    assert_string_equal(told("surface", "sent"), "-");
    assert_string_equal(told("", ""), "-");
}

TEST(test_members)
{
    struct store_audit_entry a = entry_of("verify", "match");
    char *text = event_text(&a);

    assert_string_equal(
        text,
        "{\"at\":\"2026-11-30T01:24:54.000Z\",\"type\":\"verify\",\"outcome\":\"match\","
        "\"subject\":\"alice\",\"template_id\":\"t1\",\"token\":\"door\",\"token_id\":\"" TOKEN
        "\"}");
    free(text);
    a.subject[0] = a.actor_name[0] = '\0'; /* erased */
    (void)snprintf(a.entry.actor, sizeof a.entry.actor, "surfacectl:root");
    text = event_text(&a);
    assert_string_equal(
        text,
        "{\"at\":\"2026-11-30T01:24:54.000Z\",\"type\":\"verify\",\"outcome\":\"match\","
        "\"subject\":null,\"template_id\":null,\"token\":\"surfacectl:root\",\"token_id\":null}");
    free(text);
}

TEST(test_visible)
{
    struct store_audit_entry a = entry_of("verify", "match");

    assert_true(event_visible(&a, OTHER, ""));
    assert_true(event_visible(&a, OTHER, "west"));
    assert_false(event_visible(&a, OTHER, "north"));
    assert_false(
        event_visible(&a, TOKEN, "north")); /* nor its own, of others' subjects */
    a.groups[0] = '\0';
    assert_false(event_visible(&a, OTHER, "west"));
    assert_true(event_visible(&a, OTHER, ""));
    a.subject[0] = '\0';
    assert_true(event_visible(&a, OTHER, ""));
    assert_true(event_visible(&a, TOKEN, "west"));
    assert_false(event_visible(&a, OTHER, "west"));
    assert_false(event_visible(&a, "", "west"));
}

/* ---- cursors */

TEST(test_place)
{
    struct store_audit_place p = {.changes = 12, .change_mark = 0x9f86d081, .daemons = 2},
                             q;
    char text[PLACE_MAX], again[PLACE_MAX + 2];

    p.accesses[0] = 105;
    p.access_mark[0] = 1;
    place_print(&p, text);
    assert_string_equal(text, "12.9f86d081-105.00000001-0");
    assert_true(place_read(text, 0, &q));
    assert_memory_equal(&p, &q, sizeof p);
    assert_false(place_read(text, 1, &q)); /* the last is 0 */
    p = (struct store_audit_place){
        .changes = 999999999999999999, .change_mark = UINT32_MAX, .daemons = LOG_DAEMONS};
    for (int i = 0; i < LOG_DAEMONS; i++) {
        p.accesses[i] = 999999999999999999;
        p.access_mark[i] = UINT32_MAX;
    }
    place_print(&p, text);
    assert_true(strlen(text) < PLACE_MAX);
    assert_true(place_read(text, 1, &q));
    assert_memory_equal(&p, &q, sizeof p);
    (void)snprintf(again, sizeof again, "%s-1", text); /* one too many */
    assert_false(place_read(again, 0, &q));
}

/* There is one text of a place (fuzz_cursor.c tries many others). */
TEST(test_hostile_places)
{
    static const char *const bad[] = {"",
                                      "-",
                                      "1",
                                      "1-",
                                      "-1",
                                      "1-1-",
                                      "01-1",
                                      "1-01",
                                      " 1-1",
                                      "1- 1",
                                      "+1-1",
                                      "1-+1",
                                      "1.-1",
                                      "1.1-1",
                                      "1.00000000-1",
                                      "1.ABCDEF00-1",
                                      "1.0x123456-1",
                                      "1-1.",
                                      "1-1 ",
                                      "1-1\n",
                                      "1-1.g0000000",
                                      "1-1.123456789",
                                      "1000000000000000000-1",
                                      "1-99999999999999999999999",
                                      "1..00000001-1",
                                      "1-1-x"};
    struct store_audit_place p;

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_false(place_read(bad[i], 0, &p));
}
