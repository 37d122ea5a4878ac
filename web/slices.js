// slices.js - three slices beside the picture, whose crosshairs move one another.
//
// Where they cross, and their window, are of this page alone: a key of its recipe
// that no server gets, so that undo and links have it.

import {add, cross, dot} from './camera.js';
import {apart, button, check, listen, make, number, pinched, row, section, select, short, show,
    slider, surface} from './controls.js';
import {STEPS} from './keys.js';
import {kindOf} from './pointer.js';
import {slabText, thickness} from './slab.js';
import {known} from './store.js';

/** @typedef {import('./types').Info} Info */
/** @typedef {import('./types').Pair} Pair */
/** @typedef {import('./types').Vector} Vector */
/** @typedef {import('./types').Frame} Frame */

export const COLORS = ['#ff7b72', '#56d364', '#6db1ff', '#e3b341']; // across x, y, z of the grid
const REST = 200; // ms until the exact picture is asked for
const STEP = 60; // of the wheel
const SMALL = 150; // pixels of a pane's side
const EDGE = 12; // pixels from the edge of a pane, within which a crosshair is in sight
const MAGNIFIED_MOST = 40;

/** Of a CT, in Hounsfield units: width and level.
 * @type {Record<string, Pair>} */
const WINDOWS = {'soft tissue': [400, 40], brain: [80, 40], liver: [150, 60], lung: [1500, -600],
    bone: [1800, 400]};

/** @param {number[][]} matrix
 * @param {number} k */
const column = (matrix, k) => matrix.map(line => line[k]);

/** The voxel of a place in the world, and back.
 * @param {Info} info
 * @param {Vector} place */
function voxel({matrix, dims}, place) {
    const [a, b, c, origin] = [0, 1, 2, 3].map(k => column(matrix, k));
    const from = add(place, origin, -1), whole = dot(a, cross(b, c));
    return [cross(b, c), cross(c, a), cross(a, b)].map((way, i) =>
        Math.max(0, Math.min(dims[i] - 1, Math.round(dot(from, way) / whole))));
}

/** @param {Info} info
 * @param {number[]} index */
export function world({matrix}, index) {
    return matrix.map(line => +(line[3] + dot(line.slice(0, 3), index)).toPrecision(9));
}

/** "R" or, of no patient, "+x": where a step along the grid goes.
 * @param {Info} info
 * @param {number} k
 * @param {number} sign */
function letter(info, k, sign) {
    const way = column(info.matrix, k).map(x => x * sign);
    const axis = way.reduce((best, x, i) => Math.abs(x) > Math.abs(way[best]) ? i : best, 0);
    return info.medical ? 'RLAPSI'[2 * axis + (way[axis] < 0 ? 1 : 0)]
        : (way[axis] < 0 ? '-' : '+') + 'xyz'[axis];
}

/** "S 12.5 mm", or "z = 3 um".
 * @param {Info} info
 * @param {number} k
 * @param {Vector} at */
function placeText(info, k, at) {
    const way = column(info.matrix, k).map(Math.abs), axis = way.indexOf(Math.max(...way));
    const [unit, length] = info.axes[axis], value = at[axis] / length;
    return info.medical ?
        `${'RLAPSI'[2 * axis + (value < 0 ? 1 : 0)]} ${short(Math.abs(value))} ${unit}`
        : `${'xyz'[axis]} = ${short(value)} ${unit}`;
}

export class Pane {
    /** @param {Slices} owner
     * @param {number} number_ */
    constructor(owner, number_) {
        this.owner = owner;
        this.number = number_;
        this.own = 1; // zoom, while others have another
        this.turned = 0; // the wheel, since the last slice
        /** @type {Map<number, Pair>} */
        this.fingers = new Map();
        /** @type {string|null} */
        this.kind = null; // of a drag
        /** @type {Pair} */
        this.middle = [0, 0]; // of the pane, in pixels from that of the slice
        /** @type {import('./types').SliceInfo|null} */
        this.slice = null; // null: not known yet

        // The picture that is shown, and the one that was asked for last.
        /** @type {ImageBitmap|null} */
        this.bitmap = null;
        /** @type {Blob|null} */
        this.file = null;
        this.busy = false;
        this.exact = false;
        this.asked = ''; // what was wished then
        this.n = 0;
        this.timer = 0;
        this.canvas = make('canvas', {tabIndex: 0, role: 'img'});
        this.caption = make('figcaption', {});
        this.slider = slider('slice', 0, 1, 1, owner.store,
            value => owner.step(this, value - owner.index[this.along]));
        this.element = make('figure', {className: 'pane'}, this.canvas, this.caption,
            button('\u2922', 'This slice alone, or all (Enter)', () => owner.alone(this)), this.slider);
        listen(this.canvas, this);
        new ResizeObserver(() => this.fitted()).observe(this.canvas);
    }

