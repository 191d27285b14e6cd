#include "ctl_command.h"

#include <string.h>

#include "ctl.h"

const struct ctl_command ctl_commands[] = {
    {.name = "init",
     .args = "",
     .db = true,
     .options = "passphrase plaintext",
     .run = ctl_admin_init,
     .summary = "make a new database",
     .help =
         "What it says of people is sealed with a key in the file PATH.key, or --key, which is\n"
         "made: keep a copy of it elsewhere, since without it nothing in the database can be\n"
         "read.  --passphrase asks for one instead; --plaintext leaves the key in the database.\n"
         "A database that is there already is left as it is.",
     .example = "surfacectl --db faces.db init"},
    {.name = "migrate",
     .args = "",
     .db = true,
     .options = "passphrase plaintext dry-run",
     .run = ctl_admin_migrate,
     .summary = "upgrade a database of an older version",
     .help =
         "In one transaction.  What it says of people is sealed from then on, as with init.  A\n"
         "verified copy of the old database is kept as PATH.v3.bak: what stood open in it still\n"
         "does there.  Delete it when all is well.",
     .example = "surfacectl --db faces.db migrate --dry-run"},
    {.name = "enroll",
     .args = "SUBJECT FILE... | DIR | MANIFEST",
     .min = 1,
     .max = CTL_MANY,
     .db = true,
     .options = "units label force kind threads model",
     .run = ctl_enroll,
     .summary = "enroll scans of a subject, or of many",
     .help =
         "Each FILE (PLY, OBJ or XYZ; - is standard input) becomes a template.  The same scan\n"
         "again changes nothing.  A scan that matches none of the subject's others, or has too\n"
         "little in common with them to tell, is refused, unless --force is given.  A bad scan\n"
         "does not stop the others.\n"
         "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table,\n"
         "with columns file and subject.  All its scans, or those of --kind, are enrolled, on\n"
         "all cores; what failed is listed with the reason.  Stopped and started again, it goes\n"
         "on where it was: what is there already is passed over.",
     .example = "surfacectl --db faces.db enroll alice alice-1.ply alice-2.ply"},
    {.name = "verify",
     .args = "SUBJECT FILE",
     .min = 2,
     .max = 2,
     .db = true,
     .options = "units model",
     .run = ctl_face_verify,
     .summary = "compare a scan with a subject's templates",
     .help =
         "The template with the lowest disparity decides.  Exit: 0 match, 1 no match,\n"
         "2 inconclusive.",
     .example = "surfacectl --db faces.db verify alice probe.ply"},
    {.name = "compare",
     .args = "A B",
     .min = 2,
     .max = 2,
     .options = "units model",
     .run = ctl_face_compare,
     .summary = "compare two scans; no database is needed",
     .help = "B is moved onto A.  Exit: 0 match, 1 no match, 2 inconclusive.",
     .example = "surfacectl compare monday.ply tuesday.ply"},
    {.name = "explain",
     .args = "A B",
     .min = 2,
     .max = 2,
     .options = "units out model",
     .run = ctl_explain,
     .summary = "compare two scans and show where they differ",
     .help =
         "B is moved onto A.  With --db, A is a subject or a template; else a scan.  Writes\n"
         "into a directory: explain.txt and explain.json, explain.ply (the points of B), and by\n"
         "gnuplot explain.png: the gap as measured beside what decided.  They are biometric\n"
         "data: readable by their owner alone.  Exit: 0 match, 1 non-match, 2 inconclusive.",
     .example = "surfacectl explain monday.ply tuesday.ply --out why"},
    {.name = "asymmetry",
     .args = "FILE",
     .min = 1,
     .max = 1,
     .options = "units model",
     .run = ctl_shape_asymmetry,
     .summary = "measure a scan against its own mirror image",
     .help =
         "The symmetry plane is corrected until the gap between the face and its mirror image is\n"
         "least; that gap is the asymmetry.  Nothing is stored.  Exit: 0, or 2 where too little\n"
         "of the face lies over its mirror image to say.",
     .example = "surfacectl asymmetry alice.ply"},
    {.name = "simplify",
     .args = "FILE",
     .min = 1,
     .max = 1,
     .options = "units out model tolerance mean",
     .run = ctl_shape_simplify,
     .summary = "keep the points that a scan's surface needs",
     .help =
         "Points are taken out one by one, the least needed first, as long as the surface of the\n"
         "others stays within --tolerance of the scan's at each of its points; with --mean, in\n"
         "the mean over its area.  What is left is written to the file --out (PLY, with the\n"
         "triangles).  Spikes are laid flat first.",
     .example = "surfacectl simplify alice.ply --tolerance 0.3 --out small.ply"},
    {.name = "evaluate",
     .args = "DIR|MANIFEST",
     .min = 1,
     .max = 1,
     .options = "units threshold-mm out impostors threads model",
     .run = ctl_evaluate,
     .summary = "how well a collection of scans is told apart",
     .help =
         "DIR holds scans named SUBJECT_KIND.ply, or an index.csv; MANIFEST is such a table,\n"
         "with columns file and subject.  Of each subject the scan of kind `enroll`, or else\n"
         "the first, is enrolled in memory and compared with the others and with other\n"
         "subjects'.  Writes into a directory: report.html (with its pictures), report.md,\n"
         "report.json, scores.csv (every comparison), rates.csv, and by gnuplot det and scores\n"
         "as .svg and .png.  With --db its calibration decides.  surfacectl(1) says more.",
     .example = "surfacectl evaluate scans --out evaluation"},
    {.name = "train",
     .args = "DIR|MANIFEST",
     .min = 1,
     .max = 1,
     .options = "units label out threads model",
     .run = ctl_train,
     .summary = "learn a model from a collection of scans",
     .help =
         "DIR or MANIFEST as for evaluate.  Learns the mean face, what a face does between two\n"
         "scans of one person, and the weight of each place; tells the error rates before and\n"
         "after, the latter on people it was not learned from, and writes the model to the file\n"
         "--out (./faces.model), for --model of the other commands and of surfaced.  It takes\n"
         "20 subjects and 250 scans besides the enrolled ones, at least; hundreds of subjects\n"
         "are better.  --label names the model; --model is the one to begin with.",
     .example = "surfacectl train scans/ --label 'door scanner' --out door.model"},
    {.name = "subject list",
     .was = "list",
     .args = "",
     .db = true,
     .run = ctl_subject_list,
     .summary = "list the subjects",
     .help = "In the order of their coming.",
     .example = "surfacectl --db faces.db subject list"},
    {.name = "subject show",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_subject_show,
     .summary = "describe a subject and its templates",
     .help = "Its consent, purpose, expiry, when it was last seen, and each template.",
     .example = "surfacectl --db faces.db subject show alice"},
    {.name = "subject set",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "reference purpose expires",
     .run = ctl_subject_set,
     .summary = "note a subject's consent and when it expires",
     .help =
         "What is not given stays as it is.  A subject that is not there is made, without a\n"
         "template: the consent often comes before the first scan.  `purge --due` erases it\n"
         "once it has expired.",
     .example =
         "surfacectl --db faces.db subject set alice --reference C-17 --expires 2027-01-31"},
    {.name = "subject rename",
     .args = "SUBJECT NEW",
     .min = 2,
     .max = 2,
     .db = true,
     .run = ctl_subject_rename,
     .summary = "give a subject another id",
     .help =
         "Its templates and all that is known of it stay.  Another that has the id is left\n"
         "alone: then nothing is changed.",
     .example = "surfacectl --db faces.db subject rename alice alice.b"},
    {.name = "subject disable",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_subject_disable,
     .summary = "let a subject not be verified any more",
     .help = "Everything of it is kept; `subject enable` takes it back.",
     .example = "surfacectl --db faces.db subject disable alice"},
    {.name = "subject enable",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_subject_enable,
     .summary = "let a disabled subject be verified again",
     .help = "At once, also by a running daemon.",
     .example = "surfacectl --db faces.db subject enable alice"},
    {.name = "subject hold",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_subject_hold,
     .summary = "keep a subject from being erased",
     .help =
         "Neither it nor a template of it can be deleted, by anybody, also when it has\n"
         "expired, until `subject release`.",
     .example = "surfacectl --db faces.db subject hold alice"},
    {.name = "subject release",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_subject_release,
     .summary = "end a subject's hold",
     .help = "It can be erased again; nothing is erased by this.",
     .example = "surfacectl --db faces.db subject release alice"},
    {.name = "subject erase",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "dry-run yes",
     .run = ctl_subject_erase,
     .summary = "delete a subject with all its templates",
     .help =
         "Its key goes with it, so that what is left of it anywhere cannot be read.  Prints a\n"
         "receipt, which --json gives in full, with its signature.  Asks for the id again on a\n"
         "terminal; elsewhere --yes is needed.  --dry-run says what would be deleted.",
     .example = "surfacectl --db faces.db --yes subject erase alice"},
    {.name = "purge",
     .args = "",
     .db = true,
     .options = "due dry-run yes",
     .run = ctl_purge,
     .summary = "erase the subjects that have expired",
     .help =
         "--due has to be given.  Those on hold are told of and kept.  Asks for their number on\n"
         "a terminal; elsewhere --yes is needed.  --dry-run lists them.",
     .example = "surfacectl --db faces.db purge --due --dry-run"},
    {.name = "template list",
     .args = "[SUBJECT]",
     .max = 1,
     .db = true,
     .options = "model",
     .run = ctl_template_list,
     .summary = "list the templates",
     .help =
         "Of one subject, oldest first, or of all in the order of their coming.  What another\n"
         "engine made is marked as stale (template reprocess).",
     .example = "surfacectl --db faces.db template list alice"},
    {.name = "template show",
     .args = "ID",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "model",
     .run = ctl_template_show,
     .summary = "describe a template",
     .help = "Whose it is, when and by what it was made, and of what quality it is.",
     .example =
         "surfacectl --db faces.db template show 0123456789abcdef0123456789abcdef"},
    {.name = "template export",
     .args = "ID",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "out model",
     .run = ctl_template_export,
     .summary = "write a template's points and triangles",
     .help =
         "To the file --out (PLY, millimetres), which is biometric data: it is readable by its\n"
         "owner alone.  The export is noted in the events.",
     .example =
         "surfacectl --db faces.db template export 0123456789abcdef0123456789abcdef -o a.ply"},
    {.name = "template reprocess",
     .args = "[ID...]",
     .max = CTL_MANY,
     .db = true,
     .options = "threads dry-run model",
     .run = ctl_reprocess,
     .summary = "make anew what another engine made",
     .help =
         "Every stale template, or those of the ids that are stale, as this engine (--model too)\n"
         "makes it of the points that are stored: the same id, label, time and digest, an event\n"
         "each.  What is stale costs some milliseconds more at its first use by the daemon until\n"
         "then, and decides no other way.  Works beside a running daemon; stopped and started\n"
         "again, it goes on where it was.  What can no longer be made a face of stays as it is\n"
         "and is told: delete it, and enroll another scan.\n"
         "Exit: 0 nothing is stale any more of what was wanted, 65 some of it still is.",
     .example = "surfacectl --db faces.db template reprocess --dry-run"},
    {.name = "template delete",
     .args = "ID",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "dry-run yes",
     .run = ctl_template_delete,
     .summary = "delete one template",
     .help = "Asks for the id again on a terminal; elsewhere --yes is needed.",
     .example =
         "surfacectl --db faces.db template delete 0123456789abcdef0123456789abcdef --yes"},
    {.name = "dedup",
     .args = "",
     .db = true,
     .options = "subject fmr threshold-mm threads dry-run model",
     .run = ctl_dedup,
     .summary = "find the same face under two subjects",
     .help =
         "All templates of each subject with those of every other, on all cores, as in a\n"
         "verification; or those of --subject alone with all others.  Listed are the pairs at or\n"
         "below the threshold in force, or --threshold-mm, or that for --fmr, the most alike first:\n"
         "they may be one person, or relatives, or alike by chance, of which there is about one in\n"
         "a thousand comparisons at the shipped threshold.  In a large database take a smaller\n"
         "--fmr.  What it takes is told first, with --dry-run nothing else.  Changes nothing.\n"
         "Exit: 0 there is no such pair, 1 there are some.",
     .example = "surfacectl --db faces.db dedup --fmr 1e-5"},
    {.name = "show",
     .args = "ID",
     .min = 1,
     .max = 1,
     .db = true,
     .old = true,
     .run = ctl_admin_show,
     .summary = "describe a subject or a template",
     .help = "ID is a subject's, or else a template's.",
     .example = "surfacectl --db faces.db show alice"},
    {.name = "delete",
     .args = "ID",
     .min = 1,
     .max = 1,
     .db = true,
     .old = true,
     .options = "dry-run yes",
     .run = ctl_admin_delete,
     .summary = "delete a subject with all its templates, or one template",
     .help =
         "ID is a subject's, or else a template's.  Asks for the id again on a terminal;\n"
         "elsewhere --yes is needed.",
     .example = "surfacectl --db faces.db --yes delete alice"},
    {.name = "config show",
     .args = "",
     .options = "config",
     .run = ctl_config_show,
     .summary = "the daemon's settings, and where each comes from",
     .help =
         "As they would be in force if surfaced was started now: its file, --config,\n"
         "SURFACED_CONFIG or /etc/surfaced.conf, and what the environment says.",
     .example = "surfacectl config show --json"},
    {.name = "config check",
     .args = "",
     .options = "config",
     .run = ctl_config_check,
     .summary = "what is wrong with the daemon's settings",
     .help =
         "Every problem is told with its place.  Nothing is written, and a running daemon goes\n"
         "on with what it has.  What certificates hold: surfaced --check-config.  Exit: 0 it would start, 1 it would not.",
     .example = "surfacectl config check --config new.conf"},
    {.name = "check",
     .args = "",
     .db = true,
     .run = ctl_admin_check,
     .summary = "read everything and verify it; changes nothing",
     .help =
         "The database's integrity, references and schema; of each template the checksum,\n"
         "triangulation (Delaunay), spanning tree (minimal), digest and counts.\n"
         "Exit: 0 all is well, 1 problems were found.",
     .example = "surfacectl --db faces.db check"},
    {.name = "calibrate",
     .args = "[--list | --reset]",
     .db = true,
     .options = "units threads fmr genuine dry-run list reset model",
     .run = ctl_calibrate,
     .summary = "a threshold from the database's own faces",
     .help =
         "Templates of different subjects are compared with each other; the threshold is where\n"
         "the wanted share of them would be accepted.  Subjects with several templates, and the\n"
         "scans of --genuine (a folder or a CSV file: file, subject), tell how many of the right\n"
         "people are refused.  A running daemon decides by it at once.  --list shows what was in\n"
         "force when, --reset goes back to the table that comes with the program.",
     .example = "surfacectl --db faces.db calibrate --fmr 0.01 --dry-run"},
    {.name = "backup",
     .args = "FILE",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_backup,
     .summary = "copy the database, also while the daemon runs",
     .help =
         "A copy of one moment, verified before it gets its name: every page, every subject and\n"
         "template opened with the key, the audit log.  FILE is whole or not there; an older\n"
         "backup of that name is replaced.  The key is not in it.",
     .example = "surfacectl --db faces.db backup faces-monday.db"},
    {.name = "restore",
     .args = "FILE",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "dry-run",
     .run = ctl_backup_restore,
     .summary = "put a backup in the place of the database",
     .help =
         "FILE is verified first.  Whoever was erased since is erased in it too, also under an\n"
         "older id; tokens keep the secrets that they have now, and revoked ones stay revoked.\n"
         "The database that is there is kept as PATH.before-restore.  Stop the daemon first.\n"
         "--dry-run says what would change.",
     .example = "surfacectl --db faces.db restore faces-monday.db --dry-run"},
    {.name = "export",
     .args = "SUBJECT... | --all",
     .max = CTL_MANY,
     .db = true,
     .options = "out all archive-key",
     .run = ctl_archive_export,
     .summary = "subjects and their templates for another machine",
     .help =
         "Into the new file --out, sealed with a passphrase that is asked for, or with the line\n"
         "in the file --archive-key: 64 hexadecimal digits are a key, anything else is a\n"
         "passphrase.  Tokens, calibrations and events stay here; an event says who was exported.",
     .example = "surfacectl --db faces.db export alice bob -o moving.archive"},
    {.name = "import",
     .args = "FILE",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "dry-run archive-key model",
     .run = ctl_archive_import,
     .summary = "what export wrote, all of it or nothing",
     .help =
         "Everything in it is verified first.  Who and what is there already is left as it is, so\n"
         "a second time changes nothing.  Whoever was erased here, under whatever id, is left out:\n"
         "to have them back, enroll them anew.  Templates that another engine version or another\n"
         "--model made are refused.",
     .example = "surfacectl --db faces.db import moving.archive --dry-run"},
    {.name = "rekey",
     .args = "",
     .db = true,
     .options = "passphrase plaintext new-key keep-old yes",
     .run = ctl_rekey,
     .summary = "another key for the database",
     .help =
         "A new random key takes the place of the old one in PATH.key, or --key; or the one in\n"
         "the file --new-key does.  With --passphrase it is a passphrase, asked for or in\n"
         "--new-key; with --plaintext it lies in the database.  A running daemon reads it from\n"
         "the file by itself.  Backups are still opened by the key that they were made with:\n"
         "--keep-old keeps its file, otherwise that is asked for.",
     .example = "surfacectl --db faces.db rekey --keep-old"},
    {.name = "doctor",
     .args = "",
     .db = true,
     .options = "model",
     .run = ctl_doctor,
     .summary = "what is wrong around a database, and what to do",
     .help =
         "Permissions of the database, its folder and its key; the right key, and one that a\n"
         "change has left; schema, log, room on the disk; templates of another engine.  Changes\n"
         "nothing.  Exit: 0 all is well, 1 there is trouble.",
     .example = "surfacectl --db faces.db doctor"},
    {.name = "stats",
     .args = "",
     .db = true,
     .options = "model",
     .run = ctl_admin_stats,
     .summary = "how much there is of everything",
     .help = "Counts and sizes.",
     .example = "surfacectl --db faces.db stats"},
    {.name = "vacuum",
     .args = "",
     .db = true,
     .run = ctl_admin_vacuum,
     .summary = "write the database anew, without what was deleted",
     .help =
         "The file shrinks to what is in it.  It takes as much room again while it runs, and\n"
         "others cannot write meanwhile: a running daemon answers 503 to an enrolment that has\n"
         "to wait for more than 5 seconds.",
     .example = "surfacectl --db faces.db vacuum"},
    {.name = "token create",
     .args = "[NAME]",
     .max = 1,
     .db = true,
     .options = "scope expires",
     .run = ctl_token_create,
     .summary = "make a Bearer token for the daemon",
     .help =
         "The token is printed once, on standard output; only a hash of it is kept.  It may do\n"
         "everything, for ever, unless --scope and --expires say otherwise.",
     .example =
         "surfacectl --db faces.db token create --scope verify --expires 90d front-door"},
    {.name = "token list",
     .args = "",
     .db = true,
     .run = ctl_token_list,
     .summary = "list the tokens",
     .help = "What each may do, until when, and when it was last used.",
     .example = "surfacectl --db faces.db token list"},
    {.name = "token rotate",
     .args = "ID",
     .min = 1,
     .max = 1,
     .db = true,
     .options = "expires grace",
     .run = ctl_token_rotate,
     .summary = "give a token another secret",
     .help =
         "It is printed once.  The old one counts no more, or not after --grace.  A running\n"
         "daemon sees it at once.",
     .example = "surfacectl --db faces.db token rotate 0123456789abcdef0123456789abcdef"},
    {.name = "token revoke",
     .args = "ID",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_token_revoke,
     .summary = "let a token count no more",
     .help = "For good.  A running daemon sees it at once.",
     .example = "surfacectl --db faces.db token revoke 0123456789abcdef0123456789abcdef"},
    {.name = "attempts list",
     .args = "",
     .db = true,
     .run = ctl_attempts_list,
     .summary = "list who failed to be verified lately",
     .help =
         "After some verifications that failed in a row the daemon takes none of the subject\n"
         "for a while.  How many there are, and when the last was.",
     .example = "surfacectl --db faces.db attempts list"},
    {.name = "attempts reset",
     .args = "SUBJECT",
     .min = 1,
     .max = 1,
     .db = true,
     .run = ctl_attempts_reset,
     .summary = "forget a subject's failed verifications",
     .help = "The daemon takes its next verification at once.",
     .example = "surfacectl --db faces.db attempts reset alice"},
    {.name = "audit show",
     .args = "",
     .db = true,
     .options = "subject kind since limit",
     .run = ctl_audit_show,
     .summary = "list who did what, and when",
     .help =
         "The newest 100 entries of the audit log, or --limit, oldest first.  The actor is a\n"
         "token's id or a program.  Who was erased has no name in it, but is found by --subject.",
     .example = "surfacectl --db faces.db audit show --subject alice --since 2026-11-01"},
    {.name = "audit verify",
     .args = "[FILE]",
     .max = 1,
     .options = "public-key",
     .run = ctl_audit_verify,
     .summary = "find what was removed from the log, changed or moved",
     .help =
         "In the database; or, by --public-key and without a database, in a FILE that audit\n"
         "export wrote.  Exit: 0 all is as it was written, 1 something is not.",
     .example = "surfacectl audit verify log.jsonl --public-key "
                "fc51cd8e6218a1a38da47ed00230f0580816ed13ba3303ac5deb911548908025"},
    {.name = "audit export",
     .args = "",
     .db = true,
     .options = "out",
     .run = ctl_audit_export,
     .summary = "write the log as JSON lines, signed",
     .help = "To --out or standard output.  People stand in it by a keyed hash.",
     .example = "surfacectl --db faces.db audit export --out log.jsonl"},
    {.name = "audit checkpoint",
     .args = "",
     .db = true,
     .run = ctl_audit_checkpoint,
     .summary = "sign the log as it is",
     .help =
         "Keep what is printed elsewhere: an older log that is put back is found by it.",
     .example = "surfacectl --db faces.db --json audit checkpoint"},
    {.name = "audit receipt",
     .args = "FILE",
     .min = 1,
     .max = 1,
     .options = "public-key",
     .run = ctl_receipt,
     .summary = "verify the receipt of an erasure",
     .help =
         "FILE is what DELETE answered over HTTP, or subject erase --json; - is standard input.\n"
         "With --public-key alone: is it what that key has signed?  With the database: is it by\n"
         "its key, is that entry in its log, is the subject among the erased, and is no template\n"
         "of it there?  Exit: 0 all of that, 1 not.",
     .example = "surfacectl --db faces.db audit receipt alice.json"},
    {.name = "audit erased",
     .args = "[SUBJECT]",
     .max = 1,
     .db = true,
     .run = ctl_audit_erased,
     .summary = "list when somebody was erased",
     .help = "Or when SUBJECT was; exit 1: it was not, or has come again.",
     .example = "surfacectl --db faces.db audit erased alice"},
    {.name = "completion",
     .args = "bash|zsh",
     .min = 1,
     .max = 1,
     .run = ctl_completion,
     .summary = "what the shell completes command lines by",
     .help =
         "For bash: source <(surfacectl completion bash), in ~/.bashrc.  For zsh the same\n"
         "with zsh, in ~/.zshrc after compinit.",
     .example = "surfacectl completion bash >/etc/bash_completion.d/surfacectl"},
    {.name = NULL}};

bool ctl_command_in(const struct ctl_command *cmd, const char *group)
{
    const size_t n = strlen(group);

    return strncmp(cmd->name, group, n) == 0 && cmd->name[n] == ' ';
}

/* How many of the words the name is; 0: it is not what they begin with. */
static int names(const char *name, char *const *words, int n)
{
    const size_t first = strcspn(name, " ");

    if (strlen(words[0]) != first || memcmp(words[0], name, first) != 0)
        return 0;
    if (name[first] == '\0')
        return 1;
    return n > 1 && strcmp(words[1], name + first + 1) == 0 ? 2 : 0;
}

const struct ctl_command *ctl_command_find(char *const *words, int n, int *used)
{
    for (const struct ctl_command *k = ctl_commands; k->name != NULL; k++)
        if ((*used = names(k->name, words, n)) > 0 ||
            (k->was != NULL && (*used = names(k->was, words, n)) > 0))
            return k;
    return NULL;
}
