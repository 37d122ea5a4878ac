// slices.js - three slices beside the picture, whose crosshairs move one another.
//
// Where they cross, and their window, are of this page alone: a key of its recipe
// that no server gets, so that undo and links have it.

import {add, cross, dot} from './camera.js';
import {apart, button, check, listen, make, number, pinched, row, section, select, short, show,
    slider, surface} from './controls.js';
import {STEPS} from './keys.js';
import {kindOf} from './pointer.js';

export const COLORS = ['#ff7b72', '#56d364', '#6db1ff', '#e3b341']; // across x, y, z of the grid
const REST = 200; // ms until the exact picture is asked for
const STEP = 60; // of the wheel
const MAGNIFIED_MOST = 40;

/** Of a CT, in Hounsfield units: width and level. */
const WINDOWS = {'soft tissue': [400, 40], brain: [80, 40], liver: [150, 60], lung: [1500, -600],
    bone: [1800, 400]};

const column = (matrix, k) => matrix.map(line => line[k]);

/** The voxel of a place in the world, and back. */
function voxel({matrix, dims}, place) {
    const [a, b, c, origin] = [0, 1, 2, 3].map(k => column(matrix, k));
    const from = add(place, origin, -1), whole = dot(a, cross(b, c));
    return [cross(b, c), cross(c, a), cross(a, b)].map((way, i) =>
        Math.max(0, Math.min(dims[i] - 1, Math.round(dot(from, way) / whole))));
}

export function world({matrix}, index) {
    return matrix.map(line => +(line[3] + dot(line.slice(0, 3), index)).toPrecision(9));
}

/** "R" or, of no patient, "+x": where a step along the grid goes. */
function letter(info, k, sign) {
    const way = column(info.matrix, k).map(x => x * sign);
    const axis = way.reduce((best, x, i) => Math.abs(x) > Math.abs(way[best]) ? i : best, 0);
    return info.medical ? 'RLAPSI'[2 * axis + (way[axis] < 0 ? 1 : 0)]
        : (way[axis] < 0 ? '-' : '+') + 'xyz'[axis];
}

/** "S 12.5 mm", or "z = 3 um". */
function placeText(info, k, at) {
    const way = column(info.matrix, k).map(Math.abs), axis = way.indexOf(Math.max(...way));
    const [unit, length] = info.axes[axis], value = at[axis] / length;
    return info.medical ?
        `${'RLAPSI'[2 * axis + (value < 0 ? 1 : 0)]} ${short(Math.abs(value))} ${unit}`
        : `${'xyz'[axis]} = ${short(value)} ${unit}`;
}

class Pane {
    constructor(owner, number_) {
        Object.assign(this, {owner, number: number_, zoom: 1, turned: 0, fingers: new Map(),
            middle: [0, 0]}); // of the pane, in pixels from that of the slice
        this.canvas = make('canvas', {tabIndex: 0, role: 'img'});
        this.caption = make('figcaption', {});
        this.slider = slider('slice', 0, 1, 1, owner.recipe,
            value => owner.step(this, value - owner.index[this.along]));
        this.element = make('figure', {className: 'pane'}, this.canvas, this.caption,
            button('\u2922', 'This slice alone, or all (Enter)', () => owner.alone(this)), this.slider);
        listen(this.canvas, this);
        new ResizeObserver(() => this.draw()).observe(this.canvas);
    }

    get along() {
        return this.info.along;
    }

    doubled() {
        this.owner.alone(this);
    }

    up(event) {
        if (this.fingers.delete(event.pointerId) && !this.fingers.size)
            this.owner.recipe.end();
    }

    /** Where the slice lies in the pane: its corner, and the length of a pixel. */
    get place() {
        const {clientWidth: width, clientHeight: height} = this.canvas, {info} = this;
        const scale = this.zoom * Math.min(width / info.width, height / info.height);
        return {scale, x: width / 2 - (info.width / 2 + this.middle[0]) * scale,
            y: height / 2 - (info.height / 2 + this.middle[1]) * scale};
    }

    /** Pixels of the slice, of the crosshair. */
    get cross() {
        return [[this.info.right, this.info.width], [this.info.down, this.info.height]].map(
            ([[k, sign], length]) => {
                const count = this.owner.page.info.dims[k], at = this.owner.index[k];
                return ((sign > 0 ? at : count - 1 - at) + 0.5) / count * length;
            });
    }

    /** The voxel under the pointer, in this slice. */
    voxelAt([x, y]) {
        const index = [...this.owner.index], {place, info} = this;
        [[info.right, info.width, x - place.x], [info.down, info.height, y - place.y]].forEach(
            ([[k, sign], length, at]) => {
                const count = this.owner.page.info.dims[k];
                const i = Math.floor(at / place.scale / length * count);
                index[k] = Math.max(0, Math.min(count - 1, sign > 0 ? i : count - 1 - i));
            });
        return index;
    }

