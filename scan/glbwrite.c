#include "glbwrite.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"

/* glTF 2.0's names for numbers. */
enum {
    BYTE = 5121,
    SHORT = 5123,
    INT = 5125,
    FLOAT = 5126,
    VERTICES = 34962,
    INDICES = 34963,
    POINTS = 0,
    TRIANGLES = 4
};

/* An array of the binary chunk: an accessor with a view of its own. */
struct part {
    const char *name; /* of the attribute; NULL: indices */
    const void *from;
    size_t bytes, count;
    const char *type;
    int number;
    bool narrow; /* from has indices of 32 bits, the file of 16 */
    bool bounds; /* glTF wants the least and the greatest of positions */
    size_t node;
};

#define PARTS_OF_NODE (3 + GLBWRITE_SCALARS)

static size_t glbwrite_add(struct part *p, const struct part *what, size_t *n)
{
    p[*n] = *what;
    return (*n)++;
}

/* The parts of a node, in their order; how many. */
static size_t parts_of(const struct glbwrite_node *node, size_t index, struct part *p)
{
    const bool narrow = node->n <= 65535;
    size_t n = 0;

    glbwrite_add(p,
                 &(struct part){"POSITION", node->at, (size_t)node->n * 12, node->n,
                                "VEC3", FLOAT, false, true, index},
                 &n);
    if (node->color != NULL)
        glbwrite_add(p,
                     &(struct part){"COLOR_0", node->color, (size_t)node->n * 4, node->n,
                                    "VEC4", BYTE, false, false, index},
                     &n);
    for (int i = 0; i < GLBWRITE_SCALARS && node->scalar[i].name != NULL; i++)
        glbwrite_add(p,
                     &(struct part){node->scalar[i].name, node->scalar[i].value,
                                    (size_t)node->n * 4, node->n, "SCALAR", FLOAT, false,
                                    false, index},
                     &n);
    if (node->triangles > 0)
        glbwrite_add(p,
                     &(struct part){NULL, node->triangle,
                                    (size_t)node->triangles * (narrow ? 6 : 12),
                                    (size_t)node->triangles * 3, "SCALAR",
                                    narrow ? SHORT : INT, narrow, false, index},
                     &n);
    return n;
}

static size_t glbwrite_padded(size_t bytes)
{
    return (bytes + 3) & ~(size_t)3;
}

static void bounds(struct json *j, const struct part *p)
{
    const float *at = p->from;
    float least[3], most[3];

    memcpy(least, at, sizeof least);
    memcpy(most, at, sizeof most);
    for (size_t i = 3; i < 3 * p->count; i++) {
        if (at[i] < least[i % 3])
            least[i % 3] = at[i];
        if (at[i] > most[i % 3])
            most[i % 3] = at[i];
    }
    json_array(j, "min");
    for (int k = 0; k < 3; k++)
        json_exact(j, NULL, (double)least[k]);
    json_close(j);
    json_array(j, "max");
    for (int k = 0; k < 3; k++)
        json_exact(j, NULL, (double)most[k]);
    json_close(j);
}

static void describe_parts(struct json *j, const struct part *p, size_t n, size_t bytes)
{
    size_t offset = 0;

    json_array(j, "accessors");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        json_number(j, "bufferView", (double)i);
        json_number(j, "componentType", p[i].number);
        json_number(j, "count", (double)p[i].count);
        json_text(j, "type", p[i].type);
        if (p[i].number == BYTE)
            json_flag(j, "normalized", true);
        if (p[i].bounds)
            bounds(j, &p[i]);
        json_close(j);
    }
    json_close(j);
    json_array(j, "bufferViews");
    for (size_t i = 0; i < n; i++) {
        json_object(j, NULL);
        json_number(j, "buffer", 0);
        json_number(j, "byteOffset", (double)offset);
        json_number(j, "byteLength", (double)p[i].bytes);
        json_number(j, "target", p[i].name == NULL ? INDICES : VERTICES);
        json_close(j);
        offset += glbwrite_padded(p[i].bytes);
    }
    json_close(j);
    json_array(j, "buffers");
    json_object(j, NULL);
    json_number(j, "byteLength", (double)bytes);
    json_close(j);
    json_close(j);
}

