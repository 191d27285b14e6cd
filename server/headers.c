#include "headers.h"

#include <stddef.h>
#include <strings.h>

#include "request.h"

void headers_take(struct request *r, const char *name, const char *value)
{
    if (value == NULL)
        return;
    if (strcasecmp(name, "Content-Encoding") == 0)
        r->coding = r->coding == INFLATE_NONE ? inflate_coding(value) : INFLATE_OTHER;
}
