// measure.js - lengths, angles and ellipses, and what lies under the pointer.
//
// Measures are words of the recipe, as --measure has them: "line P P; angle P P P;
// ellipse AXIS POS C A B" in units of the world.  The server measures them and draws
// them into its picture; the page draws those that lie in a slice, and what is being
// drawn or chosen.

import {add, cross, dot, project, unproject} from './camera.js';
import {button, make, row, section, short, surface} from './controls.js';
import {known} from './store.js';

/** @typedef {import('./types').Vector} Place */
/** @typedef {[number, number]} Spot of a canvas */
/** @typedef {import('./types').Info} Volume */
/** @typedef {import('./types').Result} Result */
/** @typedef {import('./slices.js').Pane} Pane */
/** A measure: its words; its points, as far as they are known.
 * @typedef {{words: string, kind: string, points: Place[]|null, result?: Result}} Item */
/** What is being drawn: in a pane, or in the picture (null).
 * @typedef {{pane: Pane|null, points: Place[], from: Spot, at: Spot, dragged: boolean}} Pending */

const NEEDS = /** @type {Record<string, number>} */ ({line: 2, angle: 3, ellipse: 2});
const NAMES = /** @type {Record<string, string>} */ ({line: 'Length', angle: 'Angle', ellipse: 'Ellipse'});
const TELLS = /** @type {Record<string, string>} */ ({line: 'Drag a line, or click its two ends',
    angle: 'Click three points; the second is the corner', ellipse: 'Drag an ellipse on a slice (x shows them)'});
export const MEASURES = [['line', 'length'], ['angle', 'angle'], ['ellipse', 'ellipse']];
const ON_LINE = 7; // pixels from a line that are on it
const ON_POINT = 10; // pixels from a point of the chosen measure, which takes it along
const CLICK = 4; // pixels that a click may move
const REST = 100; // ms in which the pointer rests before a value is asked for
const MOST = 64;
const PIECES = 64;
const EDGE = 22; // pixels at the sides of a slice, where letters are

// --- the world ------------------------------------------------------------------

/** @type {(info: Volume, k: number) => Place} */
const column = ({matrix}, k) => matrix.map(line => line[k]);

/** @type {(info: Volume, index: number[]) => Place} */
const placeOf = ({matrix}, index) => matrix.map(line => line[3] + dot(line.slice(0, 3), index));

/** Between voxels, whose centres are at whole numbers.
 * @type {(info: Volume, place: Place) => number[]} */
function indexOf(info, place) {
    const [a, b, c] = [0, 1, 2].map(k => column(info, k));
    const from = add(place, column(info, 3), -1), whole = dot(a, cross(b, c));
    return [cross(b, c), cross(c, a), cross(a, b)].map(way => dot(from, way) / whole);
}

/** In the units of the axes, without their scale, and back.
 * @type {(info: Volume, place: Place) => Place} */
const unscaled = (info, place) => place.map((x, i) => x / info.axes[i][1]);
/** @type {(info: Volume, place: Place) => Place} */
const scaled = (info, place) => place.map((x, i) => x * info.axes[i][1]);

/** Which slice across an axis of the grid has a place, and that slice's position along
 * the axis of the world that is nearest to its normal.
 * @type {(info: Volume, k: number, place: Place) => [number, number]} */
function sliceAt(info, k, place) {
    const [u, v] = [0, 1, 2].filter(i => i !== k);
    const index = info.dims.map(count => (count - 1) / 2), slice = Math.round(indexOf(info, place)[k]);
    const normal = cross(unscaled(info, column(info, u)), unscaled(info, column(info, v))).map(Math.abs);
    const axis = [1, 2].reduce((best, i) => normal[i] > normal[best] + 1e-6 * normal[best] ? i : best, 0);
    index[k] = slice;
    return [slice, unscaled(info, placeOf(info, index))[axis]];
}

/** "R 12.5 A 3 S 40 mm", or "x 1 y 2 z 3 um".
 * @type {(info: Volume, place: Place) => string} */
