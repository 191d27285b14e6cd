#include "people.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cloudfile.h"
#include "facegen.h"
#include "study.h"

#define FILE_MAX ((size_t)1 << 25)

void people_made_up(uint64_t first, size_t n, struct surface_work *w, struct person *p)
{
    struct dvec3 *pts = study_alloc(PEOPLE_POINTS, sizeof *pts);

    for (size_t i = 0; i < n; i++) {
        struct facegen_scan scan;

        facegen_default(&scan);
        scan.subject = first + i;
        facegen_pose(&scan, 3, 4);
        study_must(face_build(pts, facegen_sample(&scan, pts), w, &p[i].template, NULL));
        scan.scan = 1;
        facegen_pose(&scan, 8, 12);
        p[i].probe = study_alloc(PEOPLE_POINTS, sizeof *pts);
        p[i].n = facegen_sample(&scan, p[i].probe);
        (void)snprintf(p[i].name, sizeof p->name, "made up %zu", i);
    }
    free(pts);
}

struct dvec3 *people_points(const char *dir, const char *name, size_t *n)
{
    static const struct cloudfile_options options = {.max_points = CLOUDFILE_POINTS,
                                                     .max_bytes = FILE_MAX};
    struct cloudpoints scan;
    struct dvec3 *copy = NULL;
    unsigned char *bytes;
    char path[4096];
    FILE *f;

    (void)snprintf(path, sizeof path, "%s/%s", dir, name);
    if ((f = fopen(path, "rb")) == NULL)
        return NULL;
    bytes = study_alloc(FILE_MAX + 1, 1);
    *n = fread(bytes, 1, FILE_MAX, f);
    bytes[*n] = '\0';
    if (cloudfile_read(bytes, *n, &options, &scan, NULL) == ST_OK) {
        *n = scan.n;
        copy = study_alloc(*n, sizeof *copy);
        memcpy(copy, scan.at, *n * sizeof *copy);
        cloudpoints_free(&scan);
    }
    free(bytes);
    (void)fclose(f);
    return copy;
}

static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

static int enrolled(const struct dirent *e)
{
    return strstr(e->d_name, "_enroll.ply") != NULL;
}

size_t people_scanned(const char *dir, const char *kind, size_t most,
                      struct surface_work *w, struct person *p)
{
    struct dirent **list = NULL;
    const int files = scandir(dir, &list, enrolled, by_name);
    size_t people = 0;

    for (int i = 0; i < files; i++) {
        char name[512];
        size_t n = 0;
        struct dvec3 *pts = people_points(dir, list[i]->d_name, &n);
        const int who = (int)strcspn(list[i]->d_name, "_");

        (void)snprintf(name, sizeof name, "%.*s_%s.ply", who, list[i]->d_name, kind);
        if (people < most && pts != NULL &&
            face_build(pts, n, w, &p[people].template, NULL) == ST_OK &&
            (p[people].probe = people_points(dir, name, &p[people].n)) != NULL) {
            name[who] = '\0';
            (void)snprintf(p[people++].name, sizeof p->name, "%.31s", name);
        }
        free(pts);
        free(list[i]);
    }
    free(list);
    return people;
}

void people_free(struct person *p, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        face_free(&p[i].template);
        free(p[i].probe);
    }
}

size_t people_relatives(const char *dir, const struct person *p, size_t n,
                        size_t *relative)
{
    char path[4096], line[512];
    size_t pairs = 0;
    FILE *f;

    for (size_t i = 0; i < n; i++)
        relative[i] = i;
    (void)snprintf(path, sizeof path, "%s/subjects.csv", dir);
    f = fopen(path, "r");
    while (f != NULL && fgets(line, sizeof line, f) != NULL) {
        char *other = strrchr(line, ',');

        line[strcspn(line, "\r\n")] = '\0';
        line[strcspn(line, ",")] = '\0';
        for (size_t i = 0; i < n && other != NULL; i++)
            for (size_t j = 0; j < n; j++)
                if (strcmp(p[i].name, line) == 0 && strcmp(p[j].name, other + 1) == 0) {
                    relative[i] = j;
                    pairs++;
                }
    }
    if (f != NULL)
        (void)fclose(f);
    return pairs;
}
