#include "faces.h"

#include "clouds.h"
#include "place.h"
#include "unit.h"

struct surface_work *faces_work;
struct dvec3 faces_pts[2 * FACES_POINTS];
size_t faces_n;

static void begin(void)
{
    assert_non_null(faces_work = surface_work_new(NULL));
}

static void end(void)
{
    surface_work_free(faces_work);
}

__attribute__((constructor(101))) static void fixture(void)
{
    unit_add_hook(UNIT_BEFORE_ALL, begin);
    unit_add_hook(UNIT_AFTER_ALL, end);
}

void faces_scan(uint64_t subject, uint64_t scan, size_t n)
{
    assert_true(n <= 2 * FACES_POINTS);
    faces_n = clouds_scan(subject, scan, n, faces_pts);
    assert_true(faces_n > SURFACE_MIN_POINTS);
}

void faces_build(struct surface_face *out)
{
    assert_int_equal(face_build(faces_pts, faces_n, faces_work, out, NULL), ST_OK);
}

void faces_make(uint64_t subject, uint64_t scan, struct surface_face *out)
{
    faces_scan(subject, scan, FACES_POINTS);
    faces_build(out);
}

void faces_mistake(struct surface_face *f, double size)
{
    struct shape_fit fit;

    assert_int_equal(place_at(f, size, faces_work, &fit), ST_OK);
    f->frame.pose = fit.pose;
    place_keep(&fit, &f->frame);
    assert_int_equal(place_encode(f, &fit, faces_work, &f->encoding), ST_OK);
}
