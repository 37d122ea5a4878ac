// overlay.js - what the page draws over the picture and no file has: where the
// slices lie, and handles that move clip planes.

import {pixel, project} from './camera.js';
import {grips} from './clip.js';
import {listen, make, surface} from './controls.js';
import {STEPS} from './keys.js';
import {COLORS, world} from './slices.js';

const HANDLES = 12; // six ends and six tilted planes
const NAMES = ['x', 'y', 'z'], PATIENT = ['left - right', 'back - front', 'bottom - top'];

export const axisNames = info => info.medical ? PATIENT : NAMES;

export class Overlay {
    /** `pointer` knows the box of the picture. */
    constructor(recipe, page, pointer, slices) {
        Object.assign(this, {recipe, page, pointer, slices});
        this.canvas = make('canvas', {className: 'over', 'aria-hidden': 'true'});
        this.handles = Array.from({length: HANDLES}, (_, i) => this.handle(i));
        recipe.onChange(() => this.draw());
    }

    get elements() {
        return [this.canvas, ...this.handles];
    }

    /** From the place of the target, in pixels of the screen. */
    see(place) {
        return project(this.recipe.keys, this.page.info, place, this.pointer.side);
    }

    /** A picture may have another size than the one before. */
    follow() {
        const {width, height} = this.pointer.canvas;
        if (this.size !== `${width} ${height}`)
            this.draw();
    }

    draw() {
        const {width: across, height: down, clientWidth: width, clientHeight: height} = this.pointer.canvas;
        this.size = `${across} ${down}`;
        const {canvas, page} = this;
        if (!page.info || !width)
            return;
        canvas.hidden = !(this.slices.keys && page.info.slices); // empty, it costs as much
        if (!canvas.hidden) {
            const {g} = surface(canvas);
            g.translate(width / 2 - this.pointer.shift, height / 2);
            [0, 1, 2].forEach(k => this.outline(g, k));
        }
        this.place(width, height);
    }

    /** The edge of a slice across axis k of the grid. */
    outline(g, k) {
        const {info} = this.page, index = this.slices.index, [u, v] = [0, 1, 2].filter(i => i !== k);
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

    handle(i) {
        const {pointer} = this, button = make('button', {type: 'button', className: 'handle',
            hidden: true, role: 'slider', 'aria-label': 'clip plane'});
        listen(button, {down: event => this.down(event, i), move: event => this.move(event),
            up: event => this.up(event), wheel: event => pointer.wheel(event), key: ({key}) => {
                const by = STEPS[key], {move, value, low, high} = this.grips[i];
                if (by)
                    this.recipe.set(move(this.recipe.keys, value + (by[0] - by[1]) * (high - low) / 100));
                return by;
            }});
        return button;
    }

    place(width, height) {
        const {info, clipping} = this.page;
        this.grips = clipping ? grips(this.recipe.keys, info, axisNames(info)) : [];
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
            button.setAttribute('aria-valuemin', grip.low);
            button.setAttribute('aria-valuemax', grip.high);
            button.setAttribute('aria-valuenow', grip.value);
        });
    }

    down(event, i) {
        if (event.button || this.held)
            return true;
        const {keys} = this.recipe, {info} = this.page, grip = this.grips[i];
        const unit = info.radius / 100, from = this.see(grip.place);
        const to = this.see(grip.place.map((x, k) => x + unit * grip.way[k])) ?? from;
        event.target.focus();
        event.target.setPointerCapture(event.pointerId);
        this.held = {grip, id: event.pointerId, x: event.clientX, y: event.clientY,
            way: [(to[0] - from[0]) / unit, (to[1] - from[1]) / unit],
            length: pixel(keys, info, this.pointer.side)};
        this.recipe.begin();
        return true;
    }

    /** The plane stays under the pointer; one that is seen edge-on follows up and
     * down. */
    move(event) {
        if (this.held?.id !== event.pointerId)
            return;
        const {grip, x, y, way, length} = this.held;
        const dx = event.clientX - x, dy = event.clientY - y, square = way[0] ** 2 + way[1] ** 2;
        const by = square * length ** 2 > 0.02 ? (dx * way[0] + dy * way[1]) / square : -dy * length;
        this.recipe.set(grip.move(this.recipe.keys, grip.value + by));
    }

    up(event) {
        if (this.held?.id !== event.pointerId)
            return;
        this.held = null;
        this.recipe.end();
    }
}
