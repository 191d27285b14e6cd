/* The model's text: writing and reading keeps every value; the shipped table is the compiled
 * one; malformed text is rejected with the number of the line. */
#include "model.h"
#include "model_digest.h"
#include "toy.h"
#include "unit.h"

#define SHIPPED "core/face/default.model"

static struct surface_model model, got;

static bool same_floats(const float *a, const float *b, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (!(isnan(a[i]) && isnan(b[i])) && memcmp(&a[i], &b[i], sizeof *a) != 0)
            return false;
    return true;
}

/* Every member, bit for bit (whichever NAN). */
static void check_same(const struct surface_model *a, const struct surface_model *b)
{
    const struct model_basis *p[3] = {&a->change, &a->identity, &a->shape};
    const struct model_basis *q[3] = {&b->change, &b->identity, &b->shape};

    assert_string_equal(a->name, b->name);
    assert_true(same_floats(a->mean, b->mean, GRID_N));
    assert_true(a->kinship == b->kinship && a->noise_floor_mm == b->noise_floor_mm &&
                a->noise_factor == b->noise_factor);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(p[i]->n, q[i]->n);
        assert_true(same_floats(p[i]->rest, q[i]->rest, GRID_N));
        assert_true(same_floats(&p[i]->mode[0][0], &q[i]->mode[0][0],
                                (size_t)GRID_N * MODEL_MODES));
    }
    assert_int_equal(a->calibration.n, b->calibration.n);
    assert_true(a->calibration.threshold == b->calibration.threshold);
    for (uint32_t i = 0; i < SURFACE_KNOTS; i++)
        assert_true(a->calibration.knot[i].score == b->calibration.knot[i].score &&
                    a->calibration.knot[i].rate == b->calibration.knot[i].rate);
    assert_int_equal(a->calibration.tail.people, b->calibration.tail.people);
    assert_true(a->calibration.tail.rate == b->calibration.tail.rate &&
                a->calibration.tail.decade == b->calibration.tail.decade);
    assert_int_equal(model_mean_id(a), model_mean_id(b));
}

TEST(test_round_trip)
{
    size_t len, again;
    char *text = toy_text(&model, &len), *second;
    uint32_t line;

    assert_int_equal(strlen(text), len);
    assert_int_equal(model_parse(text, len, &got, &line), ST_OK);
    check_same(&model, &got);
    second = toy_text(&got, &again);
    assert_int_equal(len, again);
    assert_memory_equal(text, second, len);
    free(second);
    memset(text, 'x', len + 1); /* nothing is written beyond a buffer that is too small */
    assert_int_equal(surface_model_write(&model, text, 100), len);
    assert_int_equal(text[100], 'x');
    assert_int_equal(model_parse(text, 0, &got, NULL), ST_ECORRUPT);
    free(text);
}

/* The table in the source tree equals the constant that the build makes from it. */
TEST(test_shipped)
{
    FILE *in = fopen(SHIPPED, "rb");
    uint32_t line = 0;
    char *text, *again;
    size_t len, n;

    assert_non_null(in);
    assert_int_equal(fseek(in, 0, SEEK_END), 0);
    len = (size_t)ftell(in);
    rewind(in);
    assert_non_null(text = malloc(len + 1));
    assert_int_equal(fread(text, 1, len, in), len);
    (void)fclose(in);
    if (model_parse(text, len, &got, &line) != ST_OK)
        fail_msg("%s:%u: malformed", SHIPPED, line);
    check_same(&got, &model_default);
    again = toy_text(&got, &n);
    assert_int_equal(n, len);
    assert_memory_equal(text, again, len);
    assert_true(surface_calibration_valid(&got.calibration));
    free(text);
    free(again);
}

/* The line (from 1) that holds offset at. */
static uint32_t line_at(const char *text, size_t at)
{
    uint32_t line = 1;

    for (size_t i = 0; i < at; i++)
        line += text[i] == '\n';
    return line;
}

/* refused(after, from, to, st): with the first `from` behind the text `after` replaced by
 * `to`, parsing fails with st in that line. */
