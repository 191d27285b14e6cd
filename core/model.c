#include "model.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Units of the text's integers, per millimetre (of the weight: per 1). */
#define MEAN_UNITS 1000
#define REST_UNITS 10000
#define MODE_UNITS 1000
#define U_UNITS    1000
#define MM_UNITS   1e6
#define RATE_UNITS 1e9

#define VERSION 2 /* of the text */

#define HEIGHT_MAX 200000 /* of the mean face, in its units */
#define VALUE_MAX  100000
#define CAP_MAX    100000000

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

static void basis(struct reader *r, const char *word, struct model_basis *b)
{
    expect(r, word);
    b->n = (uint32_t)integer(r, 0, MODEL_MODES);
    table(r, "rest", b->rest, 1, 0, VALUE_MAX, REST_UNITS);
    for (uint32_t k = 0; k < b->n && !r->bad; k++) {
        table(r, "mode", &b->mode[0][k], MODEL_MODES, -VALUE_MAX, VALUE_MAX, MODE_UNITS);
        for (uint32_t i = 0; i < GRID_N; i++)
            r->bad |= isnan(b->mode[i][k]);
    }
}

static void decision(struct reader *r, struct decision *d)
{
    expect(r, "threshold");
    d->threshold_mm = (double)integer(r, 1, INT32_MAX) / MM_UNITS;
    expect(r, "halving");
    d->halving_mm = (double)integer(r, 1, INT32_MAX) / MM_UNITS;
    expect(r, "knots");
    d->n = (uint32_t)integer(r, 2, DECISION_KNOTS);
    for (uint32_t i = 0; i < d->n; i++) {
        d->knot[i].mm = (double)integer(r, 1, INT32_MAX) / MM_UNITS;
        d->knot[i].rate = (double)integer(r, 1, (int64_t)RATE_UNITS) / RATE_UNITS;
    }
    r->bad |= r->bad || !decision_valid(d);
}

/* A mean face to lay others on and to bend, and something to weigh. */
static bool usable(const struct model *m)
{
    uint32_t face = 0, bends = 0, measured = 0, weighed = 0;

    for (uint32_t i = 0; i < GRID_N; i++) {
        face += isnan(m->mean[i]) ? 0 : 1;
        bends += !isnan(m->mean[i]) && m->shape.rest[i] > 0.0f;
        measured += m->change.rest[i] > 0.0f;
        weighed += m->change.rest[i] > 0.0f && m->weight[i] > 0.0f;
        if (isnan(m->weight[i]))
            return false;
    }
    return face >= MODEL_FACE_MIN && bends >= MODEL_FACE_MIN &&
           measured >= MODEL_FACE_MIN && weighed >= 20;
}

enum status model_parse(const char *text, size_t len, struct model *out, uint32_t *line)
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
        expect(&r, "cap");
        out->cap_mm = (float)((double)integer(&r, 1, CAP_MAX) / MM_UNITS);
        decision(&r, &out->decision);
        table(&r, "mean", out->mean, 1, -HEIGHT_MAX, HEIGHT_MAX, MEAN_UNITS);
        table(&r, "weight", out->weight, 1, 0, VALUE_MAX, U_UNITS);
        basis(&r, "motion", &out->motion);
        basis(&r, "change", &out->change);
        basis(&r, "shape", &out->shape);
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

static void put_basis(struct writer *w, const char *word, const struct model_basis *b)
{
    put(w, "%s %u\n", word, (unsigned)b->n);
    put_table(w, "rest", b->rest, 1, REST_UNITS);
    for (uint32_t k = 0; k < b->n; k++)
        put_table(w, "mode", &b->mode[0][k], MODEL_MODES, MODE_UNITS);
}

size_t model_write(const struct model *m, char *buf, size_t size)
{
    const struct decision *d = &m->decision;
    struct writer w = {buf, size, 0};

    put(&w, "surfaced-model %d\nname %s\ncap %lld\n", VERSION, m->name,
        llrint((double)m->cap_mm * MM_UNITS));
    put(&w, "threshold %lld\nhalving %lld\nknots %u\n",
        llrint(d->threshold_mm * MM_UNITS), llrint(d->halving_mm * MM_UNITS),
        (unsigned)d->n);
    for (uint32_t i = 0; i < d->n; i++)
        put(&w, "%lld %lld\n", llrint(d->knot[i].mm * MM_UNITS),
            llrint(d->knot[i].rate * RATE_UNITS));
    put_table(&w, "mean", m->mean, 1, MEAN_UNITS);
    put_table(&w, "weight", m->weight, 1, U_UNITS);
    put_basis(&w, "motion", &m->motion);
    put_basis(&w, "change", &m->change);
    put_basis(&w, "shape", &m->shape);
    put(&w, "end\n");
    return w.at;
}
