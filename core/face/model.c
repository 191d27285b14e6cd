#include "model.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Units of the text's integers, per millimetre or per 1. */
#define MEAN_UNITS   1000
#define REST_UNITS   10000
#define MODE_UNITS   1000
#define SCALAR_UNITS 1000.0 /* of the scalars, and of scores */
#define RATE_UNITS   1e9

#define VERSION 4 /* of the text */

#define HEIGHT_MAX 200000 /* of the mean face, in its units */
#define VALUE_MAX  100000
#define SCALAR_MAX 100000
#define SCORE_MAX  10000000

/* ---- reading */

struct reader {
    const char *at, *end;
    uint32_t line;
    bool bad;
};

static void skip_space(struct reader *r)
{
    while (!r->bad && r->at < r->end && (*r->at == ' ' || *r->at == '\n')) {
        r->line += *r->at == '\n';
        r->at++;
    }
}

static bool at_space(const struct reader *r)
{
    return r->at == r->end || *r->at == ' ' || *r->at == '\n';
}

/* The next word must be this one. */
static void expect(struct reader *r, const char *word)
{
    const size_t n = strlen(word);

    skip_space(r);
    if (r->bad || (size_t)(r->end - r->at) < n || memcmp(r->at, word, n) != 0) {
        r->bad = true;
        return;
    }
    r->at += n;
    r->bad = !at_space(r);
}

/* The next word, an integer from lo to hi; 0 on failure. */
static int64_t integer(struct reader *r, int64_t lo, int64_t hi)
{
    bool minus = false;
    int64_t v = 0;
    int digits = 0;

    skip_space(r);
    if (r->at < r->end && *r->at == '-') {
        minus = true;
        r->at++;
    }
    for (; r->at < r->end && *r->at >= '0' && *r->at <= '9' && digits < 12; digits++)
        v = 10 * v + (*r->at++ - '0');
    v = minus ? -v : v;
    if (r->bad || digits == 0 || !at_space(r) || v < lo || v > hi) {
        r->bad = true;
        return 0;
    }
    return v;
}

/* The rest of the line. */
static void name(struct reader *r, char *out)
{
    size_t n = 0;

    while (r->at < r->end && *r->at == ' ')
        r->at++;
    while (r->at < r->end && *r->at != '\n') {
        if (*r->at < ' ' || *r->at > '~' || n == MODEL_NAME_MAX) {
            r->bad = true;
            return;
        }
        out[n++] = *r->at++;
    }
    out[n] = '\0';
}

static void table(struct reader *r, const char *word, float *out, size_t step, int64_t lo,
                  int64_t hi, double units)
{
    expect(r, word);
    for (uint32_t i = 0; i < GRID_N && !r->bad; i++) {
        skip_space(r);
        if (lo < 0 && r->at < r->end && *r->at == '.') {
            r->at++;
            out[i * step] = NAN;
            r->bad = !at_space(r);
        } else {
            out[i * step] = (float)((double)integer(r, lo, hi) / units);
        }
    }
}

static void modes(struct reader *r, struct model_basis *b)
{
    for (uint32_t k = 0; k < b->n && !r->bad; k++) {
        table(r, "mode", &b->mode[0][k], MODEL_MODES, -VALUE_MAX, VALUE_MAX, MODE_UNITS);
        for (uint32_t i = 0; i < GRID_N; i++)
            r->bad |= isnan(b->mode[i][k]);
    }
}

static void basis(struct reader *r, const char *word, bool rest, struct model_basis *b)
{
    expect(r, word);
    b->n = (uint32_t)integer(r, 0, MODEL_MODES);
    if (rest)
        table(r, "rest", b->rest, 1, 0, VALUE_MAX, REST_UNITS);
    modes(r, b);
}

static double scalar(struct reader *r, const char *word, int64_t lo, int64_t hi)
{
    expect(r, word);
    return (double)integer(r, lo, hi) / SCALAR_UNITS;
}

static void calibration(struct reader *r, struct surface_calibration *c)
{
    c->threshold = scalar(r, "threshold", -SCORE_MAX, SCORE_MAX);
    expect(r, "knots");
    c->n = (uint32_t)integer(r, 2, SURFACE_KNOTS);
    for (uint32_t i = 0; i < c->n; i++) {
        c->knot[i].score = (double)integer(r, -SCORE_MAX, SCORE_MAX) / SCALAR_UNITS;
        c->knot[i].rate = (double)integer(r, 1, (int64_t)RATE_UNITS) / RATE_UNITS;
    }
    expect(r, "tail");
    c->tail.people = (uint32_t)integer(r, 0, UINT32_MAX);
    if (c->tail.people > 0) {
        c->tail.rate = (double)integer(r, 1, (int64_t)RATE_UNITS) / RATE_UNITS;
        c->tail.decade = (double)integer(r, 1, SCORE_MAX) / SCALAR_UNITS;
    }
    r->bad |= r->bad || !surface_calibration_valid(c);
}

