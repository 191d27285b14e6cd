#include "hostile.h"

#include <sodium.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "errinfo.h"
#include "facegen.h"

#define POINTS    110
#define THRESHOLD 8.4321
#define MUST      HOSTILE_MUST

struct errinfo hostile_e;

static const char *const owner[HOSTILE_TEMPLATES] = {"alice", "alice", "bob", "carol"};
static const char *const people[] = {"alice", "bob", "carol"};
static struct surface_face face[HOSTILE_TEMPLATES + 1], *loaded;
static struct store_template tmpl[HOSTILE_TEMPLATES];
static size_t templates;
static char secret[65], revoked[65];
static unsigned char public[CRYPT_KEY]; /* of the device */
static struct surface_work *work;

void hostile_broken(const char *what, const char *file, int line)
{
    (void)fprintf(stderr, "%s:%d: not %s: %s\n", file, line, what, hostile_e.msg);
    abort();
}

/* ---- one of everything */

static void fill(struct store *s)
{
    struct store_calibration k = {
        .fmr = 0.001,
        .low = THRESHOLD - 1,
        .high = THRESHOLD + 1,
        .subjects = 80,
        .impostors = 6320,
        .table = {.threshold = THRESHOLD, .n = 2, .knot = {{-50, 1}, {THRESHOLD, 0.001}}},
    };
    const struct store_subject_change disable = {.disabled = &(bool){true}};
    struct store_recorded settled;
    struct store_subject bob;
    struct store_device device;
    struct log_entry mark;
    struct store_token t;
    bool created;

    for (size_t i = 0; i < templates; i++)
        MUST(store_enroll(s,
                          &(struct store_enroll){
                              .actor = "test",
                              .subject = owner[i],
                              .label = "",
                              .sample = &(struct store_sample){.face = &face[i]},
                              .n = 1},
                          &tmpl[i], &created, &hostile_e) == ST_OK);
    if (templates == HOSTILE_TEMPLATES) {
        MUST(store_subject_set(s, "test", "carol", &disable, &hostile_e) == ST_OK);
        MUST(store_subject_get(s, "", "bob", &bob, &hostile_e) == ST_OK);
        MUST(store_record_verification(s,
                                       &(struct store_record){.subject = &bob,
                                                              .as = STORE_RECORD_FAILED,
                                                              .actor = "test",
                                                              .kind = "verify",
                                                              .template_id = "",
                                                              .outcome = "no_match"},
                                       &settled, &hostile_e) == ST_OK);
    }
    MUST(store_calibration_add(s, "test", &k, &hostile_e) == ST_OK);
    MUST(store_device_add(s, "test", "door", public, &device, &hostile_e) == ST_OK);
    MUST(store_token_create(s, "test", "lost", STORE_SCOPE_ALL, "", 0, revoked, &t,
                            &hostile_e) == ST_OK);
    MUST(store_token_revoke(s, "test", t.id, &hostile_e) == ST_OK);
    MUST(store_token_create(s, "test", "gate", STORE_SCOPE_VERIFY, "", 0, secret, &t,
                            &hostile_e) == ST_OK);
    MUST(store_audit_sign(s, "test", "checkpoint", &mark, NULL, &hostile_e) == ST_OK);
}

unsigned char *hostile_make(const char *path, const struct store_key *key, size_t n,
                            size_t *size)
{
    static struct dvec3 pts[POINTS];
    unsigned char own[crypto_sign_SECRETKEYBYTES], *bytes;
    struct facegen_scan scan;
    struct store *s;
    struct stat sb;
    sqlite3 *db;
    FILE *f;

    templates = n;
    MUST((work = surface_work_new(NULL)) != NULL);
    (void)crypto_sign_keypair(public, own);
    facegen_default(&scan);
    scan.points = POINTS;
    for (size_t i = 0; i < sizeof face / sizeof *face; i++) {
        scan.subject = i;
        MUST(face_build(pts, facegen_sample(&scan, pts), work, &face[i], NULL) == ST_OK);
    }
    MUST(store_open(path, STORE_CREATE, key, &s, &hostile_e) == ST_OK);
    fill(s);
    store_close(s);
    MUST(sqlite3_open(path, &db) == SQLITE_OK &&
         sqlite3_exec(db, "PRAGMA journal_mode=DELETE; PRAGMA page_size=512; VACUUM",
                      NULL, NULL, NULL) == SQLITE_OK);
    (void)sqlite3_close(db);
    MUST((f = fopen(path, "rb")) != NULL && fstat(fileno(f), &sb) == 0);
    *size = (size_t)sb.st_size;
    MUST((bytes = malloc(*size)) != NULL && fread(bytes, 1, *size, f) == *size);
    (void)fclose(f);
    return bytes;
}

