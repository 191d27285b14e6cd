/* The report of hand-made comparisons, whose rates are known: of those scored, with refusals
 * counted as errors, by kind; and the tables that programs read. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "model.h"
#include "newfile.h"
#include "report.h"
#include "report_csv.h"
#include "report_json.h"
#include "report_text.h"

#define SUBJECTS 5
#define SCANS    (3 * SUBJECTS) /* of each subject a template, a smile and a frown */
#define TRIALS   (2 * SUBJECTS * SUBJECTS)

static char none[] = "", smile[] = "a \"smile\"", frown[] = "frown",
            why[] = "why, though";
static char *populations[] = {none}, *kinds[] = {none, smile, frown};
static char file[SCANS][16], id[SUBJECTS][4];
static struct corpus_scan scan[SCANS];
static struct corpus_subject subject[SUBJECTS];
static struct ctl_trial trial[TRIALS];
static struct ctl_trials_scan as_template[SCANS], as_probe[SCANS];
static const struct corpus corpus = {.scan = scan,
                                     .subject = subject,
                                     .kind = kinds,
                                     .population = populations,
                                     .nscan = SCANS,
                                     .nsubject = SUBJECTS,
                                     .nkind = 3,
                                     .npopulation = 1};
static struct ctl_trials trials;

static bool equal(double a, double b)
{
    return fabs(a - b) < 1e-12;
}

/* Every probe with every template: mated scores 20, others -20. */
static int set_up(void **state)
{
    size_t n = 0;

    (void)state;
    for (uint32_t i = 0; i < SCANS; i++) {
        (void)snprintf(file[i], sizeof file[i], "f%u.ply", i);
        scan[i] = (struct corpus_scan){
            .file = file[i], .subject = i / 3, .kind = i % 3, .enrolled = i % 3 == 0};
        as_template[i] = (struct ctl_trials_scan){.used = i % 3 == 0};
        as_probe[i] = (struct ctl_trials_scan){.used = i % 3 != 0};
    }
    for (uint32_t i = 0; i < SUBJECTS; i++) {
        (void)snprintf(id[i], sizeof id[i], "s%u", i);
        subject[i] = (struct corpus_subject){
            .id = id[i], .enrolled = 3 * i, .nscan = 3, .relative_of = CORPUS_NONE};
    }
    for (uint32_t p = 0; p < SCANS; p++)
        for (uint32_t t = 0; t < SUBJECTS && p % 3 != 0; t++) {
            const bool mated = t == p / 3;

            trial[n++] =
                (struct ctl_trial){.template = 3 * t,
                                   .probe = p,
                                   .type = mated ? CORPUS_GENUINE : CORPUS_IMPOSTOR,
                                   .done = true,
                                   .decision = mated ? FACE_MATCH : FACE_NO_MATCH,
                                   .score = mated ? 20 : -20,
                                   .overlap = 0.5f,
                                   .disparity_mm = NAN,
                                   .rotation_deg = NAN};
        }
    assert_int_equal(n, TRIALS);
    trials = (struct ctl_trials){.corpus = &corpus,
                                 .trial = trial,
                                 .n = TRIALS,
                                 .template = as_template,
                                 .probe = as_probe,
                                 .threshold = 8,
                                 .non_mated = CTL_TRIALS_ALL,
                                 .nthread = 1,
                                 .compare_s = 1};
    return 0;
}

static struct ctl_trial *of(uint32_t template, uint32_t probe)
{
    for (size_t i = 0; i < TRIALS; i++)
        if (trial[i].template == template && trial[i].probe == probe)
            return &trial[i];
    fail();
    return NULL;
}

static void refuse(struct ctl_trials_scan *as, uint32_t i)
{
    as[i].st = ST_ENOTFACE;
    as[i].why = why;
    for (size_t k = 0; k < TRIALS; k++)
        if ((as == as_template ? trial[k].template : trial[k].probe) == i)
            trial[k].done = false;
}

static struct report measured(void)
{
    struct report r = {.source = "scans",
                       .made = "now",
                       .calibration = "as shipped",
                       .engine = "engine",
                       .model = &model_default};

    assert_int_equal(report_measure(&r, &trials), ST_OK);
    return r;
}

/* What a writer writes, for free(). */
static char *written(newfile_writer *write, const void *arg)
{
    char *text = NULL;
    size_t size;
    FILE *to = open_memstream(&text, &size);

    assert_non_null(to);
    assert_int_equal(write(to, arg, NULL), ST_OK);
    assert_int_equal(fclose(to), 0);
    return text;
}

static void has(const char *text, const char *words)
{
    if (strstr(text, words) == NULL)
        fail_msg("no '%s' in:\n%s", words, text);
}

