/* Bodies of forms.  The first line is Content-Type's value; the file found lies in the body,
 * and every failure has a message. */
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

#include "errinfo.h"
#include "multipart.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const uint8_t *line = size > 0 ? memchr(data, '\n', size) : NULL, *body;
    char type[200], boundary[MULTIPART_BOUNDARY_MAX + 1];
    struct errinfo e = {ST_OK, ""};
    struct multipart_file f;
    enum status st;
    size_t n;

    if (line == NULL || (n = (size_t)(line - data)) >= sizeof type)
        return 0;
    memcpy(type, data, n);
    type[n] = '\0';
    if (!multipart_boundary(type, boundary)) {
        if (boundary[0] != '\0')
            abort();
        return 0;
    }
    body = line + 1;
    size -= n + 1;
    st = multipart_file(body, size, boundary, &f, &e);
    if (st != ST_OK
            ? e.msg[0] == '\0'
            : f.data < body || f.len > size || (size_t)(f.data - body) > size - f.len)
        abort();
    return 0;
}
