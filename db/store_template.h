/* store_template.h -- templates: enrolled, read, deleted.  A template's points never change,
 * what is loaded is always what this engine makes of them, and its id is never used again, so a
 * face may be cached by id as long as store_snapshot_begin(), store_template_list() or
 * store_template_get() still name it. */
#ifndef DB_STORE_TEMPLATE_H
#define DB_STORE_TEMPLATE_H
#include "store_open.h"

struct store_sample {
    const struct surface_face *face;
    const char *read;   /* as in struct store_template; NULL: not known */
    double first_score; /* as in struct store_template */
};

struct store_enroll {
    const char *actor, *subject, *label;
    bool manager;                      /* as in struct store_template */
    const struct store_sample *sample; /* [n], of one subject */
    size_t n;                          /* 1 or more */
    /* the last template that they were compared with; "": there was none; NULL: they were
     * not compared */
    const char *newest;
    const char *captured; /* follows in the events on their outcome; NULL for nothing */
};

/* store_enroll(s, what, t, created, e): encode and store a template of each sample, and the
 * subject where it is new; a change with each template.
 * t, created  [what->n].  created[i] is false when the subject has this very cloud already (by
 *             its digest as it was used, or as it was read), also of a sample before it: then
 *             t[i] describes the template that is there
 * ST_EEXISTS and nothing stored where another template than what->newest is the last by now: then
 * there may be one that a sample was not compared with, by whatever thread or process.
 * ST_EFULL: the subject would have more than STORE_TEMPLATES_MAX. */
enum status store_enroll(struct store *s, const struct store_enroll *what,
                         struct store_template *t, bool *created, struct errinfo *e);

enum status store_template_get(struct store *s, const char *id, struct store_template *t,
                               struct errinfo *e);

/* store_template_outdated(s, t): did another engine make it than s's (store_use_model())?  One
 * stored by another version of the program alone is not outdated (surface_same_engine()). */
bool store_template_outdated(const struct store *s, const struct store_template *t);

/* store_template_load(s, id, t, w, f, e): the face too, decoded and validated; *f is as in
 * surface_decode(), and NULL on failure.  Of an outdated
 * one *f is made of its points (surface_rebuild()), for some milliseconds more, and is what it would
 * be after store_reencode(); *t is as it is stored.  ST_EVERSION: this engine cannot make a face
 * of them; nothing should be compared with it then.
 * store_template_decode(s, t, face, len, w, f, e): the same of a face's
 * bytes. */
enum status store_template_load(struct store *s, const char *id, struct store_template *t,
                                struct surface_work *w, struct surface_face **f,
                                struct errinfo *e);
enum status store_template_decode(const struct store *s, const struct store_template *t,
                                  const void *face, size_t len, struct surface_work *w,
                                  struct surface_face **f, struct errinfo *e);

/* store_template_delete(s, actor, id, e): the subject stays, even without templates.
 * ST_EHELD: it is on hold. */
enum status store_template_delete(struct store *s, const char *actor, const char *id,
                                  struct errinfo *e);

/* store_template_list(s, subject, out, n, e): the subject's templates, oldest first; a
 * new array released by free().  ST_ENOTFOUND when there is no such subject. */
enum status store_template_list(struct store *s, const char *subject,
                                struct store_template **out, size_t *n,
                                struct errinfo *e);

/* store_reencode(s, actor, id, w, f, t, done, e): an outdated template is stored as this engine
 * makes it, under the same id, label, time and digest; a change with it.  *f: memory to use;
 * *t: as it is now.  *done is false where it was not outdated, or not any more.  Others can
 * use it all the time.
 * ST_EVERSION, as store_template_load(): it stays as it is. */
enum status store_reencode(struct store *s, const char *actor, const char *id,
                           struct surface_work *w, struct surface_face **f,
                           struct store_template *t, bool *done, struct errinfo *e);

/* store_reencode_due(s, out, n, e): the ids of all outdated templates, oldest first; a new
 * array released by free().
 * store_reencode_count(s, n, e): how many there are.  Both read an index alone. */
enum status store_reencode_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                               struct errinfo *e);
enum status store_reencode_count(struct store *s, uint64_t *n, struct errinfo *e);

#endif
