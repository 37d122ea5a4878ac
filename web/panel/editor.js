// editor.js - the transfer function over the histogram: points are dragged,
// added, removed, or set as numbers.  The same for the opacity by gradient.

import {Axis, EDGE} from './axis.js';
import {button, listen, make, number, row, short, show, slider, surface} from '../controls.js';
import {STEPS} from '../keys.js';
import {unitOf} from '../look.js';
import {known} from '../store.js';

/** @typedef {import('../store.js').Store} Store */
/** @typedef {import('../types').Point} Point */
/** @typedef {{x: number, y: number, value: number, opacity: number}} Place */

/** Which points are edited: their key, and those in use where it is not set.
 * @typedef {{key: 'opacity'|'gradient-opacity', name: string, usual: (store: Store) => Point[],
 *   range: (store: Store) => import('../types').Histogram|null}} Kind */

const NEAR = 12; // pixels
const NEARER = 1.5; // by a step of the axis
const BINS = 256; // of the answer: serve/draw/drawing.h
const REST = 200; // ms after which values are counted anew

/** @type {Kind} */
export const BY_VALUE = {key: 'opacity', name: 'value',
    usual: store => store.look?.opacity ?? [], range: store => store.histogram};

/** By magnitude of the gradient, up to a step of a quarter of all values.
 * @type {Kind} */
export const BY_GRADIENT = {key: 'gradient-opacity', name: 'gradient', usual: () => [],
    range({histogram, info}) {
        const step = Math.min(...info?.spacing ?? [1]);
        return histogram && {lo: 0, hi: (histogram.hi - histogram.lo) / 4 / step, counts: []};
    }};

export class Editor {
    /** @param {Store} store */
    constructor(store, kind = BY_VALUE) {
        this.store = store;
        this.kind = kind;
        this.log = true;
        this.chosen = -1;
        /** Where a drag began.
         * @type {{place: Place, points: Point[]}|null} */
        this.from = null;
        /** @type {unknown[]} */
        this.drawn = []; // what is shown
        this.axis = new Axis(() => this.all);
        /** The counts of the part that is shown, and of which parts they were asked for.
         * @type {import('../types').Histogram|null} */
        this.closer = null;
        this.closerPart = '';
        /** By the range that was asked for.
         * @type {Map<string, string>} */
        this.asked = new Map();
        this.waiting = 0;
        this.canvas = make('canvas', {className: 'editor', tabIndex: 0,
            role: 'img', 'aria-label': `Opacity by ${kind.name}, over the histogram. ` +
            'Arrow keys move the chosen point, Page keys choose another, Insert ' +
            'adds one, Delete removes it; plus and minus zoom the values, 0 shows all.'});
        this.place = slider(`which part of the ${kind.name}s is shown`, 0, 1, 0.01, store, share => {
            const [low, high] = this.axis.span, [first, last] = this.all;
            this.seen(this.axis.show(first + share * (last - first - high + low), high - low));
        });
        this.ends = ['low', 'unit', 'high'].map(() => make('span', {}));
        this.value = number(`${kind.name} of the chosen point`, value => this.put(value, null));
        this.opacity = number(`opacity at the chosen ${kind.name}`,
            value => this.put(null, Math.max(0, Math.min(1, value))), 0.01);
        this.opacity.min = '0';
        this.opacity.max = '1';
        listen(this.canvas, this);
        new ResizeObserver(() => this.draw()).observe(this.canvas);
    }

    /** For another volume: all its values are shown. */
    renew() {
        clearTimeout(this.waiting);
        this.axis.part = this.closer = null;
        this.chosen = -1;
    }

    get element() {
        const {store} = this;
        const scale = button('Log', 'Logarithmic counts of the histogram', () => {
            this.log = !this.log;
            scale.setAttribute('aria-pressed', `${this.log}`);
            this.draw();
        });
        scale.setAttribute('aria-pressed', `${this.log}`);
        const zooms = make('div', {className: 'row'},
            button('\u2212', 'Zoom out of the values (wheel)', () => this.nearer(1 / NEARER)),
            button('+', 'Zoom into the values (wheel)', () => this.nearer(NEARER)),
            button('All values', 'Show all values', () => this.seen(this.axis.show(-Infinity, Infinity))), this.place);
        return make('div', {}, this.canvas, make('div', {className: 'axis'}, ...this.ends), zooms,
            row(this.kind === BY_VALUE ? 'Value' : 'Gradient', this.value,
                make('label', {}, 'Opacity ', this.opacity)),
            make('div', {className: 'row'},
                button('Add', 'Add a point beside the chosen one', () => this.insert()),
                button('Remove', 'Remove the chosen point', () => this.remove()),
                ...this.kind === BY_VALUE ? [scale,
                    button('Automatic', 'Opacity of the preset',
                        () => store.set({opacity: null, range: null}))]
                    : [button('None', 'The gradient does not matter',
                        () => store.set({[this.kind.key]: null}))]));
    }

