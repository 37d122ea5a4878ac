// folder.js - the volumes of a folder, of which one is chosen: a list with small
// pictures, the next and the one before.
//
// The server says how many there are, and this page fetches them in pieces, and the
// pictures of those that are seen.  It says which one by number or name, and no path.

import {button, make} from './controls.js';

/** @typedef {import('./types').Entry} Entry */
/** @typedef {import('./types').Listed} Listed */

const ASKED = 4; // pictures under way
const LATER = 200; // ms in which new entries are shown together
const FEW = 8; // entries that nobody has to search

const order = new Intl.Collator(undefined, {numeric: true});

/** @param {number} bytes */
const size = bytes => bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : bytes < 1e9 ? `${(bytes / 1e6).toFixed(1)} MB`
    : `${(bytes / 1e9).toFixed(1)} GB`;

/** @param {number} seconds */
const day = seconds => new Date(1000 * seconds).toLocaleDateString('sv');

/** @param {string} name */
const split = name => [name.slice(0, name.lastIndexOf('/') + 1).slice(0, -1), name.slice(name.lastIndexOf('/') + 1)];

/** What is written under its picture: a name, and lines.
 * @param {Entry} entry
 * @returns {string[]} */
function words({kind, name, text, dims = [], times = 1, modality, description, day: own, bytes, changed}) {
    const [folder, file] = split(name);
    if (kind === 'recipe')
        return [file, `of ${text}`, day(changed), folder];
    return [description || file || 'series', [modality, dims.join(' x '), times > 1 ? `${times} steps` : ''].filter(Boolean).join(', '),
        [own || day(changed), bytes ? size(bytes) : ''].filter(Boolean).join(', '), description ? name : folder];
}

export class Folder {
    /** `found` hears that what a link names is open already.
     * @param {import('./store.js').Store} store
     * @param {() => void} openFile
     * @param {() => void} found */
    constructor(store, openFile, found) {
        this.store = store;
        this.found = found;
        /** How far the list is; null: there is none.
         * @type {Listed|null} */
        this.listed = null;
        /** @type {Entry[]} */
        this.entries = [];
        /** The volumes in the order of the page, by number.
         * @type {number[]} */
        this.order = [];
        /** @type {Map<number, HTMLElement>} */
        this.tiles = new Map();
        /** Numbers whose pictures are to be asked for.
         * @type {number[]} */
        this.wishes = [];
        this.asked = 0;
        this.fetching = false;
        /** @type {number|null} */
        this.opening = null; // the entry that was asked for
        /** @type {number|null} */
        this.then = null; // and the one after it
        /** What a link names, or was open before the viewer was started again: [name, series].
         * @type {string[]|null} */
        this.wanted = null;
        /** Whether that is not what was opened. */
        this.lacks = false;
        /** What was open when the connection was lost.
         * @type {string[]|null} */
        this.left = null;
        this.sought = false; // on this connection
        this.chosen = false; // on this connection, by the user
        this.timer = 0;
        this.head = make('h2', {textContent: 'Open', tabIndex: -1, autofocus: true, id: 'folder'});
        this.line = make('p', {className: 'faint grow', role: 'status'});
        this.find = make('input', {type: 'search', placeholder: 'Find', 'aria-label': 'Find in the list',
            oninput: () => this.arrange()});
        this.volumes = make('ul', {'aria-label': 'Volumes', className: 'tiles'});
        this.recipes = make('ul', {'aria-label': 'Recipes', className: 'tiles'});
        this.faults = make('ul', {});
        this.second = make('section', {hidden: true}, make('h3', {textContent: 'Recipes, the newest first'}), this.recipes);
        this.summary = make('summary', {textContent: 'Files that cannot be opened'});
        this.third = make('details', {hidden: true}, this.summary, this.faults);
        this.rest = make('p', {className: 'faint'});
        this.lists = make('div', {className: 'lists'}, this.volumes, this.second, this.third, this.rest);
        this.file = button('Recipe', 'A recipe from a file of this machine', openFile);
        this.close = button('Close', 'Close the list', () => this.element.close());
        for (const list of [this.volumes, this.recipes])
            list.onkeydown = event => this.move(list, event);
        /** @type {HTMLDialogElement} */
        this.element = make('dialog', {className: 'folder', 'aria-labelledby': 'folder', oncancel: (/** @type {Event} */ event) =>
            this.store.info || event.preventDefault()},
        make('div', {className: 'row'}, this.head, this.line, this.find, this.file, this.close), this.lists);
        this.buttons = make('span', {className: 'buttons', hidden: true},
            button('\u2039', 'The volume before (Shift+n)', () => this.step(-1)),
            button('\u203a', 'The next volume (n)', () => this.step(1)));
        this.seen = new IntersectionObserver(all => this.see(all), {root: this.lists, rootMargin: '100px'});
        const {engine} = store;
        engine.on('folder', listed => this.hear(listed));
        engine.on('entries', ({from, entries}) => this.take(from, entries));
        engine.on('cover', ({entry, image}) => this.show(entry, image));
        engine.on('opened', ({good}) => this.opened(good));
        engine.on('said', ({text}) => this.report(text));
        engine.on('progress', ({stage, part}) => this.opening === null ||
            this.report(part < 1 ? `${stage}, ${Math.round(100 * part)} %` : ''));
        engine.on('open', () => this.forget());
    }

