// shell.js - opens volumes on the page without a server: the one that came with
// it, a phantom, files that are dropped or chosen, or those at a URL.  page.cmake puts this
// behind `begin`, which has the modules of the viewer.

import {addressOf} from './address.js';
import {readable} from './vti.js';

const body = document.body;
const from = id => document.getElementById(id);
const WORKER = URL.createObjectURL(new Blob([from('worker').textContent], {type: 'text/javascript'}));
const PIECE = 1 << 20; // letters of base64 at once
const LONG = 60000; // ms, or until the picture is touched

/** The bytes of a script in base64. */
function bytesOf(script) {
    const text = script.textContent.trim();
    const pad = text.endsWith('==') ? 2 : text.endsWith('=') ? 1 : 0;
    const bytes = new Uint8Array(text.length / 4 * 3 - pad);
    for (let at = 0, to = 0; at < text.length; at += PIECE) {
        const piece = atob(text.slice(at, at + PIECE));
        for (let i = 0; i < piece.length; i++)
            bytes[to++] = piece.charCodeAt(i);
    }
    return bytes;
}

const engine = new Response(new Blob([bytesOf(from('engine'))]).stream()
    .pipeThrough(new DecompressionStream('gzip'))).arrayBuffer();

/** The volumes that came with the page: then it can reach no server (cmd_export.c). */
const given = [...document.querySelectorAll('script[data-name]')];

let page, stop, shown, takeRecipe, coming, newest;
let refused = ''; // why the page's address names no volume

function make(tag, properties, ...children) {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
}

/** Shows a volume in the place of the one before, which stays until the new one is open: a
 * file may be refused. */
async function show(volume) {
    const own = newest = {}, [wasm, files] = await Promise.all([engine, readable(volume)]);
    if (newest !== own)
        return;
    coming?.engine.close();
    const main = document.createElement('main'), listeners = [], stopping = new AbortController();
    let aside = !!page; // another volume is shown, and its page says what becomes of this one
    const listen = each => aside ? listeners.push(each) : document.addEventListener(...each);
    main.id = 'viewer';
    const mine = new Proxy(document, {
        get(real, name) {
            if (name === 'addEventListener')
                return (kind, hear, how) => listen([kind, hear, {...how, signal: stopping.signal}]);
            if (name === 'getElementById')
                return id => main.id === id ? main : real.getElementById(id);
            const value = real[name];
            return typeof value === 'function' ? value.bind(real) : value;
        },
        set: (real, name, value) => Reflect.set(real, name, value)});
    const host = {volume: {wasm, recipe: {}, ...volume, files}, work: () => new Worker(WORKER), document: mine, window: {},
        location,
        /** The volume is open. */
        opened() {
            if (refused && page === made) {
                page.page.say(refused, true);
                refused = '';
            }
            if (coming !== made)
                return;
            aside = false;
            stop?.abort();
            page?.engine.close();
            [page, stop, shown, coming, takeRecipe] = [made, stopping, volume, null, take];
            nameAddress(volume);
            window.snowglass = page; // for the console, and for tests
            from('viewer').replaceWith(main);
            listeners.forEach(listen);
        },
        /** Whether another page has said it. */
        says(text) {
            if (aside)
                page.page.say(text, false, LONG);
            return aside;
        },
        refused(text) {
            const raw = text.includes('--dims') && (volume.files[0]?.file || volume.address);
            if (aside)
                made.engine.close();
            if (raw)
                askRaw(volume, text);
            return host.says(raw ? '' : text);
        }};
    const made = begin(host), {take} = made;
    coming = made;
    made.take = files => showFiles([...files].map(file => ({name: file.name, file})));
    made.file.multiple = true;
    const chooser = main.querySelector('[title^="Open a recipe"]');
    chooser.title = 'Open a volume of this machine, or a recipe; or drop it, a folder of DICOM too, on the page';
    if (!given.length)
        chooser.after(make('button', {type: 'button', textContent: 'URL', ariaLabel: 'Open from a URL',
            onclick: askAddress, title: 'Open a volume on a web server: OME-Zarr, or one file'}));
    if (!aside)
        host.opened();
}

