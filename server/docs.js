// docs.js -- /openapi.json as a page.  Text goes into the page by textContent alone.
'use strict';

const METHODS = ['get', 'post', 'patch', 'delete'];
let doc;

// An element: el('p.class', child, ...); a child is an element, a text, or nothing.
function el(what, ...children) {
    const [name, ...classes] = what.split('.');
    const e = document.createElement(name);

    e.className = classes.join(' ');
    e.append(...children.flat().filter((c) => c !== null && c !== undefined));
    return e;
}

function link(to, ...children) {
    const a = el('a', ...children);

    a.href = to;
    return a;
}

function details(kind, summary, ...children) {
    return el('details.' + kind, el('summary', summary), ...children);
}

function deref(x) {
    while (x && x.$ref)
        x = x.$ref.slice(2).split('/').reduce(
            (o, k) => o[k.replace(/~1/g, '/').replace(/~0/g, '~')], doc);
    return x;
}

function paragraphs(text) {
    return (text || '').split('\n\n').filter(Boolean).map((t) => el('p', t));
}

function show(value) {
    // Short lists, of numbers above all, stay on one line.
    const text = typeof value === 'string' ? value : JSON.stringify(value, null, 2)
        .replace(/\[[^[\]{}]*\]/g, (list) => list.replace(/\s+/g, ' '));

    return el('pre', text);
}

// ---- schemas

// A type in words: "number, 0 to 1", "list of string", "match | no_match".
function words(schema) {
    const s = deref(schema);
    let w;

    if ('const' in s)
        return JSON.stringify(s.const);
    if (s.enum)
        w = s.enum.map((v) => JSON.stringify(v)).join(' | ');
    else if (s.type === 'array')
        w = 'list of ' + words(s.items);
    else
        w = [].concat(s.type || (s.properties ? 'object' : 'bytes')).join(' or ');
    if (s.minimum !== undefined)
        w += s.maximum !== undefined ? `, ${s.minimum} to ${s.maximum}` : `, ${s.minimum} or more`;
    if (s.exclusiveMinimum !== undefined)
        w += `, above ${s.exclusiveMinimum}`;
    if (s.minItems !== undefined && s.minItems === s.maxItems)
        w += `, ${s.minItems} of them`;
    else if (s.maxItems !== undefined)
        w += `, at most ${s.maxItems} of them`;
    if (s.maxLength !== undefined)
        w += `, at most ${s.maxLength} characters`;
    if (s.format)
        w += `, ${s.format}`;
    if (s.default !== undefined)
        w += `; without it ${JSON.stringify(s.default)}`;
    return w;
}

// The members of all that a schema is made of, each with whether it is always there.
function members(schema, into = new Map()) {
    const s = deref(schema);

    (s.allOf || []).concat(s.anyOf || []).forEach((part) => members(part, into));
    Object.entries(s.properties || {}).forEach(([name, p]) => {
        const old = into.get(name);
        const need = (s.required || []).includes(name);

        into.set(name, {schema: {...(old && old.schema), ...deref(p)},
            need: need || Boolean(old && old.need)});
    });
    return into;
}

function tree(schema) {
    const list = [...members(schema)].map(([name, m]) => {
        const inner = m.schema.type === 'array' ? m.schema.items : m.schema;

        return [el('dt', el('code', name), m.need ? null : el('span.type', ' optional')),
            el('dd', el('span.type', words(m.schema)), paragraphs(m.schema.description),
                members(inner).size ? tree(inner) : null)];
    });

    return el('dl', ...list.flat());
}

// ---- the parts of an operation

function content(types) {
    return Object.entries(types || {}).map(([type, media]) => {
        const examples = media.example !== undefined ? [media.example]
            : Object.values(media.examples || {}).map((x) => deref(x).value);
        const many = examples.length > 1;

        return [el('p', el('code', type), media.schema && deref(media.schema).description
            ? el('span.dim', ' ' + deref(media.schema).description) : null),
        members(media.schema).size
            ? details('schema', 'Members', tree(media.schema)) : null,
        many || typeof examples[0] === 'string'
            ? examples.map((x) => details('schema', x.code || 'Example', show(x)))
            : examples.map(show)];
    }).flat(3);
}

