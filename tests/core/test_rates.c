/* Error rates: by hand, by brute force, and their confidence intervals. */
#include "libsurface.h"
#include "rates.h"
#include "select.h"
#include "unit.h"

#define INF ((double)INFINITY)

static struct rates *rates(const struct rates_score *s, size_t n, uint32_t nsubject)
{
    struct rates *r;

    assert_int_equal(rates_new(s, n, nsubject, &r), ST_OK);
    return r;
}

/* Mated scores g and non-mated scores i (of subjects 0 and 1), each list ended by NAN. */
static struct rates_figures figures(const double *g, const double *i, double threshold)
{
    struct rates_score s[64] = {{0}};
    struct rates_figures f;
    struct rates *r;
    size_t n = 0;

    for (; !isnan(*g); g++)
        s[n++] = (struct rates_score){*g, 0, 0};
    for (; !isnan(*i); i++)
        s[n++] = (struct rates_score){*i, 0, 1};
    r = rates(s, n, 2);
    rates_figures(r, threshold, &f);
    if (n > 0)
        assert_true(f.tar_score[0] == rates_at(r, rates_target[0]) ||
                    isnan(f.tar_score[0]));
    rates_free(r);
    return f;
}

#define LIST(...) ((const double[]){__VA_ARGS__, (double)NAN})
#define NOTHING   ((const double[]){(double)NAN})

#define ASKED 0.25 /* the FMR of the figure at */
#define DET   3

static const double det_fmr[DET] = {0, ASKED, 1};

TEST(test_by_hand)
{
    struct rates_figures f;

    f = figures(LIST(-1, -2, -3), LIST(-4, -5), -3.5); /* apart */
    assert_true(f.eer == 0);
    assert_true(f.tar[0] == 1 && f.tar_score[0] == -3 && f.fmr == 0 && f.fnmr == 0);
    f = figures(LIST(1, 2), LIST(4, 5), 3); /* mated below non-mated */
    assert_true(f.eer == 1 && f.tar[0] == 0 && f.tar_score[0] == INF);
    assert_true(f.fmr == 1 && f.fnmr == 1);
    f = figures(LIST(4, 2), LIST(3, 1), 3); /* crossing at a threshold */
    assert_true(f.eer == 0.5 && f.fmr == 0.5 && f.fnmr == 0.5);
    f = figures(LIST(1, 1), LIST(1, 1), 1); /* all equal */
    assert_true(f.eer == 0.5 && f.tar[0] == 0 && f.fmr == 1 && f.fnmr == 0);
    f = figures(LIST(0, 0), LIST(0), 0);
    assert_true(f.fmr == 1 && f.fnmr == 0 && f.eer == 0.5);
    f = figures(LIST(7, 6, 6, 5), LIST(6, 3, 2, 1), 6); /* a tie of mated and non-mated */
    assert_true(f.fmr == 0.25 && f.fnmr == 0.25 && f.eer == 0.25);
    assert_true(f.tar[0] == 0.25 && f.tar_score[0] == 7);
    f = figures(LIST(9), LIST(1), 5);
    assert_true(f.eer == 0 && f.tar[2] == 1);
}

TEST(test_inconclusive)
{
    struct rates_figures f = figures(LIST(2, -INF, -INF, -INF), LIST(1, -INF), -INF);

    assert_true(f.fmr == 0.5 && f.fnmr == 0.75); /* inconclusive never matches */
    assert_true(f.eer == 0.75);                  /* FMR and FNMR do not cross */
    f = figures(LIST(-INF), LIST(-INF), -INF);
    assert_true(f.fmr == 0 && f.fnmr == 1 && f.tar_score[0] == INF && f.eer == 1);
}

TEST(test_nothing)
{
    struct rates_figures f = figures(NOTHING, NOTHING, 1);
    struct rates_score nan = {(double)NAN, 0, 0}, most = {INF, 0, 0}, far = {1, 0, 2};
    struct rates *r;

    assert_true(isnan(f.eer) && isnan(f.fmr) && isnan(f.fnmr) && isnan(f.tar[0]));
    f = figures(LIST(1, 2), NOTHING, 2); /* one subject: no non-mated scores */
    assert_true(isnan(f.eer) && isnan(f.fmr) && f.fnmr == 0.5 && isnan(f.tar[0]));
    f = figures(NOTHING, LIST(1, 2), 2);
    assert_true(isnan(f.eer) && f.fmr == 0.5 && isnan(f.fnmr) && isnan(f.tar[0]));
    assert_int_equal(rates_new(&nan, 1, 1, &r), ST_EINVAL);
    assert_int_equal(rates_new(&most, 1, 1, &r), ST_EINVAL);
    assert_int_equal(rates_new(&far, 1, 2, &r), ST_EINVAL);
    rates_free(NULL);
}

