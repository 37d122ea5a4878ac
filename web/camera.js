// camera.js - the camera of a recipe, as snowglass/view.h describes it: turns,
// shifts, zooms.

/** @typedef {import('./types').Vector} Vector */
/** @typedef {import('./types').Keys} Keys */
/** @typedef {import('./types').Info} Info */

/** @type {(a: Vector, b: Vector, k?: number) => Vector} */
export const add = (a, b, k = 1) => a.map((x, i) => x + k * b[i]);
/** @type {(a: Vector, b: Vector) => number} */
export const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
/** @type {(a: Vector, b: Vector) => Vector} */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0]];
/** @type {(a: Vector) => Vector} */
const unit = a => a.map(x => x / (Math.hypot(...a) || 1));
/** @type {(a: Vector, b: Vector, degrees: number) => [Vector, Vector]} */
const turn = (a, b, degrees) => {
    const angle = degrees * Math.PI / 180, c = Math.cos(angle), s = Math.sin(angle);
    return [add(a.map(x => c * x), b, s), add(b.map(x => c * x), a, -s)];
};

export const ZOOM_LEAST = 1e-3;
export const ZOOM_MOST = 1e3;

/** Where the camera is before it is turned: [back, up].
 * @param {Keys} recipe
 * @param {Info} info
 * @returns {[Vector, Vector]} */
function base(recipe, info) {
    if (!recipe.position)
        return info.views[recipe.view ?? info.view] ?? info.views['+z'];
    const back = unit(add(recipe.position, recipe.target ?? info.middle, -1));
    let up = recipe.up ?? (Math.abs(back[2]) > 0.999 ? [0, 1, 0] : [0, 0, 1]);
    up = unit(add(up, back, -dot(up, back)));
    return [back, up];
}

/** The camera's directions in the world: right, up, back.
 * @param {Keys} recipe
 * @param {Info} info */
export function axes(recipe, info) {
    let [back, up] = base(recipe, info);
    let right = cross(up, back);
    [back, right] = turn(back, right, recipe.azimuth ?? 0);
    [back, up] = turn(back, up, recipe.elevation ?? 0);
    right = cross(up, back);
    [up, right] = turn(up, right, recipe.roll ?? 0);
    return {right, up, back};
}

/** The eye's distance from the target, without end in a parallel projection.
 * @param {Keys} recipe
 * @param {Info} info */
function distance(recipe, info) {
    const fov = recipe.perspective ?? 0;
    return !(fov > 0) ? Infinity : recipe.position
        ? Math.hypot(...add(recipe.position, recipe.target ?? info.middle, -1))
        : info.radius / Math.sin(fov * Math.PI / 360);
}

/** The length of a pixel in the target's plane; `side` is the shorter one.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {number} side */
export function pixel(recipe, info, side) {
    const far = distance(recipe, info);
    const wide = far < Infinity ? far * Math.tan((recipe.perspective ?? 0) * Math.PI / 360) : info.radius;
    return 2 * wide / ((recipe.zoom ?? 1) * side);
}

/** Where a place of the world is seen, in pixels from the target; null behind the
 * eye.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {Vector} place
 * @param {number} side
 * @returns {[number, number]|null} */
export function project(recipe, info, place, side) {
    const {right, up, back} = axes(recipe, info), from = add(place, recipe.target ?? info.middle, -1);
    const far = distance(recipe, info), left = far < Infinity ? 1 - dot(from, back) / far : 1;
    const length = pixel(recipe, info, side) * left;
    return left > 0 ? [dot(from, right) / length, -dot(from, up) / length] : null;
}

/** The place in the world that is seen there, at a distance from the target's
 * plane.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {number} x
 * @param {number} y
 * @param {number} depth
 * @param {number} side */
export function unproject(recipe, info, x, y, depth, side) {
    const {right, up, back} = axes(recipe, info), far = distance(recipe, info);
    const length = pixel(recipe, info, side) * (far < Infinity ? 1 + depth / far : 1);
    const across = add(right.map(a => a * x * length), up, -y * length);
    return add(add(recipe.target ?? info.middle, across), back, -depth);
}

