#include "scanfile.h"

#include "errinfo.h"
#include "unit.h"

void scanfile_put(struct scanfile *f, const void *bytes, size_t len)
{
    assert_true(f->len + len <= sizeof f->bytes);
    memcpy(f->bytes + f->len, bytes, len);
    f->len += len;
}

void scanfile_text(struct scanfile *f, const char *text)
{
    scanfile_put(f, text, strlen(text));
}

void scanfile_whole(struct scanfile *f, uint64_t value, unsigned size, bool big)
{
    unsigned char bytes[8];

    for (unsigned i = 0; i < size; i++)
        bytes[big ? size - 1 - i : i] = (unsigned char)(value >> (8 * i));
    scanfile_put(f, bytes, size);
}

void scanfile_real(struct scanfile *f, double value, unsigned size, bool big)
{
    float narrow = (float)value;
    uint32_t bits;
    uint64_t wide;

    memcpy(&bits, &narrow, sizeof bits);
    memcpy(&wide, &value, sizeof wide);
    scanfile_whole(f, size == 4 ? bits : wide, size, big);
}

static void take_message(const char *msg, struct scanfile_said *out)
{
    unsigned line = 0;
    int at = 0;

    if (sscanf(msg, "line %u: %n", &line, &at) < 1 || at == 0)
        line = 0;
    if (at == 0 && (sscanf(msg, "byte %zu: %n", &out->where, &at) < 1 || at == 0))
        out->where = 0;
    out->line = line;
    (void)snprintf(out->msg, sizeof out->msg, "%s", msg);
    out->what = out->msg + at;
}

enum status scanfile_read(const void *bytes, size_t len,
                          const struct cloudfile_options *o, struct cloudpoints *out,
                          struct scanfile_said *err)
{
    struct errinfo e = {0};
    char *copy = malloc(len + 1); /* so that the sanitizer sees a read too far */
    enum status st;

    assert_non_null(copy);
    if (len != 0)
        memcpy(copy, bytes, len);
    copy[len] = '\0';
    memset(err, 0, sizeof *err);
    st = cloudfile_read(copy, len, o, out, &e);
    free(copy);
    take_message(e.msg, err);
    if (st != ST_OK) {
        assert_null(out->at);
        assert_true(out->n == 0 && out->read == 0 && out->index == NULL);
        assert_true(out->normal == NULL);
        assert_true(err->what[0] != 0);
        assert_true(err->where <= len);
        return st;
    }
    assert_non_null(out->at);
    assert_true(out->n <= out->read && (out->index != NULL || out->n == out->read));
    return st;
}

static enum status read_by(const struct scanfile *f, size_t len, enum cloudformat format,
                           struct cloudpoints *out, struct scanfile_said *err)
{
    const struct cloudfile_options o = {
        .format = format, .max_points = SCANFILE_LIMIT, .max_bytes = 1 << 20};

    return scanfile_read(f->bytes, len, &o, out, err);
}

void scanfile_good(const struct scanfile *f, enum cloudformat format,
                   struct cloudpoints *out)
{
    struct scanfile_said err;
    const enum status st = read_by(f, f->len, format, out, &err);

    if (st != ST_OK)
        fail_msg("status %d, line %u: %s", st, err.line, err.what);
}

void scanfile_bad(const struct scanfile *f, enum cloudformat format, enum status want,
                  const char *words)
{
    struct scanfile_said err;
    struct cloudpoints out;
    const enum status st = read_by(f, f->len, format, &out, &err);

    if (st != want || strstr(err.msg, words) == NULL)
        fail_msg("status %d, not %d with '%s': %s", st, want, words, err.msg);
}

void scanfile_refused(const struct scanfile_case *c, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct scanfile f = {.len = 0};

        scanfile_text(&f, c[i].text);
        scanfile_bad(&f, CLOUDFORMAT_ANY, c[i].st, c[i].words);
    }
}

void scanfile_good_text(const char *text, struct cloudpoints *out)
{
    struct scanfile f = {.len = 0};

    scanfile_text(&f, text);
    scanfile_good(&f, CLOUDFORMAT_ANY, out);
}

void scanfile_cut(const struct scanfile *f, enum cloudformat format)
{
    for (size_t len = 0; len < f->len; len++) {
        struct scanfile_said err;
        struct cloudpoints out;

        if (read_by(f, len, format, &out, &err) == ST_OK)
            fail_msg("read, with %zu of %zu bytes", len, f->len);
    }
}

void scanfile_at(struct dvec3 p, double x, double y, double z)
{
    if (p.x != x || p.y != y || p.z != z)
        fail_msg("%g %g %g, not %g %g %g", p.x, p.y, p.z, x, y, z);
}