static void refused(const char *after, const char *from, const char *to, enum status st)
{
    size_t len, at, tail;
    char *text = toy_text(&model, &len), *changed, *found = strstr(text, after);
    uint32_t line = 0;

    assert_non_null(found);
    assert_non_null(found = strstr(found, from));
    at = (size_t)(found - text);
    tail = len - at - strlen(from);
    assert_non_null(changed = malloc(len + strlen(to) + 1));
    memcpy(changed, text, at);
    memcpy(changed + at, to, strlen(to));
    memcpy(changed + at + strlen(to), found + strlen(from), tail);
    len = at + strlen(to) + tail;
    if (model_parse(changed, len, &got, &line) != st)
        fail_msg("'%s' for '%s' after '%s' does not fail with %d", to, from, after, st);
    if (line != line_at(changed, at))
        fail_msg("'%s' for '%s' after '%s': line %u, not %u", to, from, after, line,
                 line_at(changed, at));
    free(changed);
    free(text);
}

TEST(test_malformed)
{
    static const struct {
        const char *after, *from, *to;
        enum status st;
    } bad[] = {
        {"", "surfaced-model 4", "surfaced-model 5", ST_EVERSION},
        {"", "surfaced-model 4", "surfaced-model 3", ST_EVERSION},
        {"", "surfaced-model 4", "surfaced-model x", ST_ECORRUPT},
        {"", "surfaced-model", "Surfaced-model", ST_ECORRUPT},
        {"", "surfaced-model", "surfaced-models", ST_ECORRUPT},
        {"", "a toy", "a\ttoy", ST_ECORRUPT},
        {"", "a toy",
         "a toy of a name that is longer than any name may be, by far, even if nobody ever "
         "would need so long a one",
         ST_ECORRUPT},
        {"", "kinship 300", "kinship 1000", ST_ECORRUPT},
        {"", "kinship 300", "kinship -1", ST_ECORRUPT},
        {"", "noise_floor 500", "noise_floor 0", ST_ECORRUPT},
        {"", "noise_floor 500", "noise_floor 100001", ST_ECORRUPT},
        {"", "noise_floor 500", "noise_floor 1.5", ST_ECORRUPT},
        {"", "noise_floor 500", "noise_floor 500x", ST_ECORRUPT},
        {"", "noise_floor 500", "noise_floor 99999999999999999999", ST_ECORRUPT},
        {"", "noise_floor 500", "noise_floor nan", ST_ECORRUPT},
        {"", "noise_factor 1200", "noise_factor -1", ST_ECORRUPT},
        {"", "threshold 8000", "threshold 10000001", ST_ECORRUPT},
        {"", "knots 3", "knots 1", ST_ECORRUPT},
        {"", "knots 3", "knots 33", ST_ECORRUPT},
        {"knots", "-50000 1000000000", "-50000 0", ST_ECORRUPT},
        {"", "tail 5000", "tail -1", ST_ECORRUPT},
        {"", "tail 5000", "tail 4294967296", ST_ECORRUPT},
        {"tail 5000", "8000", "0", ST_ECORRUPT},
        {"8000 6000", "6000", "0", ST_ECORRUPT},
        {"mean", " . ", " 200001 ", ST_ECORRUPT},
        {"mean", " . ", " .. ", ST_ECORRUPT},
        {"mean", " . ", " .5 ", ST_ECORRUPT},
        {"mean", "mean", "means", ST_ECORRUPT},
        {"change", "6", "105", ST_ECORRUPT},
        {"change", "6", "-6", ST_ECORRUPT},
        {"change", " 0 ", " 100001 ", ST_ECORRUPT},
        {"change 6", "mode", "rest", ST_ECORRUPT},
        {"change 6", "identity", "shape", ST_ECORRUPT},
        {"identity 12", "mode", "rest", ST_ECORRUPT},
        {"shape", "18", "105", ST_ECORRUPT},
        {"shape", " 0 ", " -1 ", ST_ECORRUPT},
        {"shape 18", "mode", "end", ST_ECORRUPT},
    };

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        refused(bad[i].after, bad[i].from, bad[i].to, bad[i].st);
}

