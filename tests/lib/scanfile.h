/* scanfile.h -- scanners' files made in memory, and read as cloudfile_read() does. */
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

void scanfile_put(struct scanfile *f, const void *bytes, size_t len);
void scanfile_text(struct scanfile *f, const char *text);

/* The low size bytes of value; a float or a double. */
void scanfile_whole(struct scanfile *f, uint64_t value, unsigned size, bool big);
void scanfile_real(struct scanfile *f, double value, unsigned size, bool big);

/* By these options, from a copy of exactly len bytes and a 0; line: of the message, or 0;
 * what: the message without its place.  Checks what holds on every failure. */
struct scanfile_said {
    char msg[480];
    uint32_t line;
    size_t where;
    const char *what;
};
enum status scanfile_read(const void *bytes, size_t len,
                          const struct cloudfile_options *o, struct cloudpoints *out,
                          struct scanfile_said *err);

/* It is read, as this format or as what it is recognised to be. */
void scanfile_good(const struct scanfile *f, enum cloudformat format,
                   struct cloudpoints *out);
/* It is not, for this reason, and with these words in the message. */
void scanfile_bad(const struct scanfile *f, enum cloudformat format, enum status want,
                  const char *words);
/* scanfile_refused(c, n): each text is not read, for its reason, and with these words. */
struct scanfile_case {
    const char *text;
    enum status st;
    const char *words;
};
void scanfile_refused(const struct scanfile_case *c, size_t n);
/* The text is read, as what it is recognised to be. */
void scanfile_good_text(const char *text, struct cloudpoints *out);
/* However much of the file's end is missing. */
void scanfile_cut(const struct scanfile *f, enum cloudformat format);

void scanfile_at(struct dvec3 p, double x, double y, double z);

#endif
