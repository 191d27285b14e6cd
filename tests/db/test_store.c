/* The store: templates, subjects and events. */
#include <pthread.h>
#include <sys/stat.h>

#include "face.h"
#include "store.h"
#include "tempdb.h"
#include "unit.h"

static struct errinfo e;

TEST(test_templates)
{
    struct store *s = tempdb_fresh();
    struct store_template a, b, got, *list;
    struct store_subject subject;
    struct surface_face *f = NULL;
    struct stat sb;
    bool created = true;
    size_t n;

    assert_true(tempdb_server || stat(tempdb_path, &sb) == 0);
    assert_true(tempdb_server || (sb.st_mode & 0777) == 0600);
    must(store_ready(s, &e));
    tempdb_enroll(s, "alice", "", &tempdb_face[0], &a);
    assert_int_equal(a.points, tempdb_face[0].surface.mesh.nv);
    assert_string_equal(a.engine, store_made_by(s));

    /* The same cloud again is the same template; for another subject it is another one.
     * */
    must(tempdb_store(s, "test", "alice", "x", &tempdb_face[0], &b, &created, &e));
    assert_false(created);
    assert_memory_equal(&a, &b, sizeof a);
    tempdb_enroll(s, "bob", "", &tempdb_face[0], &b);
    assert_string_equal(a.digest, b.digest);
    assert_string_not_equal(a.id, b.id);

    must(store_template_load(s, "", a.id, &got, tempdb_work, &f, &e));
    assert_memory_equal(&a, &got, sizeof a);
    assert_int_equal(f->surface.mesh.nv, tempdb_face[0].surface.mesh.nv);
    assert_memory_equal(f->surface.mesh.twin, tempdb_face[0].surface.mesh.twin,
                        3 * f->surface.mesh.nt * sizeof *f->surface.mesh.twin);
    assert_memory_equal(&f->quality, &tempdb_face[0].quality, sizeof f->quality);
    assert_memory_equal(f->surface.spacing, tempdb_face[0].surface.spacing,
                        f->surface.mesh.nv * sizeof *f->surface.spacing);
    assert_memory_equal(f->surface.bridge, tempdb_face[0].surface.bridge,
                        f->surface.mesh.nt);
    assert_true(f->surface.measured == tempdb_face[0].surface.measured);

    must(tempdb_store(s, "test", "alice", "K\xc3\xb6ln", &tempdb_face[1], &b, &created,
                      &e));
    must(store_template_list(s, "", "alice", &list, &n, &e));
    assert_int_equal(n, 2);
    assert_string_equal(list[0].id, a.id);
    assert_string_equal(list[1].label, "K\xc3\xb6ln");
    free(list);
    must(store_subject_get(s, "", "alice", &subject, &e));
    assert_int_equal(subject.templates, 2);

    store_close(s); /* it is all in the file */
    s = tempdb_open(STORE_READ);
    must(store_template_get(s, "", b.id, &got, &e));
    assert_memory_equal(&b, &got, sizeof b);
    fails(store_template_delete(s, "", b.id, &e), ST_EDENIED);
    store_close(s);
    s = tempdb_open(STORE_WRITE);
    must(store_template_delete(s, "test", b.id, &e));
    fails(store_template_get(s, "", b.id, &got, &e), ST_ENOTFOUND);
    fails(store_template_delete(s, "test", b.id, &e), ST_ENOTFOUND);
    must(store_verify(s, NULL, NULL, &e));
    surface_face_free(f);
    store_close(s);
}

static enum status after(struct store *s, const char *subject, int face,
                         const char *newest, struct store_template *t, bool *created)
{
    const struct store_sample sample = {.face = &tempdb_face[face]};
    const struct store_enroll what = {.actor = "",
                                      .subject = subject,
                                      .label = "",
                                      .sample = &sample,
                                      .n = 1,
                                      .newest = newest};

    return store_enroll(s, &what, t, created, &e);
}

