/* sql_schema.h -- the schema of SQLite databases: schema.sql, embedded.  A file of its own, so
 * that a test can be linked with another one. */
#ifndef DB_SQL_SCHEMA_H
#define DB_SQL_SCHEMA_H

/* sql_schema_text(): the statements, with a line "-- version N" before those that lead from
 * N - 1 to N, N >= 2.  sql_schema_newest(): the greatest N. */
const char *sql_schema_text(void);
int sql_schema_newest(void);

#endif