function placeText(info, place) {
    const own = unscaled(info, place), units = info.axes.map(([unit]) => unit);
    const alike = units.every(unit => unit === units[0]);
    return own.map((x, i) => {
        const name = info.medical ? 'RLAPSI'[2 * i + (x < 0 ? 1 : 0)] : 'xyz'[i];
        return name + ' ' + rounded(info.medical ? Math.abs(x) : x) + (alike ? '' : after(units[i]));
    }).join('  ') + (alike ? after(units[0]) : '');
}

/** A unit behind a number.
 * @param {string} unit */
const after = unit => unit && ' ' + unit;

/** Four digits say enough.
 * @param {number} x */
const rounded = x => String(+x.toPrecision(4));

/** To 1/1000 of the least spacing.
 * @type {(info: Volume, own: number[]) => string} */
function word(info, own) {
    const step = Math.min(...[0, 1, 2].map(k => Math.hypot(...unscaled(info, column(info, k)))));
    const digits = Math.max(0, Math.min(12, 3 - Math.floor(Math.log10(step))));
    return own.map(x => String(+x.toFixed(digits))).join(',');
}

/** @type {(info: Volume, place: Place) => string} */
const wordOf = (info, place) => word(info, unscaled(info, place));

/** @type {(info: Volume, text: string) => Item[]} */
function parse(info, text) {
    return text.split(';').map(words => words.trim()).filter(Boolean).map(words => {
        const [kind, ...rest] = words.split(/\s+/);
        const points = (kind === 'ellipse' ? rest.slice(2) : rest).map(word => word.split(',').map(Number));
        const whole = points.every(point => point.length === 3 && point.every(Number.isFinite));
        return {words, kind, points: whole ? points.map(point => scaled(info, point)) : null};
    });
}

/** Lines of its numbers.
 * @type {(item: Item) => string[]} */
export function labelOf({kind, result}) {
    if (!result)
        return [];
    const {unit = '', value_unit = '', count = 0, mean, deviation, min, max} = result;
    const number = (/** @type {number|null|undefined} */ x) => rounded(x ?? NaN);
    if (kind === 'line')
        return [number(result.length) + after(unit)];
    if (kind === 'angle')
        return [number(result.degrees) + '°'];
    const spread = count > 1 ? ' ± ' + number(deviation) : '';
    const values = count ? [number(mean) + spread + after(value_unit), `${number(min)} to ${number(max)}`] : [];
    return [...values, number(result.area) + after(unit) + (unit && '²') + `, n ${count}`];
}

/** Where its lines go, in pieces that `see` brings to a canvas; null: out of sight.
 * @type {(kind: string, points: Place[], see: (place: Place) => number[]|null) => Spot[]} */
function path(kind, points, see) {
    const [c, a, b] = points;
    const places = kind !== 'ellipse' ? points : Array.from({length: PIECES + 1}, (_, n) => {
        const turn = 2 * Math.PI * n / PIECES;
        return add(add(c, add(a, c, -1), Math.cos(turn)), add(b, c, -1), Math.sin(turn));
    });
    return /** @type {Spot[]} */ (places.map(see).filter(Boolean));
}

/** To the right and down in a slice: the axis of the grid, its pixels, and a number of each.
 * @type {(slice: import('./types').SliceInfo, x: number, y: number) =>
 *   [way: [axis: number, sign: number], length: number, number: number][]} */
const waysOf = ({right, width, down, height}, x, y) => [[right, width, x], [down, height, y]];

/** With a point at another place: an ellipse moves by its middle, and keeps the direction
 * of a half axis.
 * @type {(item: Item, slot: number, place: Place) => Place[]} */
function reshaped({kind, points}, slot, place) {
    const all = points ?? [], [middle] = all;
    if (kind !== 'ellipse')
        return all.map((point, n) => n === slot ? place : point);
    if (slot === 0)
        return all.map(point => add(point, add(place, middle, -1)));
    const way = add(all[slot], middle, -1), share = dot(add(place, middle, -1), way) / dot(way, way);
    return all.map((point, n) => n === slot ? add(middle, way, Math.max(0.05, Math.abs(share))) : point);
}

/** How far a spot is from a path.
 * @type {(spots: Spot[], at: Spot) => number} */
function distance(spots, [x, y]) {
    let best = Infinity;
    spots.slice(1).forEach(([x1, y1], n) => {
        const [x0, y0] = spots[n], dx = x1 - x0, dy = y1 - y0;
        const along = Math.max(0, Math.min(1, ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1)));
        best = Math.min(best, Math.hypot(x0 + along * dx - x, y0 + along * dy - y));
    });
    return best;
}

