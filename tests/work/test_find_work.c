/* The search for a face costs no more than MOST times what it does in a head of as many points,
 * whatever they are: counted in basic blocks of core and the search, so that no clock is asked. */
#include <stdatomic.h>

#include "brute.h"
#include "face.h"
#include "find.h"
#include "head.h"
#include "unit.h"
#include "work.h"

#define MOST   16
#define POINTS 300000
#define KINDS  7

static struct dvec3 pts[POINTS];
static struct surface_work *work;

static uint64_t count(void)
{
    const uint64_t before = work_executed();
    struct find_result f;

    assert_int_not_equal(find_face(pts, POINTS, 0, work, NULL, &f), ST_ENOMEM);
    return work_executed() - before;
}

static uint64_t ordinary(struct draw *r)
{
    struct head h = {0};

    head_make_up(1, &h);
    for (size_t i = 0; i < POINTS; i++) {
        const struct dvec3 p = h.at[i % h.n];

        pts[i] = (struct dvec3){p.x + draw_uniform(r, -0.5, 0.5),
                                p.y + draw_uniform(r, -0.5, 0.5),
                                p.z + draw_uniform(r, -0.5, 0.5)};
    }
    head_free(&h);
    return count();
}

/* In the direction of (x, y, z) on a ball of radius, with bumps so high and so many. */
static struct dvec3 bumpy(double x, double y, double z, double radius, double high,
                          double many)
{
    const double l = sqrt(x * x + y * y + z * z), s = many / l;
    const double r = (radius + 2 * high * sin(s * x) * sin(s * y) * sin(s * z)) / l;

    return (struct dvec3){r * x, r * y, r * z};
}

static void contrive(int kind, struct draw *r)
{
    for (size_t i = 0; i < POINTS; i++) {
        const double x = draw_uniform(r, -1, 1), y = draw_uniform(r, -1, 1),
                     z = draw_uniform(r, -1, 1);
        const double e = x * 200 - 60 * rint(x * 200 / 60);
        const double f = y * 200 - 60 * rint(y * 200 / 60);

        switch (kind) {
        case 0: /* solids */
            pts[i] = (struct dvec3){300 * x, 300 * y, 300 * z};
            break;
        case 1: /* one point in each cell */
            pts[i] = (struct dvec3){20 * (double)(i % 67), 20 * (double)(i / 67 % 67),
                                    20 * (double)(i / 67 / 67)};
            break;
        case 2: /* far apart */
            pts[i] = (struct dvec3){1e6 * x, 1e6 * y, 1e6 * z};
            break;
        case 3: /* many noses */
            pts[i] = (struct dvec3){200 * x, 200 * y, 18 * exp(-(e * e + f * f) / 200)};
            break;
        case 4: /* a rough wall */
            pts[i] = (struct dvec3){750 * x, 750 * y, 20 * z};
            break;
        case 5: /* many bumpy balls */
            pts[i] = bumpy(x, y, z, 90, 12, 9);
            pts[i].x += 260 * (double)(i % 3);
            pts[i].y += 260 * (double)(i / 3 % 3);
            pts[i].z += 260 * (double)(i / 9 % 3);
            break;
        default: /* a bumpy ball */
            pts[i] = bumpy(x, y, z, 110, 15, 13);
        }
    }
}

TEST(test_contrived)
{
    struct draw r = {1};
    double head;

    work = surface_work_new(NULL);
    assert_non_null(work);
    head = (double)ordinary(&r);
    for (int kind = 0; kind < KINDS; kind++) {
        double ratio;

        contrive(kind, &r);
        ratio = (double)count() / head;
        print_message("kind %d: %.2f\n", kind, ratio);
        assert_true(ratio < MOST);
    }
    surface_work_free(work);
}

static int is_set(const void *flag)
{
    const atomic_bool *is = flag;

    return atomic_load_explicit(is, memory_order_relaxed);
}

/* A search that is stopped, at whatever moment, ends with the step that it is at. */
TEST(test_stopped)
{
    struct draw r = {1};
    uint64_t all;

    work = surface_work_new(NULL);
    assert_non_null(work);
    contrive(0, &r);
    all = count();
    for (uint64_t i = 1; i < 20; i++) {
        const uint64_t before = work_executed();
        atomic_bool flag = false;
        const struct surface_stop stop = {is_set, &flag};
        struct find_result f;

        work_set_at(&flag, all * i / 20);
        assert_int_equal(find_face(pts, POINTS, 0, work, &stop, &f), ST_EBUSY);
        const uint64_t soon = work_executed() - before - all * i / 20;
        print_message("at %2d%%: %.2f\n", (int)(5 * i), (double)soon / (double)all);
        /* the longest single step is 0.3, with sanitizers 0.4 */
        assert_true(soon < all / 2);
    }
    surface_work_free(work);
}
