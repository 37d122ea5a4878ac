// colors.js - colours at data values, in the place of a map with a name: the
// recipe's colormap is then "60:#000000,255:#ff8800".

import {apart, button, check, fill, ink, make, near, number, row, section, show} from '../controls.js';
import {mixed} from '../look.js';
import {known} from '../store.js';

const FIRST = 5; // points that are taken of a map

/** @typedef {[value: number, color: string]} ColorPoint */

/** @param {ColorPoint[]} points */
export const text = points => points.sort(([a], [b]) => a - b).map(point => point.join(':')).join();

/** [[60, '#000000'], ...]; null of a name.
 * @param {string} [map]
 * @returns {ColorPoint[]|null} */
export const ownColors = map => map?.includes(':')
    ? map.split(',').map(part => part.split(':')).map(([value, color]) => [+value, color]) : null;

/** A list of colours of labels with another one.
 * @param {string|undefined} map
 * @param {number} value
 * @param {string} color */
export const painted = (map, value, color) => text([
    ...ownColors(map)?.filter(([label, old]) => old && label !== value) ?? [], [value, color]]);

/** Another range, with which one's own colours go, as those of a map do.
 * @param {{low: number, high: number}} look
 * @param {import('../types').Keys} keys
 * @param {import('../types').Pair} to
 * @returns {{range: import('../types').Pair, colormap?: string}} */
export function ranged({low, high}, {colormap}, [a, b]) {
    const own = ownColors(colormap), range = apart([a, b], 6);
    return own ? {range, colormap: text(own.map(([value, color]) =>
        [near([a + (value - low) / (high - low || 1) * (b - a)], b - a, 6)[0], color]))} : {range};
}

const REVERSED = 'reversed'; // the colours of a preset, whatever they are

/** The name of a map that has the same colours the other way round.
 * @param {string} map */
const turned = map => map.endsWith('_r') ? map.slice(0, -2) : `${map}_r`;

/** A map's name without that.
 * @param {string} [map] */
export const upright = (map = '') => map === REVERSED ? '' : map.replace(/_r$/, '');

export class Colors {
    /** @param {import('../store.js').Store} store */
    constructor(store) {
        this.store = store;
        this.list = make('div', {});
        /** @type {ReturnType<Colors['row']>[]} */
        this.rows = [];
        /** Own colours that were inverted, and as they were.
         * @type {{from: string, to: string}|null} */
        this.turn = null;
        this.invert = check('inverted colours', on => this.turnTo(on));
        this.element = section('Colours', false, this.list, make('div', {className: 'row'},
            button('Add', 'Add a colour', () => this.add())));
    }

    /** What the look has there.
     * @param {number} value
     * @returns {ColorPoint} */
    at(value) {
        const {low, high, strip} = known(this.store.look);
        return [near([value], high - low, 5)[0],
            strip[Math.round((value - low) / (high - low) * (strip.length - 1))] ?? strip[0]];
    }

    get points() {
        const {low, high} = known(this.store.look);
        return ownColors(this.store.keys.colormap) ?? Array.from({length: FIRST}, (_, i) =>
            this.at(low + (high - low) * i / (FIRST - 1)));
    }

    get inverted() {
        const {keys: {colormap}, look} = this.store, map = colormap ?? look?.map ?? '';
        return ownColors(map) ? this.turn?.to === map : map === REVERSED || map.endsWith('_r');
    }

    /** The colours of a map of a name, of a list, or of the preset in use, the other way round.
     * @param {boolean} on */
    turnTo(on) {
        const {store} = this, {keys: {colormap, preset}} = store, look = known(store.look);
        const own = ownColors(colormap), map = colormap ?? look.map;
        if (on === this.inverted)
            return;
        if (own && colormap) {
            const low = own[0][0], high = own[own.length - 1][0];
            this.turn = on ? {from: colormap, to: text(own.map(([value, color]) =>
                [near([low + high - value], high - low || 1, 6)[0], color]))} : this.turn;
            store.set({colormap: on ? this.turn?.to : this.turn?.from});
        } else if (colormap === REVERSED) {
            store.set({colormap: null});
        } else {
            store.set(map ? {colormap: turned(map)} : {colormap: REVERSED,
                ...!preset && look.preset ? {preset: look.preset} : {}});
        }
    }

    /** @param {ColorPoint[]} points */
    set(points) {
        this.store.set({colormap: text(points)});
    }

    /** @param {number} i
     * @param {number|null} value
     * @param {string|null} color */
    put(i, value, color) {
        this.set(this.points.map((point, k) => k === i ? [value ?? point[0], color ?? point[1]] : point));
    }

    add() {
        const {points} = this, [a, b = a] = points.slice(-2);
        this.set([...points, this.at((a[0] + b[0]) / 2)]);
    }

    /** @param {number} i */
    row(i) {
        const color = ink(`colour ${i + 1}`, to => this.put(i, null, to));
        const value = number(`value of colour ${i + 1}`, to => this.put(i, to, null));
        return {color, value, element: row(`Colour ${i + 1}`, color, value, button('Remove',
            `Remove colour ${i + 1}`, () => {
                if (this.points.length > 1)
                    this.set(this.points.filter((_, k) => k !== i));
            }))};
    }

    update() {
        const {look} = this.store;
        this.invert.box.checked = this.inverted;
        this.invert.label.hidden = Boolean(look?.labels?.length) || mixed(look);
        this.element.hidden = !look || Boolean(look.labels?.length) || mixed(look);
        if (!look || this.element.hidden)
            return;
        const {points} = this;
        while (this.rows.length < points.length)
            this.rows.push(this.row(this.rows.length));
        points.forEach(([at, color], i) => {
            this.rows[i].color.value = color;
            show(this.rows[i].value, near([at], look.high - look.low, 5)[0]);
        });
        fill(this.list, this.rows.slice(0, points.length).map(({element}) => element));
    }
}
