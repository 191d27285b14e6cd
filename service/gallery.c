#include "gallery.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "groups.h"
#include "mem.h"
#include "store.h"
#include "utc.h"

#define NONE UINT32_MAX

/* Templates that are asked for each subject; if that is too few, as many as a subject can have. */
#define PER_SUBJECT 4

struct person {
    unsigned char uid[STORE_UID];
    uint32_t slot;    /* the first one's; the others follow in next; NONE: it has none */
    uint32_t set;     /* its groups */
    uint32_t until;   /* s since 1970; UINT32_MAX: for ever */
    uint32_t chain;   /* the next of its bucket, or of those that are free */
    uint32_t skipped; /* templates that cannot be searched */
};

struct slot {
    uint32_t person, next, set;
};

struct set { /* subjects that have the same groups */
    char groups[GROUPS_SIZE];
    uint32_t chain; /* the next of its bucket */
    uint64_t people, skipped;
};

#define SET_BUCKETS 4096

struct gallery {
    pthread_rwlock_t lock;
    size_t most;
    atomic_int phase; /* enum gallery_phase */
    struct {          /* of gallery_state(), which does not wait for the lock */
        atomic_ullong subjects, templates;
        atomic_size_t bytes;
    } told;
    uint64_t seq;
    struct surface_index *index;
    struct slot *slot; /* [slots], by slot of the index */
    struct person *person;
    uint32_t *bucket; /* [cap of person] */
    struct set *set;
    uint32_t set_bucket[SET_BUCKETS];
    uint32_t slots, slot_cap;
    uint32_t people, person_cap,
        free_person; /* people: used so far; those that are free are chained */
    uint32_t sets, set_cap;
    uint64_t subjects, templates, damaged;
    uint32_t now;     /* s since 1970, while it follows */
    uint32_t soonest; /* before this nobody expires */
};

static enum status full(const struct gallery *g, struct errinfo *e)
{
    return errinfo_set(e, ST_ELIMIT,
                       "the descriptors of all templates take more than the %zu MB that "
                       "gallery-memory allows",
                       g->most >> 20);
}

/* ---- memory */

/* Room for one more element; grows by an eighth, as little is given away. */
static bool gallery_room(void **array, uint32_t used, uint32_t *cap, size_t size)
{
    const uint32_t more = *cap + *cap / 8 + 64;
    void *p;

    if (used < *cap)
        return true;
    if (more < *cap || (p = mem_grow(*array, used * size, more * size)) == NULL)
        return false;
    *array = p;
    *cap = more;
    return true;
}

static size_t bytes_of(const struct gallery *g)
{
    return (g->index != NULL ? surface_index_bytes(g->index) : 0) +
           g->slot_cap * sizeof *g->slot +
           g->person_cap * (sizeof *g->person + sizeof *g->bucket) +
           g->set_cap * sizeof *g->set;
}

static void gallery_clear(struct gallery *g)
{
    surface_index_free(g->index);
    mem_free(g->slot);
    mem_free(g->person);
    mem_free(g->bucket);
    mem_free(g->set);
    g->index = NULL;
    g->slot = NULL;
    g->person = NULL;
    g->bucket = NULL;
    g->set = NULL;
    g->slots = g->slot_cap = g->people = g->person_cap = g->sets = g->set_cap = 0;
    g->free_person = NONE;
    memset(g->set_bucket, 0xff, sizeof g->set_bucket);
    g->subjects = g->templates = g->damaged = g->seq = 0;
    g->soonest = UINT32_MAX;
}

struct gallery *gallery_new(size_t most)
{
    struct gallery *g = calloc(1, sizeof *g);
    pthread_rwlockattr_t writers_first;

    if (g == NULL)
        return NULL;
    g->most = most;
    gallery_clear(g);
    (void)pthread_rwlockattr_init(
        &writers_first); /* searches never wait for each other */
    (void)pthread_rwlockattr_setkind_np(&writers_first,
                                        PTHREAD_RWLOCK_PREFER_WRITER_NONRECURSIVE_NP);
    (void)pthread_rwlock_init(&g->lock, &writers_first);
    (void)pthread_rwlockattr_destroy(&writers_first);
    return g;
}

void gallery_free(struct gallery *g)
{
    if (g == NULL)
        return;
    gallery_clear(g);
    (void)pthread_rwlock_destroy(&g->lock);
    free(g);
}

enum gallery_phase gallery_phase(const struct gallery *g)
{
    return (enum gallery_phase)atomic_load(&g->phase);
}

struct gallery_state gallery_state(struct gallery *g)
{
    return (struct gallery_state){atomic_load(&g->told.subjects),
                                  atomic_load(&g->told.templates),
                                  atomic_load(&g->told.bytes)};
}

/* ---- people by uid, which are random */