    // --- what the server says ---

    /** The connection, or the server, is another. */
    forget() {
        this.left = this.current ?? this.left;
        this.sought = this.chosen = false;
        this.report('');
        this.entries = [];
        this.order = [];
        this.tiles.clear();
        this.wishes = [];
        this.asked = 0;
        this.fetching = false;
        this.opening = this.then = null;
    }

    /** @param {Listed} listed */
    hear(listed) {
        const first = !this.listed;
        this.listed = listed;
        this.buttons.hidden = false;
        this.head.textContent = `Open - ${listed.name}`;
        if (this.waits && this.left && !this.sought)
            this.wanted = this.left;
        this.sought = true;
        this.fetch();
        this.later();
        this.seek();
        if (listed.open === null && !this.element.open && (first || this.store.info))
            this.open();
    }

    fetch() {
        const {entries, listed} = this;
        if (this.fetching || !listed || entries.length >= listed.count)
            return;
        this.fetching = true;
        this.store.engine.ask('folder', {from: entries.length});
    }

    /** @param {number} from
     * @param {Entry[]} entries */
    take(from, entries) {
        this.fetching = false;
        if (from === this.entries.length)
            this.entries.push(...entries);
        this.fetch();
        this.later();
        this.seek();
    }

    /** What a link names, which is opened once the list has it.
     * @param {string|null} text */
    want(text) {
        try {
            const [name, series] = JSON.parse(text ?? '');
            this.wanted = [`${name}`, `${series}`];
        } catch {
            this.wanted = null; // the link names none
        }
    }

    /** What is open stays as it is. */
    seek() {
        const {wanted, entries, listed} = this;
        if (!wanted || !listed)
            return;
        const wish = entries.findIndex(({name, series, kind}) => kind !== 'fault' && name === wanted[0] && series === wanted[1]);
        if (wish < 0 && (!listed.done || entries.length < listed.count))
            return;
        this.wanted = null;
        if (wish >= 0 && wish === listed.open) {
            this.found();
        } else if (wish >= 0) {
            this.start(wish, wanted === this.left);
        } else {
            const text = `The list has no ${wanted[0]}, which ${wanted === this.left ? 'was open' : 'the link names'}: choose another.`;
            this.lacks = true;
            this.report(text);
            this.store.say(text, false, 20000);
        }
    }

    later() {
        this.timer ||= setTimeout(() => {
            this.timer = 0;
            this.arrange();
        }, this.tiles.size ? LATER : 0);
    }

    /** @param {boolean} good */
    opened(good) {
        const next = this.then;
        this.opening = this.then = null;
        if (good)
            this.report('');
        if (next !== null)
            this.start(next);
        else if (good)
            this.element.close();
        this.arrange();
    }

    /** What was said lies under the list.
     * @param {string} text */
    report(text) {
        this.line.textContent = text;
    }

    // --- the list ---

    /** @param {number} n */
    tile(n) {
        const entry = this.entries[n], [name, ...lines] = words(entry);
        let tile = this.tiles.get(n);
        if (tile)
            return tile;
        tile = make('li', {}, make('button', {type: 'button', onclick: () => this.choose(n), tabIndex: -1},
            ...entry.kind === 'volume' ? [make('img', {alt: '', width: 96, height: 96})] : [],
            make('b', {textContent: name}), ...lines.filter(Boolean).map(text => make('span', {textContent: text}))));
        tile.dataset.n = `${n}`;
        this.tiles.set(n, tile);
        if (entry.kind === 'volume')
            this.seen.observe(tile);
        return tile;
    }

    arrange() {
        const {entries, listed, find} = this;
        if (!listed)
            return;
        const text = find.value.toLowerCase(), all = entries.map((entry, n) => ({entry, n}));
        /** @param {string} kind */
        const of = kind => all.filter(({entry}) => entry.kind === kind &&
            words(entry).join(' ').toLowerCase().includes(text));
        const volumes = of('volume').sort((a, b) => order.compare(a.entry.name, b.entry.name) || a.n - b.n);
        const recipes = of('recipe').sort((a, b) => b.entry.changed - a.entry.changed);
        const faults = of('fault');
        if (!text)
            this.order = volumes.map(({n}) => n);
        find.hidden = entries.length <= FEW;
        for (const [list, rows] of /** @type {[HTMLElement, {n: number}[]][]} */ ([[this.volumes, volumes], [this.recipes, recipes]]))
            this.fill(list, rows.map(({n}) => this.tile(n)));
        this.second.hidden = !recipes.length;
        this.third.hidden = !faults.length;
        this.summary.textContent = `${faults.length} cannot be opened`;
        if (this.faults.childElementCount !== faults.length)
            this.faults.replaceChildren(...faults.map(({entry}) => make('li', {}, make('b', {textContent: entry.name}), ` ${entry.text ?? ''}`)));
        this.rest.textContent = this.others(volumes.length);
        this.file.hidden = this.close.hidden = !this.store.info; // nothing is behind the list
    }