/* Random scores with many ties, against the definitions. */
TEST(test_brute_force)
{
    uint64_t seed = 1;

    for (int round = 0; round < 300; round++) {
        struct rates_score s[120];
        const size_t n = 2 + rates_below(&seed, 118);
        const uint32_t nsubject = 2 + rates_below(&seed, 6);
        const double threshold = rates_below(&seed, 14);
        struct rates_figures f;
        struct rates *r;
        size_t g = 0, i = 0, ga = 0, ia = 0;
        double best[RATES_TARGETS] = {INF, INF, INF}, apart = 2;

        for (size_t k = 0; k < n; k++) {
            const uint32_t a = rates_below(&seed, nsubject);

            s[k] = (struct rates_score){
                rates_below(&seed, 12), a,
                rates_below(&seed, 2) ? a : rates_below(&seed, nsubject)};
            if (rates_below(&seed, 15) == 0)
                s[k].score = -INF;
        }
        r = rates(s, n, nsubject);
        rates_figures(r, threshold, &f);
        for (size_t k = 0; k < n; k++) {
            g += s[k].template == s[k].probe;
            i += s[k].template != s[k].probe;
        }
        assert_int_equal(rates_ngenuine(r), g);
        assert_int_equal(rates_nimpostor(r), i);
        for (int at = 13; at >= 0 && g > 0 && i > 0; at--) {
            size_t seen = 0;
            double fmr, fnmr;

            ga = ia = 0;
            for (size_t k = 0; k < n; k++) {
                ga += s[k].score >= at && s[k].template == s[k].probe;
                ia += s[k].score >= at && s[k].template != s[k].probe;
                seen += s[k].score == at;
            }
            fmr = (double)ia / (double)i;
            fnmr = (double)(g - ga) / (double)g;
            assert_true(rates_fmr(r, at) == fmr && rates_fnmr(r, at) == fnmr);
            if (at == (int)threshold)
                assert_true(f.fmr == fmr && f.fnmr == fnmr);
            apart = fmin(apart, fmax(fmr, fnmr));
            for (int t = 0; t < RATES_TARGETS; t++)
                if (seen > 0 && fmr <= rates_target[t]) {
                    best[t] = at;
                    assert_true(f.tar[t] >= 1 - fnmr);
                }
        }
        for (int t = 0; t < RATES_TARGETS && g > 0 && i > 0; t++) {
            assert_true(f.tar_score[t] == best[t] &&
                        rates_at(r, rates_target[t]) == best[t]);
            if (best[t] < INF)
                assert_true(f.tar[t] == 1 - rates_fnmr(r, best[t]));
        }
        if (g > 0 && i > 0) /* at each threshold the larger rate is the EER or more */
            assert_true(f.eer <= apart + 1e-12 && f.eer >= 0);
        rates_free(r);
    }
}

TEST(test_rule_of_3)
{
    assert_true(rates_least(0) == INF && rates_least(300) == 0.01);
    assert_true(rates_supported(0.01, 300) && !rates_supported(0.01, 299));
    assert_int_equal(rates_needed(0.01), 300);
    assert_int_equal(rates_needed(0.001), 3000);
    assert_int_equal(rates_needed(0.0001), 30000);
    for (int i = 0; i < RATES_TARGETS; i++)
        assert_true(rates_supported(rates_target[i], rates_needed(rates_target[i])));
    assert_false(rates_supported(0, 1000000));
}

TEST(test_no_replicates)
{
    const struct rates_score one = {1, 0, 0};
    struct rates *r = rates(&one, 1, 1);
    struct rates_figures low, high;

    assert_int_equal(rates_bootstrap(r, 0, 0.5, 0, 7, &low, &high), ST_EINVAL);
    assert_int_equal(rates_bootstrap_det(r, det_fmr, DET, 0, 7, &low.eer, &high.eer),
                     ST_EINVAL);
    rates_free(r);
}

/* ---- the bootstrap against its definition */

#define FIGURES (sizeof(struct rates_figures) / sizeof(double))