static uint32_t *bucket_of(struct gallery *g, const unsigned char uid[STORE_UID])
{
    uint32_t hash;

    memcpy(&hash, uid, sizeof hash);
    return &g->bucket[hash % g->person_cap];
}

static uint32_t find_person(struct gallery *g, const unsigned char uid[STORE_UID])
{
    uint32_t i = g->person_cap > 0 ? *bucket_of(g, uid) : NONE;

    while (i != NONE && memcmp(g->person[i].uid, uid, STORE_UID) != 0)
        i = g->person[i].chain;
    return i;
}

/* After the table has grown. */
static bool gallery_rehash(struct gallery *g)
{
    mem_free(g->bucket);
    if ((g->bucket = mem_array(g->person_cap, sizeof *g->bucket)) == NULL)
        return false;
    memset(g->bucket, 0xff, g->person_cap * sizeof *g->bucket);
    for (uint32_t i = 0; i < g->people; i++) { /* it grows when none is free */
        uint32_t *b = bucket_of(g, g->person[i].uid);

        g->person[i].chain = *b;
        *b = i;
    }
    return true;
}

static uint32_t new_person(struct gallery *g, const unsigned char uid[STORE_UID])
{
    const uint32_t cap = g->person_cap;
    uint32_t i = g->free_person, *b;

    if (i == NONE) {
        if (!gallery_room((void **)&g->person, g->people, &g->person_cap,
                          sizeof *g->person) ||
            (g->person_cap != cap && !gallery_rehash(g)))
            return NONE;
        i = g->people++;
    } else {
        g->free_person = g->person[i].chain;
    }
    b = bucket_of(g, uid);
    g->person[i] = (struct person){.slot = NONE, .chain = *b};
    memcpy(g->person[i].uid, uid, STORE_UID);
    *b = i;
    return i;
}

static void remove_person(struct gallery *g, uint32_t i)
{
    struct person *p = &g->person[i];
    uint32_t *at = bucket_of(g, p->uid);

    while (*at != i)
        at = &g->person[*at].chain;
    *at = p->chain;
    for (uint32_t s = p->slot; s != NONE; s = g->slot[s].next) {
        surface_index_remove(g->index, s);
        g->slot[s].person = NONE;
        g->templates--;
    }
    if (p->slot != NONE) {
        g->set[p->set].people--;
        g->subjects--;
    }
    g->set[p->set].skipped -= p->skipped;
    *p = (struct person){.slot = NONE, .chain = g->free_person};
    g->free_person = i;
}

/* ---- those who are added */

/* Each subject may have groups of its own: they are not compared with all others. */
static uint32_t need_set(struct gallery *g, const char *groups)
{
    uint32_t hash = 0, *bucket, i;

    for (const char *c = groups; *c != '\0'; c++)
        hash = hash * 31 + (unsigned char)*c;
    bucket = &g->set_bucket[hash % SET_BUCKETS];
    for (i = *bucket; i != NONE; i = g->set[i].chain)
        if (strcmp(g->set[i].groups, groups) == 0)
            return i;
    if (!gallery_room((void **)&g->set, g->sets, &g->set_cap, sizeof *g->set))
        return NONE;
    g->set[g->sets] = (struct set){.chain = *bucket};
    memcpy(g->set[g->sets].groups, groups, strlen(groups) + 1);
    return *bucket = g->sets++;
}

static bool add_slot(struct gallery *g, struct person *p, uint32_t person, uint32_t s)
{
    while (g->slots <= s) {
        if (!gallery_room((void **)&g->slot, g->slots, &g->slot_cap, sizeof *g->slot))
            return false;
        g->slot[g->slots++].person = NONE;
    }
    if (p->slot == NONE) {
        g->set[p->set].people++;
        g->subjects++;
    }
    g->slot[s] = (struct slot){.person = person, .next = p->slot, .set = p->set};
    p->slot = s;
    g->templates++;
    return true;
}

/* Cut off, so that nobody is found too long. */
static uint32_t seconds(const char *at)
{
    int64_t ms;

    if (at[0] == '\0')
        return UINT32_MAX;
    if (!utc_read(at, &ms) || ms < 0)
        return 0;
    return ms / 1000 < UINT32_MAX ? (uint32_t)(ms / 1000) : UINT32_MAX;
}