// --- on the page ------------------------------------------------------------------

export class Measure {
    /** `pointer` knows the picture's box, `slices` the panes, both in `views`; `leave` puts
     * the tool away, of which the page has a list.
     * @param {import('./store.js').Store} store
     * @param {import('./pointer.js').Pointer} pointer
     * @param {import('./slices.js').Slices} slices
     * @param {HTMLElement} views
     * @param {() => void} leave */
    constructor(store, pointer, slices, views, leave) {
        const {engine} = store;
        this.store = store;
        this.engine = engine;
        this.pointer = pointer;
        this.slices = slices;
        this.views = views;
        this.leave = leave;
        slices.drawOver = (pane, g) => this.drawIn(pane, g);
        /** @type {string|null} */
        this.tool = null;
        /** @type {Item[]} */
        this.items = [];
        this.text = '';
        this.asked = '';
        this.chosen = -1;
        /** @type {Pending|null} */
        this.pending = null;
        this.n = 0; // of questions
        /** @type {Map<number, (message: import('./types').Probe) => void>} */
        this.waits = new Map();
        this.canvas = make('canvas', {className: 'rulers', 'aria-hidden': 'true'});
        this.told = make('output', {className: 'probe'});
        this.list = make('div', {});
        /** @type {(() => void)[]} */
        this.hearers = [];
        /** @type {Spot|null} */
        this.pressed = null;
        /** The point of the chosen measure that is dragged.
         * @type {{pane: Pane|null, n: number, slot: number, item: Item, moved: boolean}|null} */
        this.held = null;
        /** @type {object|null} */
        this.over = null; // what is asked of under the pointer
        /** @type {number|undefined} */
        this.timer = undefined;
        this.filled = '';
        engine.on('measures', message => this.hear(message));
        engine.on('probe', message => this.answered(message));
        engine.on('open', () => {
            this.asked = '';
            this.waits.clear();
            this.update();
        });
        engine.on('info', () => this.update());
        store.onChange(() => this.update());
        store.onCamera(() => this.draw());
        views.addEventListener('pointerdown', event => this.down(event), true);
        views.addEventListener('pointermove', event => this.move(event), true);
        views.addEventListener('pointerup', event => this.up(event), true);
        views.addEventListener('pointercancel', () => this.cancel(), true);
        views.addEventListener('pointerout', () => this.tell(null), true);
        document.addEventListener('keydown', event => this.key(event), true);
    }

    get info() {
        return known(this.store.info);
    }

    /** Not in pictures of a simulation, or by an engine that has none. */
    get offered() {
        const {info} = this.store;
        return Boolean(info?.keys?.includes('measure') && !info.live);
    }

    /** Draws such measures, or none.
     * @param {string|null} tool */
    take(tool) {
        this.tool = this.offered ? tool : null;
        this.pending = null;
        this.views.classList.toggle('measuring', Boolean(this.tool));
        if (this.tool)
            this.store.say(TELLS[this.tool]);
        this.changed();
    }

    // --- what the recipe says -------------------------------------------------

    update() {
        if (!this.store.info)
            return;
        const {measure: text = '', crop, time, channel, component, mask} = this.store.keys;
        const of = JSON.stringify([text, crop, time, channel, component, mask, this.info.matrix]);
        if (text !== this.text) {
            this.chosen = -1;
            this.items = parse(this.info, text);
        }
        this.text = text;
        if (text && of !== this.asked && this.offered)
            this.engine.ask('measures');
        this.asked = of;
        this.changed();
    }

    /** @param {{of: string, measures: Result[]}} message */
    hear({of, measures}) {
        if (of !== this.text || measures.length !== this.items.length)
            return;
        this.items.forEach((item, n) => {
            item.result = measures[n];
            item.points = measures[n].points.map(point => scaled(this.info, point));
        });
        this.changed();
    }

    changed() {
        this.draw();
        for (const pane of this.slices.panes)
            pane.draw();
        for (const hear of this.hearers)
            hear();
    }

    /** One step to undo.
     * @param {string[]} words */
    set(words) {
        this.store.begin();
        this.store.set({measure: words.join('; ') || null});
        this.store.end();
    }