/* A mean face to lay others on, to bend and to measure; and modes that tell people apart. */
static bool usable(const struct surface_model *m)
{
    uint32_t face = 0, bends = 0, measured = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        if (isnan(m->mean[i]))
            continue;
        face++;
        bends += m->shape.rest[i] > 0.0f;
        measured += m->change.rest[i] > 0.0f;
    }
    return face >= MODEL_FACE_MIN && bends >= MODEL_FACE_MIN &&
           measured >= MODEL_FACE_MIN && m->identity.n > 0;
}

enum status model_parse(const char *text, size_t len, struct surface_model *out,
                        uint32_t *line)
{
    struct reader r = {text, text + len, 1, false};
    enum status st = ST_OK;

    memset(out, 0, sizeof *out);
    expect(&r, "surfaced-model");
    if (!r.bad && integer(&r, 0, INT32_MAX) != VERSION)
        st = r.bad ? ST_ECORRUPT : ST_EVERSION;
    if (st == ST_OK) {
        expect(&r, "name");
        if (!r.bad)
            name(&r, out->name);
        out->kinship = scalar(&r, "kinship", 0, (int64_t)SCALAR_UNITS - 1);
        out->noise_floor_mm = scalar(&r, "noise_floor", 1, SCALAR_MAX);
        out->noise_factor = scalar(&r, "noise_factor", 0, SCALAR_MAX);
        calibration(&r, &out->calibration);
        table(&r, "mean", out->mean, 1, -HEIGHT_MAX, HEIGHT_MAX, MEAN_UNITS);
        basis(&r, "change", true, &out->change);
        basis(&r, "identity", false, &out->identity);
        basis(&r, "shape", true, &out->shape);
        expect(&r, "end");
        skip_space(&r);
        if (r.bad || r.at != r.end || !usable(out))
            st = ST_ECORRUPT;
    }
    if (line != NULL)
        *line = r.line;
    return st;
}

/* ---- writing */

struct writer {
    char *buf;
    size_t size, at;
};

__attribute__((format(printf, 2, 3))) static void put(struct writer *w,
                                                      const char *format, ...)
{
    const size_t room = w->at < w->size ? w->size - w->at : 0;
    va_list args;
    int n;

    va_start(args, format);
    n = vsnprintf(room > 0 ? w->buf + w->at : NULL, room, format, args);
    va_end(args);
    w->at += n > 0 ? (size_t)n : 0;
}

static void put_table(struct writer *w, const char *word, const float *v, size_t step,
                      double units)
{
    put(w, "%s", word);
    for (uint32_t i = 0; i < GRID_N; i++) {
        put(w, "%c", i % GRID_NX == 0 ? '\n' : ' ');
        if (isnan(v[i * step]))
            put(w, ".");
        else
            put(w, "%lld", llrint((double)v[i * step] * units));
    }
    put(w, "\n");
}

static void put_basis(struct writer *w, const char *word, bool rest,
                      const struct model_basis *b)
{
    put(w, "%s %u\n", word, (unsigned)b->n);
    if (rest)
        put_table(w, "rest", b->rest, 1, REST_UNITS);
    for (uint32_t k = 0; k < b->n; k++)
        put_table(w, "mode", &b->mode[0][k], MODEL_MODES, MODE_UNITS);
}

size_t surface_model_write(const struct surface_model *m, char *buf, size_t size)
{
    const struct surface_calibration *c = &m->calibration;
    struct writer w = {buf, size, 0};

    put(&w, "surfaced-model %d\nname %s\n", VERSION, m->name);
    put(&w, "kinship %lld\nnoise_floor %lld\nnoise_factor %lld\n",
        llrint(m->kinship * SCALAR_UNITS), llrint(m->noise_floor_mm * SCALAR_UNITS),
        llrint(m->noise_factor * SCALAR_UNITS));
    put(&w, "threshold %lld\nknots %u\n", llrint(c->threshold * SCALAR_UNITS),
        (unsigned)c->n);
    for (uint32_t i = 0; i < c->n; i++)
        put(&w, "%lld %lld\n", llrint(c->knot[i].score * SCALAR_UNITS),
            llrint(c->knot[i].rate * RATE_UNITS));
    put(&w, "tail %u\n", (unsigned)c->tail.people);
    if (c->tail.people > 0)
        put(&w, "%lld %lld\n", llrint(c->tail.rate * RATE_UNITS),
            llrint(c->tail.decade * SCALAR_UNITS));
    put_table(&w, "mean", m->mean, 1, MEAN_UNITS);
    put_basis(&w, "change", true, &m->change);
    put_basis(&w, "identity", false, &m->identity);
    put_basis(&w, "shape", true, &m->shape);
    put(&w, "end\n");
    return w.at;
}