/* Contradictions between lines are rejected too. */
TEST(test_contradictions)
{
    static struct surface_model bad;
    size_t len;
    char *text;

    for (int what = 0; what < 7; what++) {
        bad = model;
        for (uint32_t i = 0; i < GRID_N; i++) {
            if (what == 0)
                bad.mean[i] = (float)NAN;
            if (what == 1)
                bad.change.rest[i] = 0.0f;
            if (what == 2)
                bad.shape.rest[i] = 0.0f;
        }
        if (what == 3)
            bad.calibration.knot[1] = bad.calibration.knot[0];
        if (what == 4)
            bad.calibration.knot[2].rate = 0.9;
        if (what == 5)
            bad.identity.n = 0;
        if (what == 6)
            bad.calibration.tail.rate = 2 * bad.calibration.knot[2].rate;
        text = toy_text(&bad, &len);
        assert_int_equal(model_parse(text, len, &got, NULL), ST_ECORRUPT);
        free(text);
    }
}

/* A text that is cut off anywhere, or followed by anything but white space, is rejected. */
TEST(test_truncated)
{
    size_t len;
    char *text = toy_text(&model, &len), *longer = malloc(len + 8);
    uint32_t line;

    for (size_t n = 0; n < len - 1; n += n < 300 || n + 300 > len ? 1 : 977) {
        char *cut = malloc(n + 1); /* of exact size: the sanitizer sees an overrun */

        assert_non_null(cut);
        memcpy(cut, text, n);
        assert_int_equal(model_parse(cut, n, &got, &line), ST_ECORRUPT);
        assert_true(line <= line_at(text, n));
        free(cut);
    }
    assert_int_equal(model_parse(text, len - 1, &got, &line),
                     ST_OK); /* no last newline */
    assert_non_null(longer);
    memcpy(longer, text, len);
    memcpy(longer + len, " \n\n", 3);
    assert_int_equal(model_parse(longer, len + 3, &got, &line), ST_OK);
    memcpy(longer + len, "x\n", 2);
    assert_int_equal(model_parse(longer, len + 2, &got, &line), ST_ECORRUPT);
    assert_int_equal(line, line_at(text, len));
    longer[len] = '\0';
    assert_int_equal(model_parse(longer, len + 1, &got, &line), ST_ECORRUPT);
    free(longer);
    free(text);
}

/* The mark depends on the mean face and on nothing else. */
TEST(test_mark)
{
    static struct surface_model other;

    other = model;
    other.change.rest[700] += 1.0f;
    other.kinship = 0;
    assert_int_equal(model_mean_id(&model), model_mean_id(&other));
    other.mean[700] += 0.001f;
    assert_int_not_equal(model_mean_id(&model), model_mean_id(&other));
    assert_int_not_equal(model_mean_id(&model), 0);
}

/* The digest depends on all that faces and scores follow from, and on nothing else. */
TEST(test_digest)
{
    static struct surface_model other;
    float *const counts[] = {&other.mean[700],           &other.change.rest[700],
                             &other.change.mode[700][5], &other.identity.mode[700][3],
                             &other.shape.rest[700],     &other.shape.mode[700][5]};
    double *const scalars[] = {&other.kinship, &other.noise_floor_mm,
                               &other.noise_factor};
    const uint64_t digest = model_digest(&model);

    for (size_t i = 0; i < sizeof scalars / sizeof *scalars; i++) {
        other = model;
        *scalars[i] += 0.001;
        assert_true(model_digest(&other) != digest);
    }
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        other = model;
        *counts[i] += 0.001f;
        assert_true(model_digest(&other) != digest);
    }
    other = model;
    other.name[0] = 'A';
    other.calibration.threshold += 1;
    assert_true(model_digest(&other) == digest);
    other.shape.n--;
    assert_true(model_digest(&other) != digest);
}

BEFORE_ALL(set_up)
{
    toy_model(&model);
}
