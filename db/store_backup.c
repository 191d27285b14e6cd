/* Backups of store.h: what the engine does, and who asked for it. */
#include "errinfo.h"
#include "store_engine.h"
#include "store_rules.h"
#include "store_sqlite.h"

enum status store_backup(struct store *s, const char *path, const struct store_key *key,
                         struct store_copied *out, struct errinfo *e)
{
    return s->engine->backup(s, path, key, out, e);
}

enum status store_restore(const char *path, const char *from, const struct store_key *key,
                          const char *actor, bool dry, struct store_restored *out,
                          struct errinfo *e)
{
    struct store_act by;
    const enum status st = store_rules_act(&by, actor, e);

    return st != ST_OK ? st : store_sqlite_restore(path, from, key, &by, dry, out, e);
}

enum status store_look(const char *path, struct store_look *out, struct errinfo *e)
{
    return store_sqlite_look(path, out, e);
}
