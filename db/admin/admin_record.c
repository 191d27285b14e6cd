#include "admin_record.h"

#include <sodium.h>
#include <string.h>

#include "bytes.h"
#include "errinfo.h"
#include "utc.h"
#include "utf8.h"

#define DIGEST 32

/* ---- what a record has beside numbers and texts (bytes.h) */

static bool get_u32(struct bytes *b, uint32_t *out)
{
    uint64_t v;
    const bool ok = bytes_get_number(b, 4, &v);

    *out = (uint32_t)v;
    return ok;
}

static bool get_flag(struct bytes *b, bool *out)
{
    uint64_t v;
    const bool ok = bytes_get_number(b, 1, &v);

    *out = v == 1;
    return ok && v <= 1;
}

/* One of nothing but 0 would be none. */
static bool get_uid(struct bytes *b, unsigned char uid[STORE_UID])
{
    return bytes_get(b, uid, STORE_UID) && !sodium_is_zero(uid, STORE_UID);
}

/* As utc_print() writes it, or "" where that may be. */
static bool time_valid(const char *at, bool never)
{
    char text[UTC_TEXT];
    int64_t ms;

    if (at[0] == '\0')
        return never;
    if (!utc_read(at, &ms))
        return false;
    utc_print(ms, text);
    return strcmp(at, text) == 0;
}

/* ---- records */

size_t admin_record_subject(const struct store_subject *s,
                            unsigned char out[ADMIN_RECORD_HEAD])
{
    unsigned char *to = out;

    bytes_put_number(&to, 'S', 1);
    bytes_put(&to, s->uid, sizeof s->uid);
    bytes_put_text(&to, s->id);
    bytes_put_text(&to, s->reference);
    bytes_put_text(&to, s->purpose);
    bytes_put_text(&to, s->created);
    bytes_put_text(&to, s->expires);
    bytes_put_text(&to, s->seen);
    bytes_put_number(&to, s->hold, 1);
    bytes_put_number(&to, s->disabled, 1);
    return (size_t)(to - out);
}

static void put_digest(unsigned char **to, const char *hex)
{
    unsigned char digest[DIGEST] = {0};

    (void)sodium_hex2bin(digest, sizeof digest, hex, strlen(hex), NULL, NULL, NULL);
    bytes_put(to, digest, sizeof digest);
}

/* "" where it is 0: not known. */
static bool get_digest(struct bytes *b, char hex[2 * DIGEST + 1])
{
    unsigned char digest[DIGEST];
    const bool ok = bytes_get(b, digest, sizeof digest);

    hex[0] = '\0';
    if (ok && !sodium_is_zero(digest, sizeof digest))
        (void)sodium_bin2hex(hex, 2 * DIGEST + 1, digest, sizeof digest);
    return ok;
}

size_t admin_record_template(const struct rows_template *row,
                             unsigned char out[ADMIN_RECORD_HEAD])
{
    const struct store_template *t = &row->one;
    unsigned char *to = out;

    bytes_put_number(&to, 'T', 1);
    bytes_put_text(&to, t->id);
    bytes_put_text(&to, t->label);
    bytes_put_text(&to, t->created);
    bytes_put_text(&to, t->engine);
    put_digest(&to, t->digest);
    put_digest(&to, row->read);
    bytes_put_number(&to, t->points, 4);
    bytes_put_number(&to, t->triangles, 4);
    bytes_put_number(&to, t->manager, 1);
    bytes_put_real(&to, t->first_score);
    bytes_put_real(&to, t->quality.score);
    bytes_put_real(&to, t->quality.coverage);
    bytes_put_real(&to, t->quality.density_mm);
    bytes_put_real(&to, t->quality.noise_mm);
    return (size_t)(to - out);
}

static bool parse_subject(struct bytes *b, struct store_subject *s)
{
    memset(s, 0, sizeof *s);
    return get_uid(b, s->uid) && bytes_get_text(b, s->id, sizeof s->id) &&
           ident_subject_valid(s->id) &&
           bytes_get_text(b, s->reference, sizeof s->reference) &&
           utf8_is_text(s->reference, STORE_NOTE_MAX) &&
           bytes_get_text(b, s->purpose, sizeof s->purpose) &&
           utf8_is_text(s->purpose, STORE_NOTE_MAX) &&
           bytes_get_text(b, s->created, sizeof s->created) &&
           time_valid(s->created, false) &&
           bytes_get_text(b, s->expires, sizeof s->expires) &&
           time_valid(s->expires, true) && bytes_get_text(b, s->seen, sizeof s->seen) &&
           time_valid(s->seen, true) && get_flag(b, &s->hold) &&
           get_flag(b, &s->disabled) && b->at == b->end;
}

static bool parse_template(struct bytes *b, struct admin_record_item *item)
{
    struct store_template *t = &item->template.one;

    memset(&item->template, 0, sizeof item->template);
    memcpy(t->subject, item->subject.id, sizeof t->subject);
    if (!bytes_get_text(b, t->id, sizeof t->id) || !ident_id_valid(t->id) ||
        !bytes_get_text(b, t->label, sizeof t->label) ||
        !utf8_is_text(t->label, STORE_LABEL_MAX) ||
        !bytes_get_text(b, t->created, sizeof t->created) ||
        !time_valid(t->created, false) ||
        !bytes_get_text(b, t->engine, sizeof t->engine) ||
        !ident_printable(t->engine, 1, (SURFACE_ENGINE_SIZE - 1)) ||
        !get_digest(b, t->digest) || !get_digest(b, item->template.read))
        return false;
    if (!get_u32(b, &t->points) || t->points < 3 || t->points > SURFACE_MAX_POINTS ||
        !get_u32(b, &t->triangles) || t->triangles < 1 ||
        t->triangles > 2 * t->points - 5 || !get_flag(b, &t->manager) ||
        !bytes_get_finite(b, &t->first_score) ||
        !bytes_get_real(b, 1, &t->quality.score) ||
        !bytes_get_real(b, 1, &t->quality.coverage) ||
        !bytes_get_real(b, 1e6, &t->quality.density_mm) ||
        !bytes_get_real(b, 1e6, &t->quality.noise_mm))
        return false;
    item->face = b->at;
    item->len = (size_t)(b->end - b->at);
    return item->len > 0;
}

enum status admin_record_parse(const unsigned char *data, size_t n,
                               struct admin_record_item *item, struct errinfo *e)
{
    struct bytes b = {data, data + n};
    uint64_t kind = 0;
    bool ok = bytes_get_number(&b, 1, &kind);

    item->face = NULL;
    item->len = 0;
    if (kind == 'S') {
        item->kind = ADMIN_RECORD_SUBJECT;
        ok = ok && parse_subject(&b, &item->subject);
    } else if (kind == 'T') {
        item->kind = ADMIN_RECORD_TEMPLATE;
        ok = ok && item->subject.id[0] != '\0' && parse_template(&b, item);
    } else {
        item->kind = ADMIN_RECORD_END;
        ok = ok && kind == 'E' && bytes_get_number(&b, 8, &item->subjects) &&
             bytes_get_number(&b, 8, &item->templates) && b.at == b.end;
    }
    return ok ? ST_OK
              : errinfo_set(e, ST_ECORRUPT, "the archive has a record that cannot be");
}
