/* cloudaccessor.h -- arrays of numbers in the binary chunk of a GLB file, as its JSON
 * describes them (glTF 2.0, section 3.6).  For cloudglb.c. */
#ifndef SCAN_CLOUDACCESSOR_H
#define SCAN_CLOUDACCESSOR_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "cloudvalue.h"
#include "status.h"

struct errinfo;    /* errinfo.h */
struct json_value; /* json.h */

/* The values of an array of the document. */
struct cloudaccessor_items {
    const struct json_value **at; /* by mem_free() */
    size_t n;
};

/* cloudaccessor_items(document, name, out, e): of its member, an array of objects; none: no
 * items.  Returns ST_OK, ST_EINVAL, ST_ENOMEM. */
enum status cloudaccessor_items(const struct json_value *document, const char *name,
                                struct cloudaccessor_items *out, struct errinfo *e);

struct cloudaccessor_file {
    struct cloudaccessor_items accessors, views, buffers;
    const unsigned char *bin;
    size_t len;
    struct errinfo *e;
};

struct cloudaccessor {
    const unsigned char *at;
    size_t n, stride;
    enum cloudvalue type;
    double scale; /* of a value */
};

/* cloudaccessor_open(f, index, type, out): an accessor of the type "VEC3" or "SCALAR", all of
 * which is in the chunk.
 * Returns ST_OK; ST_EINVAL; ST_EVERSION: sparse, or its data is elsewhere. */
enum status cloudaccessor_open(const struct cloudaccessor_file *f, uint64_t index,
                               const char *type, struct cloudaccessor *out);

/* cloudaccessor_get(a, i, k): component k of its element i. */
double cloudaccessor_get(const struct cloudaccessor *a, size_t i, size_t k);

#endif
