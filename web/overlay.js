// overlay.js - what the page draws over the picture and no file has: where the
// slices lie, and handles that move clip planes.

import {pixel, project} from './camera.js';
import {grips} from './clip.js';
import {make} from './controls.js';
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

    /** From the middle of the picture, in pixels of the screen. */
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
        const {canvas, page} = this, dense = devicePixelRatio || 1;
        if (!page.info || !width)
            return;
        canvas.hidden = !(this.slices.keys && page.info.slices); // empty, it costs as much
        if (!canvas.hidden) {
            canvas.width = Math.round(width * dense);
            canvas.height = Math.round(height * dense);
            const g = canvas.getContext('2d');
            g.setTransform(dense, 0, 0, dense, canvas.width / 2, canvas.height / 2);
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
        const {recipe} = this;
        const button = make('button', {type: 'button', className: 'handle', hidden: true,
            role: 'slider', 'aria-label': 'clip plane',
            onpointerdown: event => this.down(event, i), onpointermove: event => this.move(event),
            onpointerup: event => this.up(event), onpointercancel: event => this.up(event),
            onlostpointercapture: event => this.up(event),
            onwheel: event => this.pointer.wheel(event),
            oncontextmenu: event => event.preventDefault(), onkeydown: event => {
                const by = {ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1}[event.key];
                if (!by)
                    return;
                event.preventDefault();
                event.stopPropagation();
                const grip = this.grips[i];
                recipe.set(grip.move(recipe.keys, grip.value + by * (grip.high - grip.low) / 100));
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
            const [x, y] = [seen[0] + width / 2, seen[1] + height / 2];
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
        event.preventDefault();
        if (event.button || this.held)
            return;
        const {keys} = this.recipe, {info} = this.page, grip = this.grips[i];
        const unit = info.radius / 100, from = this.see(grip.place);
        const to = this.see(grip.place.map((x, k) => x + unit * grip.way[k])) ?? from;
        event.target.focus();
        event.target.setPointerCapture(event.pointerId);
        this.held = {grip, id: event.pointerId, x: event.clientX, y: event.clientY,
            way: [(to[0] - from[0]) / unit, (to[1] - from[1]) / unit],
            length: pixel(keys, info, this.pointer.side)};
        this.recipe.begin();
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