    /** @param {number} n */
    choose(n) {
        this.chosen = n;
        const points = this.items[n]?.points;
        if (points && this.store.keys.slices)
            this.slices.goTo(indexOf(this.info, points[0]).map(Math.round));
        this.changed();
    }

    /** @param {number} n */
    remove(n) {
        this.set(this.items.filter((_, i) => i !== n).map(({words}) => words));
    }

    // --- where the pointer is ---------------------------------------------------

    /** The pane of a canvas, null for the picture; nothing for what else there is.
     * @param {Event} event */
    paneOf({target}) {
        return target === this.pointer.canvas ? null
            : this.slices.panes.find(pane => pane.canvas === target);
    }

    /** @param {PointerEvent} event
     * @returns {Spot} */
    spot({clientX, clientY, target}) {
        const box = /** @type {Element} */ (target).getBoundingClientRect();
        return [clientX - box.left, clientY - box.top];
    }

    /** Of a place, in a pane or the picture.
     * @param {Pane|null} pane
     * @param {Place} place
     * @returns {number[]|null} */
    see(pane, place) {
        if (!pane) {
            const {pointer} = this, seen = project(this.store.keys, this.info, place, pointer.side);
            const {clientWidth, clientHeight} = pointer.canvas;
            return seen && [seen[0] + clientWidth / 2 - pointer.shift, seen[1] + clientHeight / 2];
        }
        const {info, place: {x, y, scale}} = pane, index = indexOf(this.info, place);
        return waysOf(info, x, y).map(([[k, sign], length, from]) => {
            const count = this.info.dims[k], at = (index[k] + 0.5) / count;
            return from + (sign > 0 ? at : 1 - at) * length * scale;
        });
    }

    /** The place under a spot of a slice.
     * @param {Pane} pane
     * @param {Spot} spot */
    placeIn(pane, [px, py]) {
        const index = [...this.slices.index], {info, place: {x, y, scale}} = pane;
        for (const [[k, sign], length, at] of waysOf(info, px - x, py - y)) {
            const count = this.info.dims[k], share = Math.max(0, Math.min(1, at / scale / length));
            index[k] = (sign > 0 ? share : 1 - share) * count - 0.5;
        }
        return placeOf(this.info, index);
    }

    /** Asks the server; null where it does not say.
     * @param {object} what
     * @returns {Promise<import('./types').Probe>} */
    probe(what) {
        const n = ++this.n;
        this.engine.ask('probe', {...what, n});
        return new Promise(done => this.waits.set(n, done));
    }

    /** @param {import('./types').Probe} message */
    answered(message) {
        const done = this.waits.get(message.n);
        this.waits.delete(message.n);
        done?.(message);
    }

    /** The place of the surface under a spot of the picture, or null.
     * @param {Spot} spot
     * @returns {Promise<Place|null>} */
    async surfaceAt([x, y]) {
        const {pointer} = this, {canvas, size} = pointer, [width, height] = pointer.box;
        const dx = x - canvas.clientWidth / 2, dy = y - canvas.clientHeight / 2, {keys} = this.store;
        const share = [dx / width + 0.5, dy / height + 0.5];
        if (this.engine.flat || share.some(s => s < 0 || s > 1))
            return null;
        const {depth} = await this.probe({x: share[0], y: share[1], size});
        return typeof depth === 'number' ? unproject(keys, this.info, dx + pointer.shift, dy, depth, pointer.side) : null;
    }

    // --- the pointer ------------------------------------------------------------

    /** @param {PointerEvent} event */
    down(event) {
        const pane = this.paneOf(event);
        this.tell(null);
        if (pane === undefined || !this.offered)
            return;
        const spot = this.spot(event);
        this.pressed = event.button || !event.isPrimary ? null : spot;
        const slot = this.tool || !this.pressed || event.shiftKey || event.ctrlKey || event.metaKey ? -1
            : this.pointAt(pane, spot);
        if (slot >= 0) {
            this.held = {pane, n: this.chosen, slot, item: this.items[this.chosen], moved: false};
            this.catch(event);
            return;
        }
        if (!this.tool || event.button || !event.isPrimary || event.shiftKey || event.ctrlKey || event.metaKey)
            return;
        this.catch(event);
        if (!pane && this.tool === 'ellipse') {
            this.store.say('An ellipse is drawn on a slice: x shows them.');
            return;
        }
        if (!this.pending || this.pending.pane !== pane)
            this.pending = {pane, points: [], from: spot, at: spot, dragged: false};
        Object.assign(this.pending, {from: spot, at: spot, dragged: true});
        this.add(spot);
    }

