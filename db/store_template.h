/* store_template.h -- templates: enrolment, reading, deletion.
 * The points of a template never change, a loaded face is always this engine's face of these points, and
 * ids are never reused.  A face may therefore be cached by id as long as store_snapshot_begin(),
 * store_template_list() or store_template_get() still list the template. */
#ifndef DB_STORE_TEMPLATE_H
#define DB_STORE_TEMPLATE_H
#include "store_open.h"

struct store_sample {
    const struct surface_face *face; /* face of the sample, borrowed */
    const char *read;                /* as in struct store_template; NULL: unknown */
    double first_score;              /* as in struct store_template */
    /* Descriptor of the face (surface_describe()); NULL: no search finds the template. */
    const unsigned char *descriptor;
};

struct store_enroll {
    const char *actor, *subject, *label;
    bool manager;                      /* as in struct store_template */
    const struct store_sample *sample; /* samples [n] of one subject */
    size_t n;                          /* number of samples, 1 or more */
    /* Id of the subject's newest template when the samples were compared; "": it had none; NULL: the
     * samples were not compared. */
    const char *newest;
    /* Number of the last change (store_people_seq()) that the caller's search among all people has seen; 0: it
     * made none. */
    uint64_t seq;
    /* Groups of the subject if it is new (groups.h); NULL: those that actor is bound to. */
    const char *groups;
    const char *captured; /* text after the outcome in the events; NULL: none */
};

/* store_enroll(s, what, t, created, e): Encodes and stores a template of each sample, and adds the subject if it
 * is new.  Appends a change for each template.
 *   t        receives the templates [what->n]
 *   created  receives [what->n] flags; false: the subject already has this cloud (by its digest as used
 *            or as read), perhaps from an earlier sample of this call; t[i] is then the existing template
 * Returns ST_OK, or an error, and nothing is stored:
 *   ST_ECHANGED  another template than what->newest is now the newest: another thread or process may
 *                have added a template that the samples were not compared with; or there is a change
 *                after what->seq
 *   ST_EEXISTS   the subject exists, but not for the actor, which is bound to other groups
 *   ST_EFULL     the subject would have more than STORE_TEMPLATES_MAX templates */
enum status store_enroll(struct store *s, const struct store_enroll *what,
                         struct store_template *t, bool *created, struct errinfo *e);

/* store_template_get(s, actor, id, t, e): Reads a template without its face. */
enum status store_template_get(struct store *s, const char *actor, const char *id,
                               struct store_template *t, struct errinfo *e);

/* store_template_outdated(s, t): Returns true if t was stored by another engine than that of s
 * (store_use_model()).  Another version of the program with the same engine does not make it outdated
 * (surface_same_engine()). */
bool store_template_outdated(const struct store *s, const struct store_template *t);

/* store_template_load(s, actor, id, t, w, f, e): Reads a template and its face, decodes and validates the face.  The
 * face of an outdated template is rebuilt from its points (surface_rebuild()): the same face as after
 * store_reencode(), for some milliseconds more.  *t is as stored.
 *   f  as in surface_decode(); NULL after a failure
 * ST_EVERSION: this engine cannot rebuild the face; the template should not be compared. */
enum status store_template_load(struct store *s, const char *actor, const char *id,
                                struct store_template *t, struct surface_work *w,
                                struct surface_face **f, struct errinfo *e);

/* store_template_decode(s, t, face, len, w, f, e): The part of store_template_load() that decodes the bytes of
 * the face of t; of a template that is not outdated the head is enough (surface_decode()). */
enum status store_template_decode(const struct store *s, const struct store_template *t,
                                  const void *face, size_t len, struct surface_work *w,
                                  struct surface_face **f, struct errinfo *e);

/* store_template_delete(s, actor, id, e): Deletes a template.  The subject stays, even without templates.
 * ST_EHELD: the subject is on hold. */
enum status store_template_delete(struct store *s, const char *actor, const char *id,
                                  struct errinfo *e);

/* store_template_list(s, actor, subject, out, n, e): Lists the subject's templates, oldest first.
 *   out  a new array of *n elements, to be released by free()
 * ST_ENOTFOUND: there is no such subject. */
enum status store_template_list(struct store *s, const char *actor, const char *subject,
                                struct store_template **out, size_t *n,
                                struct errinfo *e);

/* store_reencode(s, actor, id, w, done, e): Replaces the face of an outdated template by this engine's, under the
 * same id, label, time and digest, and appends a change.  Other threads and processes can use the
 * template all the time.
 *   done  receives false if the template was not outdated, or is no longer
 * ST_EVERSION: as store_template_load(); the template is not changed. */
enum status store_reencode(struct store *s, const char *actor, const char *id,
                           struct surface_work *w, bool *done, struct errinfo *e);

/* store_reencode_due(s, out, n, e): Lists the ids of all outdated templates, oldest first.  Reads only an index.
 *   out  a new array of *n elements, to be released by free(); NULL: they are only counted */
enum status store_reencode_due(struct store *s, char (**out)[STORE_ID_LEN + 1], size_t *n,
                               struct errinfo *e);

#endif
