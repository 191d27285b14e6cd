-- postgres.sql -- what a test's database on a PostgreSQL has so that a test is written once: the schema
-- has the name that SQLite's has, another is for a test's own tables, and functions are there that
-- SQLite has.  scripts/with_postgres puts it into the template of all databases.
CREATE SCHEMA main;
CREATE SCHEMA aside;
CREATE SCHEMA lib;
ALTER ROLE surface SET search_path = main, aside, lib, public;
CREATE FUNCTION lib.zeroblob(n bigint) RETURNS bytea LANGUAGE sql
    AS $$ SELECT decode(repeat('00', CAST(n AS integer)), 'hex') $$;
CREATE FUNCTION lib.randomblob(n integer) RETURNS bytea LANGUAGE sql
    AS $$ SELECT substr(decode(md5(CAST(random() AS text)), 'hex'), 1, n) $$;
CREATE FUNCTION lib.hex(b bytea) RETURNS text LANGUAGE sql
    AS $$ SELECT upper(encode(b, 'hex')) $$;
CREATE FUNCTION lib.unixepoch() RETURNS bigint LANGUAGE sql
    AS $$ SELECT CAST(extract(epoch FROM now()) AS bigint) $$;
CREATE AGGREGATE lib.group_concat(text, text) (SFUNC = string_agg_transfn, STYPE = internal,
    FINALFUNC = string_agg_finalfn);
