/* Every statement that is prepared. */
#include "store_sqlite.h"

#define SUBJECT_WHO                                                                      \
    "s.uid, s.key, s.about, s.created, s.expires, s.seen, s.hold, s.disabled"
#define SUBJECT_COLUMNS                                                                  \
    "s.subject_key, (SELECT count(*) FROM templates t WHERE t.subject_key = "            \
    "s.subject_key), " SUBJECT_WHO

#define TEMPLATE_COLUMNS                                                                 \
    "t.template_key, t.id, " SUBJECT_WHO                                                 \
    ", t.created, t.engine, t.points, t.triangles, t.about"
#define TEMPLATE_FROM " FROM templates t JOIN subjects s USING (subject_key)"

/* ?1: an engine from its first space on, as face_same_engine() compares them. */
#define TEMPLATE_STALE "substr(engine, instr(engine, ' ')) <> ?1"

/* Of ?2 shares the one that a row is in: by its key, so that nobody who writes meanwhile moves
 * it into another, and 64 that lie together at a time.  A negative key has one too. */
#define TEMPLATE_SHARE "(t.template_key >> 6 & 9223372036854775807) % ?2"

#define ATTEMPTS_OF "(SELECT subject_key FROM subjects WHERE lookup = ?1)"

#define TOKEN_COLUMNS                                                                    \
    "id, name, created, revoked, scopes, expires, old_until, hash, old_hash, mac, used"

#define EVENT_COLUMNS                                                                    \
    "seq, e.at, e.kind, e.actor, e.subject, e.template_id, e.outcome, e.hash"
#define EVENT_WANTED                                                                     \
    " FROM events e WHERE seq > ?1 AND (?2 IS NULL OR subject = ?2) "                    \
    "AND (?3 IS NULL OR kind = ?3) AND (?4 IS NULL OR at >= ?4) "

#define CALIBRATION_COLUMNS                                                              \
    "calibration_key, created, actor, engine, shipped, fmr, threshold_mm, low_mm, "      \
    "high_mm, subjects, impostors, genuine, halving_mm, knots, mac"