    get info() {
        return known(this.slice);
    }

    /** A small pane has a short caption, and little else. */
    get isSmall() {
        return Math.min(this.canvas.clientWidth, this.canvas.clientHeight) < SMALL;
    }

    fitted() {
        this.element.classList.toggle('small', this.isSmall);
        if (this.slice && this.owner.keys)
            this.show();
    }

    get along() {
        return this.info.along;
    }

    doubled() {
        this.owner.alone(this);
    }

    /** @param {PointerEvent} event */
    up(event) {
        if (this.fingers.delete(event.pointerId) && !this.fingers.size)
            this.owner.store.end();
    }

    /** The length of a pixel of the slice in the world. */
    get length() {
        const {info, owner: {info: {dims, matrix}}} = this, [k] = info.right;
        return dims[k] * Math.hypot(...column(matrix, k)) / info.width;
    }

    /** The scale at which the slice fits. */
    get fit() {
        const {canvas: {clientWidth: width, clientHeight: height}, info} = this;
        return Math.min(width / info.width, height / info.height);
    }

    /** One for all, as pixels of the screen in the world, or its own. */
    get zoom() {
        const {owner} = this;
        return owner.isApart ? this.own : owner.scale ? owner.scale * this.length / this.fit : 1;
    }

    /** Where the slice lies in the pane: its corner, and the length of a pixel. */
    get place() {
        const {clientWidth: width, clientHeight: height} = this.canvas, {info} = this;
        const scale = this.zoom * this.fit;
        return {scale, x: width / 2 - (info.width / 2 + this.middle[0]) * scale,
            y: height / 2 - (info.height / 2 + this.middle[1]) * scale};
    }

    /** Pixels of the slice, of the crosshair. */
    get cross() {
        const {right, width, down, height} = this.info;
        /** @param {Pair} way
         * @param {number} length */
        const at = ([k, sign], length) => {
            const count = this.owner.info.dims[k], i = this.owner.index[k];
            return ((sign > 0 ? i : count - 1 - i) + 0.5) / count * length;
        };
        return [at(right, width), at(down, height)];
    }

    /** The voxel under the pointer, in this slice.
     * @param {Pair} pointer */
    voxelAt([x, y]) {
        const index = [...this.owner.index], {place, info} = this;
        /** @param {Pair} way
         * @param {number} length
         * @param {number} at */
        const put = ([k, sign], length, at) => {
            const count = this.owner.info.dims[k];
            const i = Math.floor(at / place.scale / length * count);
            index[k] = Math.max(0, Math.min(count - 1, sign > 0 ? i : count - 1 - i));
        };
        put(info.right, info.width, x - place.x);
        put(info.down, info.height, y - place.y);
        return index;
    }

    /** @param {MouseEvent} event
     * @returns {Pair} */
    at({offsetX, offsetY}) {
        return [offsetX, offsetY];
    }

    /** @param {PointerEvent} event */
    down(event) {
        this.canvas.focus();
        this.canvas.setPointerCapture(event.pointerId);
        this.fingers.set(event.pointerId, this.at(event));
        this.kind = kindOf(event, this.owner.store.tool);
        this.owner.store.begin();
        if (this.fingers.size === 1 && this.kind !== 'pan' && this.kind !== 'window')
            this.owner.goTo(this.voxelAt(this.at(event)));
        return true;
    }

    /** @param {PointerEvent} event */
    move(event) {
        const before = this.fingers.get(event.pointerId), now = this.at(event);
        if (!before)
            return;
        const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
        if (this.fingers.size === 2) {
            const [factor, x, y] = pinched(this.fingers, event.pointerId, now);
            this.zoomAt(factor, [x, y]);
            this.pan(dx / 2, dy / 2);
        } else if (this.kind === 'pan') {
            this.pan(dx, dy);
        } else if (this.kind === 'window') {
            this.owner.drag(dx, dy);
        } else {
            this.owner.goTo(this.voxelAt(now));
        }
        this.fingers.set(event.pointerId, now);
    }