function parameters(list) {
    return el('dl', ...list.map(deref).map((p) => [
        el('dt', el('code', p.name), p.required ? el('span.need', 'required') : null),
        el('dd', el('span.type', `${p.in}, ${words(p.schema)}`), paragraphs(p.description)),
    ]).flat());
}

function response(status, described) {
    const r = deref(described);
    const kind = status < 300 ? 'good' : status < 500 ? 'refused' : 'fault';
    const headers = Object.entries(r.headers || {}).map(([name, h]) => [
        el('dt', el('code', name)), el('dd', paragraphs(deref(h).description))]);

    return details('response', el('span', el('span.status.' + kind, status), r.description),
        el('div', ...content(r.content),
            headers.length ? details('schema', 'Headers', el('dl', ...headers.flat())) : null));
}

// What one would type.
function curl(method, path, all, op) {
    const types = Object.keys((deref(op.requestBody) || {}).content || {});
    const file = types.includes('model/x-ply') ? ['model/x-ply', 'scan.ply']
        : ['application/json', 'body.json'];
    const filled = all.map(deref).filter((p) => p.in === 'path')
        .reduce((s, p) => s.replace(`{${p.name}}`, p.example), path);

    return el('pre', ['curl',
        method === 'get' || method === 'post' ? null : `-X ${method.toUpperCase()}`,
        op.security.length ? '-H "Authorization: Bearer $TOKEN"' : null,
        types.length ? `-H "Content-Type: ${file[0]}" --data-binary @${file[1]}` : null,
        new URL('.' + filled, location.href).href].filter(Boolean).join(' '));
}

function operation(method, path, item) {
    const op = item[method];
    const all = (item.parameters || []).concat(op.parameters || []);
    const body = deref(op.requestBody);
    const section = el('section.op', el('h3', op.summary),
        el('p.path', el('span.method.' + method, method.toUpperCase()), path),
        op.security.length ? el('p.dim', 'Scope of the token: ',
            el('code', op.security.map((s) => s.token).join(' or '))) : null,
        ...paragraphs(op.description), curl(method, path, all, op),
        el('h4', 'Parameters'), parameters(all),
        ...(body ? [el('h4', 'Body'), ...paragraphs(body.description), ...content(body.content)]
            : []),
        el('h4', 'Responses'),
        ...Object.entries(op.responses).map(([status, r]) => response(status, r)));

    section.id = op.operationId;
    return section;
}

// ---- the page

function render() {
    const ops = Object.entries(doc.paths).flatMap(([path, item]) =>
        METHODS.filter((m) => item[m]).map((m) => ({path, item, method: m, op: item[m]})));
    const contents = [link('#main', el('span.brand', doc.info.title)),
        el('p.dim', 'Version ' + doc.info.version)];
    const main = [el('h1', doc.info.summary),
        el('p.dim', `${doc.info.title} ${doc.info.version}, OpenAPI ${doc.openapi}: `,
            link('openapi.json', 'openapi.json')),
        ...paragraphs(doc.info.description)];

    for (const tag of doc.tags) {
        const own = ops.filter((o) => o.op.tags.includes(tag.name));
        const title = tag.name[0].toUpperCase() + tag.name.slice(1);

        contents.push(el('h2', title), el('ul', ...own.map((o) => el('li',
            link('#' + o.op.operationId, el('span.method.' + o.method, o.method.toUpperCase()),
                el('span', o.op.summary.split(':')[0]))))));
        main.push(el('h2.tag', title), el('p.dim', tag.description),
            ...own.map((o) => operation(o.method, o.path, o.item)));
    }
    document.getElementById('contents').replaceChildren(...contents);
    document.getElementById('main').replaceChildren(...main);
    if (matchMedia('(max-width: 54rem)').matches)
        document.getElementById('menu').open = false;
    if (location.hash)
        document.getElementById(location.hash.slice(1))?.scrollIntoView();
}

fetch('openapi.json').then((r) => {
    if (!r.ok)
        throw new Error('status ' + r.status);
    return r.json();
}).then((json) => {
    doc = json;
    render();
}).catch((e) => {
    document.getElementById('state').textContent = 'openapi.json cannot be shown: ' + e.message;
});