static enum status add_template(void *arg, const struct store_subject *of,
                                const struct store_template *t,
                                const unsigned char *descriptor, struct errinfo *e)
{
    struct gallery *g = arg;
    uint32_t i, s = NONE;
    struct person *p;

    (void)t;
    if (of->disabled || !of->identify)
        return ST_OK;
    if ((i = find_person(g, of->uid)) == NONE) {
        const uint32_t set = need_set(g, of->groups);

        if (set == NONE || (i = new_person(g, of->uid)) == NONE)
            return errinfo_memory(e);
        g->person[i].set = set;
        g->person[i].until = seconds(of->expires);
        if (g->person[i].until < g->soonest)
            g->soonest = g->person[i].until;
    }
    p = &g->person[i];
    if (descriptor == NULL) {
        p->skipped++;
        g->set[p->set].skipped++;
    } else if ((s = surface_index_add(g->index, descriptor)) == NONE) {
        return errinfo_memory(e);
    } else if (!add_slot(g, p, i, s)) {
        surface_index_remove(g->index, s);
        return errinfo_memory(e);
    }
    return bytes_of(g) > g->most ? full(g, e) : ST_OK;
}

static void count_damaged(void *arg, const char *line)
{
    struct gallery *g = arg;

    (void)line;
    g->damaged++;
}

/* ---- following */

static enum status load(struct gallery *g, struct store_people *p, struct errinfo *e)
{
    enum status st;

    gallery_clear(g);
    if ((g->index = surface_index_new()) == NULL)
        return errinfo_memory(e);
    st = store_people_all(p, add_template, count_damaged, g, e);
    if (st != ST_OK)
        gallery_clear(g);
    return st;
}

/* A damaged subject cannot be found, and nobody is told that there is no match. */
static enum status reload_person(struct gallery *g, struct store_people *p,
                                 const unsigned char uid[STORE_UID], struct errinfo *e)
{
    const uint32_t i = find_person(g, uid);
    enum status st;

    if (i != NONE)
        remove_person(g, i);
    if ((st = store_people_of(p, uid, add_template, g, e)) != ST_ECORRUPT)
        return st;
    g->damaged++;
    return ST_OK;
}

static enum status update(struct gallery *g, struct store_people *p, struct errinfo *e)
{
    unsigned char(*uid)[STORE_UID];
    bool all;
    size_t n;
    enum status st = store_people_changed(p, g->seq, &uid, &n, &all, e);

    if (st == ST_OK && all)
        st = load(g, p, e);
    else
        for (size_t i = 0; st == ST_OK && i < n; i++)
            st = reload_person(g, p, uid[i], e);
    free(uid);
    return st;
}

static void expire(struct gallery *g)
{
    if (g->now < g->soonest)
        return;
    g->soonest = UINT32_MAX;
    for (uint32_t i = 0; i < g->people; i++) {
        const struct person *p = &g->person[i];

        if (p->slot == NONE && p->skipped == 0)
            continue;
        if (p->until <= g->now)
            remove_person(g, i);
        else if (p->until < g->soonest)
            g->soonest = p->until;
    }
}

/* An update that fails is made again as a whole by the next call: it may be done twice. */
static enum status follow(struct gallery *g, struct store_people *p, struct errinfo *e)
{
    const uint64_t seq = store_people_seq(p);
    const bool loaded = gallery_phase(g) == GALLERY_READY && g->index != NULL;
    enum status st = ST_OK;

    if (gallery_phase(g) == GALLERY_FULL)
        return full(g, e);
    if (!loaded)
        st = load(g, p, e);
    else if (seq > g->seq)
        st = update(g, p, e);
    if (st == ST_OK && seq > g->seq)
        g->seq = seq;
    if (st == ST_OK)
        expire(g);
    if (st == ST_ELIMIT)
        gallery_clear(g);
    atomic_store(&g->told.subjects, g->subjects);
    atomic_store(&g->told.templates, g->templates);
    atomic_store(&g->told.bytes, bytes_of(g));
    if (st == ST_ELIMIT)
        atomic_store(&g->phase, GALLERY_FULL);
    else
        atomic_store(&g->phase, g->index != NULL ? GALLERY_READY : GALLERY_LOADING);
    return st;
}

enum status gallery_follow(struct gallery *g, struct store_people *p, struct errinfo *e)
{
    int64_t now;
    bool is_new;
    enum status st;

    if (!utc_now(&now))
        return errinfo_set(e, ST_EINTERNAL, "the clock cannot be read");
    (void)pthread_rwlock_rdlock(&g->lock); /* mostly nothing is to be done */
    is_new = gallery_phase(g) == GALLERY_READY && store_people_seq(p) <= g->seq &&
             now / 1000 < g->soonest;
    (void)pthread_rwlock_unlock(&g->lock);
    if (is_new)
        return ST_OK;
    (void)pthread_rwlock_wrlock(&g->lock);
    g->now = (uint32_t)(now / 1000);
    st = follow(g, p, e);
    (void)pthread_rwlock_unlock(&g->lock);
    return st;
}

/* ---- searching */

struct finding {
    bool *may;         /* [sets], of the gallery: are its subjects searched? */
    uint16_t *allowed; /* of surface_search(); NULL: all */
    struct surface_hit *hit;
    uint32_t *person; /* [most] */
};