    /** @param {number} dx
     * @param {number} dy */
    pan(dx, dy) {
        const {scale} = this.place;
        this.middle = [this.middle[0] - dx / scale, this.middle[1] - dy / scale];
        this.draw();
    }

    /** About a place, which stays; others about the crossing.
     * @param {number} factor
     * @param {Pair} place */
    zoomAt(factor, place) {
        const {owner} = this, panes = owner.isApart ? [this] : owner.panes;
        const zoom = Math.max(1, Math.min(MAGNIFIED_MOST, this.zoom * factor));
        const before = panes.map(pane => pane.place);
        this.own = zoom;
        owner.scale = zoom === 1 ? null : zoom * this.fit / this.length;
        panes.forEach((pane, i) => pane.hold(before[i], pane === this ? place : null));
    }

    /** Moves the slice so that a place stays where it was before, or the crossing, which
     * is brought into sight.
     * @param {{scale: number, x: number, y: number}} before
     * @param {Pair|null} place */
    hold(before, place) {
        const {scale} = this.place, {clientWidth, clientHeight} = this.canvas, {cross: [right, down]} = this;
        const [x, y] = place ?? [before.x + right * before.scale, before.y + down * before.scale];
        const part = 1 / before.scale - 1 / scale;
        this.middle = this.zoom === 1 ? [0, 0]
            : [this.middle[0] + (x - clientWidth / 2) * part, this.middle[1] + (y - clientHeight / 2) * part];
        if (!place)
            this.seek();
        this.draw();
    }

    /** A slice that is larger than its pane shows where slices cross. */
    seek() {
        if (!this.slice || this.zoom === 1 || this.fingers.size)
            return;
        const {x, y, scale} = this.place, {info, cross: [right, down], canvas} = this;
        const [px, py] = [x + right * scale, y + down * scale];
        if (px < EDGE || py < EDGE || px > canvas.clientWidth - EDGE || py > canvas.clientHeight - EDGE)
            this.middle = [right - info.width / 2, down - info.height / 2];
    }

    /** @param {WheelEvent} event */
    wheel(event) {
        const by = event.deltaY * (event.deltaMode ? 30 : 1);
        if (event.ctrlKey) {
            this.zoomAt(Math.exp(-by / 300), this.at(event));
        } else {
            this.turned += by;
            const steps = Math.trunc(this.turned / STEP);
            this.turned -= steps * STEP;
            this.owner.step(this, steps);
        }
        return true;
    }

    /** @param {KeyboardEvent} event */
    key({key, ctrlKey, metaKey, altKey}) {
        const {owner, info: {right, down}, canvas} = this, by = STEPS[key];
        const page = key === 'PageUp' ? 1 : key === 'PageDown' ? -1 : 0;
        if (ctrlKey || metaKey || altKey)
            return false;
        if (page) {
            owner.step(this, page);
        } else if (by) {
            const {index} = owner;
            index[right[0]] += right[1] * by[0];
            index[down[0]] += down[1] * by[1];
            owner.goTo(index);
        } else if (key === 'Enter') {
            owner.alone(this);
        } else if (key === '+' || key === '=' || key === '-') {
            this.zoomAt(key === '-' ? 1 / 1.25 : 1.25, [canvas.clientWidth / 2, canvas.clientHeight / 2]);
        } else if (key === 'c') {
            owner.command(this);
        } else {
            return false;
        }
        return true;
    }

    /** What the server is to draw. */
    get wish() {
        const {index, crossing: keys} = this.owner;
        return {axis: this.info.axis, index: index[this.along], range: keys.range,
            colored: keys.colored ?? false, ...keys.slab && {slab: keys.slab}};
    }

    /** Asks for what is not there yet: at most one picture is under way. */
    ask() {
        const {owner} = this;
        clearTimeout(this.timer);
        if (this.busy || !this.slice || !owner.keys)
            return;
        const wish = JSON.stringify([this.wish, owner.data]);
        const exact = wish === this.asked;
        if (exact && this.exact)
            return;
        const send = () => {
            this.busy = true;
            this.exact = exact;
            this.asked = wish;
            this.n = ++owner.n;
            owner.engine.ask('slice', {...this.wish, pane: this.number, n: this.n, exact});
        };
        if (exact)
            this.timer = setTimeout(send, REST);
        else
            send();
    }