/* Without a fault. */
static void test_right(void **state)
{
    struct report r = measured();

    (void)state;
    assert_int_equal(r.ngroup, 3);
    assert_int_equal(r.group[0].mated.planned, 2 * SUBJECTS);
    assert_int_equal(r.group[1].mated.n, SUBJECTS);
    assert_string_equal(r.group[1].name, smile);
    assert_int_equal(r.non_mated.n, TRIALS - 2 * SUBJECTS);
    assert_true(equal(r.fmr.value, 0) && equal(r.far.value, 0));
    assert_true(equal(r.fte.value, 0) && r.fte.n == SUBJECTS);
    assert_true(equal(r.group[0].fta.value, 0) && r.group[0].fta.n == 2 * SUBJECTS);
    assert_int_equal(r.group[0].first, 2 * SUBJECTS);
    for (int i = 0; i < REPORT_OF; i++)
        assert_true(equal(r.group[0].curve[i].f.eer, 0) &&
                    equal(r.group[0].curve[i].f.tar[0], 1) &&
                    r.group[0].curve[i].n == 2 * SUBJECTS);
    report_free(&r);
}

/* One false non-match, one false match, one inconclusive comparison. */
static void test_errors(void **state)
{
    struct report r;
    const struct report_group *g;

    (void)state;
    of(0, 1)->score = 5;
    of(0, 1)->decision = FACE_NO_MATCH;
    of(3, 4)->score = 6;
    of(3, 4)->decision = FACE_INCONCLUSIVE;
    of(3, 1)->score = 9;
    of(3, 1)->decision = FACE_MATCH;
    r = measured();
    g = &r.group[0];
    assert_int_equal(g->mated.inconclusive, 1);
    assert_true(equal(g->fnmr.value, 0.1) && g->fnmr.n == 10);
    assert_true(equal(g->unmatched.value, 0.2));
    assert_true(equal(g->frr.value, 0.2));
    assert_true(equal(r.fmr.value, 1.0 / 40) && equal(r.far.value, 1.0 / 40));
    assert_true(g->fnmr.low <= 0.1 && g->fnmr.high >= 0.1);
    assert_true(equal(r.group[1].fnmr.value, 0.2)); /* both are smiles */
    assert_true(equal(r.group[1].unmatched.value, 0.4));
    assert_true(equal(r.group[2].unmatched.value, 0));
    assert_int_equal(g->first, 9); /* not the one that scores 5 and 9 */
    assert_int_equal(g->ranked, 10);
    /* what is inconclusive here matches at a lower threshold */
    assert_true(equal(rates_fnmr(g->curve[REPORT_SCORED].rates, 6), 0.1));
    assert_true(equal(rates_fnmr(g->curve[REPORT_SCORED].rates, 5), 0));
    assert_true(equal(rates_fmr(g->curve[REPORT_SCORED].rates, 9), 1.0 / 40));
    assert_true(equal(g->curve[REPORT_SCORED].f.tar[0], 0.8)); /* above 9 */
    assert_true(equal(g->curve[REPORT_SCORED].f.tar_score[0], 20));
    report_free(&r);
}

/* A template and a frown are refused: 2 + 1 of 10 mated comparisons cannot be made. */
static void test_refusals(void **state)
{
    struct report r;
    const struct report_group *g;

    (void)state;
    refuse(as_template, 0);
    refuse(as_probe, 5);
    of(6, 7)->score = 5;
    of(6, 7)->decision = FACE_NO_MATCH;
    of(6, 4)->score = 9;
    of(6, 4)->decision = FACE_MATCH;
    r = measured();
    g = &r.group[0];
    assert_true(equal(r.fte.value, 0.2) && r.fte.n == 5);
    assert_true(equal(g->fta.value, 0.1) && g->fta.n == 10);
    assert_true(equal(r.group[1].fta.value, 0) && equal(r.group[2].fta.value, 0.2));
    assert_int_equal(g->mated.planned, 10);
    assert_int_equal(g->mated.n, 7);
    assert_true(equal(g->fnmr.value, 1.0 / 7) && g->fnmr.n == 7);
    assert_true(equal(g->frr.value, 0.4) && g->frr.n == 10);
    /* of 40 non-mated ones, 8 with the template, 4 with the probe, one with both */
    assert_int_equal(r.non_mated.n, 29);
    assert_true(equal(r.fmr.value, 1.0 / 29) && equal(r.far.value, 1.0 / 40));
    assert_int_equal(g->curve[REPORT_SCORED].n, 7);
    assert_int_equal(g->curve[REPORT_ALL].n, 10);
    assert_true(equal(g->curve[REPORT_SCORED].f.tar[0], 6.0 / 7));
    assert_true(equal(g->curve[REPORT_ALL].f.tar[0], 0.6));
    assert_true(equal(g->curve[REPORT_SCORED].f.fnmr, 1.0 / 7));
    assert_true(equal(g->curve[REPORT_ALL].f.fnmr, 0.4));
    /* the threshold is that of those scored */
    assert_true(equal(g->curve[REPORT_ALL].f.tar_score[0],
                      g->curve[REPORT_SCORED].f.tar_score[0]));
    assert_true(equal(g->curve[REPORT_ALL].f.fmr, 1.0 / 29));
    assert_true(equal(r.group[1].frr.value, 0.4)); /* smiles: 5, s0's template and s2 */
    assert_true(equal(r.group[2].frr.value, 0.4)); /* frowns: s0's template, s1's own */
    assert_int_equal(report_done(&r), 36);
    report_free(&r);
}

