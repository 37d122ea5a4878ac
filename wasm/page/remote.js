// remote.js - the files of a server for the engine, which asks for them by name as for
// those of a folder (worker.js).  The engine waits while it reads, so requests wait too:
// a worker may.  Nothing is fetched twice while it is kept.
//
//   answer                                  of metadata that is looked for     of voxels
//   200, 206                                what there is                      the same
//   404, 410                                not there                          not there
//   403: a bucket that hides its list       not there                          fault
//   none: 404 without CORS, or no server    not there where the server has     fault
//                                           answered something else
//   any other, or a page of HTML            fault                              fault
//
// A server lists no folder: metadata name what is in one.
'use strict';

const FAR = 1 << 20; // the number of the first file of a server
const NONE = -1, FOLDER = -2, FAILED = -3; // host.h
const MARKS = ['zarr.json', '.zgroup', '.zattrs', '.zarray'];
const METADATA = /(^|\/)(zarr\.json|\.z(array|attrs|group|metadata))$/;
const VOXELS = /(^|[/.])(\d+|c)$/; // "0/1/2", "c.0.1.2", in version 3 of one number "c"
const ALONE = /\.(nii|hdr|img|nrrd|nhdr|mha|mhd|mrc|map|rec|npy|png|vtk|vti|dcm|nc|raw|den|vol|bin|cube|gipl|mgh|mgz|zip|tiff?|h5|gz|bz2)$/i;
const BLOCK = 1 << 18; // bytes of a large file that are fetched at once, at least
const BLOCKS_MOST = 64;
const HELD = 1 << 28; // bytes of voxels that are kept
const NUMBERS_MOST = 1000; // images of a collection
const BUSY = [429, 502, 503, 504]; // it is asked once more
const TEXT_MOST = 160; // letters of an address in a message
const LETTERS_OF_HTML = 512;

class Fault extends Error {}

/** What is said of an answer that is no file. */
function meaning(status) {
    if (status === 401 || status === 403)
        return 'only who may read it, or a signed address, gets it; of voxels that were never written a bucket ' +
            'answers so where it hides its list: allow listing';
    return status === 404 || status === 410 ? 'check the address' : 'try again later, or ask who runs the server';
}

/** An address in a message: without what may be secret. */
function shown(url) {
    const {origin, pathname} = new URL(url), text = origin + pathname;
    return text.length > TEXT_MOST ? `${text.slice(0, TEXT_MOST / 2)}...${text.slice(-TEXT_MOST / 2)}` : text;
}

function isPage(bytes) {
    const head = new TextDecoder('latin1').decode(new Uint8Array(bytes, 0, Math.min(bytes.byteLength, LETTERS_OF_HTML)));
    return /^(\xef\xbb\xbf)?\s*(<![-]-[^]*?-->\s*|<\?xml[^>]*>\s*)*<(!doctype html|html|head|body|ListBucketResult|Error)\b/i.test(head);
}

function parsed(bytes) {
    try {
        return JSON.parse(new TextDecoder().decode(bytes)) ?? {};
    } catch { // the engine says so
        return {};
    }
}

/** The files below a folder of a server.  `base` ends with a slash, `query` is put behind
 * each name; `path` is what the user has named.  `onFetch` hears of each answer. */
class Remote {
    constructor({base, query, path}, onFetch = () => {}) {
        Object.assign(this, {base, query, path, onFetch});
        this.files = new Map(); // of names: {number, bytes, size, blocks}, or null: not there
        this.list = []; // the same by number
        this.held = new Map(); // voxels that are kept, the oldest first
        this.room = HELD;
        this.inside = new Map(); // of folders, the names in them
        this.numbered = new Set(); // folders of images that have numbers
        this.sharded = []; // folders of arrays whose files are read by the part
        this.heard = false; // the server has answered
        this.denied = false; // it has said of a file that there is none
        this.whole = false; // it sends no parts
        this.fetched = 0; // bytes, and files
        this.count = 0;
    }

    url(name) {
        return this.base + name.split('/').map(encodeURIComponent).join('/') + this.query;
    }

    // --- requests ------------------------------------------------------------------

    send(method, url, range) {
        const request = new XMLHttpRequest();
        try {
            request.open(method, url, false);
            request.responseType = 'arraybuffer';
            if (range)
                request.setRequestHeader('Range', `bytes=${range.join('-')}`);
            request.send();
        } catch { // no server, or none that lets this page read what it answers
            return {status: 0};
        }
        return request;
    }

    /** An answer; of a server that is busy the second one. */
    ask(url, range) {
        let answer = this.send('GET', url, range);
        if (BUSY.includes(answer.status) || (!answer.status && this.heard && this.denied))
            answer = this.send('GET', url, range);
        const {status, response, statusText = ''} = answer;
        this.heard ||= status > 0;
        this.denied ||= status === 404 || status === 410 || status === 403;
        const came = status === 200 || status === 206;
        if (came) {
            this.fetched += response.byteLength;
            this.onFetch(this);
        }
        return {status, statusText, bytes: came ? response : null, range: came && answer.getResponseHeader('Content-Range')};
    }

