// clip.js - clip planes of a recipe: two across each axis of the world, and tilted
// ones. A plane [a, b, c, d] takes away what has a x + b y + c z > d.

import {add, axes, cross, dot} from './camera.js';

export const PLANES_MOST = 6;

/** The corners of the volume in the world, lowest and highest. */
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

const digits = value => +value.toPrecision(6);
const isTilted = plane => plane.slice(0, 3).filter(x => x !== 0).length > 1;

/** No plane can be added: ends that cut nothing stay. */
export const isFull = keys => keys.clip?.length >= PLANES_MOST;

export const tilted = keys => (keys.clip ?? []).filter(isTilted);

/** The lowest and highest visible place along each axis. */
function ends(box, keys) {
    const all = box.map(pair => [...pair]);
    for (const [a, b, c, d] of (keys.clip ?? []).filter(plane => !isTilted(plane))) {
        const axis = [a, b, c].findIndex(x => x !== 0), sign = [a, b, c][axis];
        all[axis][sign > 0 ? 1 : 0] = d / sign;
    }
    return all;
}

/** Changes of the recipe that move one end. */
function moved(box, keys, axis, end, value) {
    const all = ends(box, keys), margin = (box[axis][1] - box[axis][0]) / 200;
    all[axis][end] = end ? Math.max(value, all[axis][0] + margin)
        : Math.min(value, all[axis][1] - margin);
    const planes = tilted(keys);
    all.forEach((pair, i) => pair.forEach((place, side) => {
        const edge = box[i][side], inside = side ? edge - place : place - edge;
        if (inside <= 1e-6 * (box[i][1] - box[i][0]))
            return;
        const plane = [0, 0, 0, digits(side ? place : -place)];
        plane[i] = side ? 1 : -1;
        planes.push(plane);
    }));
    return {clip: planes.length ? planes : null};
}

/** Changes that put a tilted plane elsewhere; `d` null removes it. */
export function tiltedTo(keys, index, d) {
    const all = tilted(keys), old = all[index];
    const planes = keys.clip.map(plane => plane !== old ? plane
        : d === null ? null : [...plane.slice(0, 3), digits(d)]).filter(Boolean);
    return {clip: planes.length ? planes : null};
}

/** Changes that cut away what is before the target, as it is seen now. */
export function facing(keys, info) {
    let normal = axes(keys, info).back.map(x => Math.round(1e4 * x) / 1e4);
    if (!isTilted(normal)) // by a hair, as others have sliders
        normal = normal.map(x => x || 1e-4);
    const d = dot(normal, keys.target ?? info.middle);
    return {clip: [...keys.clip ?? [], [...normal, digits(d)]]};
}

/** Each end and plane that a handle moves: a place on it, beside the middle where
 * drags turn the picture, the way in which it moves, its name, and the changes of a
 * move. */
export function grips(keys, info, names) {
    const box = bounds(info), all = ends(box, keys);
    const middle = all.map(([low, high]) => (low + high) / 2);
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