/* Every comparison as often as its subjects were drawn, written out. */
static void expanded(const struct rates_score *s, size_t n, uint32_t nsubject,
                     const uint32_t *drawn, double threshold, double out[FIGURES],
                     double det[DET])
{
    static struct rates_score all[1 << 14];
    struct rates_figures f;
    struct rates *r;
    size_t m = 0;

    for (size_t i = 0; i < n; i++) {
        const uint32_t times = s[i].template == s[i].probe
                                   ? drawn[s[i].probe]
                                   : drawn[s[i].template] * drawn[s[i].probe];

        for (uint32_t k = 0; k < times; k++)
            all[m++] = s[i];
    }
    assert_true(m <= sizeof all / sizeof *all);
    r = rates(all, m, nsubject);
    rates_figures(r, threshold, &f);
    f.at = isnan(f.tar_score[0]) ? (double)NAN : rates_at(r, ASKED);
    memcpy(out, &f, sizeof f);
    for (int i = 0; i < DET; i++)
        det[i] =
            isnan(f.tar_score[0]) ? (double)NAN : rates_fnmr(r, rates_at(r, det_fmr[i]));
    rates_free(r);
}

/* The points of the replicates that have the figure at all. */
static void points(double *v, size_t n, double *low, double *high)
{
    size_t m = 0;

    for (size_t i = 0; i < n; i++)
        if (!isnan(v[i]))
            v[m++] = v[i];
    select_sort(v, m);
    *low = m > 0 ? v[(size_t)(0.025 * (double)(m - 1) + 0.5)] : (double)NAN;
    *high = m > 0 ? v[(size_t)(0.975 * (double)(m - 1) + 0.5)] : (double)NAN;
}

TEST(test_bootstrap_brute_force)
{
    enum { REPLICATES = 60, SUBJECTS = 7 };
    static double figure[FIGURES + DET][REPLICATES];
    uint64_t seed = 11;

    for (unsigned round = 0; round < 40; round++) {
        struct rates_score s[90];
        const size_t n = 10 + rates_below(&seed, 80);
        const uint32_t nsubject = 1 + rates_below(&seed, SUBJECTS);
        const double threshold = (double)rates_below(&seed, 20) - 10;
        struct rates_figures low, high;
        double bound[2][FIGURES + DET];
        uint64_t draws = round;
        struct rates *r;

        for (size_t k = 0; k < n; k++) {
            const uint32_t a = rates_below(&seed, nsubject),
                           b = rates_below(&seed, 2) ? a : rates_below(&seed, nsubject);

            s[k] = (struct rates_score){(double)rates_below(&seed, 16) - 8 + 6 * (a == b),
                                        a, b};
            if (rates_below(&seed, 15) == 0)
                s[k].score = -INF;
        }
        for (int i = 0; i < REPLICATES; i++) {
            uint32_t drawn[SUBJECTS] = {0};
            double v[FIGURES + DET];

            for (uint32_t k = 0; k < nsubject; k++)
                drawn[rates_below(&draws, nsubject)]++;
            expanded(s, n, nsubject, drawn, threshold, v, v + FIGURES);
            for (size_t k = 0; k < FIGURES + DET; k++)
                figure[k][i] = v[k];
        }
        r = rates(s, n, nsubject);
        assert_int_equal(
            rates_bootstrap(r, threshold, ASKED, REPLICATES, round, &low, &high), ST_OK);
        memcpy(bound[0], &low, sizeof low);
        memcpy(bound[1], &high, sizeof high);
        assert_int_equal(rates_bootstrap_det(r, det_fmr, DET, REPLICATES, round,
                                             bound[0] + FIGURES, bound[1] + FIGURES),
                         ST_OK);
        for (size_t k = 0; k < FIGURES + DET; k++) {
            double want[2];

            points(figure[k], REPLICATES, &want[0], &want[1]);
            for (int i = 0; i < 2; i++)
                assert_true(bound[i][k] == want[i] ||
                            (isnan(bound[i][k]) && isnan(want[i])));
        }
        rates_free(r);
    }
}

TEST(test_random)
{
    uint64_t seed = 5;
    int count[7] = {0};

    for (int i = 0; i < 70000; i++)
        count[rates_below(&seed, 7)]++;
    for (int i = 0; i < 7; i++)
        assert_true(count[i] > 9500 && count[i] < 10500);
    assert_int_equal(rates_below(&seed, 1), 0);
    seed = 0;
    assert_true(rates_random(&seed) == UINT64_C(0xE220A8397B1DCDAF)); /* as published */
}