void hostile_end(void)
{
    for (size_t i = 0; i < sizeof face / sizeof *face; i++)
        face_free(&face[i]);
    surface_face_free(loaded);
    loaded = NULL;
    surface_work_free(work);
}

const struct surface_face *hostile_face(void)
{
    return &face[HOSTILE_TEMPLATES];
}

/* ---- what reads may return */

static void check_template(struct store *s, const char *subject,
                           const struct store_template *t)
{
    const struct mesh *m, *was;
    struct store_template got;
    size_t i = 0;

    while (i < HOSTILE_TEMPLATES &&
           (strcmp(t->digest, tmpl[i].digest) != 0 || strcmp(owner[i], subject) != 0))
        i++;
    MUST(i < HOSTILE_TEMPLATES && memcmp(t, &tmpl[i], sizeof *t) == 0);
    if (store_template_load(s, "", t->id, &got, work, &loaded, &hostile_e) != ST_OK)
        return;
    m = &loaded->surface.mesh;
    was = &face[i].surface.mesh;
    MUST(memcmp(&got, &tmpl[i], sizeof got) == 0);
    MUST(m->nv == was->nv && m->nt == was->nt);
    MUST(memcmp(m->xy, was->xy, m->nv * sizeof *m->xy) == 0);
    MUST(memcmp(m->z, was->z, m->nv * sizeof *m->z) == 0);
}

static size_t enrolled(const char *subject)
{
    size_t n = 0;

    for (size_t i = 0; i < templates; i++)
        n += strcmp(owner[i], subject) == 0;
    return n;
}

static unsigned ask_subject(struct store *s, const char *subject)
{
    const size_t wanted = enrolled(subject);
    struct store_template *list;
    struct store_subject one;
    unsigned answers = 0;
    size_t n;

    if (store_subject_get(s, "", subject, &one, &hostile_e) == ST_OK) {
        MUST(wanted > 0 && strcmp(one.id, subject) == 0);
        MUST(one.disabled == (strcmp(subject, "carol") == 0));
        answers++;
    }
    if (store_template_list(s, "", subject, &list, &n, &hostile_e) != ST_OK)
        return answers;
    MUST(wanted > 0);
    for (size_t i = 0; i < n; i++)
        check_template(s, subject, &list[i]);
    free(list);
    return answers + (n == wanted);
}

unsigned hostile_ask(struct store *s)
{
    struct store_calibration k;
    struct store_device *devices;
    struct store_token t;
    unsigned answers = 0;
    size_t n;

    if (store_token_check(s, secret, &t, &hostile_e) == ST_OK) {
        MUST(t.scopes == STORE_SCOPE_VERIFY && t.expires[0] == '\0');
        answers++;
    }
    MUST(store_token_check(s, revoked, &t, &hostile_e) != ST_OK);
    if (store_calibration_get(s, &k, &hostile_e) == ST_OK) {
        MUST(!k.shipped && k.table.threshold == THRESHOLD);
        answers++;
    }
    if (store_device_list(s, &devices, &n, &hostile_e) == ST_OK) {
        for (size_t i = 0; i < n; i++)
            MUST(strcmp(devices[i].name, "door") == 0 &&
                 memcmp(devices[i].public, public, sizeof public) == 0);
        free(devices);
        answers += n == 1;
    }
    for (size_t i = 0; i < sizeof people / sizeof *people; i++)
        answers += ask_subject(s, people[i]);
    return answers;
}

unsigned hostile_reads(void)
{
    unsigned n = 3;

    for (size_t i = 0; i < sizeof people / sizeof *people; i++)
        n += enrolled(people[i]) > 0 ? 2 : 0;
    return n;
}
