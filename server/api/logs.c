#define _GNU_SOURCE /* memfd_create */
#include "routes.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <sodium.h>

#include "app.h"
#include "audit.h"
#include "errinfo.h"
#include "errmap.h"
#include "json.h"
#include "logger.h"
#include "params.h"
#include "place.h"
#include "request.h"

#define PAGE_DEFAULT 100
#define PAGE_MAX     1000
#define LOOKED       20000 /* entries that a request looks at, at most: some 50 ms */
#define FINDINGS_MAX 100
#define TABLE_MAX    ((size_t)64 << 20) /* bytes of CSV, which are in memory */

/* What is asked for, as texts that a filter points to. */
struct asked {
    struct store_audit_filter filter;
    char subject[STORE_SUBJECT_MAX + 1], kind[257], actor[LOG_TEXT + 1];
    char since[32], until[32];
    unsigned char uid[LOG_UID];
};

static bool logs_take(struct request *r, const char *name, char *to, size_t size,
                      const char **out)
{
    if (!params_text(r, name, to, size))
        return false;
    *out = to[0] != '\0' ? to : NULL;
    return true;
}

/* The number of a subject that is on the receipt of its erasure. */
static bool take_uid(struct request *r, struct asked *a)
{
    char hex[2 * LOG_UID + 1];
    const char *given;
    size_t n;

    if (!logs_take(r, "subject_uid", hex, sizeof hex, &given))
        return false;
    if (given == NULL)
        return true;
    if (a->filter.subject != NULL) {
        request_problem(r, ERRMAP_PARAMETER, "subject and subject_uid: one of them");
        return false;
    }
    if (sodium_hex2bin(a->uid, sizeof a->uid, hex, strlen(hex), NULL, &n, NULL) != 0 ||
        n != sizeof a->uid || sodium_is_zero(a->uid, sizeof a->uid)) {
        request_problem(
            r, ERRMAP_PARAMETER,
            "subject_uid is the %d hexadecimal digits of an entry or a receipt",
            2 * LOG_UID);
        return false;
    }
    a->filter.uid = a->uid;
    return true;
}

static bool ask(struct request *r, struct asked *a)
{
    struct store_audit_filter *f = &a->filter;

    memset(a, 0, sizeof *a);
    f->names = true;
    return logs_take(r, "subject", a->subject, sizeof a->subject, &f->subject) &&
           take_uid(r, a) && logs_take(r, "kind", a->kind, sizeof a->kind, &f->kind) &&
           logs_take(r, "actor", a->actor, sizeof a->actor, &f->actor) &&
           logs_take(r, "since", a->since, sizeof a->since, &f->since) &&
           logs_take(r, "until", a->until, sizeof a->until, &f->until);
}

static bool take_place(struct request *r, const char *name, uint64_t least,
                       struct store_audit_place *out, bool *given)
{
    char text[PLACE_MAX] = "";

    if (!params_text(r, name, text, sizeof text))
        return false;
    if (!(*given = text[0] != '\0') || place_read(text, least, out))
        return true;
    request_problem(r, ERRMAP_PARAMETER, "%s is not the next_cursor of a page", name);
    return false;
}

static char *logs_write_page(const struct store_audit_entry *a, size_t n,
                             const struct store_audit_place *next, bool more)
{
    struct json *j = json_new();
    char place[PLACE_MAX];

    json_array(j, "entries");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        audit_describe(j, &a[i]);
        json_close(j);
    }
    json_close(j);
    place_print(next, place);
    json_text(j, "next_cursor", more ? place : NULL);
    return json_compact(j);
}

void logs_list(struct request *r, struct worker *w)
{
    struct store_audit_entry *list = NULL;
    struct store_audit_place next;
    struct errinfo e = {0};
    struct asked a;
    size_t n = 0, limit = PAGE_DEFAULT;
    bool before, after;

    (void)w;
    if (!ask(r, &a) || !params_count(r, "limit", 1, PAGE_MAX, &limit) ||
        !take_place(r, "before", 1, &a.filter.from, &before) ||
        !take_place(r, "after", 0, &a.filter.from, &after))
        return;
    if (before && after) {
        request_problem(r, ERRMAP_PARAMETER, "before and after: one of them");
        return;
    }
    a.filter.limit = limit;
    a.filter.most = LOOKED;
    a.filter.newest = !after;
    if (store_audit_list(r->app->store, &a.filter, &list, &n, &next, &e) != ST_OK)
        request_fail(r, &e);
    else
        request_respond(r, 200, logs_write_page(list, n, &next, after || !next.end));
    free(list);
}

/* ---- what takes long; on a worker that does nothing else */

struct finding_list {
    struct json *j;
    unsigned n;
};

