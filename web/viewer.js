// viewer.js - puts the page together: the picture, the lines around it, and what
// the buttons do.

import {button, context, make, select, tip} from './controls.js';
import {ServerEngine} from './engine_server.js';
import {aimed, unproject} from './camera.js';
import {Cube} from './cube.js';
import {Folder} from './folder.js';
import {Hints, help} from './help.js';
import {MODES, MODE_NAMES, listenToKeys} from './keys.js';
import {layouts} from './layout.js';
import {MEASURES, Measure} from './measure.js';
import {Movies} from './panel/movies.js';
import {Overlay} from './panel/overlay.js';
import {Panel} from './panel/panel.js';
import {Pointer, TOOLS} from './pointer.js';
import {isLook} from './panel/presets.js';
import {Slices} from './slices.js';
import {FEW, Store, known} from './store.js';
import {Times} from './panel/time.js';
import {leftOut, sifted} from './valid.js';

/** @typedef {import('./types').Keys} Keys */

const SIDE_MOST = 4096;
const LEVELS = ['draft', 'almost final', 'final'];

const given = new URLSearchParams(location.hash.slice(1));
window.onhashchange = () => location.reload(); // another secret, another link
const engine = new ServerEngine(given.get('token') ?? '');
const store = new Store(engine);

// --- elements ----------------------------------------------------------------

const canvas = make('canvas', {tabIndex: 0, role: 'img', 'aria-label': 'The volume'});
const paint = context(canvas, {alpha: false});
const said = make('p', {className: 'said', role: 'status', tabIndex: 0});
const title = make('span', {className: 'faint grow'});
const level = make('span', {className: 'faint level'});
const figures = make('span', {className: 'faint grow'});
const undo = button('Undo', 'Undo (z)', () => actions.undo());
const redo = button('Redo', 'Redo (Shift+z)', () => actions.redo());
const buttons = make('span', {className: 'buttons'});
const copied = make('textarea', {readOnly: true, spellcheck: false, 'aria-label': 'Text to copy'});
const dialog = make('dialog', {});
const picture = make('div', {className: 'picture'}, canvas, said);
const views = make('div', {className: 'views'}, picture);

// --- what is said --------------------------------------------------------------

let quiet = 0;
/** @param {string} line */
function say(line, stays = false, time = 6000) {
    said.textContent = line;
    picture.onpointerdown = ({target}) => stays || target === said || say(''); // it covers what is touched
    clearTimeout(quiet);
    if (!stays)
        quiet = setTimeout(() => {
            if (document.activeElement !== said) // it is read
                said.textContent = '';
        }, time);
}

store.say = say;

/** @type {Record<string, string>} */
const SECTIONS = {channel: 'Channels', crop: 'Crop', clip: 'Clip', preset: 'Presets', range: 'Range',
    window: 'Window', opacity: 'Opacity', colormap: 'Colours', time: 'Step', light: 'Light', title: 'Title'};

/** "0.5 x 0.5 x 2 mm", or each with its unit where these differ.
 * @param {import('./types').Info} info */
function distances({spacing, axes}) {
    const texts = spacing.map(x => `${+x.toPrecision(4)}`), units = axes.map(([unit]) => unit);
    return new Set(units).size === 1 ? `${texts.join(' x ')} ${units[0]}`.trim()
        : texts.map((text, i) => `${text} ${units[i]}`.trim()).join(' x ');
}

/** What is said of options, in words of the page: "--channel N" is its section Channels.
 * @param {string} line */
const plain = line => line.replace(/--([a-z][a-z-]*)( [A-Z]+\b)?/g, (all, name) => SECTIONS[name] ?? name);

/** @param {string} name
 * @param {...(Node|string)} children */
function open(name, ...children) {
    // A long text is read from its beginning.
    dialog.replaceChildren(make('h2', {textContent: name, tabIndex: -1, autofocus: true}), ...children,
        make('p', {}, button('Close', 'Close', () => dialog.close())));
    if (!dialog.open)
        dialog.showModal();
}

/** Asks whether something is to be done.
 * @param {string} name
 * @param {string} text
 * @param {string} answer
 * @param {() => void} act */
function question(name, text, answer, act) {
    open(name, make('p', {textContent: text}), make('p', {}, button(answer, answer, () => {
        dialog.close();
        act();
    })));
}

/** Shows a text, and copies it where the browser allows that.
 * @param {string} name
 * @param {string} value */
async function copy(name, value) {
    copied.value = value;
    open(name, copied);
    copied.select();
    copied.scrollTop = 0; // a long command is read from its beginning
    try {
        await navigator.clipboard.writeText(value);
        say('Copied.');
    } catch {
        say('Press Ctrl+C to copy.');
    }
}

