// overlay.js - what the page draws over the picture and no file has: where the
// slices lie, and handles that move clip planes.

import {pixel, project} from '../camera.js';
import {grips} from './clip.js';
import {listen, make, surface} from '../controls.js';
import {STEPS} from '../keys.js';
import {COLORS, world} from '../slices.js';
import {known} from '../store.js';

/** @typedef {import('../types').Vector} Vector */

const HANDLES = 12; // six ends and six tilted planes
const NAMES = ['x', 'y', 'z'], PATIENT = ['left - right', 'back - front', 'bottom - top'];

/** @param {import('../types').Info} info */
export const axisNames = info => info.medical ? PATIENT : NAMES;

export class Overlay {
    /** `pointer` knows the box of the picture.
     * @param {import('../store.js').Store} store
     * @param {import('../pointer.js').Pointer} pointer
     * @param {import('../slices.js').Slices} slices */
    constructor(store, pointer, slices) {
        this.store = store;
        this.pointer = pointer;
        this.slices = slices;
        this.size = '';
        /** @type {import('./clip.js').Grip[]} */
        this.grips = [];
        /** What is dragged: from where, and how many pixels a step of it are.
         * @type {{grip: import('./clip.js').Grip, id: number, x: number, y: number, way: Vector,
         *   length: number}|null} */
        this.held = null;
        this.canvas = make('canvas', {className: 'over', 'aria-hidden': 'true'});
        this.handles = Array.from({length: HANDLES}, (_, i) => this.handle(i));
        store.onCamera(() => this.draw());
    }

    get elements() {
        return [this.canvas, ...this.handles];
    }

    /** From the place of the target, in pixels of the screen.
     * @param {Vector} place */
    see(place) {
        return project(this.store.keys, known(this.store.info), place, this.pointer.side);
    }

    /** A picture may have another size than the one before. */
    follow() {
        if (this.size !== `${this.pointer.size}`)
            this.draw();
    }

    draw() {
        const {canvas, pointer, store: {info, clipping}} = this;
        this.size = `${pointer.size}`;
        canvas.hidden = !(this.slices.keys && info?.slices && this.slices.hasLines); // empty, it costs as much
        if (canvas.hidden && !clipping && !this.grips.length)
            return; // nor is the page laid out to ask it for its size
        const {clientWidth: width, clientHeight: height} = pointer.canvas;
        if (!info || !width)
            return;
        const g = canvas.hidden ? null : surface(canvas)?.g;
        if (g) {
            g.translate(width / 2 - this.pointer.shift, height / 2);
            [0, 1, 2].forEach(k => this.outline(g, k));
        }
        this.place(width, height);
    }

    /** The edge of a slice across axis k of the grid.
     * @param {CanvasRenderingContext2D} g
     * @param {number} k */
    outline(g, k) {
        const info = known(this.store.info), index = this.slices.index, [u, v] = [0, 1, 2].filter(i => i !== k);
        g.strokeStyle = COLORS[k];
        g.lineWidth = 1.5;
        g.beginPath();
        for (const [a, b] of [[0, 0], [1, 0], [1, 1], [0, 1]]) {
            const corner = [...index];
            corner[u] = a * info.dims[u] - 0.5;
            corner[v] = b * info.dims[v] - 0.5;
            const seen = this.see(world(info, corner));
            if (seen)
                g.lineTo(...seen);
        }
        g.closePath();
        g.stroke();
    }

    // --- handles ---------------------------------------------------------------

    /** @param {number} i */
    handle(i) {
        const {pointer} = this, button = make('button', {type: 'button', className: 'handle',
            hidden: true, role: 'slider', 'aria-label': 'clip plane'});
        listen(button, {down: event => this.down(event, i), move: event => this.move(event),
            up: event => this.up(event), wheel: event => pointer.wheel(event), key: ({key}) => {
                const by = STEPS[key], {move, value, low, high} = this.grips[i];
                if (by)
                    this.store.set(move(this.store.keys, value + (by[0] - by[1]) * (high - low) / 100));
                return by;
            }});
        return button;
    }

    /** @param {number} width
     * @param {number} height */
    place(width, height) {
        const {clipping, keys} = this.store, info = known(this.store.info);
        this.grips = clipping ? grips(keys, info, axisNames(info)) : [];
        this.handles.forEach((button, i) => {
            const grip = this.grips[i], seen = grip && !grip.fixed && this.see(grip.place);
            button.hidden = !seen;
            if (!seen)
                return;
            const [x, y] = [seen[0] + width / 2 - this.pointer.shift, seen[1] + height / 2];
            button.style.left = `${Math.max(12, Math.min(width - 12, x))}px`;
            button.style.top = `${Math.max(12, Math.min(height - 12, y))}px`;
            button.style.background = COLORS[grip.axis];
            button.title = grip.name;
            button.setAttribute('aria-label', grip.name);
            button.setAttribute('aria-valuemin', `${grip.low}`);
            button.setAttribute('aria-valuemax', `${grip.high}`);
            button.setAttribute('aria-valuenow', `${grip.value}`);
        });
    }

    /** @param {PointerEvent} event
     * @param {number} i */
    down(event, i) {
        if (event.button || this.held)
            return true;
        const {keys} = this.store, info = known(this.store.info), grip = this.grips[i], handle = this.handles[i];
        const unit = info.radius / 100, from = known(this.see(grip.place));
        const to = this.see(grip.place.map((x, k) => x + unit * grip.way[k])) ?? from;
        handle.focus();
        handle.setPointerCapture(event.pointerId);
        this.held = {grip, id: event.pointerId, x: event.clientX, y: event.clientY,
            way: [(to[0] - from[0]) / unit, (to[1] - from[1]) / unit],
            length: pixel(keys, info, this.pointer.side)};
        this.store.begin();
        return true;
    }

    /** The plane stays under the pointer; one that is seen edge-on follows up and
     * down.
     * @param {PointerEvent} event */
    move(event) {
        if (!this.held || this.held.id !== event.pointerId)
            return;
        const {grip, x, y, way, length} = this.held;
        const dx = event.clientX - x, dy = event.clientY - y, square = way[0] ** 2 + way[1] ** 2;
        const by = square * length ** 2 > 0.02 ? (dx * way[0] + dy * way[1]) / square : -dy * length;
        this.store.set(grip.move(this.store.keys, grip.value + by));
    }

    /** @param {PointerEvent} event */
    up(event) {
        if (!this.held || this.held.id !== event.pointerId)
            return;
        this.held = null;
        this.store.end();
    }
}
