/* builder.h -- a thread beside a worker that builds the probe while the worker reads and
 * decodes the templates, so that the verification seldom waits for the disk. */
#ifndef SERVER_BUILDER_H
#define SERVER_BUILDER_H
#include <stddef.h>

struct builder;
struct face_work; /* face.h */
struct model;     /* model.h */

struct builder *builder_start(const struct model *m); /* NULL: out of memory */

/* Deeper than that no thread that computes has its stack. */
#define BUILDER_STACK ((size_t)256 << 10)

/* builder_begin(b, build, arg): build(arg, w) begins on the thread, with working memory of the
 * thread's own.  builder_wait(b): it has ended; at once where none was begun.  One at a time,
 * from one thread. */
void builder_begin(struct builder *b, void (*build)(void *arg, struct face_work *w),
                   void *arg);
void builder_wait(struct builder *b);

/* builder_wipe(b): face_work_wipe() of its memory, and the same of its stack.  Between two. */
void builder_wipe(struct builder *b);
void builder_stop(struct builder *b); /* after builder_wait(); NULL is allowed */

#endif
