// address.js - the address of a volume on a web server, as remote.js reads it.

/** What pages cannot open, as they can. */
const ELSEWHERE = {
    's3:': url => `https://${url.host}.s3.amazonaws.com${url.pathname}`,
    'gs:': url => `https://storage.googleapis.com/${url.host}${url.pathname}`};
const METADATA = /\/(zarr\.json|\.z(array|attrs|group|metadata))$/;
const OF_THIS_MACHINE = /^(localhost|127(\.\d+){3}|\[::1\])$/;
const KIND = /\.[a-z0-9]{1,8}$/i; // of a file's name

/** A part of an address as a name: "a b" of "a%20b". */
function decoded(part) {
    try {
        const name = decodeURIComponent(part);
        return /[/\0]/.test(name) || name === '..' ? part : name;
    } catch {
        return part;
    }
}

/** Where the names below an address begin: with the highest folder of Zarr in it; of a file
 * with its name; else one above, which may be an image whose level is named. */
function firstOf(parts) {
    const zarr = parts.findIndex(part => /\.zarr$/i.test(part));
    return zarr >= 0 ? zarr : Math.max(0, parts.length - (KIND.test(parts.at(-1)) ? 1 : 2));
}

/** The folder, what is put behind each name, and the path of the volume; throws an Error that
 * says why it cannot be opened. */
export function addressOf(text, page) {
    const given = text.trim();
    if (!given)
        throw new Error('There is no address: type one that begins with https:// or http://.');
    let url;
    try {
        url = new URL(given, page.href);
    } catch {
        throw new Error(`"${given}" is no address: it begins with https:// or http://.`);
    }
    const other = ELSEWHERE[url.protocol];
    if (!/^https?:$/.test(url.protocol))
        throw new Error(other ? `A page cannot open ${url.protocol}//; try ${other(url)}` :
            `"${given}" cannot be opened: an address begins with https:// or http://.`);
    if (url.username || url.password)
        throw new Error('An address with a name and a password is not taken: use one that is signed, or public.');
    if (page.protocol === 'https:' && url.protocol === 'http:' && !OF_THIS_MACHINE.test(url.hostname))
        throw new Error('A page that came by https reads nothing by http: use the https address.');
    const parts = url.pathname.replace(METADATA, '').split('/').filter(Boolean);
    if (!parts.length)
        throw new Error(`"${given}" names a server alone: add the path of a volume.`);
    const first = firstOf(parts), folder = parts.slice(0, first).map(part => `${part}/`).join('');
    return {address: `${url.origin}/${parts.join('/')}${url.search}`, base: `${url.origin}/${folder}`,
        query: url.search, path: parts.slice(first).map(decoded).join('/')};
}
