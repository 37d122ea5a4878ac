// axis.js - which part of the values the axis of an editor shows, and where a value lies
// on it: x = EDGE + (value - low) / (high - low) (width - 2 EDGE).

/** @typedef {import('../types').Pair} Pair */

export const EDGE = 8; // pixels beside the values
const MOST = 1e6; // times nearer than all values

export class Axis {
    /** @param {() => Pair} all what there is to be shown */
    constructor(all) {
        this.all = all;
        /** @type {Pair|null} */
        this.part = null;
    }

    /** @returns {Pair} */
    get span() {
        return this.part ?? this.all();
    }

    /** @param {number} value
     * @param {number} width */
    x(value, width) {
        const [low, high] = this.span;
        return EDGE + (value - low) / (high - low) * (width - 2 * EDGE);
    }

    /** @param {number} x
     * @param {number} width */
    value(x, width) {
        const [low, high] = this.span;
        return low + (x - EDGE) / (width - 2 * EDGE) * (high - low);
    }

    /** Shows a part within all values.  Whether that is another one.
     * @param {number} low
     * @param {number} wide */
    show(low, wide) {
        const [first, last] = this.all(), before = this.part;
        const from = Math.max(first, Math.min(last - wide, low));
        this.part = wide < last - first ? [from, from + wide] : null;
        return `${before}` !== `${this.part}`;
    }

    /** Nearer by a factor, about a value, which stays where it is.
     * @param {number} by
     * @param {number} about */
    zoom(by, about) {
        const [low, high] = this.span, [first, last] = this.all();
        const wide = Math.max((high - low) / by, (last - first) / MOST);
        return this.show(about - (about - low) * wide / (high - low), wide);
    }

    /** @param {number} share of what is shown */
    pan(share) {
        const [low, high] = this.span;
        return this.part !== null && this.show(low + share * (high - low), high - low);
    }
}
