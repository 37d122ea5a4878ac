// pointer.js - mouse, wheel and fingers on the picture.

import {panned, round, turned, zoomed} from './camera.js';
import {listed, mixed} from './channels.js';
import {ranged} from './colors.js';
import {apart, listen, pinched} from './controls.js';

/** What a drag does, by button and key; otherwise what was chosen, as a finger has
 * neither. */
export const TOOLS = [['turn', 'turns'], ['pan', 'moves'], ['window', 'window, level'],
    ['opacity', 'opacity'], ['light', 'light']];

export function kindOf(event, tool) {
    if (event.button === 1 || (event.button === 0 && event.shiftKey))
        return 'pan';
    if (event.button === 2)
        return event.ctrlKey || event.metaKey ? 'opacity' : 'window';
    return event.button ? null : event.ctrlKey ? 'light' : tool;
}

/** The light follows the pointer; the key light is where it begins. */
function lit(keys, dx, dy, side) {
    const [azimuth, elevation] = Array.isArray(keys.light) ? keys.light
        : keys.light === 'head' ? [0, 0] : [-25, 35];
    const bound = value => round(Math.max(-90, Math.min(90, value)));
    return {light: [bound(azimuth + 180 * dx / side), bound(elevation - 180 * dy / side)]};
}

export class Pointer {
    /** `page.look` has the present range and points; `aim` gets a place that was
     * double-clicked, as shares of the picture's sides. */
    constructor(canvas, recipe, page, aim) {
        Object.assign(this, {canvas, recipe, page, aim, fingers: new Map()});
        listen(canvas, this);
    }

    doubled(event) {
        const [x, y] = this.at(event), [width, height] = this.box;
        this.aim((x - this.shift) / width + 0.5, y / height + 0.5);
    }

    /** The box in which the picture is drawn: another page may have another window. */
    get box() {
        const {clientWidth, clientHeight, width, height} = this.canvas;
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
        return this.box[0] * (this.page.look?.legend ?? 0) / 2;
    }

    /** From the place of the target. */
    at(event) {
        const box = this.canvas.getBoundingClientRect();
        return [event.clientX - box.left - box.width / 2 + this.shift,
            event.clientY - box.top - box.height / 2];
    }

    down(event) {
        if (this.page.info && this.page.look)
            this.kind ??= kindOf(event, this.page.tool);
        if (!this.kind)
            return false;
        this.canvas.focus();
        this.canvas.setPointerCapture(event.pointerId);
        this.fingers.set(event.pointerId, this.at(event));
        this.take();
        this.recipe.begin();
        return true;
    }

    /** What a drag begins with. */
    take() {
        this.start = this.page.look;
        this.map = this.recipe.keys.colormap;
        this.total = [0, 0];
    }

    /** What keys do in the place of a drag, by degrees of a turn.  Steps without other
     * changes between them are one drag: the look that they change comes late. */
    step(...degrees) {
        const {recipe, page: {tool}} = this;
        const made = () => [tool, recipe.keys[tool === 'window' ? 'range' : 'opacity'],
            recipe.keys.channel].join(); // what the viewer adds to it is no change
        if (this.last !== made())
            this.take();
        this.drag(...degrees.map(x => x * this.box[1] / 180), tool);
        this.last = made();
    }

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

    drag(dx, dy, kind = this.kind) {
        const keys = this.recipe.keys, info = this.page.info;
        this.total = [this.total[0] + dx, this.total[1] + dy];
        if (kind === 'turn')
            this.recipe.set(turned(keys, dx, dy, this.box[1]));
        else if (kind === 'pan')
            this.recipe.set(panned(keys, info, dx, dy, this.side));
        else if (kind === 'light')
            this.recipe.set(lit(keys, dx, dy, this.side));
        else
            this.recipe.set(kind === 'window' ? this.windowed() : this.faded());
    }

    /** To the right: wider; up: a higher level. */
    windowed() {
        const {start} = this, [x, y] = this.total;
        const to = (low, high) => {
            const half = (high - low) * Math.exp(x / 250) / 2;
            const level = (low + high) / 2 - (high - low) * y / this.canvas.clientHeight;
            return apart([level - half, level + half], 5);
        };
        return mixed(start) ? listed(start.channels.map(([a, b, c, d, low, high, e]) =>
            [a, b, c, d, ...to(low, high), e]))
            : ranged(start, {...this.recipe.keys, colormap: this.map}, to(start.low, start.high));
    }

    /** Up: more opaque; not of a look whose points the page has not all. */
    faded() {
        const factor = Math.exp(-this.total[1] / 120);
        if (mixed(this.start))
            return listed(this.start.channels.map(one =>
                Object.assign([...one], {6: Math.min(1, +(one[6] * factor).toFixed(3))})));
        if (!this.recipe.keys.opacity && this.start.count > this.start.opacity.length) {
            this.page.say('The look has too many points to change here; choose a preset.');
            return {};
        }
        return {opacity: this.start.opacity.map(
            ([value, opacity]) => [value, Math.min(1, opacity * factor)])};
    }

    /** Two fingers: the middle moves, the distance zooms. */
    pinch(id, before, now) {
        const {recipe, page: {info}, side} = this, zoom = pinched(this.fingers, id, now);
        recipe.set(panned(recipe.keys, info, (now[0] - before[0]) / 2, (now[1] - before[1]) / 2, side));
        recipe.set(zoomed(recipe.keys, info, ...zoom, side));
    }

    up(event) {
        if (!this.fingers.delete(event.pointerId) || this.fingers.size)
            return;
        this.kind = null;
        this.recipe.end();
    }

    wheel(event) {
        const lines = event.deltaMode ? 30 : 1;
        const [x, y] = this.at(event), {info} = this.page;
        if (info)
            this.recipe.set(zoomed(this.recipe.keys, info,
                Math.exp(-event.deltaY * lines / 600), x, y, this.side));
        return true;
    }
}
