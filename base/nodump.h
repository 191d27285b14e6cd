/* nodump.h -- no core file may hold a face, a key or a token. */
#ifndef BASE_NODUMP_H
#define BASE_NODUMP_H

/* nodump_begin(): from now on this process writes no core file, and no other process of its user
 * can read its memory or trace it (Linux; root still can).  What fails is not done. */
void nodump_begin(void);

#endif