    /** Nobody else gets what the pointer does until it is let go.
     * @param {PointerEvent} event */
    catch(event) {
        event.stopPropagation();
        event.preventDefault();
        const canvas = /** @type {HTMLElement} */ (event.target);
        canvas.focus();
        canvas.setPointerCapture(event.pointerId);
    }

    /** Which point of the chosen measure is at a spot; -1: none.  An ellipse lies in slices.
     * @param {Pane|null} pane
     * @param {Spot} spot */
    pointAt(pane, [x, y]) {
        const item = this.items[this.chosen];
        if (!item?.points || !this.isIn(pane, this.chosen) || (!pane && (item.kind === 'ellipse' || this.engine.flat)))
            return -1;
        const far = item.points.map(point => this.see(pane, point)).map(
            seen => seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity);
        const least = Math.min(...far);
        return least <= ON_POINT ? far.indexOf(least) : -1;
    }

    /** Numbers come when it is let go.
     * @param {Place} place */
    drag(place) {
        const {n, slot, item} = known(this.held);
        this.items[n] = {...item, points: reshaped(item, slot, place), result: undefined};
        this.changed();
    }

    /** Lets a point go, where it is: on the surface, in the picture.  One step to undo.
     * @param {Spot} spot */
    async drop(spot) {
        const {pane, n, slot, item, moved} = known(this.held), {info} = this;
        this.held = null;
        const place = !moved ? null : pane ? this.placeIn(pane, spot) : await this.surfaceAt(spot);
        this.items[n] = item;
        if (moved && !place)
            this.store.say('Nothing opaque is there to measure; modes over and iso have a surface.');
        if (place) {
            const begin = item.kind === 'ellipse' ? item.words.split(/\s+/).slice(0, 3) : [item.kind];
            const words = [...begin, ...reshaped(item, slot, place).map(point => wordOf(info, point))];
            if (new Set(words).size === words.length) // no two points are one
                this.set(this.items.map((each, i) => i === n ? words.join(' ') : each.words));
            this.chosen = n;
        }
        this.changed();
    }

    /** @param {PointerEvent} event */
    move(event) {
        const pane = this.paneOf(event);
        if (pane === undefined || !this.offered)
            return;
        if (this.held) {
            const spot = this.spot(event), from = this.pressed ?? spot;
            event.stopPropagation();
            this.held.moved ||= Math.hypot(spot[0] - from[0], spot[1] - from[1]) > CLICK;
            if (this.held.moved && pane && pane === this.held.pane)
                this.drag(this.placeIn(pane, spot));
            return;
        }
        if (this.pending && this.pending.pane === pane) {
            this.pending.at = this.spot(event);
            this.redraw(pane);
        }
        if (this.pending?.dragged)
            event.stopPropagation();
        else if (!event.buttons && event.pointerType === 'mouse')
            this.rest(pane, this.spot(event));
    }

    /** The browser took the pointer away: all is as it was before. */
    cancel() {
        this.held = this.pressed = null;
        if (this.pending)
            this.pending.dragged = false;
        this.text = this.asked = '';
        this.update();
    }

    /** @param {PointerEvent} event */
    up(event) {
        const pane = this.paneOf(event), {pending, pressed} = this;
        if (pane === undefined || !this.offered)
            return;
        const spot = this.spot(event);
        const moved = pressed && Math.hypot(spot[0] - pressed[0], spot[1] - pressed[1]) > CLICK;
        this.pressed = null;
        if (this.held) {
            event.stopPropagation();
            this.drop(spot);
            return;
        }
        if (pending?.dragged) {
            event.stopPropagation();
            pending.dragged = false;
            if (moved)
                this.add(spot);
        } else if (pressed && !moved && !this.tool) {
            this.pick(pane, spot);
            if (event.pointerType !== 'mouse')
                this.ask(pane, spot);
        }
    }