static bool is_searched(const struct set *s, const struct gallery_search *what)
{
    return groups_meet(what->bound, s->groups) &&
           (what->group[0] == '\0' || groups_meet(what->group, s->groups));
}

/* Which slots are searched. */
static bool gallery_allow(const struct gallery *g, const struct gallery_search *what,
                          struct finding *f, struct gallery_found *out)
{
    const size_t words = (size_t)g->slots / 16 + 1;
    bool all = true;

    out->skipped = g->damaged;
    if ((f->may = mem_array(g->sets, sizeof *f->may)) == NULL)
        return false;
    for (uint32_t i = 0; i < g->sets; i++) {
        f->may[i] = is_searched(&g->set[i], what);
        all = all && f->may[i];
        out->searched += f->may[i] ? g->set[i].people : 0;
        out->skipped += f->may[i] ? g->set[i].skipped : 0;
    }
    if (all)
        return true;
    if ((f->allowed = mem_array(words, sizeof *f->allowed)) == NULL)
        return false;
    memset(f->allowed, 0, words * sizeof *f->allowed);
    for (uint32_t s = 0; s < g->slots; s++)
        if (g->slot[s].person != NONE && f->may[g->slot[s].set])
            f->allowed[s / 16] |= (uint16_t)(1U << s % 16);
    return true;
}

/* Each subject once, at the place of its best template. */
static void gallery_collect(const struct gallery *g, const struct finding *f, size_t hits,
                            size_t most, struct gallery_found *out)
{
    for (size_t i = 0; i < hits && out->n < most; i++) {
        const uint32_t person = g->slot[f->hit[i].slot].person;
        size_t k = 0;

        while (k < out->n && f->person[k] != person)
            k++;
        if (k < out->n)
            continue;
        f->person[out->n] = person;
        memcpy(out->uid[out->n++], g->person[person].uid, STORE_UID);
    }
}

/* Into f and out, of the index as it is. */
static enum status search(const struct gallery *g, struct surface_work *w,
                          const struct gallery_search *what, const struct finding *f,
                          struct gallery_found *out)
{
    enum status st = ST_OK;
    size_t hits = 0, most = 0;

    for (size_t each = PER_SUBJECT;
         st == ST_OK && g->index != NULL && out->n < what->most && hits == most &&
         each <= STORE_TEMPLATES_MAX;
         each *= STORE_TEMPLATES_MAX / PER_SUBJECT) {
        most = what->most * each;
        out->n = 0;
        st = status_from(surface_search(w, g->index, what->probe, f->allowed, what->floor,
                                        most, f->hit, &hits));
        if (st == ST_OK)
            gallery_collect(g, f, hits, what->most, out);
    }
    return st;
}

static enum status find(struct gallery *g, struct surface_work *w,
                        const struct gallery_search *what, struct finding *f,
                        struct gallery_found *out)
{
    enum status st;

    f->hit = mem_array(what->most * STORE_TEMPLATES_MAX, sizeof *f->hit);
    f->person = mem_array(what->most, sizeof *f->person);
    out->uid = malloc(what->most * sizeof *out->uid);
    if (f->hit == NULL || f->person == NULL || out->uid == NULL)
        return ST_ENOMEM;
    (void)pthread_rwlock_rdlock(&g->lock);
    st = gallery_allow(g, what, f, out) ? search(g, w, what, f, out) : ST_ENOMEM;
    (void)pthread_rwlock_unlock(&g->lock);
    return st;
}

enum status gallery_find(struct gallery *g, struct surface_work *w,
                         const struct gallery_search *what, struct gallery_found *out,
                         struct errinfo *e)
{
    struct finding f = {.may = NULL};
    enum status st;

    *out = (struct gallery_found){.n = 0};
    st = find(g, w, what, &f, out);
    mem_free(f.may);
    mem_free(f.allowed);
    mem_free(f.hit);
    mem_free(f.person);
    return st == ST_OK ? st : errinfo_set(e, st, "searching: %s", status_message(st));
}

enum status gallery_count(struct gallery *g, const char *bound, const char *group,
                          struct gallery_found *out, struct errinfo *e)
{
    const struct gallery_search what = {.bound = bound, .group = group};
    struct finding f = {.may = NULL};
    bool done;

    *out = (struct gallery_found){.n = 0};
    (void)pthread_rwlock_rdlock(&g->lock);
    done = gallery_allow(g, &what, &f, out);
    (void)pthread_rwlock_unlock(&g->lock);
    mem_free(f.may);
    mem_free(f.allowed);
    return done ? ST_OK : errinfo_memory(e);
}

void gallery_found_free(struct gallery_found *f)
{
    free(f->uid);
    *f = (struct gallery_found){.n = 0};
}