/* An enrolment that was decided on templates that have changed since. */
TEST(test_enroll_after)
{
    struct store *s = tempdb_fresh();
    struct store_template a, b, t;
    struct store_subject who;
    bool created;

    assert_int_equal(after(s, "alice", 0, "", &a, &created), ST_OK);
    assert_int_equal(after(s, "alice", 1, "", &t, &created), ST_ECHANGED);
    assert_false(created);
    assert_int_equal(after(s, "alice", 0, "", &t, &created), ST_OK);
    assert_false(created); /* the same cloud again changes nothing */
    assert_int_equal(after(s, "alice", 1, a.id, &b, &created), ST_OK);
    assert_true(created);
    assert_int_equal(after(s, "alice", 2, a.id, &t, &created), ST_ECHANGED);
    must(store_template_delete(s, "", b.id, &e));
    assert_int_equal(after(s, "alice", 2, b.id, &t, &created),
                     ST_ECHANGED); /* nothing new, but it cannot know */
    assert_int_equal(after(s, "bob", 2, a.id, &t, &created), ST_ECHANGED);
    fails(store_subject_get(s, "", "bob", &who, &e), ST_ENOTFOUND);
    assert_int_equal(after(s, "alice", 2, a.id, &t, &created), ST_OK);
    store_close(s);
    assert_int_equal(tempdb_count("templates"), 2);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'enroll'"), 3);
}

/* Several samples at once: each a template, but for what is there already; all of them or none. */
TEST(test_enroll_several)
{
    struct store *s = tempdb_fresh();
    char read[65] = "";
    struct store_sample sample[5] = {{.face = &tempdb_face[0]},
                                     {.face = &tempdb_face[1], .read = read},
                                     {.face = &tempdb_face[0]},
                                     {.face = &tempdb_face[2], .read = read}};
    struct store_enroll what = {.actor = "",
                                .subject = "alice",
                                .label = "",
                                .sample = sample,
                                .n = 5,
                                .newest = ""};
    struct surface_face bad = tempdb_face[3]; /* which the database refuses */
    struct store_template t[5], *list;
    struct store_subject who;
    bool created[5];
    size_t n;

    memset(read, 'a', 64);
    bad.surface.mesh.nt = 0;
    sample[4].face = &bad;
    fails(store_enroll(s, &what, t, created, &e), ST_EDB);
    assert_false(created[0] || created[1] || created[4]);
    fails(store_subject_get(s, "", "alice", &who, &e), ST_ENOTFOUND);
    assert_int_equal(tempdb_count("templates"), 0);

    sample[4].face = &tempdb_face[3];
    must(store_enroll(s, &what, t, created, &e));
    assert_true(created[0] && created[1] && !created[2] && !created[3] && created[4]);
    assert_string_equal(t[2].id, t[0].id);
    assert_string_equal(t[3].id, t[1].id);
    must(store_template_list(s, "", "alice", &list, &n, &e));
    assert_int_equal(n, 3);
    assert_string_equal(list[0].id, t[0].id);
    assert_string_equal(list[1].id, t[1].id);
    assert_string_equal(list[2].id, t[4].id);
    free(list);
    must(store_subject_get(s, "", "alice", &who, &e));
    assert_int_equal(who.templates, 3);

    /* behind a sample that is there the last template counts all the same */
    must(store_template_delete(s, "", t[1].id, &e));
    fails(store_enroll(s, &what, t, created, &e), ST_ECHANGED);
    assert_int_equal(tempdb_count("templates"), 2);
    must(store_verify(s, NULL, NULL, &e));
    store_close(s);
    assert_int_equal(tempdb_count("change_log WHERE kind = 'enroll'"), 3);
}

TEST(test_subjects)
{
    struct store *s = tempdb_fresh();
    struct store_template t, gone, *list;
    struct store_subject *page;
    struct store_receipt receipt;
    char name[16];
    int64_t last = 0;
    int seen = 0;
    size_t n;

    for (int i = 0; i < 25; i++) {
        (void)snprintf(name, sizeof name, "s%02d", (i * 7) % 25);
        tempdb_add(s, name);
    }
    do {
        must(store_subject_list(s, last, 10, &page, &n, &e));
        for (size_t i = 0; i < n; i++, seen++) {
            (void)snprintf(name, sizeof name, "s%02d", seen * 7 % 25);
            assert_string_equal(page[i].id, name);
            assert_true(page[i].key > last);
            last = page[i].key;
        }
        free(page);
    } while (n == 10);
    assert_int_equal(seen, 25);
    for (int i = 0; i < 2; i++)
        tempdb_enroll(s, "s03", "", &tempdb_face[i], &t);
    must(store_subject_erase(s, "test", "s03", &receipt, &e));
    assert_int_equal(receipt.templates, 2);
    store_receipt_free(&receipt);
    fails(store_template_list(s, "", "s03", &list, &n, &e), ST_ENOTFOUND);
    assert_null(list);
    fails(store_template_get(s, "", t.id, &gone, &e), ST_ENOTFOUND);
    fails(tempdb_erase(s, "test", "s03", &e), ST_ENOTFOUND);
    store_close(s);
}