/* ---- the threshold and the table of rates learned from non-mated comparisons */

#define SUBJECTS 100

/* A score for every ordered pair of subjects: -35 to 5, spread over the subjects, or
 * inconclusive for the given share.
 *   mated  each subject with itself too, at 20 */
static struct rates *scores(uint32_t subjects, double inconclusive, bool mated)
{
    static struct rates_score s[SUBJECTS * SUBJECTS];
    struct rates *r;
    size_t n = 0;

    for (uint32_t i = 0; i < subjects; i++)
        for (uint32_t k = 0; k < subjects; k++)
            if (i == k && mated) {
                s[n++] = (struct rates_score){20, i, i};
            } else if (i != k) {
                const double place = (double)((n * 7919) % 9901) / 9901;

                s[n].score =
                    place < inconclusive ? -(double)INFINITY : 5 - 40 * place * place;
                s[n].template = i;
                s[n++].probe = k;
            }
    assert_int_equal(rates_new(s, n, subjects, &r), ST_OK);
    return r;
}

TEST(test_learned)
{
    static const double wanted[] = {0.001, 0.0013, 0.01, 0.1, 0.5};
    struct rates *r = scores(SUBJECTS, 0, false);

    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        struct surface_calibration d;
        bool knot = false;

        assert_int_equal(rates_calibrate(r, wanted[i], &d), ST_OK);
        assert_true(surface_calibration_valid(&d));
        assert_true(rates_fmr(r, d.threshold) <= wanted[i]);
        assert_true(rates_fmr(r, d.threshold) > 0.9 * wanted[i]);
        assert_true(d.threshold == rates_at(r, wanted[i]));
        for (uint32_t k = 0; k < d.n; k++) {
            knot = knot || d.knot[k].score == d.threshold;
            assert_true(k == 0 || d.knot[k].rate == rates_fmr(r, d.knot[k].score));
        }
        assert_true(knot); /* the rate at the threshold is no interpolation */
        for (double at = -36; at < 6; at += 0.1) {
            assert_true(fabs(surface_calibration_rate(&d, at) - rates_fmr(r, at)) < 0.06);
            assert_true(surface_calibration_rate(&d, at) > 0);
        }
    }
    rates_free(r);
}

/* A table goes on from the threshold with the upper ends of the intervals, to the rate that the pairs support; what
 * decides verifications stays. */
static void check_extended(const struct rates *r, double fmr, size_t pairs)
{
    struct surface_calibration d, longer;
    struct rates_figures low, high;
    uint32_t same = 0, k;

    assert_int_equal(rates_calibrate(r, fmr, &d), ST_OK);
    longer = d;
    assert_int_equal(rates_extend(r, pairs, 3, &longer), ST_OK);
    assert_true(surface_calibration_valid(&longer) && longer.threshold == d.threshold);
    for (; longer.knot[same].score <= d.threshold; same++)
        assert_memory_equal(&longer.knot[same], &d.knot[same], sizeof *d.knot);
    assert_true(longer.knot[same - 1].score == d.threshold);
    for (k = same; k < longer.n - 1; k++) {
        assert_int_equal(rates_bootstrap(r, longer.knot[k].score, (double)NAN,
                                         RATES_REPLICATES, 3, &low, &high),
                         ST_OK);
        assert_true(longer.knot[k].rate == high.fmr);
        assert_true(longer.knot[k].rate > rates_fmr(r, longer.knot[k].score));
    }
    assert_true(longer.knot[k].rate == rates_least(pairs));
    assert_true(rates_fmr(r, longer.knot[k].score) == 0 &&
                rates_fmr(r, longer.knot[k].score - 0.002) > 0);
}

TEST(test_extended)
{
    static const double wanted[] = {0.001, 0.003, 0.01, 0.1, 0.5};
    const size_t pairs = SUBJECTS * (SUBJECTS - 1) / 2;
    struct surface_calibration d;
    struct rates *r = scores(SUBJECTS, 0, false);

    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
        check_extended(r, wanted[i], pairs);
    /* 4,950 pairs: 0.0006, which is 1 - 0.99^16 or less for 16 people */
    assert_int_equal(rates_calibrate(r, 0.01, &d), ST_OK);
    assert_int_equal(rates_extend(r, pairs, 3, &d), ST_OK);
    assert_int_equal(surface_search_people(&d), 16);
    check_extended(r, 0.01, 1000); /* ends where the intervals go further */
    rates_free(r);
    r = scores(SUBJECTS, 0.4, true);
    check_extended(r, 0.01, pairs);
    check_extended(r, 0.5, pairs);
    rates_free(r);
}

