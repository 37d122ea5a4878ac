// clip.js - clip planes of a recipe: two across each axis of the world, and tilted
// ones. A plane [a, b, c, d] takes away what has a x + b y + c z > d.

import {add, axes, cross, dot} from '../camera.js';

export const PLANES_MOST = 6;

/** @typedef {import('../types').Keys} Keys */
/** @typedef {import('../types').Info} Info */
/** @typedef {import('../types').Plane} Plane */
/** @typedef {import('../types').Pair} Pair */
/** @typedef {{clip: Plane[]|null}} Change */

/** What a handle moves: a place on it, the way in which it moves, and the change of a move.
 * @typedef {{place: number[], axis: number, way: number[], value: number, low: number, high: number,
 *   name: string, fixed?: boolean, move: (keys: Keys, to: number) => Change}} Grip */

/** The corners of the volume in the world, lowest and highest.
 * @param {Info} info
 * @returns {Pair[]} */
function bounds(info) {
    return info.matrix.map((line, i) => {
        let low = line[3], high = line[3];
        line.slice(0, 3).forEach((step, k) => {
            const ends = [-0.5 * step, (info.dims[k] - 0.5) * step];
            low += Math.min(...ends);
            high += Math.max(...ends);
        });
        return [low, high];
    });
}

/** @param {number} value */
const digits = value => +value.toPrecision(6);
/** @param {number[]} plane */
const isTilted = plane => plane.slice(0, 3).filter(x => x !== 0).length > 1;

/** No plane can be added: ends that cut nothing stay.
 * @param {Keys} keys */
export const isFull = keys => (keys.clip?.length ?? 0) >= PLANES_MOST;

/** @param {Keys} keys */
export const tilted = keys => (keys.clip ?? []).filter(isTilted);

/** The lowest and highest visible place along each axis.
 * @param {Pair[]} box
 * @param {Keys} keys */
function ends(box, keys) {
    const all = box.map(([low, high]) => [low, high]);
    for (const [a, b, c, d] of (keys.clip ?? []).filter(plane => !isTilted(plane))) {
        const axis = [a, b, c].findIndex(x => x !== 0), sign = [a, b, c][axis];
        all[axis][sign > 0 ? 1 : 0] = d / sign;
    }
    return all;
}

/** Changes of the recipe that move one end.
 * @param {Pair[]} box
 * @param {Keys} keys
 * @param {number} axis
 * @param {number} end
 * @param {number} value
 * @returns {Change} */
function moved(box, keys, axis, end, value) {
    const all = ends(box, keys), margin = (box[axis][1] - box[axis][0]) / 200;
    all[axis][end] = end ? Math.max(value, all[axis][0] + margin)
        : Math.min(value, all[axis][1] - margin);
    const planes = tilted(keys);
    all.forEach((pair, i) => pair.forEach((place, side) => {
        const edge = box[i][side], inside = side ? edge - place : place - edge;
        if (inside <= 1e-6 * (box[i][1] - box[i][0]))
            return;
        /** @type {Plane} */
        const plane = [0, 0, 0, digits(side ? place : -place)];
        plane[i] = side ? 1 : -1;
        planes.push(plane);
    }));
    return {clip: planes.length ? planes : null};
}

/** Changes that put a tilted plane elsewhere; `d` null removes it.
 * @param {Keys} keys
 * @param {number} index
 * @param {number|null} d
 * @returns {Change} */
export function tiltedTo(keys, index, d) {
    const all = tilted(keys), old = all[index];
    const planes = (keys.clip ?? []).flatMap(plane => {
        const [a, b, c] = plane;
        return plane !== old ? [plane] : d === null ? [] : [/** @type {Plane} */ ([a, b, c, digits(d)])];
    });
    return {clip: planes.length ? planes : null};
}

/** Changes that cut away what is before the target, as it is seen now.
 * @param {Keys} keys
 * @param {Info} info
 * @returns {Change} */
export function facing(keys, info) {
    let normal = axes(keys, info).back.map(x => Math.round(1e4 * x) / 1e4);
    if (!isTilted(normal)) // by a hair, as others have sliders
        normal = normal.map(x => x || 1e-4);
    const [a, b, c] = normal, d = dot(normal, keys.target ?? info.middle);
    return {clip: [...keys.clip ?? [], [a, b, c, digits(d)]]};
}

/** Each end and plane that a handle moves, by a place on it beside the middle, where
 * drags turn the picture.
 * @param {Keys} keys
 * @param {Info} info
 * @param {string[]} names
 * @returns {Grip[]} */
export function grips(keys, info, names) {
    const box = bounds(info), all = ends(box, keys);
    const middle = all.map(([low, high]) => (low + high) / 2);
    /** @type {Grip[]} */
    const list = all.flatMap((pair, axis) => pair.map((value, end) => ({
        place: middle.map((x, i) => i === axis ? value : x), axis,
        way: middle.map((_, i) => i === axis ? 1 : 0), value, low: box[axis][0], high: box[axis][1],
        fixed: value === box[axis][end] && isFull(keys), name: `clip ${names[axis]}, ${end ? 'highest' : 'lowest'}`,
        move: (now, to) => moved(box, now, axis, end, Math.max(box[axis][0], Math.min(box[axis][1], to)))})));
    return list.concat(tilted(keys).map((plane, index) => {
        const way = plane.slice(0, 3), square = dot(way, way), from = keys.target ?? info.middle;
        const off = (plane[3] - dot(way, from)) / square, length = Math.sqrt(square);
        const far = info.radius * length, at = dot(way, info.middle);
        const aside = cross(Math.abs(way[2]) < 0.7 * length ? [0, 0, 1] : [0, 1, 0], way);
        return {place: add(add(from, way, off), aside, 0.3 * info.radius / Math.hypot(...aside)), way: way.map(x => x / length), axis: 3,
            value: plane[3] / length, low: (at - far) / length, high: (at + far) / length,
            name: `tilted clip plane ${index + 1}`,
            move: (now, to) => tiltedTo(now, index, to * length)};
    }));
}
