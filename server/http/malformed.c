#include "malformed.h"

#include "errmap.h"
#include "request.h"

void malformed_explain(struct request *r, unsigned status)
{
    switch (status) {
    case 414:
        request_problem(r, ERRMAP_TARGET, "the path and query have at most some 11 KB");
        break;
    case 431:
        request_problem(r, ERRMAP_HEADERS, "the headers have at most some 11 KB in all");
        break;
    case 505:
        request_problem(r, ERRMAP_VERSION, "HTTP/1.1 is served, and HTTP/1.0");
        break;
    case 413: /* it may be a stranger, who is not told the limit */
        request_problem(r, ST_ESIZE,
                        "Content-Length or a chunk's size has too many digits");
        break;
    case 400:
        request_problem(r, ST_EINVAL,
                        "a header, Content-Length or a chunk is not as HTTP has it");
        break;
    case 500: /* its buffer is full, and we cannot take anything of it */
        request_problem(r, ST_EINVAL, "a chunk's size and extension are too long");
        break;
    default:
        request_problem(r, ST_EINTERNAL, "libmicrohttpd gave up with %u", status);
    }
}