TEST(test_bad_arguments)
{
    static const char *const subject[] = {"",         "a b", "a/b", "../a", "a\n",
                                          "\xc3\xa4", "a;b", ".",   ".."};
    struct store *s = tempdb_fresh();
    struct store_template t;
    char longest[STORE_SUBJECT_MAX + 2], text[STORE_LABEL_MAX + 2];
    bool created;

    for (size_t i = 0; i < sizeof subject / sizeof *subject; i++) {
        assert_false(ident_subject_valid(subject[i]));
        fails(tempdb_store(s, "", subject[i], "", &tempdb_face[0], &t, &created, &e),
              ST_EINVAL);
    }
    fails(tempdb_store(s, "", "a", "a\nb", &tempdb_face[0], &t, &created, &e), ST_EINVAL);
    memset(longest, 'x', sizeof longest);
    longest[STORE_SUBJECT_MAX + 1] = '\0';
    assert_false(ident_subject_valid(longest));
    longest[STORE_SUBJECT_MAX] = '\0';
    memset(text, 'y', sizeof text);
    text[STORE_LABEL_MAX + 1] = '\0';
    fails(tempdb_store(s, "", longest, text, &tempdb_face[0], &t, &created, &e),
          ST_EINVAL);
    text[STORE_LABEL_MAX] = '\0';
    must(tempdb_store(s, "", longest, text, &tempdb_face[0], &t, &created, &e));
    assert_string_equal(t.subject, longest);
    assert_string_equal(t.label, text);
    fails(store_template_get(s, "", "nonsense", &t, &e), ST_EINVAL);
    fails(store_template_get(s, "", "0123456789ABCDEF0123456789abcdef", &t, &e),
          ST_EINVAL);
    store_close(s);
}

/* ---- the bytes of the files */

static void take_bytes(void *out, const char *data, size_t n)
{
    memcpy(out, data, n);
}

/* The bytes of a BLOB, as they lie in the file. */
static void blob(const char *text, unsigned char *out)
{
    struct rawdb *d = tempdb_raw();

    must(rawdb_each(d, text, take_bytes, out, &e));
    rawdb_close(d);
}

/* Are these bytes in the database or its WAL? */
static bool in_files(const void *needle, size_t len)
{
    bool found = false;

    if (tempdb_server)
        skip();
    for (int i = 0; i < 2; i++) {
        unsigned char *bytes;
        char name[128];
        FILE *in;
        size_t n;

        (void)snprintf(name, sizeof name, "%s%s", tempdb_path, i == 0 ? "" : "-wal");
        if ((in = fopen(name, "rb")) == NULL)
            continue;
        assert_non_null(bytes = malloc(4 << 20));
        n = fread(bytes, 1, 4 << 20, in);
        (void)fclose(in);
        for (size_t k = 0; k + len <= n; k++)
            found = found || memcmp(bytes + k, needle, len) == 0;
        free(bytes);
    }
    return found;
}

/* A reader is there for longer than an erasure waits: the WAL is truncated when it has
 * ended, by this handle or by one that is closed before the reader ends. */
static void erase_while_read(bool by_another)
{
    struct store *s = tempdb_fresh(), *eraser = s;
    struct store_template t;
    unsigned char key[72];
    struct rawdb *reader;

    tempdb_enroll(s, "gone", "", &tempdb_face[1], &t);
    blob("SELECT key FROM subjects", key);
    if (by_another)
        eraser = tempdb_open(STORE_WRITE);
    reader = tempdb_raw();
    must(rawdb_run(reader, "BEGIN; SELECT count(*) FROM subjects", &e));
    must(tempdb_erase(eraser, "test", "gone", &e));
    if (by_another)
        store_close(eraser);
    assert_true(in_files(key, 16));
    for (int i = 0; i < 2; i++)
        must(store_event(s, "verify", "test", "x", "", "match", &e));
    assert_true(in_files(key, 16));
    rawdb_close(reader);
    must(store_event(s, "verify", "test", "x", "", "match", &e));
    assert_false(in_files(key, 16));
    store_close(s);
}

