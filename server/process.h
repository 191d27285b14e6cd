/* process.h -- this process and the operating system (Linux). */
#ifndef SERVER_PROCESS_H
#define SERVER_PROCESS_H
#include <stdint.h>

struct process_state {
    double cpu_seconds;
    uint64_t resident_bytes, virtual_bytes;
    uint64_t open_fds;
};

/* process_begin(): nothing is dumped (nodump.h); what is freed is overwritten, also by
 * libraries, as qsort() and GnuTLS do not, in blocks of more than 1 KB (core/mesh/mem.h does
 * it for all of its own); blocks that only large requests need go back to the system when
 * they are freed. */
void process_begin(void);

/* process_look(out): what cannot be read is 0.  Some 100 us. */
void process_look(struct process_state *out);

#endif