/* Without any probe that could be read there is a report all the same. */
static void test_all_refused(void **state)
{
    struct report r;

    (void)state;
    for (uint32_t i = 0; i < SCANS; i++)
        if (i % 3 != 0)
            refuse(as_probe, i);
    r = measured();
    assert_true(equal(r.group[0].frr.value, 1) && isnan(r.group[0].fnmr.value));
    assert_true(equal(r.far.value, 0) && isnan(r.fmr.value));
    assert_int_equal(r.group[0].ranked, 0);
    free(written(report_text, &r));
    free(written(report_json, &r));
    free(written(report_csv_rates, &r));
    report_free(&r);
}

static void test_scores(void **state)
{
    struct report r;
    char *text;

    (void)state;
    refuse(as_probe, 5);
    of(3, 4)->score = 6;
    of(3, 4)->decision = FACE_INCONCLUSIVE;
    of(0, 1)->disparity_mm = 0.75f;
    of(0, 1)->region[GRID_NOSE] = 3;
    of(0, 1)->region[GRID_CHIN] = NAN;
    r = measured();
    text = written(report_csv_scores, &r);
    has(text,
        ",score,threshold,fmr_at_score,disparity_mm,overlap,region_nose,region_eyes,"
        "region_forehead,region_cheeks,region_mouth,region_chin,rotation_deg,code,detail\n"
        "f0.ply,f1.ply,s0,s0,\"\",\"a \"\"smile\"\"\",mated,match,20.000000,8.000000,0,"
        "0.7500,0.5000,3.0000,0.0000,0.0000,0.0000,0.0000,,,,\n");
    has(text,
        "\nf3.ply,f4.ply,s1,s1,\"\",\"a \"\"smile\"\"\",mated,inconclusive,6.000000,8.000000,0,,");
    has(text, "\nf3.ply,f5.ply,s1,s1,\"\",frown,mated,refused,,,,,,,,,,,,,not_a_face,\n");
    has(text, "\n,f5.ply,,s1,,frown,failure_to_acquire,refused,,,,,,,,,,,,,not_a_face,"
              "\"why, though\"\n");
    free(text);
    report_free(&r);
}

static void test_matrix(void **state)
{
    struct report r;
    char *text;

    (void)state;
    refuse(as_template, 3);
    of(0, 4)->done = false;
    of(6, 14)->score = -1.5;
    r = measured();
    text = written(report_csv_matrix, &r);
    assert_string_equal(
        text,
        "template,f1.ply,f2.ply,f4.ply,f5.ply,f7.ply,f8.ply,f10.ply,f11.ply,f13.ply,f14.ply\n"
        "f0.ply,20.000000,20.000000,,-20.000000,-20.000000,-20.000000,-20.000000,-20.000000,"
        "-20.000000,-20.000000\n"
        "f3.ply,,,,,,,,,,\n"
        "f6.ply,-20.000000,-20.000000,-20.000000,-20.000000,20.000000,20.000000,-20.000000,"
        "-20.000000,-20.000000,-1.500000\n"
        "f9.ply,-20.000000,-20.000000,-20.000000,-20.000000,-20.000000,-20.000000,20.000000,"
        "20.000000,-20.000000,-20.000000\n"
        "f12.ply,-20.000000,-20.000000,-20.000000,-20.000000,-20.000000,-20.000000,-20.000000,"
        "-20.000000,20.000000,20.000000\n");
    free(text);
    report_free(&r);
}

/* Several reports: as many fields in each row. */
static void test_sets(void **state)
{
    struct report r[2];
    const struct report_csv_list list = {r, 2};
    char *text, *row;
    size_t commas[3] = {0}, n = 0;

    (void)state;
    r[0] = measured();
    refuse(as_probe, 5);
    r[1] = measured();
    text = written(report_csv_sets, &list);
    for (row = text; *row != '\0'; row++) {
        commas[n] += *row == ',';
        n += *row == '\n';
    }
    assert_int_equal(n, 3);
    assert_int_equal(commas[1], commas[0]);
    assert_int_equal(commas[2], commas[0]);
    has(text, "scans,engine,threshold,subjects,fte,fte_low,fte_high,fte_of,fta,");
    has(text, "\nscans,engine,8.000000,5,0,0,0,5,0.1,");
    free(text);
    for (int i = 0; i < 2; i++)
        report_free(&r[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_right, set_up),
        cmocka_unit_test_setup(test_errors, set_up),
        cmocka_unit_test_setup(test_refusals, set_up),
        cmocka_unit_test_setup(test_all_refused, set_up),
        cmocka_unit_test_setup(test_scores, set_up),
        cmocka_unit_test_setup(test_matrix, set_up),
        cmocka_unit_test_setup(test_sets, set_up),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
