#include "audit.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"

#define PAGE 1000 /* entries that are in memory at a time */

static void hex(struct json *j, const char *key, const void *bytes, size_t n)
{
    char text[2 * CRYPT_WRAPPED + 1];

    (void)sodium_bin2hex(text, sizeof text, bytes, n);
    json_text(j, key, text);
}

/* "" for none. */
static void uid_of(const struct log_entry *entry, char out[2 * LOG_UID + 1])
{
    out[0] = '\0';
    if (!sodium_is_zero(entry->uid, sizeof entry->uid))
        (void)sodium_bin2hex(out, 2 * LOG_UID + 1, entry->uid, sizeof entry->uid);
}

static void describe_what(struct json *j, const struct log_entry *entry)
{
    char uid[2 * LOG_UID + 1];

    uid_of(entry, uid);
    json_text(j, "log", log_word(entry->log));
    json_number(j, "seq", (double)entry->seq);
    json_number(j, "daemon", entry->daemon);
    json_text(j, "at", entry->at);
    json_text(j, "kind", entry->kind);
    json_text(j, "actor", entry->actor);
    json_text_or_null(j, "subject_uid", uid);
    json_text_or_null(j, "object", entry->object);
    json_text(j, "outcome", entry->outcome);
}

void audit_describe(struct json *j, const struct store_audit_entry *a)
{
    describe_what(j, &a->entry);
    json_text_or_null(j, "actor_name", a->actor_name);
    json_text_or_null(j, "subject", a->subject);
    json_flag(j, "erased", a->erased);
    hex(j, "hash", a->entry.hash, LOG_HASH);
}

void audit_receipt(struct json *j, const struct store_receipt *r)
{
    json_text(j, "subject", r->subject);
    json_number(j, "templates_removed", r->templates);
    json_array(j, "template_ids");
    for (uint32_t i = 0; i < r->templates; i++)
        json_text(j, NULL, r->template_id[i]);
    json_close(j);
    hex(j, "subject_uid", r->entry.uid, sizeof r->entry.uid);
    json_text(j, "erased_at", r->entry.at);
    json_text(j, "digest", r->digest);
    json_object(j, "audit");
    json_number(j, "seq", (double)r->entry.seq);
    hex(j, "hash", r->entry.hash, LOG_HASH);
    json_close(j);
    hex(j, "signature", r->entry.signature, sizeof r->entry.signature);
    hex(j, "public_key", r->public_key, sizeof r->public_key);
}

/* ---- files */

enum status audit_export_begin(struct store *s, const char *actor, struct audit_export *x,
                               struct errinfo *e)
{
    *x = (struct audit_export){.store = s};
    store_audit_public(s, x->public_key);
    return store_audit_sign(s, actor, LOG_EXPORT, &x->end, &x->to, e);
}

static enum status audit_put(FILE *to, const char *text, struct errinfo *e)
{
    return text != NULL && fputs(text, to) != EOF
               ? ST_OK
               : errinfo_set(e, ST_EIO, "the audit log cannot be written");
}

/* The document on a line of its own; it is released. */
static enum status put_line(FILE *to, struct json *j, struct errinfo *e)
{
    char *text = json_compact(j);
    const enum status st = audit_put(to, text, e);

    free(text);
    return st == ST_OK ? audit_put(to, "\n", e) : st;
}

static enum status put_entry(FILE *to, const struct store_audit_entry *a,
                             struct errinfo *e)
{
    const struct log_entry *entry = &a->entry;
    struct json *j = json_new();

    describe_what(j, entry);
    if (entry->log == LOG_CHANGES) {
        hex(j, "digest", entry->digest, sizeof entry->digest);
        json_number(j, "access_seq", (double)entry->accesses.seq);
        hex(j, "access_hash", entry->accesses.hash, LOG_HASH);
    }
    hex(j, "hash", entry->hash, LOG_HASH);
    if (entry->is_signed)
        hex(j, "signature", entry->signature, sizeof entry->signature);
    else if (entry->log == LOG_CHANGES)
        json_text(j, "signature", NULL);
    return put_line(to, j, e);
}

