// pointer.js - mouse, wheel and fingers on the picture.

import {panned, round, tumbled, turned, zoomed} from './camera.js';
import {ranged} from './panel/colors.js';
import {apart, listen, pinched} from './controls.js';
import {listed, mixed} from './look.js';
import {known} from './store.js';

/** @typedef {import('./types').Keys} Keys */
/** @typedef {import('./types').Pair} Pair */

/** What a drag does, by button and key; otherwise what was chosen, as a finger has
 * neither. */
export const TOOLS = [['turn', 'turns'], ['tumble', 'turns over the poles'], ['pan', 'moves'], ['window', 'window, level'],
    ['opacity', 'opacity'], ['light', 'light']];

/** @param {MouseEvent} event
 * @param {string} tool
 * @returns {string|null} */
export function kindOf(event, tool) {
    if (event.button === 1 || (event.button === 0 && event.shiftKey))
        return 'pan';
    if (event.button === 2)
        return event.ctrlKey || event.metaKey ? 'opacity' : 'window';
    return event.button ? null : event.ctrlKey ? 'light' : tool;
}

/** The light follows the pointer; the key light is where it begins.
 * @param {Keys} keys
 * @param {number} dx
 * @param {number} dy
 * @param {number} side */
function lit(keys, dx, dy, side) {
    const [azimuth, elevation] = Array.isArray(keys.light) ? keys.light
        : keys.light === 'head' ? [0, 0] : [-25, 35];
    /** @param {number} value */
    const bound = value => round(Math.max(-90, Math.min(90, value)));
    return {light: [bound(azimuth + 180 * dx / side), bound(elevation - 180 * dy / side)]};
}

export class Pointer {
    /** `aim` gets a place that was double-clicked, as shares of the picture's sides.
     * @param {HTMLCanvasElement} canvas
     * @param {import('./store.js').Store} store
     * @param {(x: number, y: number) => void} aim */
    constructor(canvas, store, aim) {
        this.canvas = canvas;
        /** Pixels of the picture, of which the canvas has fewer in a small draft.
         * @type {Pair} */
        this.size = [canvas.width, canvas.height];
        this.store = store;
        this.aim = aim;
        /** @type {Map<number, Pair>} */
        this.fingers = new Map();
        /** @type {string|null} */
        this.kind = null;
        // What a drag began with: the look, the colours, and the way since.
        this.start = store.look;
        /** @type {string|undefined} */
        this.map = undefined;
        /** @type {Pair} */
        this.total = [0, 0];
        this.last = ''; // what steps of keys have made
        listen(canvas, this);
    }

    /** @param {MouseEvent} event */
    doubled(event) {
        const [x, y] = this.at(event), [width, height] = this.box;
        this.aim((x - this.shift) / width + 0.5, y / height + 0.5);
    }

    /** The box in which the picture is drawn: another page may have another window. */
    get box() {
        const {canvas: {clientWidth, clientHeight}, size: [width, height]} = this;
        const scale = Math.min(clientWidth / width, clientHeight / height) || 1;
        return [width * scale, height * scale];
    }

    /** The shorter side of what is not left to a legend. */
    get side() {
        const [width, height] = this.box;
        return Math.min(width - 2 * this.shift, height);
    }

    /** How far the target is left of the middle, beside a legend. */
    get shift() {
        return this.box[0] * (this.store.look?.legend ?? 0) / 2;
    }

    /** From the place of the target.
     * @param {MouseEvent} event
     * @returns {Pair} */
    at(event) {
        const box = this.canvas.getBoundingClientRect();
        return [event.clientX - box.left - box.width / 2 + this.shift,
            event.clientY - box.top - box.height / 2];
    }

    /** @param {PointerEvent} event */
    down(event) {
        if (this.store.info && this.store.look)
            this.kind ??= kindOf(event, this.store.tool);
        if (!this.kind)
            return false;
        this.canvas.focus();
        this.canvas.setPointerCapture(event.pointerId);
        this.fingers.set(event.pointerId, this.at(event));
        this.take();
        this.store.begin();
        return true;
    }

