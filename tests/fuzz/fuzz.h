/* fuzz.h -- included by every fuzzer.  `make fuzz` links a fuzzer with clang's libFuzzer; built
 * like any other test it has the main() below, which runs the seed corpus
 * tests/fuzz/corpus/NAME (or the given files) and some thousand changed copies of each file.
 * The copies come from a fixed seed: they are the same on every run, with any compiler. */
#ifndef TESTS_FUZZ_H
#define TESTS_FUZZ_H
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

/* Ends the program, as a crash that is reported, unless the condition holds. */
static inline void require(int condition)
{
    if (!condition)
        abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#ifndef FUZZ_LIBFUZZER
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef FUZZ_ROUNDS
#define FUZZ_ROUNDS 1500
#endif
#define FUZZ_SEED 7

static uint64_t fuzz_state = FUZZ_SEED;

static size_t fuzz_below(size_t n) /* splitmix64 */
{
    uint64_t z = fuzz_state += UINT64_C(0x9E3779B97F4A7C15);

    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (size_t)((z ^ (z >> 31)) % n);
}

/* Changes data in place; it has room for twice its size.  Returns the new size. */
static size_t fuzz_change(uint8_t *data, size_t size)
{
    static const uint8_t odd[] = {0,   1,   127,  128, 255, '-',
                                  '0', '9', '\n', ' ', '"', '['};
    const size_t at = fuzz_below(size), len = fuzz_below(size - at < 64 ? size - at : 64);

    switch (fuzz_below(5)) {
    case 0:
        data[at] ^= (uint8_t)(1U << fuzz_below(8));
        return size;
    case 1:
        data[at] = odd[fuzz_below(sizeof odd)];
        return size;
    case 2: /* remove a piece */
        memmove(data + at, data + at + len, size - at - len);
        return size - len;
    case 3: /* duplicate a piece */
        memmove(data + at + len, data + at, size - at);
        return size + len;
    default:
        return at + 1;
    }
}

static int fuzz_file(const char *path)
{
    FILE *in = fopen(path, "rb");
    uint8_t *seed = malloc(1 << 20);
    size_t size;

    if (in == NULL || seed == NULL || (size = fread(seed, 1, 1 << 20, in)) == 0) {
        (void)fprintf(stderr, "%s: cannot be read\n", path);
        exit(1);
    }
    (void)fclose(in);
    (void)LLVMFuzzerTestOneInput(seed, size);
    for (int round = 0; round < FUZZ_ROUNDS; round++) {
        uint8_t *copy = malloc(2 * size + 256), *exact;
        size_t n = size;

        if (copy == NULL)
            exit(1);
        memcpy(copy, seed, size);
        for (size_t changes = 1 + fuzz_below(4); changes > 0 && n > 0 && n < 2 * size;
             changes--)
            n = fuzz_change(copy, n);
        if ((exact = realloc(copy, n != 0 ? n : 1)) == NULL)
            exit(1);
        (void)LLVMFuzzerTestOneInput(exact, n);
        free(exact);
    }
    free(seed);
    return 1;
}

int main(int argc, char **argv)
{
    const char *name = strstr(argv[0], "fuzz_");
    char path[512];
    struct dirent *entry;
    DIR *dir;
    int files = 0;

    for (int i = 1; i < argc; i++)
        files += fuzz_file(argv[i]);
    if (argc == 1 && name != NULL) {
        (void)snprintf(path, sizeof path, "tests/fuzz/corpus/%s", name + strlen("fuzz_"));
        if ((dir = opendir(path)) == NULL) {
            (void)fprintf(stderr, "%s: no corpus\n", path);
            return 1;
        }
        while ((entry = readdir(dir)) != NULL) {
            (void)snprintf(path, sizeof path, "tests/fuzz/corpus/%s/%s",
                           name + strlen("fuzz_"), entry->d_name);
            if (entry->d_name[0] != '.')
                files += fuzz_file(path);
        }
        (void)closedir(dir);
    }
    (void)printf("%d files, %d changed copies each, seed %d\n", files, FUZZ_ROUNDS,
                 FUZZ_SEED);
    return files == 0;
}
#endif

#endif