TEST(test_erased_while_read)
{
    if (tempdb_server)
        skip();
    erase_while_read(false);
    erase_while_read(true);
}

/* What is stored of a subject cannot be read with the file alone. */
TEST(test_encrypted)
{
    struct store *s = tempdb_fresh();
    struct store_subject who = {.id = "mary-jane",
                                .identify = true,
                                .reference = "consent 4711",
                                .purpose = "the front door"};
    struct store_template t;
    unsigned char descriptor[SURFACE_DESCRIPTOR];
    bool created;

    must(store_subject_add(s, "test", &who, &e));
    fails(store_subject_add(s, "test", &who, &e), ST_EEXISTS);
    must(tempdb_store(s, "test", "mary-jane", "left camera", &tempdb_face[1], &t,
                      &created, &e));
    must(store_event(s, "verify", "door", "mary-jane", t.id, "match", &e));
    assert_true(in_files(t.id, 32)); /* the search finds things */
    assert_false(in_files("mary-jane", 9));
    assert_false(in_files("consent 4711", 12));
    assert_false(in_files("front door", 10));
    assert_false(in_files("left camera", 11));
    assert_false(in_files(t.digest, 64));
    assert_false(in_files(tempdb_face[1].surface.mesh.z + 700, 16));
    assert_int_equal(surface_describe(tempdb_work, &tempdb_face[1], descriptor),
                     SURFACE_OK);
    assert_false(in_files(descriptor + 1, 32));
    memset(&who, 0, sizeof who);
    must(store_subject_get(s, "", "mary-jane", &who, &e));
    assert_string_equal(who.reference, "consent 4711");
    assert_string_equal(who.purpose, "the front door");
    assert_int_equal(who.templates, 1);
    store_close(s);
}

/* ---- threads */

#define ROUNDS 40

static void *reader(void *arg)
{
    struct store *s = arg;
    struct surface_work *w = surface_work_new(NULL);
    struct surface_face *f = NULL;
    struct errinfo why;
    intptr_t bad = w == NULL;

    for (int i = 0; i < ROUNDS && !bad; i++) {
        struct store_template *list, got;
        size_t n;
        enum status st = store_template_list(s, "", "alice", &list, &n, &why);

        if (st != ST_OK || n < 1)
            bad = 1;
        for (size_t k = 0; k < n && !bad; k++) {
            st = store_template_load(s, "", list[k].id, &got, w, &f, &why);
            if (st != ST_OK && st != ST_ENOTFOUND) /* deleted meanwhile */
                bad = 1;
        }
        free(list);
    }
    surface_face_free(f);
    surface_work_free(w);
    return (void *)bad;
}

static void *writer(void *arg)
{
    struct store *s = arg;
    struct errinfo why;
    struct store_template t;
    intptr_t bad = 0;
    bool created;

    for (int i = 0; i < ROUNDS && !bad; i++)
        if (tempdb_store(s, "test", "alice", "", &tempdb_face[1 + i % 3], &t, &created,
                         &why) != ST_OK ||
            store_template_delete(s, "test", t.id, &why) != ST_OK)
            bad = 1;
    return (void *)bad;
}

TEST(test_threads)
{
    struct store *s = tempdb_fresh();
    struct store_template t;
    pthread_t thread[5];

    tempdb_enroll(s, "alice", "", &tempdb_face[0], &t);
    for (int i = 0; i < 5; i++)
        assert_int_equal(pthread_create(&thread[i], NULL, i == 0 ? writer : reader, s),
                         0);
    for (int i = 0; i < 5; i++) {
        void *bad;

        assert_int_equal(pthread_join(thread[i], &bad), 0);
        assert_null(bad);
    }
    must(store_verify(s, NULL, NULL, &e));
    assert_int_equal(tempdb_count("templates"), 1);
    store_close(s);
}
