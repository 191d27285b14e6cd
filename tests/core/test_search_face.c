/* A search finds whom a comparison finds: people by a second scan, also one that was taken for a head of
 * another size; failures of memory leave nothing. */
/* link: -Wl,--wrap=aligned_alloc */
#include "face_work.h"
#include "faces.h"
#include "fail_alloc.h"
#include "surface_search.h"
#include "unit.h"

#define POINTS 2000
#define PEOPLE 24

static struct surface_index *people;
static struct surface_face enrolled[PEOPLE], probe;
static uint32_t slot[PEOPLE];

static void make(uint64_t subject, uint64_t number, struct surface_face *f)
{
    faces_scan(subject, number, POINTS);
    faces_build(f);
}

BEFORE_ALL(set_up)
{
    people = surface_index_new();
    assert_non_null(people);
    for (uint32_t i = 0; i < PEOPLE; i++) {
        unsigned char d[SURFACE_DESCRIPTOR];

        make(i, 0, &enrolled[i]);
        assert_int_equal(surface_describe(faces_work, &enrolled[i], d), SURFACE_OK);
        slot[i] = surface_index_add(people, d);
        assert_true(slot[i] != SURFACE_NOWHERE);
    }
}

AFTER_ALL(tear_down)
{
    for (int i = 0; i < PEOPLE; i++)
        face_free(&enrolled[i]);
    face_free(&probe);
    surface_index_free(people);
}

/* The person comes first, the scores fall, and each slot comes once. */
static void check(uint32_t person)
{
    struct surface_hit hit[PEOPLE];
    size_t n;

    assert_int_equal(
        surface_search(faces_work, people, &probe, NULL, -1e9, PEOPLE, hit, &n),
        SURFACE_OK);
    assert_int_equal(n, PEOPLE);
    assert_int_equal(hit[0].slot, slot[person]);
    for (size_t i = 0; i < n; i++) {
        struct surface_comparison c;

        for (size_t k = 0; k < i; k++)
            assert_true(hit[k].slot != hit[i].slot && hit[k].score >= hit[i].score);
        for (uint32_t p = 0; p < PEOPLE; p++)
            if (slot[p] == hit[i].slot) {
                assert_int_equal(surface_compare(faces_work, &enrolled[p], &probe, &c),
                                 SURFACE_OK);
                if (c.score >= 8) /* what matters is not lost */
                    assert_true((double)hit[i].score > c.score - 6);
            }
    }
}

TEST(test_people)
{
    for (uint32_t person = 0; person < PEOPLE; person += 3) {
        make(person, 1, &probe);
        check(person);
    }
}

TEST(test_other_size)
{
    make(7, 2, &probe);
    faces_mistake(&probe, 0.9);
    check(7);
}

TEST(test_allowed)
{
    uint16_t allowed[PEOPLE] = {0};
    struct surface_hit hit[3];
    size_t n;

    make(5, 1, &probe);
    for (uint32_t i = 0; i < PEOPLE; i++)
        if (i != 5 && i % 2 == 1)
            allowed[slot[i] / 16] |= (uint16_t)(1U << slot[i] % 16);
    assert_int_equal(
        surface_search(faces_work, people, &probe, allowed, -1e9, 3, hit, &n),
        SURFACE_OK);
    assert_int_equal(n, 3);
    for (size_t i = 0; i < n; i++)
        assert_true(hit[i].slot != slot[5] &&
                    (allowed[hit[i].slot / 16] >> hit[i].slot % 16 & 1) == 1);
    assert_int_equal(surface_search(faces_work, people, &probe, NULL, 8, 3, hit, &n),
                     SURFACE_OK);
    assert_int_equal(n, 1);
    assert_int_equal(hit[0].slot, slot[5]);
}

TEST(test_unknown)
{
    unsigned char d[SURFACE_DESCRIPTOR];
    struct surface_hit hit;
    size_t n = 7;

    make(3, 1, &probe);
    probe.encoding.n = 0;
    assert_int_equal(surface_describe(faces_work, &probe, d), SURFACE_EINVAL);
    assert_int_equal(surface_search(faces_work, people, &probe, NULL, 0, 1, &hit, &n),
                     SURFACE_EINVAL);
    assert_int_equal(n, 0);
}

static enum status search_once(void *arg)
{
    struct surface_work *fresh = arg;
    struct surface_hit hit[4];
    size_t n;

    surface_work_wipe(fresh);
    mem_free(fresh->search);
    fresh->search = NULL;
    return status_from(surface_search(fresh, people, &probe, NULL, 0, 4, hit, &n));
}

TEST(test_no_memory)
{
    struct surface_work *fresh = surface_work_new(NULL);

    assert_non_null(fresh);
    make(4, 1, &probe);
    faces_mistake(&probe, 0.9);
    assert_true(fail_alloc_walk(search_once, fresh) >= 2);
    surface_work_free(fresh);
}