const char *const store_sqlite_sql[SQL_COUNT] = {
    [SQL_BEGIN] = "BEGIN IMMEDIATE",
    [SQL_BEGIN_READ] = "BEGIN",
    [SQL_COMMIT] = "COMMIT",
    [SQL_ROLLBACK] = "ROLLBACK",
    [SQL_VERSION] = "PRAGMA user_version",
    [SQL_ROOT_VERSION] = "SELECT version FROM root",
    [SQL_ROOT_GET] =
        "SELECT kind, version, passes, mib, salt, open, public, secrets FROM root",
    [SQL_ROOT_SET] = "REPLACE INTO root (root_key, kind, version, passes, mib, salt, "
                     "open, public, secrets) VALUES (1, ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
    [SQL_KEY_LIST] = "SELECT subject_key, uid, key FROM subjects ORDER BY subject_key",
    [SQL_KEY_SET] = "UPDATE subjects SET key = ?2 WHERE subject_key = ?1",
    [SQL_SUBJECT_FIND] =
        "SELECT s.subject_key, " SUBJECT_WHO " FROM subjects s WHERE s.lookup = ?1",
    [SQL_SUBJECT_SAME] =
        "SELECT s.subject_key, " SUBJECT_WHO " FROM subjects s WHERE s.uid = ?1",
    [SQL_SUBJECT_ADD] =
        "INSERT INTO subjects (lookup, uid, key, about, created, expires, "
        "seen, hold, disabled) "
        "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)",
    [SQL_SUBJECT_GET] = "SELECT " SUBJECT_COLUMNS " FROM subjects s WHERE s.lookup = ?1",
    [SQL_SUBJECT_LIST] = "SELECT " SUBJECT_COLUMNS " FROM subjects s "
                         "WHERE s.subject_key > ?1 ORDER BY s.subject_key LIMIT ?2",
    [SQL_SUBJECT_ALL] = "SELECT " SUBJECT_WHO " FROM subjects s",
    [SQL_SUBJECT_DUE] = "SELECT " SUBJECT_COLUMNS " FROM subjects s "
                        "WHERE s.expires <= ?1 ORDER BY s.expires, s.subject_key",
    [SQL_SUBJECT_EDIT] = "UPDATE subjects SET lookup = ?2, about = ?3, expires = ?4, "
                         "hold = ?5, disabled = ?6 WHERE subject_key = ?1",
    [SQL_SUBJECT_SEEN] = "UPDATE subjects SET seen = ?2 WHERE lookup = ?1",
    [SQL_SUBJECT_DELETE] = "DELETE FROM subjects WHERE subject_key = ?1",
    [SQL_TEMPLATE_ADD] =
        "INSERT INTO templates (id, subject_key, same, created, engine, points, "
        "triangles, about, model) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)",
    [SQL_TEMPLATE_GET] = "SELECT " TEMPLATE_COLUMNS TEMPLATE_FROM " WHERE t.id = ?1",
    [SQL_TEMPLATE_LOAD] =
        "SELECT " TEMPLATE_COLUMNS ", t.model" TEMPLATE_FROM " WHERE t.id = ?1",
    [SQL_TEMPLATE_SAME] = "SELECT " TEMPLATE_COLUMNS TEMPLATE_FROM
                          " WHERE t.subject_key = ?1 AND t.same = ?2",
    [SQL_TEMPLATE_NEWEST] = "SELECT id FROM templates WHERE subject_key = ?1 "
                            "ORDER BY template_key DESC LIMIT 1",
    [SQL_TEMPLATE_LIST] = "SELECT " TEMPLATE_COLUMNS TEMPLATE_FROM
                          " WHERE t.subject_key = ?1 ORDER BY t.template_key",
    [SQL_TEMPLATE_EACH] = "SELECT " TEMPLATE_COLUMNS ", t.model "
                          "FROM templates t LEFT JOIN subjects s USING (subject_key) "
                          "WHERE " TEMPLATE_SHARE " = ?1 ORDER BY t.template_key",
    [SQL_TEMPLATE_IDS] =
        "SELECT id FROM templates WHERE subject_key = ?1 ORDER BY template_key",
    [SQL_TEMPLATE_DELETE] = "DELETE FROM templates WHERE id = ?1",
    [SQL_TEMPLATE_RENEW] =
        "UPDATE templates SET engine = ?2, triangles = ?3, about = ?4, "
        "model = ?5 WHERE id = ?1",
    /* Both by the index alone. */
    [SQL_TEMPLATE_STALE] =
        "SELECT id FROM templates WHERE " TEMPLATE_STALE " ORDER BY template_key",
    [SQL_TEMPLATE_STALE_COUNT] = "SELECT count(*) FROM templates WHERE " TEMPLATE_STALE,
    [SQL_EVENT_ADD] = "INSERT INTO events (seq, at, kind, actor, subject, template_id, "
                      "outcome, hash) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8)",
    [SQL_EVENT_END] = "SELECT seq, hash, mac FROM events_end",
    [SQL_EVENT_SET_END] = "REPLACE INTO events_end (events_key, seq, hash, mac) "
                          "VALUES (1, ?1, ?2, ?3)",
    [SQL_EVENT_LIST] = "SELECT " EVENT_COLUMNS EVENT_WANTED "ORDER BY seq LIMIT ?5",
    [SQL_EVENT_NEWEST] = "SELECT * FROM (SELECT " EVENT_COLUMNS EVENT_WANTED
                         "ORDER BY seq DESC LIMIT ?5) ORDER BY seq",
    [SQL_EVENT_ERASED] =
        "SELECT (SELECT max(seq) FROM events), EXISTS (SELECT 1 FROM events "
        "WHERE seq > ?1 AND kind IN "
        "('delete_subject', 'delete_template', 'rekey'))",
    [SQL_EVENT_EACH] = "SELECT " EVENT_COLUMNS ", c.at, c.hash, c.signature "
                       "FROM events e LEFT JOIN checkpoints c USING (seq) ORDER BY seq",
    [SQL_MARK_ADD] =
        "INSERT INTO checkpoints (seq, at, hash, signature) VALUES (?1, ?2, ?3, ?4)",
    [SQL_MARK_GET] = "SELECT seq, at, hash, signature FROM checkpoints WHERE seq = ?1",
    [SQL_MARK_LIST] = "SELECT seq, at, hash, signature FROM checkpoints ORDER BY seq",
    [SQL_MARK_ALONE] = "SELECT seq, at, hash, signature FROM checkpoints "
                       "WHERE seq NOT IN (SELECT seq FROM events) ORDER BY seq",
    [SQL_ERASED_LIST] = "SELECT lookup, at FROM erased WHERE ?1 IS NULL OR lookup = ?1 "
                        "ORDER BY at, lookup",
    [SQL_ERASED_ADD] = "REPLACE INTO erased (uid, lookup, at) VALUES (?1, ?2, ?3)",
    [SQL_ERASED_NOTE] = "REPLACE INTO erased (uid, lookup, at) "
                        "SELECT uid, lookup, ?2 FROM subjects WHERE subject_key = ?1",
    [SQL_ERASED_UID] = "SELECT 1 FROM erased WHERE uid = ?1",
    [SQL_ERASED_LOOKUP] = "SELECT 1 FROM erased WHERE lookup = ?1",
    [SQL_TOKEN_ADD] = "INSERT INTO tokens (id, name, hash, created, scopes, expires) "
                      "VALUES (?1, ?2, ?3, ?4, ?5, ?6)",
    [SQL_TOKEN_LIST] = "SELECT " TOKEN_COLUMNS " FROM tokens ORDER BY token_key",
    [SQL_TOKEN_GET] = "SELECT " TOKEN_COLUMNS " FROM tokens WHERE id = ?1",
    [SQL_TOKEN_REVOKE] =
        "UPDATE tokens SET revoked = coalesce(revoked, ?2) WHERE id = ?1",
    [SQL_TOKEN_ROTATE] = "UPDATE tokens SET old_hash = iif(?3 IS NULL, NULL, hash), "
                         "old_until = ?3, hash = ?2, expires = ?4 "
                         "WHERE id = ?1 AND revoked IS NULL",
    [SQL_TOKEN_FIND] =
        "SELECT " TOKEN_COLUMNS ", 0 FROM tokens WHERE hash = ?1 UNION ALL "
        "SELECT " TOKEN_COLUMNS ", 1 FROM tokens WHERE old_hash = ?1",
    [SQL_TOKEN_PROVE] = "UPDATE tokens SET mac = ?2 WHERE id = ?1",
    [SQL_TOKEN_USE] = "UPDATE tokens SET used = ?2 WHERE id = ?1",
    [SQL_ATTEMPTS_GET] = "SELECT coalesce(failures, 0), coalesce(at_ms, 0) FROM subjects "
                         "LEFT JOIN attempts USING (subject_key) WHERE lookup = ?1",
    [SQL_ATTEMPTS_LIST] = "SELECT a.failures, a.at_ms, " SUBJECT_WHO
                          " FROM attempts a JOIN subjects s USING (subject_key) "
                          "ORDER BY subject_key",
    [SQL_ATTEMPTS_FAIL] =
        "INSERT INTO attempts (subject_key, failures, at_ms) "
        "SELECT subject_key, 1, ?2 FROM subjects WHERE lookup = ?1 "
        "ON CONFLICT (subject_key) DO UPDATE "
        "SET failures = min(failures + 1, 1000000), at_ms = excluded.at_ms",
    [SQL_ATTEMPTS_SINCE] = "UPDATE attempts SET at_ms = min(at_ms, ?2) "
                           "WHERE subject_key = " ATTEMPTS_OF,
    [SQL_ATTEMPTS_CLEAR] = "DELETE FROM attempts WHERE subject_key = " ATTEMPTS_OF,
    [SQL_CALIBRATION_ADD] =
        "INSERT INTO calibrations (created, actor, engine, shipped, fmr, threshold_mm, "
        "low_mm, high_mm, subjects, impostors, genuine, halving_mm, knots) "
        "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13)",
    [SQL_CALIBRATION_GET] = "SELECT " CALIBRATION_COLUMNS " FROM calibrations "
                            "ORDER BY calibration_key DESC LIMIT 1",
    [SQL_CALIBRATION_PROVE] =
        "UPDATE calibrations SET mac = ?2 WHERE calibration_key = ?1",
    [SQL_CALIBRATION_END] =
        "REPLACE INTO calibrations_end (calibrations_key, version) "
        "SELECT 1, coalesce(max(calibration_key), 0) FROM calibrations",
    [SQL_CALIBRATION_END_PROVE] =
        "UPDATE calibrations_end SET mac = ?2 WHERE version = ?1",
    [SQL_CALIBRATION_VERSION] = "SELECT version, mac FROM calibrations_end",
    [SQL_CALIBRATION_LIST] =
        "SELECT " CALIBRATION_COLUMNS " FROM calibrations ORDER BY calibration_key",
    [SQL_STATS] = "SELECT (SELECT count(*) FROM subjects), count(*), "
                  "coalesce(sum(points), 0), coalesce(sum(length(model)), 0), "
                  "(SELECT count(*) FROM events), (SELECT count(*) FROM tokens) "
                  "FROM templates",
};
