/* report_json.h -- the report of an evaluation in JSON. */
#ifndef CTL_REPORT_JSON_H
#define CTL_REPORT_JSON_H
#include <stdio.h>
#include "errinfo.h"

struct json;   /* json.h */
struct report; /* report.h */

/* A writer of report.json (ctl_dir.h); r is a struct report.  ST_OK; ST_ENOMEM, ST_EIO. */
enum status report_json(FILE *to, const void *r, struct errinfo *e);

/* report_json_out(o, r): what report.json has, as members of o's open object. */
void report_json_out(struct json *o, const struct report *r);

#endif