    /** @param {Frame} frame */
    async take(frame) {
        if (frame.n !== this.n)
            return;
        const bitmap = await createImageBitmap(frame.blob, {colorSpaceConversion: 'none'});
        if (frame.n !== this.n) { // of another volume, meanwhile
            bitmap.close();
            return;
        }
        this.bitmap?.close();
        this.bitmap = bitmap;
        this.file = frame.level === 2 ? frame.blob : null;
        this.busy = false;
        this.draw();
        this.ask();
    }

    /** No picture is better than that of something else. */
    blank() {
        this.bitmap?.close();
        this.bitmap = this.file = null;
        surface(this.canvas, {alpha: false});
    }

    show() {
        const {info: whole, index} = this.owner, count = whole.dims[this.along];
        const name = this.info.axis.length === 1 ? `across ${this.info.axis}` : this.info.axis;
        const place = `${name} ${index[this.along]}/${count - 1}, ` + placeText(whole, this.along, world(whole, index));
        this.caption.textContent = this.isSmall ? `${name} ${index[this.along]}` : place;
        this.caption.style.color = COLORS[this.along];
        this.slider.max = `${count - 1}`;
        this.slider.value = `${index[this.along]}`;
        this.slider.setAttribute('aria-label', `${name} slice`);
        this.canvas.setAttribute('aria-label', `Slice ${place}. Arrow keys move ` +
            'the crosshair, Page keys choose the slice, Enter shows it alone.');
        this.draw();
    }

    draw() {
        const {canvas, bitmap, slice: info} = this, area = bitmap && info && surface(canvas, {alpha: false});
        if (!area)
            return;
        const {g, width, height} = area;
        const {x, y, scale} = this.place;
        g.imageSmoothingQuality = 'high';
        g.drawImage(bitmap, x, y, info.width * scale, info.height * scale);
        const {cross: [right, down]} = this, px = x + right * scale, py = y + down * scale;
        if (this.owner.hasLines) {
            this.line(g, COLORS[info.right[0]], [px, 0, px, py - 9], [px, py + 9, px, height]);
            this.line(g, COLORS[info.down[0]], [0, py, px - 9, py], [px + 9, py, width, py]);
        }
        this.write(g, width, height);
        this.owner.drawOver(this, g);
    }

    /** @param {CanvasRenderingContext2D} g
     * @param {string} color
     * @param {...[number, number, number, number]} parts */
    line(g, color, ...parts) {
        g.strokeStyle = color;
        g.beginPath();
        for (const [x0, y0, x1, y1] of parts) {
            g.moveTo(x0, y0);
            g.lineTo(x1, y1);
        }
        g.stroke();
    }

    /** Letters of the sides, window and level, the value where the lines cross.
     * @param {CanvasRenderingContext2D} g
     * @param {number} width
     * @param {number} height */
    write(g, width, height) {
        const {info, crossing: keys, value} = this.owner, {right: [r, a], down: [d, b]} = this.info;
        /** @param {string} text
         * @param {number} x
         * @param {number} y
         * @param {CanvasTextAlign} align */
        const put = (text, x, y, align) => {
            g.textAlign = align;
            g.strokeText(text, x, y);
            g.fillText(text, x, y);
        };
        g.font = '600 14px system-ui, sans-serif';
        g.fillStyle = '#fff';
        g.strokeStyle = '#000';
        g.lineWidth = 3;
        g.textBaseline = 'middle';
        put(letter(info, r, a), width - 5, height / 2, 'right');
        put(letter(info, r, -a), 5, height / 2, 'left');
        if (this.isSmall)
            return;
        const caption = this.caption.offsetTop + this.caption.offsetHeight; // it may have two lines
        put(letter(info, d, -b), width / 2, Math.max(32, caption + 10), 'center');
        put(letter(info, d, b), width / 2, height - 46, 'center');
        g.font = '12px system-ui, sans-serif';
        const [low, high] = keys.range;
        put(`W ${short(high - low)} L ${short((low + high) / 2)}`, 5, height - 30, 'left');
        if (keys.slab)
            put(slabText(keys.slab), 5, height - 46, 'left');
        if (Number.isFinite(value))
            put(short(value), width - 5, height - 30, 'right');
    }
}

