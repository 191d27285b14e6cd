"""What is in a database: for crash.py and faults.py."""
import json
import os
import subprocess


class Failure(Exception):
    pass


def tell(ctl, *words):
    """Returns what a command of surfacectl tells.  ctl: the words that run it."""
    r = subprocess.run([*ctl, '--json', *words], stdin=subprocess.DEVNULL, capture_output=True, check=False)
    if r.returncode != 0:
        raise Failure('%s: status %d: %s' % (' '.join(words), r.returncode, (r.stderr or r.stdout).decode().strip()))
    return json.loads(r.stdout)


def look(ctl):
    """Checks the database, and returns its subjects, templates and tokens without random ids.
    ctl: the words that run surfacectl on it."""
    tell(ctl, 'check-database')
    kept = {'subject': ('subjects', 'subject', 'consent', 'hold', 'disabled'),
            'template': ('templates', 'subject', 'digest', 'engine', 'label'),
            'token': ('tokens', 'name', 'scopes', 'revoked_at')}
    return [[one[m] for m in members] for what, (all_of, *members) in kept.items()
            for one in tell(ctl, what, 'list')[all_of]]


def names(folder):
    """Returns the files in a folder and those below it, without those that only an open database has."""
    return {os.path.relpath(at + '/' + n, folder) for at, _, found in os.walk(folder) for n in found
            if not n.endswith(('-wal', '-shm', '-journal'))}
