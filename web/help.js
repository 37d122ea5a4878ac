// help.js - what a reader is told: three hints at first, and Help, a page of two minutes.

import {button, check, make} from './controls.js';

const SECONDS = 15; // a hint stays so long, or until it was followed

/** @typedef {import('./store.js').Store} Store */
/** @typedef {import('./types').Key} Key */

/** @type {{text: string, touch?: string, keys: Key[]}[]} */
const HINTS = [
    {text: 'Drag to turn, and zoom with the wheel.', touch: 'Drag to turn; two fingers move and zoom.',
        keys: ['azimuth', 'elevation', 'zoom', 'target', 'view', 'light']},
    {text: 'A drag with the right button sets window and level. Presets have other looks.',
        touch: 'Presets have other looks. "Drag", below, lets a finger set window and level.',
        keys: ['preset', 'range', 'window', 'opacity', 'colormap', 'channel']},
    {text: 'x shows three slices. Help has a short guide, and all keys.',
        touch: '"3D + 3", above, shows three slices. Help has a short guide.', keys: ['slices']}];

/** Three lines over the picture, one after another. */
export class Hints {
    /** @param {Store} store */
    constructor(store) {
        this.store = store;
        this.at = HINTS.length;
        this.timer = 0;
        this.was = '';
        this.line = make('span', {});
        this.element = make('p', {className: 'hint', hidden: true}, this.line,
            button('\u00d7', 'No more hints', () => this.show(HINTS.length)));
        store.onChange(() => {
            if (HINTS[this.at] && this.now !== this.was)
                this.show(this.at + 1);
        });
    }

    /** What the hint is about. */
    get now() {
        return JSON.stringify(HINTS[this.at].keys.map(key => this.store.keys[key]));
    }

    /** @param {number} at */
    show(at) {
        const hint = HINTS[at], coarse = matchMedia('(pointer: coarse)').matches;
        this.at = at;
        clearTimeout(this.timer);
        this.element.hidden = !hint;
        if (!hint)
            return;
        this.was = this.now;
        this.line.textContent = coarse && hint.touch || hint.text;
        this.timer = setTimeout(() => this.show(at + 1), 1000 * SECONDS);
    }
}

const KEYS = [['Drag', 'turn'], ['Shift or middle drag', 'move'], ['Wheel', 'zoom'],
    ['Right drag', 'window, level'], ['Ctrl right drag', 'opacity'],
    ['Ctrl drag', 'light'], ['Double click', 'turn around this point'],
    ['u a e', 'measure: length, angle, ellipse; Esc: no more; Delete: the chosen one'],
    ['x', 'slices, or none'], ['h', 'lines where slices cross'], ['k', 'handles of clip planes'],
    ['On a slice', 'drag: where they cross; wheel: next slice; right drag: window, level; ' +
        'Ctrl wheel: zoom; double click: alone'],
    ['On a histogram', 'wheel, + -: zoom its values, 0: all; Page keys: choose a point; arrows: move it'],
    ['Two fingers', 'move and zoom'], ['Arrows', 'as Drag: 5 degrees, Shift: 1'], ['d', 'next kind of drag'],
    ['+ -', 'zoom'], ['r', 'frame all'],
    ['1 - 6', 'front, back, left, right, top, bottom'], ['m', 'next mode'],
    ['p', 'perspective'], ['l', 'letters'], ['Space', 'play time steps'],
    ['c v', 'the command, that of a movie'], ['s', 'save the picture'], ['z Shift+z', 'undo, redo; Ctrl+z, Ctrl+y too'],
    ['?', 'this help']];

/** Where there is a list of volumes. */
const FOLDER_KEYS = [['o', 'open another volume'], ['n Shift+n', 'the next volume, the one before']];

/** What a section says; the last is of patients alone.
 * @type {[name: string, text: string, patient?: string][]} */
const GUIDE = [
    ['Look around', 'Drag the picture to turn it, with Shift to move it; the wheel zooms. A double click ' +
        'turns around that point. "Camera" has the usual views, and a press on a face of the cube looks from there; ' +
        '"Frame all" shows everything again. "Drag" below, "turns over the poles", tumbles the volume freely.',
    "Letters at the edges are the patient's sides: Right, Left, Anterior, Posterior, Superior, Inferior."],
    ['Window, level and looks', 'Drag with the right button: to the right for a wider window, up for a higher ' +
        'level. "Presets" shows other looks on this volume, those for its kind first, and saves yours to a file. In ' +
        '"Look" points on the histogram say how opaque each value is: drag them, double-click to add or remove ' +
        'one; the wheel zooms the values. "Mode" has projections, such as mip, ' +
        'the maximum along each ray.'],
    ['Slices', 'Buttons at the top choose the layout: the picture, three slices beside it, four of one size, or one ' +
        'slice large. A click in a slice moves the others, the wheel goes to the next, a double click shows it ' +
        'alone. The value where they cross stands at the lower right. "Slab" in the panel makes them thick.',
    'The value of a CT is in Hounsfield units, and "Slices" in the panel has the usual windows.'],
    ['Measure', '"Measures" draws lengths and angles, on slices and on the surface, and ellipses on slices, with the ' +
        'mean of their values. The pointer at rest shows the place and the value under it.'],
    ['Cut', '"Clip" has planes with handles on the picture; "Cut here" cuts what is before the middle.'],
    ['Time and movies', '"Time", where the file has several steps, plays them. "Movie" has a turn, or these steps, ' +
        'written where the viewer runs, and saves the file here.'],
    ['Take back, save, share', '"Undo" takes back what you did, "Reset" all of it. "Picture" saves what is shown ' +
        'once it is final. "Link" and "Recipe" keep the state, for you or others; "Command" is the command ' +
        'that makes the same picture, byte for byte.']];

/** The guide, all keys, and whether those that are single letters act.
 * @param {Store} store */
export function help(store) {
    const {box, label} = check('single letters, digits and signs act', on => {
        store.letters = on;
    });
    box.checked = store.letters;
    const guide = GUIDE.map(([name, text, patient]) => make('section', {}, make('h3', {textContent: name}),
        make('p', {textContent: [text, ...store.info?.medical && patient ? [patient] : []].join(' ')})));
    return [...guide, make('h3', {textContent: 'Mouse, fingers and keys'}), label,
        make('table', {}, ...[...KEYS, ...store.info?.opened ? FOLDER_KEYS : []].map(([key, text]) => make('tr', {},
            make('td', {}, make('kbd', {textContent: key})), make('td', {textContent: text}))))];
}