// --- raw data ------------------------------------------------------------------

const TYPES = ['uint8', 'int8', 'uint16', 'int16', 'uint32', 'int32', 'uint64', 'int64',
    'float32', 'float64'];

/** Asks what a file without a header does not say, and opens it by that. */
function askRaw(volume, text) {
    const [, ...fits] = /fits: (\d+)x(\d+)x(\d+) (\w+)/.exec(text) ?? [];
    const old = volume.recipe ?? {};
    const numbers = (name, values, least) => values.map((value, i) => {
        const field = make('input', {type: 'number', min: least, step: 'any', value, required: true});
        field.setAttribute('aria-label', values.length > 1 ? `${name} along ${'xyz'[i]}` : name);
        return field;
    });
    const dims = numbers('voxels', old.dims ?? [fits[0] ?? '', fits[1] ?? '', fits[2] ?? ''], 1);
    const spacing = numbers('spacing', old.spacing ?? [1, 1, 1], 0);
    const [offset] = numbers('bytes before the voxels', [old.offset ?? 0], 0);
    const choice = (name, list) => {
        const made = make('select', {}, ...list.map(value => make('option', {value, textContent: value})));
        made.setAttribute('aria-label', name);
        return made;
    };
    const type = choice('type', TYPES), endian = choice('order of bytes', ['little', 'big']);
    type.value = old.type ?? fits[3] ?? 'uint8';
    endian.value = old.endian ?? 'little';
    const dialog = make('dialog', {});
    const open = () => {
        if (![...dims, ...spacing, offset].every(field => field.reportValidity()))
            return;
        dialog.close();
        const all = fields => fields.map(field => field.valueAsNumber);
        show({...volume, recipe: {dims: all(dims), type: type.value, endian: endian.value,
            offset: offset.valueAsNumber, spacing: all(spacing)}});
    };
    const row = (name, ...fields) => make('div', {className: 'row'},
        make('span', {className: 'name', textContent: name}), ...fields);
    dialog.append(make('h2', {textContent: `${volume.path}: how is it stored?`}),
        make('p', {className: 'faint', textContent: text}),
        row('Voxels', ...dims), row('Type', type), row('Bytes', endian), row('Header', offset),
        row('Distances', ...spacing), make('p', {}, make('button', {type: 'button', textContent: 'Open',
            onclick: open}), ' ', make('button', {type: 'button', textContent: 'Cancel',
            onclick: () => dialog.close()})));
    dialog.onclose = () => dialog.remove();
    body.append(dialog);
    dialog.showModal();
}

// --- a web server ----------------------------------------------------------------

/** A volume at an address, as the worker opens it. */
function volumeAt(text) {
    const {address, ...place} = addressOf(text, location);
    return {files: [place], path: place.path, address};
}

/** Whether a text is the address of a volume. */
function names(text, address) {
    try {
        return text !== null && addressOf(text, location).address === address;
    } catch {
        return false;
    }
}

/** The page's own address names the volume, unless there is a secret in it. */
function nameAddress({address}) {
    const url = new URL(location.href), was = url.searchParams.get('url');
    if (refused || names(was, address) || (was === null && !address))
        return;
    url.searchParams.delete('url');
    if (address && !new URL(address).search)
        url.searchParams.set('url', address);
    try {
        history.replaceState(null, '', url);
    } catch { // a page from the disk keeps its own
    }
}