    /** The points in use: those of the recipe, else of the look. */
    get points() {
        return this.store.keys[this.kind.key] ?? this.kind.usual(this.store);
    }

    /** A recipe holds fewer points than a file: such a look is shown, not changed. */
    get isWhole() {
        const {store, store: {look}} = this;
        const whole = this.kind !== BY_VALUE || store.keys.opacity ||
            (look?.count ?? 0) <= this.points.length;
        if (!whole)
            store.say(`The look has ${look?.count} points, too many to change here; choose a preset.`);
        return whole;
    }

    /** What the axis spans: the histogram, and the points. */
    get span() {
        return this.axis.span;
    }

    /** @returns {import('../types').Pair} */
    get all() {
        const histogram = this.kind.range(this.store), points = this.points;
        const low = Math.min(histogram?.lo ?? Infinity, points[0]?.[0] ?? Infinity);
        const high = Math.max(histogram?.hi ?? -Infinity, points.at(-1)?.[0] ?? -Infinity);
        return low < high ? [low, high] : [low - 1, low + 1];
    }

    /** @param {number} value */
    x(value) {
        return this.axis.x(value, this.canvas.clientWidth);
    }

    /** @param {number} opacity */
    y(opacity) {
        return this.bottom - opacity * (this.bottom - EDGE);
    }

    get bottom() {
        return this.canvas.clientHeight - 18;
    }

    /** Value and opacity at a place of the canvas.
     * @param {MouseEvent} event
     * @returns {Place} */
    at(event) {
        const {offsetX: x, offsetY: y} = event;
        return {x, y, value: this.axis.value(x, this.canvas.clientWidth),
            opacity: Math.max(0, Math.min(1, (this.bottom - y) / (this.bottom - EDGE)))};
    }

    /** @param {Place} place */
    near(place) {
        let best = -1, least = NEAR;
        this.points.forEach(([value, opacity], i) => {
            const far = Math.hypot(this.x(value) - place.x, this.y(opacity) - place.y);
            if (far < least)
                [best, least] = [i, far];
        });
        return best;
    }

    /** @param {Point[]} points */
    set(points, chosen = this.chosen) {
        if (!this.isWhole)
            return;
        this.chosen = chosen;
        this.store.set({[this.kind.key]: points});
    }

    /** @param {number} value */
    digits(value) {
        const [low, high] = this.span;
        const places = Math.max(0, Math.ceil(3 - Math.log10(high - low)));
        return +value.toFixed(Math.min(12, places));
    }

    /** A copy, of which points may be changed.
     * @returns {Point[]} */
    get copy() {
        return this.points.map(([value, opacity]) => [value, opacity]);
    }

    /** Moves the chosen point, between its neighbours.
     * @param {number|null} value
     * @param {number|null} opacity */
    put(value, opacity) {
        const points = this.copy, point = points[this.chosen];
        if (!point)
            return;
        const low = points[this.chosen - 1]?.[0] ?? -Infinity;
        const high = points[this.chosen + 1]?.[0] ?? Infinity;
        if (value !== null)
            point[0] = Math.max(low, Math.min(high, this.digits(value)));
        if (opacity !== null)
            point[1] = +opacity.toFixed(3);
        this.set(points);
    }

    /** @param {Place|null} place */
    insert(place = null) {
        const points = this.copy;
        if (!points.length && !place) { // the usual beginning: edges alone
            this.set([[0, 0], [this.digits(this.span[1] / 4), 1]], 1);
            return;
        }
        const from = Math.max(0, Math.min(this.chosen, points.length - 2));
        const a = points[from] ?? [this.span[0], 0], b = points[from + 1] ?? a;
        /** @type {Point} */
        const point = place ? [this.digits(place.value), +place.opacity.toFixed(3)]
            : [this.digits((a[0] + b[0]) / 2), +((a[1] + b[1]) / 2).toFixed(3)];
        const index = place ? points.filter(other => other[0] <= point[0]).length : from + 1;
        points.splice(index, 0, point);
        this.set(points, index);
    }