static void logs_tell(void *arg, enum log_name log, uint64_t seq, const char *line)
{
    struct finding_list *l = arg;
    char text[256];

    if (l->n++ >= FINDINGS_MAX)
        return;
    (void)snprintf(text, sizeof text, "%s, at entry %" PRIu64 ": %s", log_word(log), seq,
                   line);
    json_text(l->j, NULL, text);
}

static char *write_verified(struct json *j, const struct log_walk *found,
                            const struct store_stats *all, double ms)
{
    char hash[2 * LOG_HASH + 1];

    (void)sodium_bin2hex(hash, sizeof hash, found->head.hash, LOG_HASH);
    json_flag(j, "ok", found->problems == 0);
    json_number(j, "changes", (double)found->changes);
    json_number(j, "accesses", (double)(found->entries - found->changes));
    json_number(j, "rows",
                (double)(all->subjects + all->templates + all->tokens + all->devices +
                         all->calibrations));
    json_number(j, "problems", (double)found->problems);
    json_object(j, "head");
    json_number(j, "seq", (double)found->head.seq);
    json_text(j, "hash", hash);
    json_close(j);
    json_number(j, "took_ms", ms);
    return json_compact(j);
}

void logs_verify(struct request *r, struct worker *w)
{
    const double begin = logger_clock_ms();
    struct finding_list list = {.j = json_new()};
    struct store_stats all;
    struct log_walk found;
    struct errinfo e = {0};
    enum status st;

    (void)w;
    json_array(list.j, "findings");
    if ((st = store_stats(r->app->store, false, &all, &e)) == ST_OK)
        st = store_audit_verify(r->app->store, logs_tell, &list, &found, &e);
    json_close(list.j);
    if (st == ST_OK) {
        request_respond(r, 200,
                        write_verified(list.j, &found, &all, logger_clock_ms() - begin));
    } else {
        json_discard(list.j);
        request_fail(r, &e);
    }
}

/* Without a name, so that nothing stays; ids are on no disk. */
static FILE *open_file(bool table)
{
    const int fd = table ? memfd_create("audit", MFD_CLOEXEC) : -1;
    FILE *f = table ? (fd >= 0 ? fdopen(fd, "w+") : NULL) : tmpfile();

    if (f == NULL && fd >= 0)
        (void)close(fd);
    return f;
}

static void send_file(struct request *r, FILE *f, bool table)
{
    const off_t len = ftello(f);

    if (len <= 0 || fflush(f) != 0 || ferror(f) != 0) {
        (void)fclose(f);
        request_problem(r, ST_EIO, "the audit log's file cannot be written");
        return;
    }
    request_file(r, table ? "text/csv; charset=utf-8" : "application/jsonl", f,
                 (size_t)len,
                 table ? "attachment; filename=\"audit.csv\""
                       : "attachment; filename=\"audit.jsonl\"");
}

static void write_file(struct request *r, const struct store_audit_filter *filter,
                       bool table)
{
    FILE *f = open_file(table);
    struct audit_export x;
    struct errinfo e = {0};
    enum status st;

    if (f == NULL) {
        request_problem(r, ST_EIO, "no file for the audit log");
        return;
    }
    if ((st = audit_export_begin(r->app->store, r->actor, &x, &e)) == ST_OK) {
        x.filter = filter;
        x.most = TABLE_MAX;
        x.stop = &r->gone;
        st = table ? audit_export_table(f, &x, &e) : audit_export_lines(f, &x, &e);
    }
    if (st == ST_OK) {
        send_file(r, f, table);
        return;
    }
    (void)fclose(f);
    if (st == ST_ESIZE)
        request_problem(r, ERRMAP_PARAMETER, "%s: narrow it by since and until", e.msg);
    else
        request_fail(r, &e);
}

void logs_export(struct request *r, struct worker *w)
{
    char format[8] = "";
    struct asked a;
    bool table;

    (void)w;
    if (!params_text(r, "format", format, sizeof format) || !ask(r, &a))
        return;
    table = strcmp(format, "csv") == 0;
    if (!table && format[0] != '\0' && strcmp(format, "jsonl") != 0)
        request_problem(r, ERRMAP_PARAMETER, "format is jsonl or csv, not '%s'", format);
    else if (!table &&
             (a.filter.subject != NULL || a.filter.uid != NULL || a.filter.kind != NULL ||
              a.filter.actor != NULL || a.filter.since != NULL || a.filter.until != NULL))
        request_problem(
            r, ERRMAP_PARAMETER,
            "jsonl is all of the log, or it could not be verified: filters are "
            "for format=csv");
    else
        write_file(r, &a.filter, table);
}