    fault(url, {status, statusText}) {
        const named = statusText && ` (${statusText})`;
        return new Fault(status ? `${shown(url)} was answered by ${status}${named}; ${meaning(status)}`
            : `${shown(url)} got no answer that this page may read; check the address and that the server runs, and ` +
            'allow this page there by CORS (Access-Control-Allow-Origin: *)' +
            (this.heard ? ', also in its answers for what is missing' : ''));
    }

    /** A whole file, or null: it is not there. */
    get(name) {
        const url = this.url(name), answer = this.ask(url), {status, bytes} = answer, probed = METADATA.test(name);
        if (status === 404 || status === 410 || (probed && (status === 403 || (!status && !this.denied)))) {
            this.missed = this.fault(url, answer);
            return null;
        }
        if (!bytes)
            throw this.fault(url, answer);
        return this.checked(url, bytes);
    }

    checked(url, bytes) {
        if (isPage(bytes))
            throw new Fault(`${shown(url)} is a page of HTML or a listing, no data; check the address, and that the server answers ` +
                '404 for what is missing');
        return bytes;
    }

    // --- names ---------------------------------------------------------------------

    /** The file of a name, whose beginning is there, or null.  A store has nothing but
     * metadata and voxels, in a folder of version 3 nothing of version 2. */
    file(name) {
        const known = this.files.get(name);
        if (known instanceof Fault)
            throw known;
        const stray = this.store && !METADATA.test(name) && !VOXELS.test(name);
        const older = /(^|\/)\.z(array|attrs|group)$/.test(name) && this.files.get(name.replace(/[^/]*$/, MARKS[0]));
        if (known !== undefined || stray || older)
            return known ?? null;
        try {
            return this.fetchFile(name);
        } catch (error) {
            this.files.set(name, error);
            throw error;
        }
    }

    fetchFile(name) {
        const parts = !this.whole && (name === this.path || this.sharded.some(each => name.startsWith(each)));
        const found = METADATA.test(name) ? this.metadata(name) : parts ? this.beginning(name) : this.get(name);
        const file = found && (found.byteLength === undefined ? found : {bytes: found, size: found.byteLength});
        this.files.set(name, file);
        if (!file)
            return null;
        Object.assign(file, {name, number: FAR + this.list.length});
        this.list.push(file);
        this.count++;
        if (file.bytes && !METADATA.test(name))
            this.keep(name, file.size, () => { file.bytes = null; });
        return file;
    }

    find(name) {
        const slash = name.lastIndexOf('/'), listed = this.inside.get(name.slice(0, Math.max(0, slash)));
        if (!name || this.path.startsWith(`${name}/`) || listed?.has(name.slice(slash + 1)) ||
            (name === this.path && this.isStore()))
            return FOLDER;
        const file = this.file(name);
        if (!file && name === this.path)
            throw this.missed;
        return file?.number ?? NONE;
    }

    /** Whether the user has named a folder of Zarr. */
    isStore() {
        const named = /\.zarr(\/|$)/i.test(this.path), alone = ALONE.test(this.path) && !named;
        this.store ??= !alone && MARKS.some(mark => this.file(`${this.path}/${mark}`));
        if (!named || this.store)
            return this.store;
        throw !this.denied || / 40[13]/.test(this.missed.message) ? this.missed : new Fault(`${shown(this.url(this.path))} has ` +
            `no ${MARKS.slice(0, -1).join(', ')} or ${MARKS.at(-1)}: there is no Zarr array or group; check the address`);
    }

    /** A file of metadata, which says what else is there. */
    metadata(name) {
        const bytes = this.get(name);
        if (!bytes)
            return null;
        const slash = name.lastIndexOf('/'), folder = name.slice(0, Math.max(0, slash)), last = name.slice(slash + 1);
        const tree = parsed(bytes);
        if (last === 'zarr.json') {
            this.learn(folder, tree.attributes ?? {}, Object.keys(tree.consolidated_metadata?.metadata ?? {}));
            if (tree.node_type === 'array' && /"sharding_indexed"/.test(JSON.stringify(tree.codecs ?? '')))
                this.sharded.push(`${folder}/`);
        } else if (last === '.zattrs') {
            this.learn(folder, tree, []);
        } else if (last === '.zmetadata') {
            const all = Object.keys(tree.metadata ?? {}).map(each => each.split('/').slice(0, -1).join('/'));
            this.learn(folder, {}, all.filter(Boolean));
        }
        return bytes;
    }

    /** What attributes and others say that a folder holds: plates have wells, wells fields, and
     * collections of images (bioformats2raw) numbers. */
    learn(folder, attributes, paths) {
        const own = attributes.ome ?? attributes;
        const named = [own.plate?.wells, own.well?.images].flat().map(each => each?.path);
        for (const path of [...named, ...paths])
            if (typeof path === 'string')
                this.add(folder, path);
        if (own['bioformats2raw.layout'] !== undefined)
            this.numbered.add(folder);
    }