    /** Another point of what is drawn; the last one ends it.  Those of the surface come
     * when the server has found them.
     * @param {Spot} spot */
    async add(spot) {
        const {pending, tool} = this;
        if (!pending || !tool)
            return;
        const slot = pending.points.push([]) - 1;
        const place = pending.pane ? this.placeIn(pending.pane, spot) : await this.surfaceAt(spot);
        if (this.pending !== pending)
            return;
        if (!place) {
            this.pending = null;
            this.store.say(this.engine.flat ? 'Without a server measures are drawn on slices: x shows them.'
                : 'Nothing opaque is there to measure; modes over and iso have a surface.');
        } else {
            pending.points[slot] = place;
            if (pending.points.length === NEEDS[tool] && pending.points.every(point => point.length))
                this.finish(tool, pending);
        }
        this.changed();
    }

    /** @param {string} tool
     * @param {Pending} pending */
    finish(tool, {pane, points}) {
        const {info} = this, words = tool === 'ellipse' && pane ? this.ellipse(pane, points)
            : `${tool} ${points.map(point => wordOf(info, point)).join(' ')}`;
        this.pending = null;
        if (!words || new Set(words.split(' ')).size < words.split(' ').length)
            return; // two of its points are one
        if (this.items.length >= MOST) {
            this.store.say(`There are ${MOST} measures already: delete some.`);
            return;
        }
        this.set([...this.items.map(item => item.words), words]);
        this.chosen = this.items.length - 1;
    }

    /** In the box of two corners.
     * @param {Pane} pane
     * @param {Place[]} corners */
    ellipse(pane, [from, to]) {
        const {info} = this, k = pane.along, ends = [from, to].map(place => indexOf(info, place));
        const middle = ends[0].map((x, i) => (x + ends[1][i]) / 2);
        const [a, b] = [pane.info.right[0], pane.info.down[0]].map(axis => {
            const end = [...middle];
            end[axis] = Math.max(ends[0][axis], ends[1][axis]);
            return end;
        });
        const [, position] = sliceAt(info, k, from);
        if (!(a[pane.info.right[0]] > middle[pane.info.right[0]] && b[pane.info.down[0]] > middle[pane.info.down[0]]))
            return '';
        return `ellipse ${'xyz'[k]} ${word(info, [position])} ` +
            [middle, a, b].map(index => wordOf(info, placeOf(info, index))).join(' ');
    }

    /** Chooses the measure at a spot, or none.
     * @param {Pane|null} pane
     * @param {Spot} spot */
    pick(pane, spot) {
        const far = this.items.map((item, n) => item.points && this.isIn(pane, n)
            ? distance(path(item.kind, item.points, place => this.see(pane, place)), spot) : Infinity);
        const near = Math.min(...far), n = near <= ON_LINE ? far.indexOf(near) : -1;
        if (n === this.chosen)
            return;
        this.chosen = n;
        this.changed();
    }

    /** @param {KeyboardEvent} event */
    key(event) {
        const {key, target} = event;
        if (!(target instanceof Element) || target.closest('dialog, input, select, textarea') || !this.offered)
            return;
        if (key === 'Escape' && (this.tool || this.chosen >= 0)) {
            this.chosen = -1;
            if (this.pending)
                this.pending = null;
            else
                this.leave();
            this.changed();
        } else if ((key === 'Delete' || key === 'Backspace') && this.chosen >= 0) {
            this.remove(this.chosen);
        } else {
            return;
        }
        event.preventDefault();
        event.stopPropagation();
    }

    // --- what is under the pointer ------------------------------------------------

