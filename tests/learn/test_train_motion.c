/* Finding the point that heads were turned about from the scans' frames and turns. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "align_pose.h"
#include "corpus.h"
#include "face.h"
#include "train.h"
#include "train_motion.h"
#include "train_set.h"

#define SUBJECTS 4
#define EACH     5
#define SCANS    (SUBJECTS * EACH)

struct made {
    struct corpus_scan scan[SCANS];
    struct corpus_subject subject[SUBJECTS];
    struct face face[SCANS];
    struct corpus corpus;
    struct train_set set;
};

/* q turned by degrees about axis (0 x, 1 y, 2 z). */
static struct dvec3 turn(struct dvec3 q, int axis, double degrees)
{
    const double c = cos(degrees * acos(-1) / 180), s = sin(degrees * acos(-1) / 180);

    if (axis == 0)
        return (struct dvec3){q.x, c * q.y - s * q.z, s * q.y + c * q.z};
    if (axis == 1)
        return (struct dvec3){c * q.x + s * q.z, q.y, c * q.z - s * q.x};
    return (struct dvec3){c * q.x - s * q.y, s * q.x + c * q.y, q.z};
}

/* Scans of heads that were turned about centre; each subject's nose is at another place, and
 * a frame gives only the position of the nose. */
static void make(struct made *m, struct dvec3 centre, double most_deg)
{
    memset(m, 0, sizeof *m);
    for (uint32_t i = 0; i < SCANS; i++) {
        const uint32_t s = i / EACH, k = i % EACH;
        const struct dvec3 nose = {2.0 * s - 3, 4 - 1.5 * s, 1.0 * s};
        const double yaw = most_deg * sin(2.1 * i), pitch = most_deg * cos(3.7 * i);
        const double roll = most_deg * sin(5.3 * i + 1),
                     shift[3] = {3.0 * k, -4, 2.0 * k};
        struct dvec3 q = {nose.x - centre.x, nose.y - centre.y, nose.z - centre.z};

        q = turn(turn(turn(q, 1, yaw), 0, pitch), 2, roll);
        m->scan[i] = (struct corpus_scan){
            .subject = s,
            .enrolled = k == 0,
            .pose = {yaw, pitch, roll, shift[0], shift[1], shift[2]}};
        m->subject[s].enrolled = s * EACH;
        m->face[i].surface.mesh.nv = 1;
        m->face[i].frame.pose = (struct align_pose){{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                                    {-(q.x + centre.x + shift[0]),
                                                     -(q.y + centre.y + shift[1]),
                                                     -(q.z + centre.z + shift[2])}};
    }
    m->corpus = (struct corpus){.scan = m->scan,
                                .subject = m->subject,
                                .nscan = SCANS,
                                .nsubject = SUBJECTS,
                                .posed = true};
    m->set = (struct train_set){&m->corpus, m->face};
}

static void assert_centre(struct made *m, double x, double y, double z)
{
    const struct dvec3 c = train_motion_centre(&m->set);

    assert_float_equal(c.x, x, 0.1);
    assert_float_equal(c.y, y, 0.1);
    assert_float_equal(c.z, z, 0.1);
}

static void test_centre_is_found(void **state)
{
    static struct made m;

    (void)state;
    make(&m, (struct dvec3){5, -10, -80}, 8);
    assert_centre(&m, 5, -10, -80);
    make(&m, (struct dvec3){0, 0, 0}, 8);
    assert_centre(&m, 0, 0, 0);
    /* scans without a face are ignored */
    make(&m, (struct dvec3){0, 0, -80}, 8);
    m.face[7].surface.mesh.nv = 0;
    m.face[7].frame.pose.t[0] = 1e4;
    assert_centre(&m, 0, 0, -80);
}

static void test_nothing_turned(void **state)
{
    static struct made m;

    (void)state;
    make(&m, (struct dvec3){0, 0, -80}, 0);
    assert_centre(&m, 0, 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_centre_is_found),
        cmocka_unit_test(test_nothing_turned),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