static bool is_covered(const struct store_audit_place *to, const struct log_entry *entry)
{
    return entry->seq <=
           (entry->log == LOG_CHANGES ? to->changes : to->accesses[entry->daemon]);
}

/* What the filter leaves, up to the signed entry. */
static enum status
put_all(FILE *to, const struct audit_export *x, const struct store_audit_filter *filter,
        enum status (*put_one)(FILE *to, const struct store_audit_entry *a,
                               struct errinfo *e),
        struct errinfo *e)
{
    struct store_audit_filter wanted = *filter;
    enum status st = ST_OK;

    wanted.limit = wanted.most = PAGE;
    while (st == ST_OK && !wanted.from.end) {
        struct store_audit_entry *a = NULL;
        size_t n = 0;

        if (x->stop != NULL && atomic_load(x->stop))
            return errinfo_set(e, ST_EBUSY,
                               "the client disconnected; the export was stopped");
        if (x->most != 0 && ftello(to) > (off_t)x->most)
            return errinfo_set(e, ST_ESIZE, "the table has more than %zu MB",
                               x->most >> 20);
        st = store_audit_list(x->store, &wanted, &a, &n, &wanted.from, e);
        for (size_t i = 0; i < n && st == ST_OK; i++)
            if (is_covered(&x->to, &a[i].entry)) /* else it came since */
                st = put_one(to, &a[i], e);
        free(a);
    }
    return st;
}

enum status audit_export_lines(FILE *to, const void *arg, struct errinfo *e)
{
    static const enum log_name changes = LOG_CHANGES;
    const struct audit_export *x = arg;
    struct json *j = json_new();
    enum status st;

    json_number(j, "surface_audit", 2);
    json_text(j, "public_key", x->public_key);
    json_text(j, "at", x->end.at);
    json_number(j, "changes", (double)x->end.seq);
    st = put_line(to, j, e);
    if (st == ST_OK)
        st = put_all(to, x, &(struct store_audit_filter){.log = &changes}, put_entry, e);
    for (uint32_t i = 0; i < x->to.daemons && st == ST_OK; i++)
        st = put_all(to, x, &(struct store_audit_filter){.daemon = &i}, put_entry, e);
    return st;
}

/* A field for any spreadsheet: quoted, and no formula. */
static void put_field(FILE *to, const char *text, char after)
{
    (void)fputc('"', to);
    if (text[0] != '\0' && strchr("=+-@\t\r", text[0]) != NULL)
        (void)fputc('\'', to);
    for (; *text != '\0'; text++)
        (void)(*text == '"' ? fputs("\"\"", to) : fputc(*text, to));
    (void)fputc('"', to);
    (void)fputc(after, to);
}

static enum status audit_put_row(FILE *to, const struct store_audit_entry *a,
                                 struct errinfo *e)
{
    const struct log_entry *entry = &a->entry;
    char uid[2 * LOG_UID + 1], daemon[16], seq[24];
    const char *const field[] = {log_word(entry->log), seq,          entry->at,
                                 entry->kind,          entry->actor, a->actor_name,
                                 a->subject,           uid,          entry->object,
                                 entry->outcome,       daemon};
    const size_t n = sizeof field / sizeof *field;

    uid_of(entry, uid);
    (void)snprintf(daemon, sizeof daemon, "%" PRIu32, entry->daemon);
    (void)snprintf(seq, sizeof seq, "%" PRIu64, entry->seq);
    for (size_t i = 0; i < n; i++)
        put_field(to, field[i], i + 1 < n ? ',' : '\r');
    return audit_put(to, "\n", e);
}

enum status audit_export_table(FILE *to, const void *arg, struct errinfo *e)
{
    const struct audit_export *x = arg;
    const enum status st =
        audit_put(to,
                  "\"log\",\"seq\",\"at\",\"kind\",\"actor\",\"actor_name\",\"subject\","
                  "\"subject_uid\",\"object\",\"outcome\",\"daemon\"\r\n",
                  e);

    return st == ST_OK ? put_all(to, x, x->filter, audit_put_row, e) : st;
}
