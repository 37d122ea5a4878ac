// camera.mjs - what a drag over the poles does to a camera, beside matrices of rotation: the
// axes of the picture turn about the line in it that is straight across the drag.
import {axes, tumbled} from './web/camera.js';

let wrong = 0;

function check(what, good, why = '') {
    console.log(good ? `ok     ${what}` : `FAILED ${what}: ${why}`);
    wrong += good ? 0 : 1;
}

const times = (a, b) => a.map(row => b[0].map((_, j) => row.reduce((sum, x, k) => sum + x * b[k][j], 0)));

/** Of Rodrigues: about a unit vector, as the right hand turns. */
function rotation([x, y, z], degrees) {
    const angle = degrees * Math.PI / 180, c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
    return [[t * x * x + c, t * x * y - s * z, t * x * z + s * y], [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
        [t * x * z - s * y, t * y * z + s * x, t * z * z + c]];
}

/** Columns right, up, back. */
const matrixOf = ({right, up, back}) => [0, 1, 2].map(i => [right[i], up[i], back[i]]);
const distance = (a, b) => Math.max(...a.flatMap((row, i) => row.map((x, j) => Math.abs(x - b[i][j]))));

const info = {view: 'front', middle: [1, 2, 3], radius: 50,
    views: {front: [[0, 1, 0], [0, 0, 1]], '+z': [[0, 0, 1], [0, 1, 0]], tilted: [[0.6, 0, 0.8], [-0.8, 0, 0.6]]}};
const SIDE = 500;
const drags = [[40, 0], [0, 90], [0, 300], [-17, 25], [0, -700], [123, -45], [3, 2], [0, 250], [250, 0], [-60, -60]];

for (const begin of [{}, {view: '+z', azimuth: 33, elevation: -71, roll: 12}, {view: 'tilted', elevation: 90, roll: 5},
    {position: [90, 12, 40], up: [0.1, 1, 0.3], azimuth: 7}]) {
    let keys = begin, wanted = matrixOf(axes(keys, info)), worst = 0;
    for (const [dx, dy] of drags) {
        const [r, u] = [0, 1].map(k => wanted.map(row => row[k])), way = Math.hypot(dx, dy);
        // The eye goes against the pointer: about up for a drag across, about right for one down.
        const axis = r.map((x, i) => (-dy * x - dx * u[i]) / way);
        wanted = times(rotation(axis, way * 180 / SIDE), wanted);
        keys = {...keys, ...tumbled(keys, info, dx, dy, SIDE)};
        worst = Math.max(worst, distance(matrixOf(axes(keys, info)), wanted));
    }
    // Angles have two places: 1/200 degree of each, some times.
    check(`drags over the poles from ${JSON.stringify(begin)}`, worst < 2e-3, worst);
    check('they are angles that a recipe may have', Math.abs(keys.elevation) <= 90 &&
        [keys.azimuth, keys.elevation, keys.roll].every(Number.isFinite), JSON.stringify(keys));
}
const still = tumbled({azimuth: 5}, info, 0, 0, SIDE);
check('no drag is no turn', Object.keys(still).length === 0, JSON.stringify(still));
process.exit(wrong ? 1 : 0);
