#include "process.h"

#include <dirent.h>
#include <inttypes.h>
#include <malloc.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "mem.h"
#include "nodump.h"

/* An ordinary request allocates no block of MEM_MAPPED; and what it frees is kept, up to so much
 * in each arena, instead of being asked for again. */
#define KEPT_FREE (8 << 20)

void process_begin(void)
{
    nodump_begin();
    (void)mallopt(M_PERTURB, 1); /* what libraries free is overwritten, too */
    (void)mallopt(M_MMAP_THRESHOLD, (int)MEM_MAPPED);
    (void)mallopt(M_TRIM_THRESHOLD, KEPT_FREE);
}

static uint64_t count_fds(void)
{
    DIR *d = opendir("/proc/self/fd");
    uint64_t n = 0;

    if (d == NULL)
        return 0;
    while (readdir(d) != NULL)
        n++;
    (void)closedir(d);
    return n - 3; /* ".", ".." and the folder's own */
}

static void look_at_memory(struct process_state *out)
{
    FILE *f = fopen("/proc/self/statm", "re");
    uint64_t all, resident, page = (uint64_t)sysconf(_SC_PAGESIZE);

    if (f == NULL)
        return;
    if (fscanf(f, "%" SCNu64 " %" SCNu64, &all, &resident) == 2) {
        out->virtual_bytes = all * page;
        out->resident_bytes = resident * page;
    }
    (void)fclose(f);
}

void process_look(struct process_state *out)
{
    struct timespec cpu;

    *out = (struct process_state){.open_fds = count_fds()};
    look_at_memory(out);
    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu) == 0)
        out->cpu_seconds = (double)cpu.tv_sec + (double)cpu.tv_nsec * 1e-9;
}