export class Slices {
    /** `views` is the element that holds the picture, and gets the panes.
     * @param {import('./store.js').Store} store
     * @param {HTMLElement} views */
    constructor(store, views) {
        const {engine} = store;
        this.store = store;
        this.engine = engine;
        this.views = views;
        this.n = 0;
        this.value = NaN; // where the lines cross
        /** @type {number|null} */
        this.scale = null; // pixels of the screen in the world; null: each slice fits
        this.seen = ''; // where slices crossed last
        this.last = this.keys; // how they were before they were put away
        this.at = ''; // where a value was asked for last,
        this.waits = false; // and it has not come
        /** Draws what else lies in a slice.
         * @type {(pane: Pane, g: CanvasRenderingContext2D) => void} */
        this.drawOver = () => {};
        this.panes = [1, 2, 3].map(i => new Pane(this, i));
        engine.on('small', frame => this.panes[frame.pane - 1]?.take(frame));
        engine.on('slice', ({pane}) => { // there is none; why has been said
            const one = this.panes[pane - 1];
            one.busy = false;
            one.exact = true;
            one.blank();
            if (one.element.isConnected)
                one.ask();
        });
        engine.on('open', () => this.renew());
        engine.on('value', message => this.hearValue(message));
        store.onChange(() => this.update());
    }

    /** Nothing where there are no slices. */
    get keys() {
        return this.store.keys.slices;
    }

    get crossing() {
        return known(this.keys);
    }

    get info() {
        return known(this.store.info);
    }

    get index() {
        return voxel(this.info, this.crossing.at);
    }

    /** The volume that is shown: another crop, time, channel has other slices. */
    get data() {
        const {crop, time, channel, component, labels, preset, colormap, scale, overlay,
            'overlay-look': look} = this.store.keys;
        return [crop, time, channel, component, labels, overlay, look,
            this.crossing.colored && [preset, colormap, scale]];
    }

    /** @param {Partial<import('./types').Crossing>} changes */
    set(changes) {
        this.store.set({slices: {...this.crossing, ...changes}});
    }

    /** Whether each slice has a zoom of its own. */
    get isApart() {
        return Boolean(this.keys?.apart);
    }

    get hasLines() {
        return this.keys?.lines !== false;
    }

    /** @returns {import('./layout.js').Name} */
    get layout() {
        return this.keys ? this.keys.layout ?? 'beside' : 'picture';
    }

    toggle() {
        this.arrange(this.keys ? 'picture' : this.last?.layout ?? 'beside');
    }

    /** Once more a large slice: the next one.
     * @param {import('./layout.js').Name} name */
    arrange(name) {
        const {info, keys, layout} = this;
        if (!info.slices || (name === layout && name !== 'slice'))
            return;
        this.views.classList.remove('alone');
        const {large = 0, ...own} = keys ?? this.last ?? {range: apart(info.window, 5),
            at: world(info, info.dims.map(count => Math.floor(count / 2)))};
        const next = name === 'slice' && layout === 'slice' ? (large + 1) % this.panes.length : large;
        this.store.part();
        this.store.set({slices: name === 'picture' ? null
            : {...own, layout: name === 'beside' ? undefined : name, ...next && {large: next}}});
        this.store.part(); // what is done to slices at once is undone alone
    }

    /** @param {number[]} index */
    goTo(index) {
        const {info} = this;
        this.set({at: world(info, index.map((i, k) => Math.max(0, Math.min(info.dims[k] - 1, i))))});
    }

    /** @param {Pane} pane
     * @param {number} by */
    step(pane, by) {
        const index = this.index;
        index[pane.along] += by;
        if (by)
            this.goTo(index);
    }

    /** @param {number} width
     * @param {number} level */
    setWindow(width, level) {
        if (width > 0)
            this.set({range: apart([level - width / 2, level + width / 2], 6)});
    }

    /** To the right: wider; up: a higher level.
     * @param {number} dx
     * @param {number} dy */
    drag(dx, dy) {
        const [low, high] = this.crossing.range, width = high - low;
        this.setWindow(width * Math.exp(dx / 250), (low + high) / 2 - width * dy / 300);
    }

    /** @param {Pane} pane */
    alone(pane) {
        const on = !this.views.classList.contains('alone');
        this.views.classList.toggle('alone', on);
        for (const each of this.panes)
            each.element.classList.toggle('chosen', on && each === pane);
    }

    /** What is seen stays as it is, apart; linked, all take the zoom of the first one.
     * @param {boolean} on */
    link(on) {
        const [first] = this.panes, zooms = this.panes.map(pane => pane.zoom);
        this.panes.forEach((pane, i) => {
            pane.own = zooms[i];
        });
        this.scale = zooms[0] === 1 ? null : zooms[0] * first.fit / first.length;
        this.set({apart: on ? undefined : true});
    }

