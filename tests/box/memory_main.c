/* memory -- for the tests: counts the points of scans in a process's memory.
 *   memory PID FILE...
 * FILE: a binary PLY of float32, as facegen writes it; of a large scan some 3,000 points are looked
 * for, as of more some would be found by chance.  Prints how many are there as three float32, as
 * three doubles, and as x and y of an int32 lattice in um; where each is, on stderr.
 * Exit status: 1 if the memory cannot be read. */
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_POINTS  3000
#define MOST_NEEDLES 100000
#define BLOCK        ((size_t)1 << 20)
#define LONGEST      24

enum form { AS_FLOAT, AS_DOUBLE, AS_LATTICE, FORMS };

static const size_t length[FORMS] = {12, 24, 8};
static const char *const name[FORMS] = {"float32", "double", "lattice"};

struct needle {
    unsigned char bytes[LONGEST];
    enum form form;
    bool found;
};

static struct needle needle[MOST_NEEDLES];
static size_t n;
static unsigned char
    begins[1 << 16]; /* whether a needle begins with 8 bytes of this hash */

static void fail(const char *what)
{
    perror(what);
    exit(1);
}

/* The first 8 bytes. */
static uint64_t first(const unsigned char *bytes)
{
    uint64_t word;

    memcpy(&word, bytes, sizeof word);
    return word;
}

static unsigned hash(uint64_t word)
{
    return (unsigned)((word * 0x9e3779b97f4a7c15u) >> 48);
}

static int by_first(const void *a, const void *b)
{
    const uint64_t x = first(((const struct needle *)a)->bytes),
                   y = first(((const struct needle *)b)->bytes);

    return (x > y) - (x < y);
}

static void add(enum form form, const void *bytes)
{
    if (n == MOST_NEEDLES) {
        (void)fprintf(stderr, "memory: too many points\n");
        exit(2);
    }
    needle[n].form = form;
    memcpy(needle[n].bytes, bytes, length[form]);
    begins[hash(first(needle[n++].bytes))] = 1;
}

/* Returns true if um can be the upper half of a pointer: with the number beside it, it would be a point by
 * chance. */
static bool half_pointer(int32_t um)
{
    const int32_t high = um >> 8;

    return high == 0x55 || high == 0x56 || high == 0x7f;
}

static void add_lattice(const float *p)
{
    const int32_t um[] = {(int32_t)lround(1000.0 * p[0]), (int32_t)lround(1000.0 * p[1])};

    if (!half_pointer(um[0]) && !half_pointer(um[1]))
        add(AS_LATTICE, um);
}

static void add_file(const char *path)
{
    FILE *f = fopen(path, "rb");
    unsigned long count = 0, step;
    float p[3];
    char line[200];

    if (f == NULL)
        fail(path);
    while (fgets(line, sizeof line, f) != NULL && strcmp(line, "end_header\n") != 0)
        if (strncmp(line, "element vertex ", 15) == 0)
            count = strtoul(line + 15, NULL, 10);
    step = count > MOST_POINTS ? count / MOST_POINTS : 1;
    for (unsigned long i = 0; i < count; i++) {
        if (fread(p, sizeof p, 1, f) != 1)
            fail(path);
        if (i % step == 0) {
            add(AS_FLOAT, p);
            add(AS_DOUBLE, (const double[]){p[0], p[1], p[2]});
            add_lattice(p);
        }
    }
    (void)fclose(f);
}

/* Marks the needles that begin in the first begin bytes of the block, and prints their places on stderr. */
static void look(const unsigned char *block, size_t begin, size_t size, uint64_t address,
                 const char *mapping)
{
    for (size_t at = 0; at < begin && at + 8 <= size; at += 4) {
        const uint64_t word = first(block + at);
        size_t low = 0, high = n;

        if (!begins[hash(word)])
            continue;
        while (low < high) {
            const size_t mid = (low + high) / 2;

            if (first(needle[mid].bytes) < word)
                low = mid + 1;
            else
                high = mid;
        }
        for (; low < n && first(needle[low].bytes) == word; low++) {
            const size_t len = length[needle[low].form];

            if (at + len <= size && memcmp(block + at, needle[low].bytes, len) == 0) {
                needle[low].found = true;
                (void)fprintf(stderr, "%s at %" PRIx64 " of %s", name[needle[low].form],
                              address + at, mapping);
            }
        }
    }
}

static void look_in(int mem, uint64_t from, uint64_t to, const char *mapping)
{
    static unsigned char block[BLOCK + LONGEST];

    for (; from < to; from += BLOCK) {
        const size_t begin = to - from < BLOCK ? (size_t)(to - from) : BLOCK,
                     most = to - from < sizeof block ? (size_t)(to - from) : sizeof block;
        const ssize_t got = pread(mem, block, most, (off_t)from);

        if (got > 0)
            look(block, begin < (size_t)got ? begin : (size_t)got, (size_t)got, from,
                 mapping);
    }
}

static FILE *open_maps(const char *pid, int *mem)
{
    char path[64];
    FILE *maps;

    (void)snprintf(path, sizeof path, "/proc/%s/maps", pid);
    if ((maps = fopen(path, "r")) == NULL)
        fail(path);
    (void)snprintf(path, sizeof path, "/proc/%s/mem", pid);
    if ((*mem = open(path, O_RDONLY)) < 0)
        fail(path);
    return maps;
}

int main(int argc, char **argv)
{
    unsigned long found[FORMS] = {0};
    char line[1000];
    FILE *maps;
    int mem;

    if (argc < 2) {
        (void)fprintf(stderr, "usage: memory PID FILE...\n");
        return 64;
    }
    for (int i = 2; i < argc; i++)
        add_file(argv[i]);
    qsort(needle, n, sizeof needle[0], by_first);
    maps = open_maps(argv[1], &mem);
    while (fgets(line, sizeof line, maps) != NULL) {
        char *rest;
        const uint64_t from = strtoull(line, &rest, 16),
                       to = strtoull(rest + 1, &rest, 16);

        if (strncmp(rest, " rw", 3) == 0)
            look_in(mem, from, to, line);
    }
    for (size_t i = 0; i < n; i++)
        found[needle[i].form] += needle[i].found;
    (void)printf("%lu %lu %lu\n", found[AS_FLOAT], found[AS_DOUBLE], found[AS_LATTICE]);
    return 0;
}
