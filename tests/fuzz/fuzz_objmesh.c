/* OBJ meshes: from any bytes come finite vertices and triangles of them, or an error. */
#include "fuzz.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "objmesh.h"

static bool is_skin(const char *material)
{
    require(strlen(material) < 128);
    return material[0] != 'l';
}

static void parse(const uint8_t *data, size_t size, bool (*takes)(const char *material))
{
    struct errinfo e = {ST_OK, ""};
    struct objmesh m;
    FILE *in = tmpfile();
    enum status st;

    require(in != NULL && fwrite(data, 1, size, in) == size);
    rewind(in);
    st = objmesh_parse(in, takes, &m, &e);
    (void)fclose(in);
    require(st == ST_OK ? m.nv > 0
                        : m.at == NULL && m.corner == NULL && e.msg[0] != '\0');
    for (size_t i = 0; i < 3 * (size_t)m.nv; i++)
        require(isfinite(m.at[i]));
    for (uint32_t i = 0; i < m.nt; i++)
        for (int k = 0; k < 3; k++)
            require(m.corner[i][k] < m.nv);
    require(takes != NULL || m.nt == 0);
    objmesh_free(&m);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    parse(data, size, is_skin);
    parse(data, size, NULL);
    return 0;
}