    /** @param {Pane} pane */
    command(pane) {
        this.engine.ask('slice-command', pane.wish);
    }

    /** What is of another volume. */
    forget() {
        this.value = NaN;
        for (const pane of this.panes) {
            pane.n = ++this.n; // one that is under way is of no use
            pane.blank();
        }
    }

    /** After a connection was lost, or for another volume. */
    renew() {
        this.last = this.keys;
        for (const pane of this.panes) {
            pane.busy = pane.exact = false;
            pane.asked = '';
        }
        this.at = '';
        this.waits = false;
        this.update();
    }

    /** At most one value is under way. */
    askValue() {
        const at = String([this.index, this.data]);
        if (this.waits || at === this.at)
            return;
        this.at = at;
        this.waits = true;
        this.engine.ask('value', {at: this.index});
    }

    /** @param {import('./types').Heard['value']} message */
    hearValue({at, value}) {
        this.waits = false;
        if (!this.keys || !this.store.info?.slices)
            return;
        if (String(at) === String(this.index)) {
            this.value = value ?? NaN;
            this.panes.forEach(pane => pane.draw());
        }
        this.askValue();
    }

    /** Nothing goes on in panes that are put away. */
    putAway() {
        const held = this.panes.some(pane => pane.fingers.size);
        for (const pane of this.panes) {
            clearTimeout(pane.timer);
            pane.fingers.clear();
            pane.element.remove();
        }
        this.views.classList.remove('alone');
        this.at = '';
        if (held)
            this.store.end();
    }

    update() {
        const slices = this.keys && this.store.info?.slices;
        this.views.classList.toggle('sliced', Boolean(slices));
        this.views.dataset.layout = this.layout;
        this.last = this.keys ?? this.last;
        if (!slices) {
            this.putAway();
            return;
        }
        const at = String(this.index);
        this.panes.forEach((pane, i) => {
            pane.slice = slices[i];
            if (!pane.element.isConnected)
                this.views.append(pane.element);
            pane.element.classList.toggle('large', i === (this.crossing.large ?? 0));
            if (this.seen !== at)
                pane.seek();
            pane.show();
            pane.ask();
        });
        this.seen = at;
        this.askValue();
    }

    /** Of the panel.
     * @param {(each: () => void) => void} follow */
    section(follow) {
        const {info} = this, all = () => this.keys?.range ?? info.window;
        const on = check('beside the picture (x)', () => this.toggle());
        const wide = number('width of the window of slices',
            value => this.setWindow(value, (all()[0] + all()[1]) / 2));
        const middle = number('level of the window of slices',
            value => this.setWindow(all()[1] - all()[0], value));
        const named = select([['', 'choose'], ['all', 'of the volume'],
            ...info.hounsfield ? Object.keys(WINDOWS) : []], name => {
            const [low, high] = info.window;
            const [width, level] = WINDOWS[name] ?? [high - low, (low + high) / 2];
            this.setWindow(width, level);
            named.value = '';
        });
        const colored = check('in the colours of the look', value => this.set({colored: value}));
        const lines = check('lines where they cross (h)', value => this.set({lines: value ? undefined : false}));
        const linked = check('one zoom for all', value => this.link(value));
        const slab = thickness(this);
        const places = ['x', 'y', 'z'].map((name, k) => number(`voxel ${name} where slices cross`,
            value => this.goTo(this.index.map((i, j) => j === k ? Math.round(value) : i)), 1));
        const more = make('div', {}, row('Window', named), row('Width, level', wide, middle),
            row('Voxel', ...places), slab.row,
            colored.label, lines.label, linked.label, make('div', {className: 'row'},
                ...info.slices?.map((each, i) => button(`Command, ${each.axis}`,
                    `The command that makes the slice ${each.axis}`,
                    () => this.command(this.panes[i]))) ?? []));
        follow(() => {
            const {keys} = this;
            on.box.checked = Boolean(keys);
            more.hidden = !keys;
            if (!keys)
                return;
            show(wide, short(keys.range[1] - keys.range[0]));
            show(middle, short((keys.range[0] + keys.range[1]) / 2));
            this.index.forEach((i, k) => show(places[k], i));
            colored.box.checked = Boolean(keys.colored);
            lines.box.checked = this.hasLines;
            linked.box.checked = !this.isApart;
            slab.follow();
        });
        const made = section('Slices', false, on.label, more);
        made.hidden = !info.slices;
        return made;
    }
}
