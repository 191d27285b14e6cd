/* Rates by threshold: a comparison in doubt, of a face that hides a part, has a score that a
 * larger threshold takes; one with too little in common has none. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "report.h"

#define SUBJECTS 3

static void test_inconclusive(void **state)
{
    static char name[] = "", *names[] = {name}, *refused[2 * SUBJECTS];
    struct corpus_scan scan[2 * SUBJECTS] = {{.subject = 0}};
    struct corpus_subject subject[SUBJECTS];
    struct ctl_trial trial[SUBJECTS];
    const struct corpus corpus = {.scan = scan,
                                  .subject = subject,
                                  .kind = names,
                                  .population = names,
                                  .nscan = 2 * SUBJECTS,
                                  .nsubject = SUBJECTS,
                                  .nkind = 1,
                                  .npopulation = 1};
    const struct ctl_trials t = {.corpus = &corpus,
                                 .trial = trial,
                                 .n = SUBJECTS,
                                 .refused = refused,
                                 .threshold_mm = 0.1};
    struct report r = {.source = ""};

    (void)state;
    for (uint32_t i = 0; i < SUBJECTS; i++) {
        scan[2 * i] = (struct corpus_scan){.subject = i, .enrolled = true};
        scan[2 * i + 1] = (struct corpus_scan){.subject = i};
        subject[i] = (struct corpus_subject){
            .enrolled = 2 * i, .nscan = 2, .relative_of = CORPUS_NONE};
        trial[i] = (struct ctl_trial){.template = 2 * i,
                                      .probe = 2 * i + 1,
                                      .type = CORPUS_GENUINE,
                                      .done = true,
                                      .decision = FACE_INCONCLUSIVE,
                                      .comparable = true,
                                      .calibrated_mm = 0.12,
                                      .rotation_deg = (double)NAN};
    }
    trial[0].decision = FACE_MATCH;
    trial[0].calibrated_mm = 0.05;
    trial[1].comparable = false;
    assert_int_equal(report_measure(&r, &t), ST_OK);
    assert_int_equal(r.group[0].mated.inconclusive, 2);
    assert_true(fabs(r.group[0].unmatched.value - 2.0 / 3) < 1e-12);
    assert_true(fabs(rates_fnmr(r.group[0].rates, 0.1) - 2.0 / 3) < 1e-12);
    assert_true(fabs(rates_fnmr(r.group[0].rates, 0.12) - 1.0 / 3) < 1e-12);
    assert_true(fabs(rates_fnmr(r.group[0].rates, 9) - 1.0 / 3) < 1e-12);
    report_free(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_inconclusive),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