/** The field of an address: it stays until one is taken. */
function askAddress() {
    const field = make('input', {type: 'text', id: 'address', autofocus: true, spellcheck: false,
        placeholder: 'https://...', value: shown?.address ?? ''});
    const wrong = make('p', {id: 'wrong'}), dialog = make('dialog', {});
    wrong.setAttribute('role', 'alert');
    field.setAttribute('aria-describedby', 'wrong');
    const form = make('form', {onsubmit(event) {
        event.preventDefault();
        try {
            const volume = volumeAt(field.value);
            dialog.close();
            show(volume);
        } catch (error) {
            wrong.textContent = error.message;
            field.focus();
        }
    }}, make('div', {className: 'row'}, make('label', {className: 'name', htmlFor: 'address', textContent: 'Address'}), field),
    wrong, make('p', {className: 'faint', textContent: 'An image or array of OME-Zarr, of which only what is shown is ' +
        'fetched, or one file, such as .nii.gz or .nrrd. Its server must allow this page to read it (CORS); cookies and ' +
        'passwords go to no other server.'}),
    make('p', {}, make('button', {textContent: 'Open'}), ' ',
        make('button', {type: 'button', textContent: 'Cancel', onclick: () => dialog.close()})));
    dialog.append(make('h2', {textContent: 'Open from a URL'}), form);
    dialog.onclose = () => dialog.remove();
    body.append(dialog);
    dialog.showModal();
    field.select();
}

// --- files of this machine -----------------------------------------------------

const HEADER = /\.(nhdr|mhd|hdr|bov|xdmf|xmf|pvti|pvd|vtm|vth|visit)$/i;

/** Several files are a header with its data, or a folder of slices; one of JSON is the
 * recipe of what is shown. */
function showFiles(files) {
    const [first] = files, header = files.find(({name}) => HEADER.test(name));
    if (!first)
        return;
    if (files.length === 1 && first.file && /^[^/]*\.json$/i.test(first.name))
        takeRecipe([first.file]);
    else if (first.name.includes('/') || header || files.length === 1)
        show({files, path: header?.name ?? first.name.split('/')[0]});
    else
        show({files: files.map(({name, file}) => ({name: `files/${name}`, file})), path: 'files'});
}

/** All files of a dropped file or folder. */
async function filesOf(entry) {
    if (entry.isFile) {
        const file = await new Promise((good, bad) => entry.file(good, bad));
        return [{name: entry.fullPath.slice(1), file}];
    }
    const reader = entry.createReader(), found = [];
    for (;;) { // some at a time
        const some = await new Promise((good, bad) => reader.readEntries(good, bad));
        if (!some.length)
            return (await Promise.all(found.map(filesOf))).flat();
        found.push(...some);
    }
}

/** The same of a handle, which Chromium has. */
async function filesOfHandle(handle, name) {
    if (handle.kind === 'file')
        return [{name, file: await handle.getFile()}];
    const found = [];
    for await (const each of handle.values())
        found.push(filesOfHandle(each, `${name}/${each.name}`));
    return (await Promise.all(found)).flat();
}

/** Of what was dropped.  On a page from the disk Chromium opens no entry, but handles of
 * folders; what a file is, is known without either. */
async function filesOfItem(entry, file, handle) {
    if (!entry?.isDirectory)
        return file ? [{name: file.name, file}] : [];
    const folder = await handle?.catch(() => null);
    return folder ? filesOfHandle(folder, folder.name) : filesOf(entry);
}

body.addEventListener('dragover', event => event.preventDefault());
body.addEventListener('drop', async event => {
    event.preventDefault();
    event.stopPropagation(); // the viewer takes recipes alone
    const dropped = [...event.dataTransfer.items].map(item => filesOfItem(item.webkitGetAsEntry(),
        item.getAsFile(), item.getAsFileSystemHandle?.()));
    try {
        showFiles((await Promise.all(dropped)).flat());
    } catch {
        page.page.say('The browser cannot read this folder: drop its files, or choose them with Open.');
    }
});

/** Another link: files of this machine cannot be loaded again. */
addEventListener('hashchange', () => shown?.files[0]?.file || shown?.address ? show(shown) : location.reload());

// --- at the beginning ----------------------------------------------------------

const phantom = {files: [], path: 'phantom:engine'}, wanted = new URLSearchParams(location.search).get('url');
if (given.length) { // a volume, and what its recipe names
    const [{dataset}] = given;
    show({path: dataset.name, recipe: JSON.parse(dataset.recipe),
        files: given.map(each => ({name: each.dataset.name, bytes: bytesOf(each).buffer}))});
} else if (wanted === null) {
    show(phantom);
} else {
    try {
        show(volumeAt(wanted));
    } catch (error) {
        refused = error.message;
        show(phantom);
    }
}