    at({offsetX, offsetY}) {
        return [offsetX, offsetY];
    }

    down(event) {
        this.canvas.focus();
        this.canvas.setPointerCapture(event.pointerId);
        this.fingers.set(event.pointerId, this.at(event));
        this.kind = kindOf(event, this.owner.page.tool);
        this.owner.recipe.begin();
        if (this.fingers.size === 1 && !['pan', 'window'].includes(this.kind))
            this.owner.goTo(this.voxelAt(this.at(event)));
        return true;
    }

    move(event) {
        const before = this.fingers.get(event.pointerId), now = this.at(event);
        if (!before)
            return;
        const [dx, dy] = [now[0] - before[0], now[1] - before[1]];
        if (this.fingers.size === 2) {
            const [factor, ...at] = pinched(this.fingers, event.pointerId, now);
            this.zoomAt(factor, at);
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

    pan(dx, dy) {
        const {scale} = this.place;
        this.middle = [this.middle[0] - dx / scale, this.middle[1] - dy / scale];
        this.draw();
    }

    /** About a place, which stays. */
    zoomAt(factor, [x, y]) {
        const before = this.place;
        this.zoom = Math.max(1, Math.min(MAGNIFIED_MOST, this.zoom * factor));
        const after = this.place, part = 1 / before.scale - 1 / after.scale;
        const {clientWidth, clientHeight} = this.canvas;
        this.middle = this.zoom === 1 ? [0, 0]
            : [this.middle[0] + (x - clientWidth / 2) * part, this.middle[1] + (y - clientHeight / 2) * part];
        this.draw();
    }

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
        const {index, keys} = this.owner;
        return {axis: this.info.axis, index: index[this.along], range: keys.range,
            colored: keys.colored ?? false};
    }

    /** Asks for what is not there yet: at most one picture is under way. */
    ask() {
        const {owner} = this;
        clearTimeout(this.timer);
        if (this.busy || !this.info || !owner.keys)
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

    async take(frame) {
        if (frame.n !== this.n)
            return;
        const bitmap = await createImageBitmap(frame.blob, {colorSpaceConversion: 'none'});
        this.bitmap?.close();
        this.bitmap = bitmap;
        this.file = frame.level === 2 ? frame.blob : null;
        this.busy = false;
        this.draw();
        this.ask();
    }

    show() {
        const {info: whole} = this.owner.page, {index} = this.owner, count = whole.dims[this.along];
        const name = this.info.axis.length === 1 ? `across ${this.info.axis}` : this.info.axis;
        this.caption.textContent = `${name} ${index[this.along]}/${count - 1}, ` +
            placeText(whole, this.along, world(whole, index));
        this.caption.style.color = COLORS[this.along];
        this.slider.max = count - 1;
        this.slider.value = index[this.along];
        this.slider.setAttribute('aria-label', `${name} slice`);
        this.canvas.setAttribute('aria-label', `Slice ${this.caption.textContent}. Arrow keys move ` +
            'the crosshair, Page keys choose the slice, Enter shows it alone.');
        this.draw();
    }

    draw() {
        const {canvas, bitmap, info} = this;
        const {g, width, height} = bitmap ? surface(canvas, {alpha: false}) : {};
        if (!g)
            return;
        const {x, y, scale} = this.place;
        g.imageSmoothingQuality = 'high';
        g.drawImage(bitmap, x, y, info.width * scale, info.height * scale);
        const [px, py] = this.cross.map((at, i) => [x, y][i] + at * scale);
        this.line(g, COLORS[info.right[0]], [px, 0, px, py - 9], [px, py + 9, px, height]);
        this.line(g, COLORS[info.down[0]], [0, py, px - 9, py], [px + 9, py, width, py]);
        this.write(g, width, height);
        this.owner.page.measure?.drawIn(this, g);
    }

    line(g, color, ...parts) {
        g.strokeStyle = color;
        g.beginPath();
        for (const [x0, y0, x1, y1] of parts) {
            g.moveTo(x0, y0);
            g.lineTo(x1, y1);
        }
        g.stroke();
    }

    /** Letters of the sides, window and level, the value where the lines cross. */
    write(g, width, height) {
        const {page: {info}, keys, value} = this.owner, {right: [r, a], down: [d, b]} = this.info;
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
        put(letter(info, d, -b), width / 2, 32, 'center');
        put(letter(info, d, b), width / 2, height - 46, 'center');
        g.font = '12px system-ui, sans-serif';
        const [low, high] = keys.range;
        put(`W ${short(high - low)} L ${short((low + high) / 2)}`, 5, height - 30, 'left');
        if (Number.isFinite(value))
            put(short(value), width - 5, height - 30, 'right');
    }
}

export class Slices {
    /** `views` is the element that holds the picture, and gets the panes. */
    constructor(recipe, page, engine, views) {
        Object.assign(this, {recipe, page, engine, views});
        this.n = 0;
        this.panes = [1, 2, 3].map(i => new Pane(this, i));
        engine.on('small', frame => this.panes[frame.pane - 1]?.take(frame));
        engine.on('slice', ({pane}) => { // there is none; why has been said
            const one = this.panes[pane - 1];
            one.busy = false;
            one.exact = true;
            if (one.element.isConnected)
                one.ask();
        });
        engine.on('open', () => this.renew());
        engine.on('value', message => this.hearValue(message));
        recipe.onChange(() => this.update());
    }

    get keys() {
        return this.recipe.keys.slices;
    }

    get index() {
        return voxel(this.page.info, this.keys.at);
    }

    /** The volume that is shown: another crop, time, channel has other slices. */
    get data() {
        const {crop, time, channel, component, labels, preset, colormap, scale, overlay,
            'overlay-look': look} = this.recipe.keys;
        return [crop, time, channel, component, labels, overlay, look,
            this.keys.colored && [preset, colormap, scale]];
    }

    set(changes) {
        this.recipe.set({slices: {...this.keys, ...changes}});
    }

    toggle() {
        const {info} = this.page;
        if (!info.slices)
            return;
        this.views.classList.remove('alone');
        this.recipe.set({slices: this.keys ? null : {range: apart(info.window, 5),
            at: world(info, info.dims.map(count => Math.floor(count / 2)))}});
    }

    goTo(index) {
        const {info} = this.page;
        this.set({at: world(info, index.map((i, k) => Math.max(0, Math.min(info.dims[k] - 1, i))))});
    }

    step(pane, by) {
        const index = this.index;
        index[pane.along] += by;
        if (by)
            this.goTo(index);
    }

    setWindow(width, level) {
        if (width > 0)
            this.set({range: apart([level - width / 2, level + width / 2], 6)});
    }

    /** To the right: wider; up: a higher level. */
    drag(dx, dy) {
        const [low, high] = this.keys.range, width = high - low;
        this.setWindow(width * Math.exp(dx / 250), (low + high) / 2 - width * dy / 300);
    }

    alone(pane) {
        const on = !this.views.classList.contains('alone');
        this.views.classList.toggle('alone', on);
        for (const each of this.panes)
            each.element.classList.toggle('chosen', on && each === pane);
    }

    command(pane) {
        this.engine.ask('slice-command', pane.wish);
    }

    /** After a connection was lost, or for another volume. */
    renew() {
        for (const pane of this.panes)
            pane.busy = pane.exact = pane.asked = null;
        this.at = this.waits = null;
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

    hearValue({at, value}) {
        this.waits = false;
        if (!this.keys || !this.page.info?.slices)
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
        this.at = null;
        if (held)
            this.recipe.end();
    }

    update() {
        const {info} = this.page, on = Boolean(this.keys && info?.slices);
        this.views.classList.toggle('sliced', on);
        if (!on) {
            this.putAway();
            return;
        }
        this.panes.forEach((pane, i) => {
            pane.info = info.slices[i];
            if (!pane.element.isConnected)
                this.views.append(pane.element);
            pane.show();
            pane.ask();
        });
        this.askValue();
    }

    /** Of the panel. */
    section(follow) {
        const {page: {info}} = this, all = () => this.keys?.range ?? info.window;
        const on = check('beside the picture (x)', () => this.toggle());
        const width = number('width of the window of slices',
            value => this.setWindow(value, (all()[0] + all()[1]) / 2));
        const level = number('level of the window of slices',
            value => this.setWindow(all()[1] - all()[0], value));
        const named = select([['', 'choose'], ['all', 'of the volume'],
            ...info.hounsfield ? Object.keys(WINDOWS) : []], name => {
            const [low, high] = info.window;
            this.setWindow(...WINDOWS[name] ?? [high - low, (low + high) / 2]);
            named.value = '';
        });
        const colored = check('in the colours of the look', value => this.set({colored: value}));
        const places = ['x', 'y', 'z'].map((name, k) => number(`voxel ${name} where slices cross`,
            value => this.goTo(this.index.map((i, j) => j === k ? Math.round(value) : i)), 1));
        const more = make('div', {}, row('Window', named), row('Width, level', width, level),
            row('Voxel', ...places), colored.label, make('div', {className: 'row'},
                ...info.slices?.map((each, i) => button(`Command, ${each.axis}`,
                    `The command that makes the slice ${each.axis}`,
                    () => this.command(this.panes[i]))) ?? []));
        follow(() => {
            const {keys} = this;
            on.box.checked = Boolean(keys);
            more.hidden = !keys;
            if (!keys)
                return;
            show(width, short(keys.range[1] - keys.range[0]));
            show(level, short((keys.range[0] + keys.range[1]) / 2));
            this.index.forEach((i, k) => show(places[k], i));
            colored.box.checked = Boolean(keys.colored);
        });
        const made = section('Slices', false, on.label, more);
        made.hidden = !info.slices;
        return made;
    }
}