/** Changes that make a place the one that the camera turns around.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {Vector} place */
export function aimed(recipe, info, place) {
    return {...move(recipe, info, add(place, recipe.target ?? info.middle, -1)), target: place};
}

/** @param {Keys} recipe
 * @param {Info} info
 * @param {Vector} by
 * @returns {Keys} */
function move(recipe, info, by) {
    /** @type {Keys} */
    const changes = {target: add(recipe.target ?? info.middle, by)};
    if (recipe.position)
        changes.position = add(recipe.position, by);
    return changes;
}

/** Turns by a drag of dx, dy pixels in a picture whose height is `side`.
 * @param {Keys} recipe
 * @param {number} dx
 * @param {number} dy
 * @param {number} side */
export function turned(recipe, dx, dy, side) {
    const k = 180 / side;
    const elevation = (recipe.elevation ?? 0) + dy * k;
    return {azimuth: round(((recipe.azimuth ?? 0) - dx * k) % 360),
        elevation: round(Math.max(-90, Math.min(90, elevation)))};
}

/** The angles that turn the base of a recipe to these directions.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {{right: Vector, up: Vector, back: Vector}} to
 * @returns {Keys} */
function anglesOf(recipe, info, {right, up, back}) {
    const [front, high] = base(recipe, info), side = cross(high, front), k = 180 / Math.PI;
    const rise = Math.max(-1, Math.min(1, dot(back, high))), pole = 1 - Math.abs(rise) < 1e-9;
    const azimuth = pole ? recipe.azimuth ?? 0 : k * Math.atan2(dot(back, side), dot(back, front));
    const level = axes({...recipe, azimuth, elevation: k * Math.asin(rise), roll: 0}, info);
    return {azimuth: round(azimuth), elevation: round(k * Math.asin(rise)),
        roll: round(k * Math.atan2(dot(up, level.right), dot(up, level.up)))};
}

/** Turns as a ball under the pointer does, over the poles too: about the axis in the
 * picture that is straight across the drag.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {number} dx
 * @param {number} dy
 * @param {number} side */
export function tumbled(recipe, info, dx, dy, side) {
    const {right, up, back} = axes(recipe, info), way = Math.hypot(dx, dy);
    if (!way)
        return {};
    const [x, y] = [-dx / way, dy / way], across = add(right.map(a => -a * y), up, x);
    const [behind, along] = turn(back, add(right.map(a => a * x), up, y), way * 180 / side);
    return anglesOf(recipe, info, {right: add(along.map(a => a * x), across, -y),
        up: add(along.map(a => a * y), across, x), back: behind});
}

/** The object follows the pointer.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {number} dx
 * @param {number} dy
 * @param {number} side */
export function panned(recipe, info, dx, dy, side) {
    const {right, up} = axes(recipe, info), length = pixel(recipe, info, side);
    return move(recipe, info, add(right.map(x => -dx * length * x), up, dy * length));
}

/** Zooms by a factor about a point, in pixels from the middle.
 * @param {Keys} recipe
 * @param {Info} info
 * @param {number} factor
 * @param {number} x
 * @param {number} y
 * @param {number} side */
export function zoomed(recipe, info, factor, x, y, side) {
    const zoom = Math.max(ZOOM_LEAST, Math.min(ZOOM_MOST, (recipe.zoom ?? 1) * factor));
    const left = 1 - (recipe.zoom ?? 1) / zoom, length = pixel(recipe, info, side);
    const {right, up} = axes(recipe, info);
    const by = add(right.map(a => x * length * left * a), up, -y * length * left);
    return {zoom, ...move(recipe, info, by)};
}

/** A few digits are enough for an angle, and read better in a command.
 * @param {number} value */
export function round(value) {
    return Math.round(value * 100) / 100;
}