    remove() {
        if (this.points.length < 2 || !this.points[this.chosen])
            return;
        this.set(this.points.filter((_, i) => i !== this.chosen),
            Math.min(this.chosen, this.points.length - 2));
    }

    /** @param {PointerEvent} event */
    down(event) {
        if (event.button)
            return;
        const place = this.at(event);
        this.canvas.setPointerCapture(event.pointerId);
        this.chosen = this.near(place);
        this.from = {place, points: this.points};
        this.store.begin();
        this.draw();
    }

    /** A point, or all of them where none is near.
     * @param {PointerEvent} event */
    move(event) {
        const {from} = this;
        if (!from)
            return;
        const place = this.at(event);
        if (this.chosen >= 0) {
            this.put(place.value, place.opacity);
            return;
        }
        const by = place.value - from.place.value;
        if (Math.abs(place.x - from.place.x) > 2)
            this.set(from.points.map(
                ([value, opacity]) => [this.digits(value + by), opacity]));
    }

    up() {
        if (!this.from)
            return;
        this.from = null;
        this.store.end();
    }

    /** Zooms about the pointer, and moves along where it turns to the side; where all is
     * shown, the wheel is the page's.
     * @param {WheelEvent} event */
    wheel(event) {
        const {deltaX, deltaY} = event;
        return this.seen(Math.abs(deltaX) > Math.abs(deltaY)
            ? this.axis.pan(deltaX / this.canvas.clientWidth)
            : this.axis.zoom(NEARER ** (-deltaY / 100), this.at(event).value));
    }

    /** About the chosen point, or the middle.
     * @param {number} by */
    nearer(by) {
        const [low, high] = this.span, at = this.points[this.chosen]?.[0] ?? NaN;
        this.seen(this.axis.zoom(by, at >= low && at <= high ? at : (low + high) / 2));
    }

    /** After the axis: its values are counted once it rests.
     * @param {boolean} another */
    seen(another) {
        if (!another)
            return false;
        this.draw();
        clearTimeout(this.waiting);
        this.waiting = setTimeout(() => this.ask(), REST);
        return true;
    }

    ask() {
        const {axis: {part}, store, kind} = this;
        if (!part || kind !== BY_VALUE || !store.histogram)
            return;
        const [lo, hi] = this.counted(part);
        this.asked.set(`${[lo, hi]}`, `${part}`);
        store.engine.ask('histogram', {lo, hi});
    }

    /** A part in bins: those of whole numbers are as wide as some of these, or bins of one and
     * of two would stand side by side.
     * @param {import('../types').Pair} part
     * @returns {import('../types').Pair} */
    counted([low, high]) {
        const {type, min, max} = known(this.store.info);
        if (!/int/.test(type) || !Number.isInteger(min) || !Number.isInteger(max))
            return [low, high];
        const from = Math.floor(low) - 0.5;
        return [from, from + BINS * Math.ceil((high + 1 - from) / BINS)];
    }

    /** Counts of all values, or of a part.
     * @param {import('../types').Histogram} counts */
    take(counts) {
        const range = `${[counts.lo, counts.hi]}`, part = this.asked.get(range);
        if (!this.asked.delete(range)) {
            this.store.histogram = counts;
            if (!this.asked.size)
                this.ask();
        } else if (part) {
            [this.closer, this.closerPart] = [counts, part];
        }
        this.draw();
    }

    /** A point beyond what is shown comes into its middle. */
    reveal() {
        const [low, high] = this.span, [at] = this.points[this.chosen] ?? [low];
        if (at < low || at > high)
            this.seen(this.axis.show(at - (high - low) / 2, high - low));
    }

    /** @param {MouseEvent} event */
    doubled(event) {
        const place = this.at(event), index = this.near(place);
        if (index < 0) {
            this.insert(place);
            return;
        }
        this.chosen = index;
        this.remove();
    }

    /** @param {KeyboardEvent} event */
    key({key, shiftKey}) {
        const [low, high] = this.span, step = shiftKey ? 0.002 : 0.01;
        const point = this.points[this.chosen], by = STEPS[key];
        if (by && point)
            this.put(point[0] + by[0] * step * (high - low),
                Math.max(0, Math.min(1, point[1] - by[1] * step)));
        else if (key === 'PageDown' || key === 'PageUp')
            this.chosen = Math.max(0, Math.min(this.points.length - 1,
                this.chosen + (key === 'PageDown' ? 1 : -1)));
        else if (key === '+' || key === '=' || key === '-')
            this.nearer(key === '-' ? 1 / NEARER : NEARER);
        else if (key === '0')
            this.seen(this.axis.show(-Infinity, Infinity));
        else if (key === 'Insert')
            this.insert();
        else if (key === 'Delete')
            this.remove();
        else
            return false;
        this.reveal();
        this.draw();
        return true;
    }