    add(folder, path) {
        let at = folder;
        for (const part of path.split('/').filter(each => each && each !== '.' && each !== '..')) {
            this.inside.set(at, (this.inside.get(at) ?? new Set()).add(part));
            at += `/${part}`;
        }
    }

    entries(folder) {
        if (this.numbered.delete(folder))
            for (let n = 0; n < NUMBERS_MOST && MARKS.some(mark => this.file(`${folder}/${n}/${mark}`)); n++)
                this.add(folder, `${n}`);
        for (let at = folder; at && !this.inside.has(folder); at = at.split('/').slice(0, -1).join('/'))
            this.file(`${at}/.zmetadata`);
        const url = shown(this.url(folder));
        if (!this.inside.has(folder))
            throw new Fault(`${url} is a group, which no server lists, and its metadata do not say what is in it ` +
                `(there is no .zmetadata); name an array or image behind the address, as in ${url}/0`);
        return [...this.inside.get(folder)];
    }

    // --- bytes ---------------------------------------------------------------------

    /** Keeps what can be fetched again, and lets the oldest go. */
    keep(key, size, drop) {
        this.held.set(key, {size, drop});
        this.room -= size;
        for (const [old, each] of this.held) {
            if (this.room >= 0 || old === key)
                break;
            each.drop();
            this.room += each.size;
            this.held.delete(old);
        }
    }

    /** The first bytes of a file that may be large: all of it where the server sends no
     * parts. */
    beginning(name) {
        const url = this.url(name), answer = this.ask(url, [0, BLOCK - 1]), {status, bytes, range} = answer;
        if (status === 200 || status === 416)
            return bytes ? this.checked(url, bytes) : this.get(name);
        if (!status) { // CORS may not allow to ask for a part
            const all = this.get(name);
            this.whole = all !== null;
            return all;
        }
        if (status === 404 || status === 410) {
            this.missed = this.fault(url, answer);
            return null;
        }
        if (!bytes)
            throw this.fault(url, answer);
        this.checked(url, bytes);
        if (bytes.byteLength < BLOCK)
            return bytes;
        const size = Number(/\/(\d+)$/.exec(range || '')?.[1] ?? this.length(url));
        if (!(size >= bytes.byteLength))
            return this.get(name);
        const file = {size, blocks: new Map(), next: 1, ahead: 1};
        this.put(file, name, 0, bytes);
        return file;
    }

    /** The length of a file of which the server does not say it with a part. */
    length(url) {
        const answer = this.send('HEAD', url);
        return answer.status === 200 ? answer.getResponseHeader('Content-Length') : NaN;
    }

    put(file, name, first, bytes) {
        for (let at = 0; at < bytes.byteLength; at += BLOCK) {
            const block = first + at / BLOCK, part = bytes.slice(at, at + BLOCK);
            file.blocks.set(block, part);
            this.keep(`${name}:${block}`, part.byteLength, () => file.blocks.delete(block));
        }
    }

    size(number) {
        return this.list[number - FAR].size;
    }

    read(number, at, size) {
        const file = this.list[number - FAR];
        if (file.blocks)
            return this.readPart(file, at, size);
        file.bytes ??= this.again(file);
        return new Uint8Array(file.bytes, at, size);
    }

    /** What was let go. */
    again(file) {
        const bytes = this.get(file.name);
        if (bytes?.byteLength !== file.size)
            throw new Fault(`${shown(this.url(file.name))} has changed while it was read; open it again`);
        this.keep(file.name, file.size, () => { file.bytes = null; });
        return bytes;
    }

    /** Where reading goes on, more is fetched at once. */
    readPart(file, at, size) {
        const out = new Uint8Array(size), first = Math.floor(at / BLOCK), last = Math.floor((at + size - 1) / BLOCK);
        const end = Math.ceil(file.size / BLOCK);
        for (let block = first; block <= last; block++) {
            if (!file.blocks.has(block)) {
                file.ahead = block === file.next ? Math.min(2 * file.ahead, BLOCKS_MOST) : 1;
                let until = Math.min(end, Math.max(block + file.ahead, Math.min(last + 1, block + BLOCKS_MOST)));
                for (let each = block + 1; each < until; each++)
                    if (file.blocks.has(each))
                        until = each;
                this.fetchPart(file, block, until);
                file.next = until;
            }
            const begin = block * BLOCK, from = Math.max(at, begin), to = Math.min(at + size, begin + BLOCK);
            out.set(new Uint8Array(file.blocks.get(block), from - begin, to - from), from - at);
        }
        return out;
    }

    fetchPart(file, block, until) {
        const url = this.url(file.name), from = block * BLOCK, to = Math.min(file.size, until * BLOCK);
        const answer = this.ask(url, [from, to - 1]);
        if (answer.status !== 206)
            throw this.fault(url, answer);
        if (answer.bytes.byteLength !== to - from)
            throw new Fault(`${shown(url)} has changed while it was read; open it again`);
        this.put(file, file.name, block, answer.bytes);
    }
}

if (typeof module !== 'undefined')
    module.exports = {Remote, FAR};
