/* process.h -- what the operating system knows of this process (Linux). */
#ifndef SERVER_PROCESS_H
#define SERVER_PROCESS_H
#include <stdint.h>

struct process_state {
    double cpu_seconds;
    uint64_t resident_bytes, virtual_bytes;
    uint64_t open_fds, max_fds;
};

/* process_look(out): what cannot be read is 0.  Some 100 us. */
void process_look(struct process_state *out);

#endif
