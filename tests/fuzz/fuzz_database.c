/* A database that was changed by somebody without the key.  The input gives the changes to a
 * small encrypted one: first to rows (values, other rows' values, deleted or duplicated rows,
 * the schema), then to bytes of the file.  Every query then fails or returns what was stored:
 * no template is loaded for another subject, and no other token is valid.  Where the rows verify,
 * all of them are there.  A write to rows that do not is refused.
 * The database is made at the start from fixed random numbers. */
#define FUZZ_ROUNDS 40
#include "fuzz.h"

#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "admin_check.h"
#include "errinfo.h"
#include "hostile.h"

#define EDITS_MAX 16
#define MUST      HOSTILE_MUST

static char dir[64], path[96], key[96];
static const struct store_key by_key = {.path = key, .make = CRYPT_FILE};
static unsigned char *base;
static size_t size;

/* ---- the database */

static uint64_t random_state;

static uint32_t random_number(void)
{
    random_state = random_state * UINT64_C(6364136223846793005) + 1442695040888963407;
    return (uint32_t)(random_state >> 32);
}

static const char *random_name(void)
{
    return "fuzz";
}

static void random_bytes(void *const out, const size_t n)
{
    for (size_t i = 0; i < n; i++)
        ((unsigned char *)out)[i] = (unsigned char)random_number();
}

static void remove_files(void)
{
    static const char *const suffix[] = {"", "-wal", "-shm", "-journal"};
    char name[128];

    for (size_t i = 0; i < sizeof suffix / sizeof *suffix; i++) {
        (void)snprintf(name, sizeof name, "%s%s", path, suffix[i]);
        (void)unlink(name);
    }
}

static void end(void)
{
    remove_files();
    (void)unlink(key);
    (void)rmdir(dir);
    hostile_end();
    free(base);
}