    /** @param {Pane|null} pane
     * @param {Spot} spot */
    rest(pane, spot) {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => this.waits.size || this.ask(pane, spot), REST);
    }

    /** @param {Pane|null} pane
     * @param {Spot} spot */
    async ask(pane, spot) {
        const now = this.over = {}, place = pane ? this.placeIn(pane, spot) : await this.surfaceAt(spot);
        if (this.over !== now)
            return;
        if (!place) {
            this.tell(null);
            return;
        }
        const at = indexOf(this.info, place).map((x, k) => Math.max(0, Math.min(this.info.dims[k] - 1, Math.round(x))));
        const {value} = await this.probe({at});
        const {hounsfield, value_unit: own} = this.info, unit = hounsfield ? 'HU' : own ?? '';
        if (this.over === now)
            this.tell(pane, placeText(this.info, place) + ':  ' + (typeof value === 'number' ? short(value) + after(unit) : 'no value'));
    }

    /** @param {Pane|null} pane
     * @param {string} [text] */
    tell(pane, text = '') {
        if (!text) {
            clearTimeout(this.timer);
            this.over = null;
        }
        this.told.textContent = text;
        const parent = pane?.element ?? this.pointer.canvas.parentElement;
        if (text && this.told.parentElement !== parent)
            parent?.append(this.told);
    }

    // --- drawing ------------------------------------------------------------------

    /** Whether a measure lies in the slice of a pane; all are in the picture.
     * @param {Pane|null} pane
     * @param {number} n */
    isIn(pane, n) {
        const {kind, points, words} = this.items[n];
        if (!pane || !points)
            return !pane;
        const index = this.slices.index[pane.along], far = points.map(point => Math.abs(indexOf(this.info, point)[pane.along] - index));
        return far.every(x => x <= 0.500001) && (kind !== 'ellipse' || words.split(/\s+/)[1] === 'xyz'[pane.along] ||
            far.every(x => x < 1e-3));
    }

    /** @param {Pane|null} pane */
    redraw(pane) {
        if (pane)
            pane.draw();
        else
            this.draw();
    }

    /** Over the picture, which has its measures already. */
    draw() {
        const shown = this.chosen >= 0 || (this.pending && !this.pending.pane);
        this.canvas.hidden = !shown;
        const g = shown && this.store.info ? surface(this.canvas)?.g : null;
        if (!g)
            return;
        const item = this.items[this.chosen];
        if (item?.points)
            this.stroke(g, path(item.kind, item.points, place => this.see(null, place)), true);
        if (item?.points && item.kind !== 'ellipse' && !this.engine.flat)
            this.grips(g, null, item.points);
        this.drawPending(g, null);
    }

    /** Over a slice.
     * @param {Pane|null} pane
     * @param {CanvasRenderingContext2D} g */
    drawIn(pane, g) {
        this.items.forEach((item, n) => {
            if (!item.points || !this.isIn(pane, n))
                return;
            const spots = path(item.kind, item.points, place => this.see(pane, place));
            this.stroke(g, spots, n === this.chosen);
            if (n === this.chosen)
                this.grips(g, pane, item.points);
            this.write(g, item, spots);
        });
        this.drawPending(g, pane);
    }

    /** @param {CanvasRenderingContext2D} g
     * @param {Pane|null} pane */
    drawPending(g, pane) {
        const {pending, tool} = this;
        if (!pending || pending.pane !== pane || !tool)
            return;
        const spots = pending.points.map(point => point.length ? this.see(pane, point) : pending.from);
        const all = /** @type {Spot[]} */ ([...spots, pending.at].filter(Boolean));
        const [[x0, y0], [x1, y1]] = [all[0], pending.at];
        this.stroke(g, tool !== 'ellipse' ? all : Array.from({length: PIECES + 1}, (_, n) => {
            const turn = 2 * Math.PI * n / PIECES;
            return /** @type {Spot} */ ([(x0 + x1 + (x1 - x0) * Math.cos(turn)) / 2, (y0 + y1 + (y1 - y0) * Math.sin(turn)) / 2]);
        }), true);
    }

    /** @param {CanvasRenderingContext2D} g
     * @param {Spot[]} spots
     * @param {boolean} chosen */
    stroke(g, spots, chosen) {
        g.lineJoin = 'round';
        for (const [color, width] of /** @type {[string, number][]} */ ([['#000c', 4], [chosen ? '#ffd54a' : '#fff', 1.75]])) {
            g.strokeStyle = color;
            g.lineWidth = width;
            g.beginPath();
            for (const [x, y] of spots)
                g.lineTo(x, y);
            g.stroke();
            if (spots.length > 3) // an ellipse has no ends
                continue;
            for (const [x, y] of spots) {
                g.beginPath();
                g.arc(x, y, 2.5, 0, 7);
                g.stroke();
            }
        }
    }

    /** Points that can be dragged.
     * @param {CanvasRenderingContext2D} g
     * @param {Pane|null} pane
     * @param {Place[]} points */
    grips(g, pane, points) {
        for (const seen of points.map(point => this.see(pane, point))) {
            if (!seen)
                continue;
            g.beginPath();
            g.arc(seen[0], seen[1], 5, 0, 7);
            g.fillStyle = '#ffd54a';
            g.strokeStyle = '#000';
            g.lineWidth = 1.5;
            g.fill();
            g.stroke();
        }
    }

    /** Beside its middle, in the canvas.
     * @param {CanvasRenderingContext2D} g
     * @param {Item} item
     * @param {Spot[]} spots */
    write(g, item, spots) {
        const lines = labelOf(item), {clientWidth: width, clientHeight: height} = g.canvas;
        if (!lines.length)
            return;
        g.font = '12px system-ui, sans-serif';
        g.textAlign = 'left';
        g.textBaseline = 'middle';
        const wide = Math.max(...lines.map(line => g.measureText(line).width)), tall = 15 * lines.length;
        const xs = spots.map(([x]) => x), ys = spots.map(([, y]) => y);
        const [x0, x1, y0, y1] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
        const mx = (x0 + x1) / 2, my = (y0 + y1) / 2, fit = (Math.abs(my - height / 2) < tall / 2 + 10 ? EDGE : 4) + wide, rises = (spots[1][0] - spots[0][0]) * (spots[1][1] - spots[0][1]);
        let [x, y] = item.kind === 'angle' ? [spots[1][0] + 8, spots[1][1] + 12]
            : item.kind === 'line' ? [mx + 8, my + (rises > 0 ? -10 : 10)]
            : x1 + 8 + fit < width ? [x1 + 8, my] : x0 - 8 - fit > 0 ? [x0 - wide - 8, my]
            : [mx - wide / 2, y1 + 12 + tall < height - 24 ? y1 + 12 + tall / 2 : y0 - 12 - tall / 2];
        x = Math.max(4, Math.min(width - wide - 4, x));
        y = Math.max(tall / 2 + 4, Math.min(height - tall / 2 - 4, y)) - tall / 2 + 7.5;
        g.lineWidth = 3;
        g.strokeStyle = '#000';
        g.fillStyle = item === this.items[this.chosen] ? '#ffd54a' : '#fff';
        lines.forEach((line, n) => {
            g.strokeText(line, x, y + 15 * n);
            g.fillText(line, x, y + 15 * n);
        });
    }

    // --- the panel ------------------------------------------------------------------

    /** `pick` takes a tool, by its name. */
    section(/** @type {(tool: string|null) => void} */ pick) {
        const tools = Object.keys(NEEDS).map(kind => {
            const key = {line: 'u', angle: 'a', ellipse: 'e'}[kind];
            return button(NAMES[kind], `${NAMES[kind]} (${key})`, () => pick(this.tool === kind ? null : kind));
        });
        const all = button('Delete all', 'Delete all measures', () => this.set([]));
        const made = section('Measures', false, row('Draw', ...tools), this.list, all);
        this.hearers = [() => {
            made.hidden = !this.offered;
            tools.forEach((each, n) => each.setAttribute('aria-pressed', String(this.tool === Object.keys(NEEDS)[n])));
            all.hidden = this.items.length < 2;
            this.fill();
        }];
        this.hearers[0]();
        return made;
    }

    /** A line for each measure: a press chooses it. */
    fill() {
        const text = JSON.stringify([this.items, this.chosen]);
        if (text === this.filled)
            return;
        this.filled = text;
        const held = document.activeElement, at = [...this.list.querySelectorAll('button')].indexOf(/** @type {any} */ (held));
        this.list.replaceChildren(...this.items.map((item, n) => {
            const named = button(`${NAMES[item.kind] ?? item.kind} ${labelOf(item).join('; ') || '...'}`,
                `Choose measure ${n + 1}`, () => this.choose(n === this.chosen ? -1 : n));
            named.setAttribute('aria-pressed', String(n === this.chosen));
            return make('div', {className: 'row measure'}, named,
                button('×', `Delete measure ${n + 1} (Delete)`, () => this.remove(n)));
        }));
        if (at >= 0)
            this.list.querySelectorAll('button')[Math.min(at, 2 * this.items.length - 1)]?.focus();
    }
}
