/* Bodies of forms.  The first line is Content-Type's value; the files found lie in the body one
 * behind the other, and every failure has a message. */
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
    struct multipart_file f[MULTIPART_FILES_MAX];
    enum status st;
    size_t n, at = 0;

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
    st = multipart_read(body, size, boundary, MULTIPART_FILES_MAX, f, &n, &e);
    if (st != ST_OK) {
        if (e.msg[0] == '\0')
            abort();
        return 0;
    }
    if (n == 0 || n > MULTIPART_FILES_MAX)
        abort();
    for (size_t i = 0; i < n; i++) {
        if (f[i].data < body + at || f[i].len > size ||
            (size_t)(f[i].data - body) > size - f[i].len)
            abort();
        at = (size_t)(f[i].data - body) + f[i].len;
    }
    return 0;
}