static void start(void)
{
    static struct randombytes_implementation numbers = {
        .implementation_name = random_name, .random = random_number, .buf = random_bytes};

    MUST(randombytes_set_implementation(&numbers) == 0);
    (void)snprintf(dir, sizeof dir, "%s/fuzz_database.XXXXXX",
                   access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    MUST(mkdtemp(dir) != NULL);
    (void)snprintf(path, sizeof path, "%s/db", dir);
    (void)snprintf(key, sizeof key, "%s/key", dir);
    (void)atexit(end);
    base = hostile_make(path, &by_key, HOSTILE_TEMPLATES, &size);
}

/* ---- the changes */

struct input {
    const uint8_t *at;
    size_t left;
};

static unsigned take(struct input *in) /* 0 at the end */
{
    if (in->left == 0)
        return 0;
    in->left--;
    return *in->at++;
}

static unsigned take2(struct input *in)
{
    const unsigned low = take(in);

    return low | take(in) << 8;
}

static size_t take_bytes(struct input *in, const uint8_t **out)
{
    const size_t want = take(in), n = want < in->left ? want : in->left;

    *out = in->at;
    in->at += n;
    in->left -= n;
    return n;
}

/* The n-th name that a query returns; beyond the last it begins again. */
static bool nth(sqlite3 *db, const char *sql, unsigned n, char out[64])
{
    char whole[256];
    sqlite3_stmt *stmt = NULL;
    bool found = false;

    (void)snprintf(whole, sizeof whole,
                   "WITH n(name) AS (%s) SELECT name FROM n LIMIT 1 OFFSET "
                   "%u %% (SELECT max(1, count(*)) FROM n)",
                   sql, n);
    if (sqlite3_prepare_v2(db, whole, -1, &stmt, NULL) == SQLITE_OK &&
        sqlite3_step(stmt) == SQLITE_ROW && sqlite3_column_bytes(stmt, 0) < 64 &&
        sqlite3_column_text(stmt, 0) != NULL) {
        (void)snprintf(out, 64, "%s", (const char *)sqlite3_column_text(stmt, 0));
        found = true;
    }
    (void)sqlite3_finalize(stmt);
    return found;
}

/* Replacements of a value: @ is its column, # its table. */
static const char *const values[] = {
    "?1",
    "CAST(?1 AS TEXT)",
    "CAST(CAST(?1 AS TEXT) AS INTEGER)",
    "NULL",
    "?2",
    "-?2",
    "?2 * 72057594037927936",
    "?2 / 3.0",
    "(SELECT @ FROM # LIMIT 1 OFFSET ?2 % 4)",
    "substr(@, 1, ?2)",
    "CAST(@ || ?1 AS BLOB)",
    "CAST(substr(@, 1, ?2) || ?1 || substr(@, ?2 + 1 + length(?1)) AS BLOB)",
    "CAST(substr(@, 1, ?2) || ?1 || substr(@, ?2 + 1 + length(?1)) AS TEXT)",
    "zeroblob(?2)",
};

static void name_all(char out[1024], const char *sql, const char *column,
                     const char *table)
{
    size_t n = 0;

    for (; *sql != '\0'; sql++)
        n += (size_t)snprintf(out + n, 1024 - n,
                              *sql == '@' || *sql == '#' ? "%s" : "%.1s",
                              *sql == '@'   ? column
                              : *sql == '#' ? table
                                            : sql);
}

static void edit_row(sqlite3 *db, struct input *in)
{
    char table[64], column[64], columns[128], pattern[512], sql[1024];
    sqlite3_stmt *stmt = NULL;
    const unsigned what = take(in), at = take(in);
    const uint8_t *bytes;
    size_t n;

    if (!nth(db,
             "SELECT name FROM sqlite_schema WHERE type = 'table' "
             "UNION ALL SELECT 'sqlite_schema'",
             at / 8, table))
        return;
    (void)snprintf(columns, sizeof columns, "SELECT name FROM pragma_table_info('%s')",
                   table);
    if (!nth(db, columns, take(in), column) || strcmp(column, "kind") == 0)
        return; /* without passphrases: deriving their keys is slow */
    if (what % 4 == 3)
        (void)snprintf(pattern, sizeof pattern,
                       "DELETE FROM # WHERE rowid = (SELECT rowid FROM # "
                       "LIMIT 1 OFFSET %u) AND ?1 IS NOT ?2",
                       at % 8);
    else
        (void)snprintf(pattern, sizeof pattern,
                       "UPDATE OR IGNORE # SET @ = %s WHERE rowid = "
                       "(SELECT rowid FROM # LIMIT 1 OFFSET %u)",
                       values[what / 4 % (sizeof values / sizeof *values)], at % 8);
    name_all(sql, pattern, column, table);
    if (sqlite3_prepare_v2(db, sql, -1, &stmt, NULL) == SQLITE_OK) {
        n = take_bytes(in, &bytes);
        (void)sqlite3_bind_blob(stmt, 1, bytes, (int)n, SQLITE_STATIC);
        (void)sqlite3_bind_int(stmt, 2, (int)take2(in));
        (void)sqlite3_step(stmt); /* may fail by a constraint of the schema */
    }
    (void)sqlite3_finalize(stmt);
}

/* Applies the input's changes of rows; returns the database as a file in memory. */
static unsigned char *edit_rows(struct input *in, unsigned edits, size_t *n)
{
    unsigned char *bytes = sqlite3_malloc64(size), *out;
    sqlite3_int64 len = 0;
    sqlite3 *db = NULL;

    MUST(bytes != NULL && sqlite3_open(":memory:", &db) == SQLITE_OK);
    memcpy(bytes, base, size);
    MUST(sqlite3_deserialize(db, "main", bytes, (sqlite3_int64)size, (sqlite3_int64)size,
                             SQLITE_DESERIALIZE_FREEONCLOSE |
                                 SQLITE_DESERIALIZE_RESIZEABLE) == SQLITE_OK);
    (void)sqlite3_exec(db,
                       "PRAGMA ignore_check_constraints=ON; PRAGMA foreign_keys=OFF;"
                       "PRAGMA writable_schema=ON",
                       NULL, NULL, NULL);
    for (unsigned i = 0; i < edits; i++)
        edit_row(db, in);
    MUST((out = sqlite3_serialize(db, "main", &len, 0)) != NULL);
    *n = (size_t)len;
    (void)sqlite3_close(db);
    return out;
}

static void edit_bytes(unsigned char *file, size_t *n, struct input *in)
{
    const unsigned what = take(in);
    const uint8_t *bytes;
    size_t at = (take2(in) | (size_t)take(in) << 16) % *n, from, len;

    switch (what % 4) {
    case 0: /* bytes of the input */
        len = take_bytes(in, &bytes);
        memcpy(file + at, bytes, len < *n - at ? len : *n - at);
        break;
    case 1: /* a piece from elsewhere */
        from = take2(in) % *n;
        len = take(in);
        len = len < *n - at ? len : *n - at;
        memmove(file + at, file + from, len < *n - from ? len : *n - from);
        break;
    case 2: /* a whole page of it */
        from = take2(in) % (*n / 512) * 512;
        memmove(file + at / 512 * 512, file + from, 512);
        break;
    default:
        *n = what / 4 % 8 == 0 ? at + 1 : *n;
        file[at < *n ? at : 0] ^= (unsigned char)(1U << what / 32);
    }
}

static void make_file(struct input *in)
{
    const unsigned how = take(in), rows = how % EDITS_MAX, bytes = how / EDITS_MAX;
    size_t n;
    unsigned char *file = edit_rows(in, rows, &n);
    FILE *f;

    for (unsigned i = 0; i < bytes / 2 && n >= 512; i++)
        edit_bytes(file, &n, in);
    if (bytes % 2 == 1 && n >= 100)
        file[18] = file[19] = 2; /* WAL mode */
    MUST((f = fopen(path, "wb")) != NULL && fwrite(file, 1, n, f) == n && fclose(f) == 0);
    sqlite3_free(file);
}

/* ---- the checks */

static void ask_lists(struct store *s)
{
    static const struct store_audit_filter names = {.names = true};
    struct store_subject *subjects;
    struct store_token *tokens;
    struct store_calibration *calibrations;
    struct store_audit_entry *entries;
    struct store_attempts *attempts;
    struct store_stats stats;
    size_t n;

    if (store_subject_list(s, 0, 10, &subjects, &n, &hostile_e) == ST_OK) {
        for (size_t i = 0; i < n; i++) /* a row may be there twice: check finds it */
            MUST(strcmp(subjects[i].id, "alice") == 0 ||
                 strcmp(subjects[i].id, "bob") == 0 ||
                 strcmp(subjects[i].id, "carol") == 0);
        free(subjects);
    }
    if (store_token_list(s, "", &tokens, &n, &hostile_e) == ST_OK)
        free(tokens);
    if (store_calibration_list(s, &calibrations, &n, &hostile_e) == ST_OK)
        free(calibrations);
    if (store_audit_list(s, &names, &entries, &n, NULL, &hostile_e) == ST_OK)
        free(entries);
    if (store_attempts_list(s, &attempts, &n, &hostile_e) == ST_OK)
        free(attempts);
    (void)store_stats(s, true, &stats, &hostile_e);
}

static void ignore(void *arg, const char *line)
{
    (void)arg;
    MUST(line[0] != '\0');
}

static void ask(struct store *s)
{
    struct admin_check check;

    (void)hostile_ask(s);
    ask_lists(s);
    (void)admin_check(s, true, ignore, NULL, &check, &hostile_e);
}

/* The first write succeeds where the rows verify, by another store, and is refused where not. */
static void change(struct store *s)
{
    struct store_receipt receipt;
    struct store *other = NULL;
    struct store_template t;
    bool created, good;

    good = store_open(path, STORE_READ, &by_key, &other, &hostile_e) == ST_OK &&
           store_verify(other, NULL, NULL, &hostile_e) == ST_OK;
    store_close(other);
    if (store_enroll(s,
                     &(struct store_enroll){
                         .actor = "test",
                         .subject = "dave",
                         .label = "",
                         .sample = &(struct store_sample){.face = hostile_face()},
                         .n = 1},
                     &t, &created, &hostile_e) == ST_OK)
        MUST(good && created && strcmp(t.subject, "dave") == 0);
    if (store_subject_erase(s, "test", "alice", &receipt, &hostile_e) == ST_OK)
        MUST(good &&
             store_subject_get(s, "", "alice", &(struct store_subject){.hold = false},
                               &hostile_e) == ST_ENOTFOUND);
    store_receipt_free(&receipt);
    if (good)
        MUST(store_verify(s, NULL, NULL, &hostile_e) == ST_OK);
    (void)hostile_ask(s);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t len)
{
    struct input in = {data, len};
    struct store *s;

    if (base == NULL)
        start();
    make_file(&in);
    if (store_open(path, STORE_READ, &by_key, &s, &hostile_e) == ST_OK) {
        ask(s);
        if (store_verify(s, NULL, NULL, &hostile_e) == ST_OK)
            MUST(hostile_ask(s) == hostile_reads());
        store_close(s);
    }
    if (len % 4 == 0 && store_open(path, STORE_WRITE, &by_key, &s, &hostile_e) == ST_OK) {
        change(s);
        store_close(s);
    }
    remove_files();
    return 0;
}
