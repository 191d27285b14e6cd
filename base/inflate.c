#define ZLIB_CONST /* zlib only reads its input */
#include "inflate.h"

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include "errinfo.h"
#include "mem.h"

#define FIRST_ROOM      65536
#define ZSTD_WINDOW_LOG 23        /* 8 MB: what RFC 9659 allows a sender */
#define GZIP_WINDOW     (15 + 16) /* 32 KB, the gzip format alone */

/* The decompressed bytes.  size grows by doubling up to limit + 1: the byte beyond the
 * limit separates "just as long" from "longer", and holds the final 0. */
struct sink {
    unsigned char *data;
    size_t len, size, limit;
    const char *why; /* reason of a failure; static */
};

/* Room for at least one more byte.  Returns ST_OK, ST_ESIZE, ST_ENOMEM. */
static enum status inflate_grow(struct sink *s)
{
    size_t size = s->size == 0 ? FIRST_ROOM : 2 * s->size;
    unsigned char *data;

    if (s->len < s->size)
        return ST_OK;
    if (s->size > s->limit)
        return ST_ESIZE;
    if (size > s->limit)
        size = s->limit + 1;
    data = mem_grow(s->data, s->len, size);
    if (data == NULL)
        return ST_ENOMEM;
    s->data = data;
    s->size = size;
    return ST_OK;
}

static unsigned least(size_t n)
{
    return n < UINT_MAX ? (unsigned)n : UINT_MAX;
}

static enum status gunzip(const unsigned char *in, size_t len, struct sink *s)
{
    z_stream z = {0};
    size_t used = 0;
    enum status st = ST_OK;
    int got;

    if (inflateInit2(&z, GZIP_WINDOW) != Z_OK)
        return ST_ENOMEM;
    do {
        unsigned given = least(len - used), room;

        if ((st = inflate_grow(s)) != ST_OK)
            break;
        room = least(s->size - s->len);
        z.next_in = in + used;
        z.avail_in = given;
        z.next_out = s->data + s->len;
        z.avail_out = room;
        got = inflate(&z, Z_NO_FLUSH);
        used += given - z.avail_in;
        s->len += room - z.avail_out;
        if (got == Z_STREAM_END && used < len) /* a file may have several members */
            got = inflateReset(&z);
        if (got == Z_MEM_ERROR) {
            st = ST_ENOMEM;
        } else if (got != Z_OK &&
                   got != Z_STREAM_END) { /* Z_BUF_ERROR: no more to read */
            s->why = got == Z_BUF_ERROR ? "it ends too early" : z.msg;
            st = ST_EINVAL;
        }
    } while (st == ST_OK && got != Z_STREAM_END);
    (void)inflateEnd(&z);
    return st;
}

/* Does a frame of RFC 8878 begin here, one with data or one to skip?  The library may also
 * read the formats of older versions, which no client needs. */
static bool frame_begins(const unsigned char *in, size_t len)
{
    uint32_t magic;

    if (len < 4)
        return false;
    magic = (uint32_t)in[0] | (uint32_t)in[1] << 8 | (uint32_t)in[2] << 16 |
            (uint32_t)in[3] << 24;
    return magic == ZSTD_MAGICNUMBER ||
           (magic & ZSTD_MAGIC_SKIPPABLE_MASK) == ZSTD_MAGIC_SKIPPABLE_START;
}

static enum status unzstd(const unsigned char *in, size_t len, struct sink *s)
{
    ZSTD_DStream *z = ZSTD_createDStream();
    ZSTD_inBuffer from = {in, len, 0};
    enum status st = ST_OK;
    size_t left = 0; /* 0: between two frames */

    if (z == NULL ||
        ZSTD_isError(ZSTD_DCtx_setParameter(z, ZSTD_d_windowLogMax, ZSTD_WINDOW_LOG)))
        st = ST_ENOMEM;
    while (st == ST_OK && (left != 0 || from.pos < from.size)) {
        ZSTD_outBuffer to;

        if (left == 0 && !frame_begins(in + from.pos, len - from.pos)) {
            s->why = "no frame begins there";
            st = ST_EINVAL;
            break;
        }
        if ((st = inflate_grow(s)) != ST_OK)
            break;
        to = (ZSTD_outBuffer){s->data + s->len, s->size - s->len, 0};
        left = ZSTD_decompressStream(z, &to, &from);
        s->len += to.pos;
        if (ZSTD_isError(left)) {
            s->why = ZSTD_getErrorName(left);
            st = ZSTD_getErrorCode(left) == ZSTD_error_memory_allocation ? ST_ENOMEM
                                                                         : ST_EINVAL;
        } else if (left != 0 && from.pos == from.size && to.pos < to.size) {
            s->why = "it ends too early"; /* all is read, all is written */
            st = ST_EINVAL;
        }
    }
    (void)ZSTD_freeDStream(z);
    return st;
}

enum inflate_coding inflate_coding(const char *value)
{
    static const struct {
        const char *name;
        enum inflate_coding coding;
    } known[] = {
        {"identity", INFLATE_NONE},
        {"gzip", INFLATE_GZIP},
        {"x-gzip", INFLATE_GZIP}, /* the same by RFC 9110 section 8.4.1.3 */
        {"zstd", INFLATE_ZSTD},
    };
    size_t len;

    if (value == NULL)
        return INFLATE_NONE;
    value += strspn(value, " \t");
    len = strcspn(value, " \t");
    if (value[len + strspn(value + len, " \t")] != '\0')
        return INFLATE_OTHER;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (strlen(known[i].name) == len && strncasecmp(value, known[i].name, len) == 0)
            return known[i].coding;
    return INFLATE_OTHER;
}

enum status inflate_body(enum inflate_coding coding, const unsigned char *in, size_t len,
                         size_t limit, unsigned char **out, size_t *outlen,
                         struct errinfo *e)
{
    const char *name = coding == INFLATE_GZIP ? "gzip" : "zstd";
    struct sink s = {.limit = limit};
    enum status st = coding == INFLATE_GZIP ? gunzip(in, len, &s) : unzstd(in, len, &s);

    *out = NULL;
    *outlen = 0;
    if (st == ST_OK)
        st = s.len > limit ? ST_ESIZE : inflate_grow(&s); /* for the final 0 */
    if (st != ST_OK) {
        mem_free(s.data);
        if (st == ST_ESIZE)
            return errinfo_set(e, st, "the limit is %zu bytes when unpacked", limit);
        if (st == ST_EINVAL)
            return errinfo_set(e, st, "%s, after %zu bytes unpacked: %s", name, s.len,
                               s.why != NULL ? s.why : "damaged");
        return errinfo_set(e, st, "no memory to unpack the body");
    }
    s.data[s.len] = 0;
    *out = s.data;
    *outlen = s.len;
    return ST_OK;
}