    /** What a drag begins with. */
    take() {
        this.start = this.store.look;
        this.map = this.store.keys.colormap;
        this.total = [0, 0];
    }

    /** What keys do in the place of a drag, by degrees of a turn.  Steps without other
     * changes between them are one drag: it goes on from what it began with.
     * @param {number} across
     * @param {number} down */
    step(across, down) {
        const {store, store: {tool}} = this;
        const made = () => [tool, store.keys[tool === 'window' ? 'range' : 'opacity'],
            store.keys.channel].join(); // what the viewer adds to it is no change
        if (this.last !== made())
            this.take();
        const pixels = this.box[1] / 180;
        this.drag(across * pixels, down * pixels, tool);
        this.last = made();
    }

    /** @param {PointerEvent} event */
    move(event) {
        const before = this.fingers.get(event.pointerId);
        if (!before)
            return;
        const now = this.at(event);
        if (this.fingers.size === 2)
            this.pinch(event.pointerId, before, now);
        else
            this.drag(now[0] - before[0], now[1] - before[1]);
        this.fingers.set(event.pointerId, now);
    }

    /** @param {number} dx
     * @param {number} dy */
    drag(dx, dy, kind = this.kind) {
        const {store, store: {keys}} = this, info = known(store.info);
        this.total = [this.total[0] + dx, this.total[1] + dy];
        if (kind === 'turn')
            store.set(turned(keys, dx, dy, this.box[1]));
        else if (kind === 'tumble')
            store.set(tumbled(keys, info, dx, dy, this.box[1]));
        else if (kind === 'pan')
            store.set(panned(keys, info, dx, dy, this.side));
        else if (kind === 'light')
            store.set(lit(keys, dx, dy, this.side));
        else
            store.set(kind === 'window' ? this.windowed() : this.faded());
    }

    /** To the right: wider; up: a higher level. */
    windowed() {
        const start = known(this.start), [x, y] = this.total;
        /** @param {number} low
         * @param {number} high */
        const to = (low, high) => {
            const half = (high - low) * Math.exp(x / 250) / 2;
            const level = (low + high) / 2 - (high - low) * y / this.canvas.clientHeight;
            return apart([level - half, level + half], 5);
        };
        return mixed(start) ? listed(known(start.channels).map(([a, b, c, d, low, high, e]) =>
            [a, b, c, d, ...to(low, high), e]))
            : ranged(start, {...this.store.keys, colormap: this.map}, to(start.low, start.high));
    }

    /** Up: more opaque; not of a look whose points the page has not all.
     * @returns {import('./types').Changes} */
    faded() {
        const factor = Math.exp(-this.total[1] / 120), start = known(this.start);
        if (mixed(start))
            return listed(known(start.channels).map(([a, b, c, d, e, f, opacity]) =>
                [a, b, c, d, e, f, Math.min(1, +(opacity * factor).toFixed(3))]));
        if (!this.store.keys.opacity && start.count > start.opacity.length) {
            this.store.say('The look has too many points to change here; choose a preset.');
            return {};
        }
        return {opacity: start.opacity.map(
            ([value, opacity]) => [value, Math.min(1, opacity * factor)])};
    }

    /** Two fingers: the middle moves, the distance zooms.
     * @param {number} id
     * @param {Pair} before
     * @param {Pair} now */
    pinch(id, before, now) {
        const {store, side} = this, info = known(store.info), [factor, x, y] = pinched(this.fingers, id, now);
        store.set(panned(store.keys, info, (now[0] - before[0]) / 2, (now[1] - before[1]) / 2, side));
        store.set(zoomed(store.keys, info, factor, x, y, side));
    }

    /** @param {PointerEvent} event */
    up(event) {
        if (!this.fingers.delete(event.pointerId) || this.fingers.size)
            return;
        this.kind = null;
        this.store.end();
    }

    /** @param {WheelEvent} event */
    wheel(event) {
        const lines = event.deltaMode ? 30 : 1, {store} = this;
        const [x, y] = this.at(event);
        if (store.info)
            store.set(zoomed(store.keys, store.info,
                Math.exp(-event.deltaY * lines / 600), x, y, this.side));
        return true;
    }
}