/** @param {string} name
 * @param {Blob} blob */
function save(name, blob) {
    const link = make('a', {href: URL.createObjectURL(blob), download: name});
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const baseName = () => known(store.info).name.split(':').at(-1)?.split('.')[0] || 'picture';

// --- actions --------------------------------------------------------------------

/** @type {import('./types').Actions} */
const actions = {
    view(name) {
        store.set({view: name, azimuth: 0, elevation: 0, roll: 0, position: null, up: null});
    },
    fit() {
        store.remember(['zoom', 'target', 'fit']);
        engine.ask('fit');
    },
    mode() {
        const next = MODES[(MODES.indexOf(store.keys.mode ?? 'over') + 1) % MODES.length];
        const {low, high} = known(store.look);
        store.set(next === 'iso' ? {mode: next, iso: store.keys.iso ?? (low + high) / 2}
            : {mode: next, iso: null});
        say(`Mode: ${MODE_NAMES[next]}`);
    },
    perspective() {
        const on = (store.keys.perspective ?? 0) > 0;
        store.set({perspective: on ? 0 : known(store.info).fov});
    },
    letters: () => store.set({'no-labels': store.keys['no-labels'] ? null : true}),
    play: () => times.play(),
    drag() {
        tool.value = store.tool = TOOLS[(TOOLS.findIndex(([name]) => name === store.tool) + 1) % TOOLS.length][0];
        measure.take(null);
        say(`A drag ${tool.selectedOptions[0].text}`);
    },
    slices: () => slices.toggle(),
    lines: () => slices.keys && slices.set({lines: slices.keys.lines === false ? undefined : false}),
    /** Another press puts it away. */
    measure(name) {
        const own = measure.offered && measure.tool !== name ? name : null;
        measure.take(own);
        tool.value = own ?? store.tool;
    },
    length: () => actions.measure('line'),
    angle: () => actions.measure('angle'),
    ellipse: () => actions.measure('ellipse'),
    handles() {
        if (panel.clips)
            panel.clips.open = !panel.clips.open;
    },
    command: () => engine.ask('command'),
    movie: () => engine.ask('movie-command', movies.order),
    link() {
        const url = new URL(location.href);
        url.hash = linkTo(store.keys, folder.current); // all of them: elsewhere no look was before
        copy('Link to this state', url.href);
    },
    file: () => engine.ask('recipe'),
    saveLook: () => engine.ask('look-file'),
    choose: chooseFile,
    save() {
        if (store.rest)
            save(`${baseName()}.png`, store.rest);
        else
            say('The picture is saved when it is final: wait a moment.');
    },
    reset() {
        store.replace(begin);
    },
    open: () => folder.listed ? folder.open() : chooseFile(),
    next: () => folder.step(1),
    previous: () => folder.step(-1),
    undo: () => store.undo() || say('Nothing to undo'),
    redo: () => store.redo() || say('Nothing to redo'),
    help: () => open('Help', ...help(store)),
};

// --- the picture ------------------------------------------------------------------

/** Pixels of the screen, as many as the server draws. */
function fitWindow(anew = false) {
    const scale = devicePixelRatio || 1;
    if (!picture.clientWidth || store.info?.live) // a slice is shown alone; a movie has one size
        return;
    const size = [picture.clientWidth, picture.clientHeight].map(
        side => Math.max(16, Math.min(SIDE_MOST, Math.round(side * scale))));
    if (anew || `${store.keys.size}` !== `${size}`)
        store.apply({size});
}

/** The pixels that a draft stands for: those of this page, unless it was made for the shape of another.
 * @param {import('./types').Frame} frame
 * @returns {[number, number]} */
function enlarged({width, height}) {
    const [across, down] = store.keys.size ?? [width, height];
    return Math.abs(across * height - down * width) <= 2 * Math.max(across, down) ? [across, down]
        : [width, height];
}

let trip = 0;
engine.on('measured', ms => {
    trip = ms;
});
engine.on('picture', frame => {
    const {width, height} = frame;
    pointer.size = frame.level ? [width, height] : enlarged(frame);
    const other = canvas.width !== width || canvas.height !== height;
    if (other)
        [canvas.width, canvas.height] = [width, height];
    // The browser enlarges a small draft as it puts the page together, which is quicker than a larger canvas.
    canvas.style.objectFit = `${pointer.size}` === `${[width, height]}` ? '' : 'fill';
    if (frame.level === 2) { // it may have alpha: over black, as those before it
        paint.fillStyle = '#000';
        paint.fillRect(0, 0, width, height);
    }
    paint.drawImage(known(frame.bitmap), 0, 0);
    const own = !store.size || `${store.size}` === `${[frame.width, frame.height]}`;
    store.rest = frame.level === 2 && own ? frame.blob : null;
    store.frames++;
    if (other || canvas.dataset.level !== '0' || frame.level || store.frames % FEW === 0) {
        canvas.dataset.level = `${frame.level}`;
        const part = Math.round(pointer.size[0] / width);
        const share = part > 1 ? `, 1/${part} size` : '';
        level.textContent = store.info?.live ? `step ${store.step}` : frame.level < 2 || own
            ? LEVELS[frame.level] + share : 'as another page has it';
        figures.textContent = `${frame.width} x ${frame.height}, drawn in ${frame.render.toFixed(1)} ms, ` +
            `packed in ${frame.pack.toFixed(1)} ms, ${(frame.bytes / 1024).toFixed(0)} kB, ` +
            `round trip ${trip.toFixed(0)} ms`;
    }
    overlay.follow();
});

function describe() {
    const {keys, info} = store;
    if (!info)
        return;
    canvas.setAttribute('aria-label', `${info.name} from ${keys.view ?? info.view}, ` +
        `azimuth ${keys.azimuth ?? 0}, elevation ${keys.elevation ?? 0} degrees, ` +
        `preset ${keys.preset ?? 'automatic'}, mode ${keys.mode ?? 'over'}`);
    undo.disabled = !store.before.length;
    redo.disabled = !store.after.length;
}

/** What stands behind the # of a link.
 * @param {Keys} state
 * @param {string[]|null} volume of a folder */
function linkTo({size, ...keys}, volume) {
    const words = new URLSearchParams({token: engine.token, recipe: JSON.stringify(keys)});
    if (volume)
        words.set('volume', JSON.stringify(volume));
    return `${words}`;
}

// --- recipes of files -----------------------------------------------------------------

/** @param {unknown} path */
const lastOf = path => `${path}`.split('/').at(-1);

/** Takes the state of a file; what a page cannot change stays as it is.
 * @param {ArrayLike<File>} files */
async function take({0: file}) {
    if (!file) // a text was dropped
        return;
    if (!store.info) {
        engine.tell('said', {text: 'Nothing is open yet: choose a volume, then a recipe.'});
        return;
    }
    const {info} = store;
    /** @type {Record<string, unknown>} */
    const taken = {};
    try {
        const keys = JSON.parse(await file.text()), name = lastOf(keys.input ?? info.name);
        for (const [key, value] of Object.entries(keys)) {
            const switched = key === 'mask' || key === 'overlay', own = switched && info[key];
            if (switched ? own === true || own === lastOf(value) : info.keys?.includes(key))
                taken[key] = switched || value;
        }
        const {good, wrong} = sifted(taken, info);
        if (!Object.keys(good).length)
            throw 0;
        if (isLook(keys))
            panel.presets.take(good);
        else
            store.replace({slices: store.keys.slices, ...good});
        say(`${leftOut(wrong)} ${name === info.name ? '' : `The recipe is of ${name}, and taken.`}`.trim());
    } catch {
        say(`${file.name} is no recipe, as Recipe and --save-config write them.`);
    }
}

/** The state of a link: of what it says, all that is understood.
 * @param {string} text */
function openLink(text) {
    try {
        const {size, ...keys} = JSON.parse(text), {good, wrong} = sifted(keys, known(store.info));
        store.replace(good);
        say(leftOut(wrong));
    } catch {
        say('The link is damaged: its recipe cannot be read.');
    }
}

// --- the server ----------------------------------------------------------------------

/** Buttons work when the volume and its look are known; what a notebook's kernel does
 * not offer is hidden. */
function ready() {
    const {info, look} = store;
    if (info && look)
        for (const each of buttons.querySelectorAll('button'))
            each.disabled = false;
    sliced.hidden = filmed.hidden = !info?.slices;
    commanded.hidden = Boolean(info?.live);
    chooser.hidden = !info?.keys && !folder.listed;
    describe();
}

/** What this page showed when its viewer went away; of a folder which volume.
 * @type {{keys: Keys, unheard: import('./types').Changes, volume: string[]|null}} */
let lost = {keys: {}, unheard: {}, volume: null};
/** Whether it is another viewer, or file.
 * @type {{other: boolean, same: boolean}|null} */
let returns = null;

/** Another viewer has none of the state: it gets that of this page if nobody has changed
 * its own and the file is the same, else when the user says so.  The same one gets what
 * it has not heard.
 * @param {boolean|undefined} touched
 * @param {boolean} renewed */
function returned(touched, renewed) {
    const {other, same} = returns ?? {}, info = known(store.info), {keys, volume} = lost;
    if (!other) {
        if (!renewed && Object.keys(lost.unheard).length)
            store.apply(lost.unheard);
        return;
    }
    const {good} = sifted(keys, info);
    if (same && !touched)
        store.replace(good);
    else if (!same && folder.chosen)
        return;
    else if (!same && volume && `${volume}` !== `${folder.current}`)
        question('The viewer was started again', `It shows ${info.name}, which another page has opened. This page had ${volume[0]}.`,
            `Open ${volume[0]} as it was`, () => {
                location.hash = linkTo(keys, volume);
            });
    else if (JSON.stringify(good) !== JSON.stringify(sifted(store.keys, info).good))
        question('The viewer was started again', `It shows ${info.name}: ${same ? 'another page has changed it'
            : 'this is another file'}. This page had a state of its own.`,
        'Take the state of this page', () => store.replace(good));
}

const slices = new Slices(store, views);
/** @type {Pointer} */
const pointer = new Pointer(canvas, store, (x, y) => engine.ask('depth', {x, y, size: pointer.size}));
/** @type {Measure} */
const measure = new Measure(store, pointer, slices, views, () => actions.measure(measure.tool));
const times = new Times(store, () => panel.update());
const movies = new Movies(store, times, save, question);
/** @type {Panel} */
const panel = new Panel(store, actions, slices, measure, times, movies);
const overlay = new Overlay(store, pointer, slices);
const hints = new Hints(store), cube = new Cube(store, picture, actions);
const folder = new Folder(store, chooseFile, () => greet(true));
picture.append(measure.canvas, ...overlay.elements, cube.element, hints.element);
let renewed = false; // another volume of a folder is open, whose state follows
let first = true, fresh = true; // the first state of all, and of a connection
/** What the page began with.
 * @type {Keys} */
let begin = {};

engine.on('closed', reason => say(plain(reason), true));
engine.on('open', () => {
    const {size, ...own} = store.own;
    if (!store.info || !folder.waits) // else it is not what is shown yet
        lost = {keys: own, unheard: engine.lost, volume: folder.left};
    returns = null;
    fresh = true;
    say('');
});
engine.on('said', message => say(plain(message.text)));
/** The line of progress, which replaces nothing but itself. */
let progress = '';
engine.on('progress', ({stage, part}) => {
    if (said.textContent === progress || !said.textContent)
        say(progress = part < 1 ? `${stage}, ${Math.round(100 * part)} %` : '');
});
engine.on('command', message => copy('The command that makes this picture', message.text));
engine.on('recipe', message => save(`${baseName()}.json`,
    new Blob([`${message.text}\n`], {type: 'application/json'})));
engine.on('look-file', message => save(`${baseName()}-look.json`,
    new Blob([`${message.text}\n`], {type: 'application/json'})));
engine.on('depth', ({x, y, depth}) => {
    if (depth === null || !Number.isFinite(depth)) {
        say('Nothing opaque is there to turn around; modes over and iso have depths.');
        return;
    }
    const [width, height] = pointer.box, {keys} = store, info = known(store.info);
    const place = unproject(keys, info, (x - 0.5) * width + pointer.shift,
        (y - 0.5) * height, depth, pointer.side)
        .map(value => +value.toPrecision(6));
    const changes = aimed(keys, info, place);
    store.set(keys.slices ? {...changes, slices: {...keys.slices, at: place}} : changes);
});
engine.on('step', ({step}) => {
    store.step = step;
});
engine.on('histogram', message => panel.editor.take(message));
engine.on('look', message => {
    store.answered = message;
    panel.update();
    ready();
});
engine.on('replaced', ({gone, again}) => {
    const {name} = known(store.info);
    if (again)
        question(`${name} is another file now`, `${name} was replaced since it was opened. What is shown is the ` +
            'one before; a crop, another time or a clip plane would show voxels of the new one.',
        'Open the new one', () => engine.ask('reopen'));
    else
        say(gone ? `${name} was removed: what is shown is as it was.` : `${name} was replaced: start the viewer again.`);
});
engine.on('info', info => {
    const before = store.info, part = before !== null && before.file === info.file; // of the same volume
    const other = before !== null && before.instance !== info.instance;
    const same = part && before.name === info.name && before.series === info.series;
    if (before)
        returns ??= {other, same};
    fresh ||= other; // of a folder nothing was open until now
    if (info.opened && !(other && same) && (!before || other || info.opened !== before.opened)) {
        renewed = true;
        store.renew();
        slices.forget();
    }
    if (renewed || other)
        say('');
    store.info = info;
    document.title = `${info.name} - snowglass`;
    title.textContent = `${info.name}  ${info.dims.join(' x ')}${info.live ? '' : ` ${info.type}`}, ` +
        distances(info);
    if (part && !renewed) // a recipe may have a mask that its volume had not
        panel.update();
    else
        panel.build();
    slices.renew();
    cube.name(info);
    engine.ask('histogram');
    ready();
});
/** The state of a link, or hints: once, and when there is a volume.
 * @param {boolean|undefined} touched */
function greet(touched) {
    if (!store.info || !greeting)
        return;
    greeting = false;
    const link = given.get('recipe'), {slices: left, file: of} = history.state ?? {};
    if (link && engine.token) // to load the page again keeps what was done since
        history.replaceState(null, '', `#${new URLSearchParams({token: engine.token})}`);
    if (link && !folder.lacks) // it is of what the link names
        openLink(link);
    else if (left && of === store.info.file) // the page was loaded again
        store.apply(sifted({slices: left}, store.info).good);
    else if (touched === false && !store.info.live)
        hints.show(0); // nobody has used this viewer yet
}

let greeting = true;
engine.on('state', ({touched}) => {
    const begins = first;
    if (!fresh && !renewed)
        return;
    if (first || renewed)
        begin = store.own;
    const again = fresh && !first && !folder.waits, other = renewed;
    first = fresh = renewed = false;
    fitWindow(true);
    if (again)
        returned(touched, other);
    if (begins)
        folder.want(given.get('volume'));
    if (!folder.wanted)
        greet(touched);
});
store.onChange(() => {
    panel.update();
    describe();
});

const tool = select([...TOOLS, ...MEASURES], name => {
    const own = MEASURES.some(([each]) => each === name);
    measure.take(own ? name : null);
    store.tool = own ? store.tool : name;
});
const sliced = layouts(slices);
const file = make('input', {type: 'file', onchange: () => shared.take(file.files ?? [])});
const chooser = button('Open', 'Open a recipe, or drop it on the page', () => actions.open());
function chooseFile() {
    file.value = ''; // the same one may be chosen again
    file.click();
}
engine.on('folder', () => {
    chooser.hidden = false;
    tip(chooser, 'Open another volume of the folder, or a recipe (o)');
});
const commanded = button('Command', 'Copy the command that makes this picture (c)', actions.command);
const filmed = button('Movie', 'Copy the command that makes a movie, as the section Movie has it (v)',
    actions.movie);
buttons.append(tip(make('label', {}, 'Drag ', tool), 'What a drag, and arrow keys, do (d: the next)'),
    commanded, filmed,
    button('Link', 'Copy a link to this state', actions.link),
    button('Recipe', 'Save the recipe of this state', actions.file),
    button('Picture', 'Save the picture (s)', actions.save), undo, redo,
    button('Reset', 'All as it was when the page was opened', actions.reset));
for (const each of buttons.querySelectorAll('button'))
    each.disabled = true;
document.getElementById('viewer')?.append(
    make('section', {className: 'stage', 'aria-label': 'Picture'},
        make('div', {className: 'top'}, make('h1', {textContent: 'snowglass'}), title, level, folder.buttons, sliced, chooser,
            button('Help', 'A short guide, and all keys (?)', actions.help)),
        views,
        make('div', {className: 'bottom'}, figures, buttons)),
    panel.element, folder.element, dialog);
listenToKeys(store, actions, pointer);
new ResizeObserver(() => {
    overlay.draw();
    measure.draw();
    cube.draw();
    if (!first)
        fitWindow();
}).observe(picture);
engine.open();
document.addEventListener('pointerdown', () => store.part(), true);
window.addEventListener?.('beforeunload', event => { // in a notebook the window is not this page's
    history.replaceState({slices: store.keys.slices, file: store.info?.file}, ''); // of this page alone: nobody else has them
    if (movies.comes) // without any page it would not be written
        event.preventDefault();
});
document.addEventListener('dragover', event => event.preventDefault());
document.addEventListener('drop', event => {
    event.preventDefault();
    shared.take(event.dataTransfer?.files ?? []);
});
// For the console, for tests, and for a page that opens volumes.
const shared = {engine, store, recipe: store, page: store, editor: panel.editor, slices, measure, overlay, times, movies, take, file};
Object.assign(window, {snowglass: shared});
