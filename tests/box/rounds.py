"""rounds.py ROUNDS SEED FOLDER URL URL: enrols and takes away people at one of two daemons of a database, in random
order, and searches for them at the other one with the next request.  FOLDER has eN.ply and pN.ply of each.  Prints
what was wrong, and exits with 1 if anything was."""
import glob
import json
import random
import sys
import urllib.error
import urllib.request

ROUNDS, SEED, FOLDER, *URLS = sys.argv[1:]
draw = random.Random(int(SEED))


def ask(url, method, path, body=None, kind='model/ply'):
    request = urllib.request.Request(url + path, data=body, method=method, headers={'Content-Type': kind} if body else {})
    try:
        with urllib.request.urlopen(request) as response:
            return response.status, json.loads(response.read() or b'{}')
    except urllib.error.HTTPError as e:
        return e.code, json.loads(e.read())


def scan(kind, number):
    with open(f'{FOLDER}/{kind}{number}.ply', 'rb') as f:
        return f.read()


def take_away(url, name):
    how = draw.choice([None, None, b'{"disabled": true}', b'{"identify": false}'])
    if how is None:
        return ask(url, 'DELETE', f'/v1/subjects/{name}')[0]
    return ask(url, 'PATCH', f'/v1/subjects/{name}', how, 'application/json')[0]


def look(url, name, probe, there):
    """Returns what is wrong with a search; None: nothing."""
    status, found = ask(url, 'POST', '/v1/identify?candidates=50', probe)
    if status != 200:
        return f'{status} {found.get("code")}'
    named = name in [found['subject']] + [c['subject'] for c in found['candidates']]
    if there:
        return None if found['decision'] == 'match' and found['subject'] == name else 'not found'
    return 'named' if named else None


def main():
    people = [(f'r{n}', scan('e', n), scan('p', n)) for n in range(len(glob.glob(f'{FOLDER}/p*.ply')))]
    there, wrong = set(), 0
    for turn in range(int(ROUNDS)):
        name, enrolled, probe = draw.choice(people)
        one, other = draw.sample(URLS, 2)
        if name in there:
            status = take_away(one, name)
        else:
            ask(one, 'DELETE', f'/v1/subjects/{name}')
            status = ask(one, 'POST', f'/v1/subjects/{name}/templates', enrolled)[0]
        there ^= {name}
        problem = look(other, name, probe, name in there) if status in (200, 201) else f'status {status}'
        if problem:
            wrong += 1
            print(f'round {turn}, {name}: {problem}')
    print(f'{ROUNDS} rounds, {wrong} wrong')
    return 1 if wrong else 0


sys.exit(main())