/* The highest scores alone lead to the same table beyond them as all scores. */
TEST(test_tail)
{
    enum { PEOPLE = 90 };
    static struct rates_score all[4 * PEOPLE * PEOPLE], high[4 * PEOPLE * PEOPLE];
    uint32_t probes[PEOPLE];
    struct surface_calibration d, whole, tail;
    struct rates *r, *t;
    uint64_t seed = 9;
    double floor;
    size_t n = 0, m = 0;

    for (uint32_t i = 0; i < PEOPLE; i++)
        probes[i] = 1 + i % 3;
    for (uint32_t i = 0; i < PEOPLE; i++)
        for (uint32_t k = 0; k < PEOPLE; k++)
            for (uint32_t p = 0; i != k && p < probes[k]; p++)
                all[n++] = (struct rates_score){rates_below(&seed, 100000) / 1e3, i, k};
    assert_int_equal(rates_new(all, n, PEOPLE, &r), ST_OK);
    floor = rates_at(r, 0.004);
    for (size_t i = 0; i < n; i++)
        if (all[i].score >= floor)
            high[m++] = all[i];
    assert_int_equal(rates_new_tail(high, m, probes, PEOPLE, &t), ST_OK);
    assert_int_equal(rates_nimpostor(t), n);
    assert_true(rates_fmr(t, floor) == rates_fmr(r, floor));
    assert_int_equal(rates_calibrate(r, 0.01, &d), ST_OK);
    whole = tail = d;
    assert_int_equal(rates_extend(r, n / 2, 3, &whole), ST_OK);
    tail = whole;
    assert_int_equal(rates_extend(t, n / 2, 3, &tail), ST_OK);
    assert_true(surface_calibration_valid(&tail) && tail.n > d.n + 1);
    for (uint32_t k = 0; k < whole.n;
         k++) /* those beyond the floor, and up to the threshold */
        if (whole.knot[k].score <= d.threshold || whole.knot[k].score > floor + 0.5) {
            uint32_t at = 0;

            while (at < tail.n && tail.knot[at].score != whole.knot[k].score)
                at++;
            assert_true(at < tail.n && tail.knot[at].rate == whole.knot[k].rate);
        }
    rates_free(t);
    assert_int_equal(rates_new_tail(high, 0, probes, PEOPLE, &t), ST_OK);
    whole = tail;
    assert_int_equal(rates_extend(t, n / 2, 3, &tail), ST_OK); /* nobody scores so high */
    assert_memory_equal(&whole, &tail, sizeof tail);
    rates_free(t);
    rates_free(r);
}

TEST(test_learned_from_little)
{
    struct surface_calibration d;
    struct rates *r = scores(12, 0, false);

    assert_int_equal(rates_calibrate(r, 0.001, &d), ST_ETOOFEW); /* 132 comparisons */
    assert_int_equal(rates_calibrate(r, 0.05, &d), ST_OK);
    assert_true(surface_calibration_valid(&d));
    rates_free(r);
    r = scores(SUBJECTS, 0.4, false); /* 40 % are inconclusive */
    assert_int_equal(rates_calibrate(r, 0.01, &d), ST_OK);
    assert_true(d.knot[1].rate <= 0.6 && d.knot[0].rate == 1);
    rates_free(r);
    r = scores(SUBJECTS, 1, false);
    assert_int_equal(rates_calibrate(r, 0.01, &d), ST_ETOOFEW);
    rates_free(r);
    r = scores(2, 0, false);
    assert_int_equal(rates_calibrate(r, 0.5, &d), ST_ETOOFEW);
    rates_free(r);
}

TEST(test_subjects)
{
    assert_int_equal(rates_subjects(0.001), 78);
    assert_int_equal(rates_subjects(0.0001), 246);
    assert_int_equal(rates_subjects(1), 3);
    for (double rate = 1; rate > 1e-9; rate /= 3) {
        const double n = rates_subjects(rate);

        assert_true(n * (n - 1) / 2 >= 3 / rate - 1e-5);
        assert_true((n - 1) * (n - 2) / 2 < 3 / rate);
    }
}
