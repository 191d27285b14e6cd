/* logs.h -- handlers of the audit log.  logs_verify() and logs_export() are slow routes (route.h). */
#ifndef SERVER_LOGS_H
#define SERVER_LOGS_H

struct request; /* request.h */
struct worker;  /* worker.h */

/* logs_list(r, w): Lists the entries that the query parameters choose. */
void logs_list(struct request *r, struct worker *w);

/* logs_verify(r, w): Verifies the whole log. */
void logs_verify(struct request *r, struct worker *w);

/* logs_export(r, w): Exports the log before it responds: to a file without a name, or, if the export contains the
 * ids of subjects, to memory. */
void logs_export(struct request *r, struct worker *w);

#endif