/* The scene: each node has a mesh, which has one primitive of the parts that are the node's. */
static void describe_nodes(struct json *j, const struct glbwrite_node *node, size_t nodes,
                           const struct part *p, size_t n)
{
    json_array(j, "meshes");
    for (size_t i = 0; i < nodes; i++) {
        json_object(j, NULL);
        json_array(j, "primitives");
        json_object(j, NULL);
        json_number(j, "mode", node[i].triangles > 0 ? TRIANGLES : POINTS);
        json_object(j, "attributes");
        for (size_t k = 0; k < n; k++)
            if (p[k].node == i && p[k].name != NULL)
                json_number(j, p[k].name, (double)k);
        json_close(j);
        for (size_t k = 0; k < n; k++)
            if (p[k].node == i && p[k].name == NULL)
                json_number(j, "indices", (double)k);
        json_close(j);
        json_close(j);
        json_close(j);
    }
    json_close(j);
    json_array(j, "nodes");
    for (size_t i = 0; i < nodes; i++) {
        json_object(j, NULL);
        json_text(j, "name", node[i].name);
        json_number(j, "mesh", (double)i);
        json_array(j, "scale");
        for (int k = 0; k < 3; k++)
            json_number(j, NULL, 0.001);
        json_close(j);
        json_close(j);
    }
    json_close(j);
    json_array(j, "scenes");
    json_object(j, NULL);
    json_array(j, "nodes");
    for (size_t i = 0; i < nodes; i++)
        json_number(j, NULL, (double)i);
    json_close(j);
    json_close(j);
    json_close(j);
    json_number(j, "scene", 0);
}

static unsigned char *glbwrite_put(unsigned char *to, size_t value)
{
    for (int i = 0; i < 4; i++)
        *to++ = (unsigned char)(value >> 8 * i);
    return to;
}

static unsigned char *put_part(unsigned char *to, const struct part *p)
{
    const uint32_t *index = p->from;

    if (!p->narrow) {
        memcpy(to, p->from, p->bytes); /* of a machine that is little-endian */
    } else {
        for (size_t i = 0; i < p->count; i++) {
            to[2 * i] = (unsigned char)index[i];
            to[2 * i + 1] = (unsigned char)(index[i] >> 8);
        }
    }
    memset(to + p->bytes, 0, glbwrite_padded(p->bytes) - p->bytes);
    return to + glbwrite_padded(p->bytes);
}

/* The file: 12 bytes, the document filled with blanks, the arrays. */
static unsigned char *assemble(const char *text, const struct part *p, size_t n,
                               size_t bytes, size_t *len)
{
    const size_t document = strlen(text);
    unsigned char *out, *to;

    *len = 12 + 8 + glbwrite_padded(document) + 8 + bytes;
    if ((out = malloc(*len)) == NULL)
        return NULL;
    memcpy(out, "glTF", 4);
    to = glbwrite_put(glbwrite_put(out + 4, 2), *len);
    to = glbwrite_put(to, glbwrite_padded(document));
    memcpy(to, "JSON", 4);
    memset(to + 4, ' ', glbwrite_padded(document));
    memcpy(to + 4, text, document);
    to = glbwrite_put(to + 4 + glbwrite_padded(document), bytes);
    memcpy(to, "BIN", 4);
    to += 4;
    for (size_t i = 0; i < n; i++)
        to = put_part(to, &p[i]);
    return out;
}

enum status glbwrite(const struct glbwrite_node *node, size_t n, struct json *j,
                     unsigned char **out, size_t *len)
{
    struct part *p = calloc(n * PARTS_OF_NODE, sizeof *p);
    size_t parts = 0, bytes = 0;
    char *text;

    *out = NULL;
    *len = 0;
    if (p == NULL) {
        json_discard(j);
        return ST_ENOMEM;
    }
    for (size_t i = 0; i < n; i++)
        parts += parts_of(&node[i], i, p + parts);
    for (size_t i = 0; i < parts; i++)
        bytes += glbwrite_padded(p[i].bytes);
    json_object(j, "asset");
    json_text(j, "version", "2.0");
    json_text(j, "generator", "surfaced");
    json_close(j);
    describe_parts(j, p, parts, bytes);
    describe_nodes(j, node, n, p, parts);
    if ((text = json_compact(j)) != NULL)
        *out = assemble(text, p, parts, bytes, len);
    free(text);
    free(p);
    return *out != NULL ? ST_OK : ST_ENOMEM;
}