    /** After a change of the page: most change nothing here. */
    follow() {
        const {store} = this, now = [store.keys[this.kind.key], store.keys.range, store.answered, store.histogram,
            matchMedia('(prefers-color-scheme: light)').matches];
        if (now.every((each, i) => each === this.drawn[i]))
            return;
        this.drawn = now;
        this.draw();
    }

    draw() {
        const g = surface(this.canvas)?.g;
        if (!g)
            return;
        const style = getComputedStyle(this.canvas);
        this.drawHistogram(g, style.getPropertyValue('--bars'));
        this.drawStrip(g);
        this.drawPoints(g, style.getPropertyValue('--text'), style.getPropertyValue('--accent'));
        const point = this.points[this.chosen];
        this.value.disabled = this.opacity.disabled = !point;
        show(this.value, point ? short(point[0]) : '');
        show(this.opacity, point ? short(point[1]) : '');
        this.showAxis();
    }

    /** The values at its ends, what they are of, and where they lie among all. */
    showAxis() {
        const {axis: {part}, ends, store: {info}} = this, [low, high] = this.span, [first, last] = this.all;
        const texts = [short(low), info && this.kind === BY_VALUE ? unitOf(info) : '', short(high)];
        ends.forEach((end, i) => {
            end.textContent = texts[i];
        });
        this.place.disabled = !part;
        show(this.place, part ? (low - first) / (last - first - high + low) : 0);
        this.canvas.dataset.span = `${[low, high]}`;
    }

    /** @param {CanvasRenderingContext2D} g
     * @param {string} color */
    drawHistogram(g, color) {
        const {part} = this.axis, {closer} = this;
        const histogram = closer && `${part}` === this.closerPart ? closer : this.kind.range(this.store);
        if (!histogram?.counts.length)
            return;
        /** @param {number} count */
        const scaled = count => this.log ? Math.log1p(count) : count;
        const top = Math.max(1, ...histogram.counts.map(scaled));
        const {bottom} = this, left = this.x(histogram.lo);
        const wide = (this.x(histogram.hi) - left) / histogram.counts.length;
        const end = this.canvas.clientWidth - EDGE;
        g.fillStyle = color;
        histogram.counts.forEach((count, i) => {
            const tall = scaled(count) / top * (bottom - EDGE), at = left + i * wide;
            const from = part ? Math.max(EDGE, at) : at, to = part ? Math.min(end, at + wide) : at + wide;
            if (to > from)
                g.fillRect(from, bottom - tall, to - from + 0.5, tall);
        });
    }

    /** @param {CanvasRenderingContext2D} g */
    drawStrip(g) {
        const {look} = this.store;
        if (this.kind !== BY_VALUE || !look)
            return;
        const {bottom} = this, left = this.x(look.low);
        const wide = (this.x(look.high) - left) / look.strip.length;
        look.strip.forEach((color, i) => {
            g.fillStyle = color;
            g.fillRect(left + i * wide, bottom + 3, wide + 0.5, 11);
        });
    }

    /** @param {CanvasRenderingContext2D} g
     * @param {string} line
     * @param {string} accent */
    drawPoints(g, line, accent) {
        const points = this.points, last = points.at(-1);
        if (!last)
            return;
        g.strokeStyle = line;
        g.lineWidth = 1.5;
        g.beginPath();
        g.moveTo(0, this.y(points[0][1]));
        for (const [value, opacity] of points)
            g.lineTo(this.x(value), this.y(opacity));
        g.lineTo(this.canvas.clientWidth, this.y(last[1]));
        g.stroke();
        this.canvas.dataset.points = points.map(([value, opacity]) =>
            `${Math.round(this.x(value))},${Math.round(this.y(opacity))}`).join(' ');
        points.forEach(([value, opacity], i) => {
            g.fillStyle = i === this.chosen ? accent : line;
            g.beginPath();
            g.arc(this.x(value), this.y(opacity), i === this.chosen ? 6 : 4.5, 0, 7);
            g.fill();
        });
    }
}
