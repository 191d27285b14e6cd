#include "malformed.h"

#include <microhttpd.h>

#include "body.h"
#include "errmap.h"
#include "request.h"

void malformed_explain(struct request *r, unsigned status)
{
    switch (status) {
    case MHD_HTTP_URI_TOO_LONG:
        request_problem(r, ERRMAP_TARGET, "the path and query have at most some 11 KB");
        break;
    case MHD_HTTP_REQUEST_HEADER_FIELDS_TOO_LARGE:
        request_problem(r, ERRMAP_HEADERS, "the headers have at most some 11 KB in all");
        break;
    case MHD_HTTP_HTTP_VERSION_NOT_SUPPORTED:
        request_problem(r, ERRMAP_VERSION, "HTTP/1.1 is served, and HTTP/1.0");
        break;
    case MHD_HTTP_CONTENT_TOO_LARGE:
        body_refuse_size(r);
        break;
    case MHD_HTTP_BAD_REQUEST:
        request_problem(r, ST_EINVAL,
                        "a header, Content-Length or a chunk is not as HTTP has it");
        break;
    default:
        request_problem(r, ST_EINTERNAL, "libmicrohttpd gave up with %u", status);
    }
}