    /** @param {number} volumes */
    others(volumes) {
        const {others, beyond, done} = /** @type {Listed} */ (this.listed);
        return [done ? volumes ? '' : 'Nothing here can be opened.' : `Looking: ${this.entries.length} found so far ...`,
            others ? `${others} ${others > 1 ? 'other files are no volumes' : 'other file is no volume'}.` : '',
            beyond ? `${beyond} more are too many to be listed.` : ''].filter(Boolean).join(' ');
    }

    /** Tiles that are there stay, with the focus; one of them is reached by Tab.
     * @param {HTMLElement} list
     * @param {HTMLElement[]} tiles */
    fill(list, tiles) {
        const focused = document.activeElement;
        if (list.childElementCount !== tiles.length || tiles.some((tile, i) => list.children[i] !== tile))
            list.replaceChildren(...tiles);
        if (focused instanceof HTMLElement && focused !== document.activeElement && list.contains(focused))
            focused.focus();
        const open = this.listed?.open ?? -1;
        for (const tile of tiles) {
            const own = tile.querySelector('button');
            if (own && Number(tile.dataset.n) === open)
                own.setAttribute('aria-current', 'true');
            else
                own?.removeAttribute('aria-current');
        }
        const stop = list.querySelector('[tabindex="0"]') ?? list.querySelector('[aria-current]') ?? list.querySelector('button');
        stop?.setAttribute('tabindex', '0');
    }

    /** Arrows go from one to another.
     * @param {HTMLElement} list
     * @param {KeyboardEvent} event */
    move(list, event) {
        const all = [...list.querySelectorAll('button')], at = all.indexOf(/** @type {any} */ (document.activeElement));
        const across = all.filter(each => each.offsetTop === all[0]?.offsetTop).length || 1;
        const steps = {ArrowRight: 1, ArrowLeft: -1, ArrowDown: across, ArrowUp: -across, Home: -at, End: all.length - 1 - at};
        const step = steps[/** @type {keyof typeof steps} */ (event.key)], next = all[at + (step ?? 0)];
        if (step === undefined || at < 0)
            return;
        event.preventDefault();
        if (!next)
            return;
        all[at].tabIndex = -1;
        next.tabIndex = 0;
        next.focus();
    }

    // --- pictures of those that are seen ---

    /** @param {IntersectionObserverEntry[]} all */
    see(all) {
        for (const {target, isIntersecting} of all) {
            if (!isIntersecting || !(target instanceof HTMLElement))
                continue;
            this.seen.unobserve(target);
            this.wishes.push(Number(target.dataset.n));
        }
        this.ask();
    }

    ask() {
        for (; this.asked < ASKED && this.wishes.length; this.asked++)
            this.store.engine.ask('cover', {entry: this.wishes.shift()});
    }

    /** @param {number} n
     * @param {string|null} image */
    show(n, image) {
        const picture = this.tiles.get(n)?.querySelector('img');
        if (picture && image)
            picture.src = image;
        this.asked = Math.max(0, this.asked - 1);
        this.ask();
    }

    // --- what is chosen ---

    open() {
        this.arrange();
        if (!this.element.open)
            this.element.showModal();
        this.element.querySelector('[aria-current]')?.scrollIntoView({block: 'nearest'});
    }

    /** @param {number} n */
    choose(n) {
        this.lacks ||= this.wanted !== null;
        this.wanted = null;
        this.chosen = true;
        this.start(n);
    }

    /** `first`: unless something is open by then.
     * @param {number} n */
    start(n, first = false) {
        if (this.opening !== null) {
            this.then = n;
            return;
        }
        this.opening = n;
        const text = `Opening ${words(this.entries[n])[0]} ...`;
        this.report(text);
        this.store.say(text, true);
        this.store.engine.ask('open', {entry: n, first});
    }

    /** The next, or the one before, of what is open or asked for.
     * @param {number} by */
    step(by) {
        const {order: all, listed} = this, from = this.then ?? this.opening ?? listed?.open ?? -1;
        if (!all.length)
            return;
        const at = all.indexOf(from);
        this.choose(all[at < 0 ? 0 : (at + by + all.length) % all.length]);
    }

    /** Whether nothing is open yet. */
    get waits() {
        return this.listed?.open === null;
    }

    /** What a link names of what is open, a volume or a recipe.
     * @returns {string[]|null} */
    get current() {
        const entry = this.entries[this.listed?.open ?? -1];
        return entry ? [entry.name, entry.series] : null;
    }
}
