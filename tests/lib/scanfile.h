/* scanfile.h -- files of scanners, made in memory and read by cloudfile_read(). */
#ifndef TESTS_SCANFILE_H
#define TESTS_SCANFILE_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "cloudfile.h"

#define SCANFILE_LIMIT 100000

struct scanfile {
    unsigned char bytes[65536];
    size_t len;
};

/* scanfile_put(f, bytes, len), scanfile_text(f, text): Append to f. */
void scanfile_put(struct scanfile *f, const void *bytes, size_t len);
void scanfile_text(struct scanfile *f, const char *text);

/* scanfile_whole(f, value, size, big): Appends the low size bytes of value. */
void scanfile_whole(struct scanfile *f, uint64_t value, unsigned size, bool big);

/* scanfile_real(f, value, size, big): Appends a float (size 4) or a double. */
void scanfile_real(struct scanfile *f, double value, unsigned size, bool big);

struct scanfile_said {
    char msg[480];
    uint32_t line;    /* line that the message names, or 0 */
    size_t where;     /* byte that it names, or 0 */
    const char *what; /* message without its place */
};

/* scanfile_read(bytes, len, o, out, err): Reads a copy of exactly len bytes and a 0, and checks the
 * invariants of success and failure. */
enum status scanfile_read(const void *bytes, size_t len,
                          const struct cloudfile_options *o, struct cloudpoints *out,
                          struct scanfile_said *err);

/* scanfile_good(f, format, out): Fails the test unless f is read. */
void scanfile_good(const struct scanfile *f, enum cloudformat format,
                   struct cloudpoints *out);

/* scanfile_good_text(text, out): Fails the test unless the text is read, in the recognised format. */
void scanfile_good_text(const char *text, struct cloudpoints *out);

/* scanfile_bad(f, format, want, words): Fails the test unless f is refused with this status and with
 * these words in the message. */
void scanfile_bad(const struct scanfile *f, enum cloudformat format, enum status want,
                  const char *words);

struct scanfile_case {
    const char *text;
    enum status st;
    const char *words;
};

/* scanfile_refused(c, n): Calls scanfile_bad() for n texts. */
void scanfile_refused(const struct scanfile_case *c, size_t n);

/* scanfile_cut(f, format): Fails the test if any proper prefix of f is read. */
void scanfile_cut(const struct scanfile *f, enum cloudformat format);

/* scanfile_at(p, x, y, z): Fails the test unless p is (x, y, z). */
void scanfile_at(struct dvec3 p, double x, double y, double z);

#endif
