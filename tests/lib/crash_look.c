#include "crash.h"

#include <sqlite3.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "admin_check.h"
#include "errinfo.h"
#include "store.h"

struct text {
    char *at;
    size_t n;
};

__attribute__((format(printf, 2, 3))) static void say(struct text *t, const char *fmt,
                                                      ...)
{
    va_list args;
    int n;

    va_start(args, fmt);
    n = vsnprintf(t->at + t->n, CRASH_TEXT - t->n, fmt, args);
    va_end(args);
    if (n < 0 || (size_t)n >= CRASH_TEXT - t->n) {
        (void)fprintf(stderr, "a database says more than %d bytes\n", CRASH_TEXT);
        exit(2);
    }
    t->n += (size_t)n;
}

static void problem(void *arg, const char *line)
{
    say(arg, "%s\n", line);
}

static enum status say_templates(struct store *s, const char *subject, struct text *t,
                                 struct errinfo *e)
{
    struct store_template *list;
    size_t n;
    enum status st = store_template_list(s, subject, &list, &n, e);

    if (st != ST_OK)
        return st;
    for (size_t i = 0; i < n; i++)
        say(t, "  %s %s %s\n", list[i].digest, list[i].engine, list[i].label);
    free(list);
    return st;
}

static enum status say_subjects(struct store *s, struct text *t, struct errinfo *e)
{
    struct store_subject *list;
    size_t n;
    enum status st = store_subject_list(s, 0, 1000, &list, &n, e);

    if (st != ST_OK)
        return st;
    for (size_t i = 0; i < n && st == ST_OK; i++) {
        say(t, "%s %s %d %d\n", list[i].id, list[i].reference, list[i].hold,
            list[i].disabled);
        st = say_templates(s, list[i].id, t, e);
    }
    free(list);
    return st;
}

static enum status say_tokens(struct store *s, struct text *t, struct errinfo *e)
{
    struct store_token *list;
    size_t n;
    enum status st = store_token_list(s, &list, &n, e);

    if (st != ST_OK)
        return st;
    for (size_t i = 0; i < n; i++)
        say(t, "token %s %u %d\n", list[i].name, list[i].scopes, list[i].revoked);
    free(list);
    return st;
}

bool crash_look(const char *dir, char out[CRASH_TEXT])
{
    struct text t = {out, 0};
    char path[CRASH_PATH];
    struct errinfo e = {ST_OK, ""};
    struct admin_check check;
    struct store_key key = {.make = CRYPT_FILE};
    enum crypt_kind kind;
    struct store *s;
    enum status st;

    crash_join(path, dir, "db");
    out[0] = '\0';
    if ((st = store_kind(path, &kind, &e)) == ST_ENOTFOUND) {
        say(&t, "none");
        return true;
    }
    key.plaintext = st == ST_OK && kind == CRYPT_PLAINTEXT;
    if (st != ST_OK || (st = store_open(path, STORE_READ, &key, &s, &e)) != ST_OK) {
        say(&t, "cannot be opened: %s", e.msg);
        return false;
    }
    if ((st = admin_check(s, true, problem, &t, &check, &e)) == ST_OK && t.n == 0 &&
        (st = say_subjects(s, &t, &e)) == ST_OK)
        st = say_tokens(s, &t, &e);
    else if (st == ST_OK)
        st = ST_ECORRUPT;
    if (st != ST_OK)
        say(&t, "not well: %s", e.msg);
    store_close(s);
    return st == ST_OK;
}

size_t crash_secrets(const char *dir, struct crash_secret *out, size_t max)
{
    static const char *const sql[] = {"SELECT key FROM subjects",
                                      "SELECT substr(face, 101, 32) FROM faces"};
    char path[CRASH_PATH];
    sqlite3_stmt *stmt;
    sqlite3 *db;
    size_t n = 0;

    crash_join(path, dir, "db");
    if (access(path, F_OK) != 0)
        return 0;
    if (sqlite3_open_v2(path, &db, SQLITE_OPEN_READWRITE, NULL) != SQLITE_OK)
        exit(2);
    for (size_t i = 0; i < 2; i++) {
        if (sqlite3_prepare_v2(db, sql[i], -1, &stmt, NULL) != SQLITE_OK)
            continue;
        while (n < max && sqlite3_step(stmt) == SQLITE_ROW)
            if (sqlite3_column_bytes(stmt, 0) >= (int)sizeof *out)
                memcpy(out[n++].at, sqlite3_column_blob(stmt, 0), sizeof *out);
        (void)sqlite3_finalize(stmt);
    }
    (void)sqlite3_close(db);
    return n;
}
