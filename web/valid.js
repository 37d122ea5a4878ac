// valid.js - which keys of a recipe this page takes: those of links and of files come
// from anywhere, and the page counts with what they hold.

/** @typedef {(value: any) => boolean} Test */

/** @type {Test} */
const isNumber = value => Number.isFinite(value);
/** @type {Test} */
const isText = value => typeof value === 'string';
/** @type {(length: number, each?: Test) => Test} */
const isList = (length, each = isNumber) => value => Array.isArray(value) &&
    (!length || value.length === length) && value.every(each);
/** @type {(...tests: Test[]) => Test} */
const isOne = (...tests) => value => tests.some(test => test(value));
/** @type {Test} */
const isRange = value => isList(2)(value) && value[0] < value[1];
/** @type {(low: number, high: number) => Test} */
const isWithin = (low, high) => value => isNumber(value) && value >= low && value <= high;
/** @type {(names: string[]) => Test} */
const isNamed = names => value => isText(value) && names.includes(value);
const arePoints = isList(0, isList(2));
/** @type {Test} */
const isOn = value => value === true;

/** How slices are shown.
 * @type {Record<string, Test>} */
const own = {colored: value => typeof value === 'boolean', layout: isNamed(['grid', 'slice']),
    large: value => [0, 1, 2].includes(value), lines: value => value === false, apart: isOn,
    slab: value => isText(value) && /^[\d.e+-]+[^:]*:(max|mean|min)$/.test(value)};

/** What a value has to be; other keys are for the server to judge.
 * @type {(info: import('./types').Info) => Record<string, Test>} */
const shapes = ({times}) => ({
    mode: isText, preset: isText, view: isText, colormap: isText, background: isText, title: isText, labels: isText,
    azimuth: isNumber, elevation: isNumber, roll: isNumber, iso: isNumber, zoom: isWithin(1e-6, 1e6),
    perspective: isWithin(0, 179), threshold: isWithin(0, 255), time: isWithin(0, times - 1),
    'z-scale': isOne(isWithin(1e-9, 1e9), isNamed(['auto'])), 'depth-darkening': isWithin(0, 1), occlusion: isWithin(0, 1),
    position: isList(3), target: isList(3), up: isList(3), material: isList(4),
    opacity: arePoints, 'gradient-opacity': arePoints, clip: isList(0, isList(4)),
    crop: isList(3, isList(2, isWithin(0, 1e15))),
    range: isOne(isRange, isList(2, value => /^p[\d.]+$/.test(value)), isNamed(['full'])),
    window: isList(2), light: isOne(isNamed(['key', 'head']), isList(2)), shade: isNamed(['phong', 'none']),
    legend: isOne(isOn, isText), box: isText, measure: isText, 'no-labels': isOn, mask: isOn, overlay: isOn,
    'overlay-look': isText, channel: isOne(isText, isNumber), component: isOne(isText, isNumber),
    slices: value => isRange(value?.range) && isList(3)(value.at) && Object.entries(value).every(
        ([key, each]) => own[key]?.(each) ?? true)});

/** The keys that are good, which have the types that their tests say, and the names of the others.
 * @param {Record<string, unknown>} keys
 * @param {import('./types').Info} info */
export function sifted(keys, info) {
    const tests = shapes(info);
    /** @type {Record<string, unknown>} */
    const good = {};
    /** @type {string[]} */
    const wrong = [];
    for (const [key, value] of Object.entries(keys)) {
        const known = info.keys?.includes(key) ?? Object.hasOwn(tests, key);
        if ((known || (key === 'slices' && info.slices)) && (tests[key]?.(value) ?? true))
            good[key] = value;
        else if (value !== null)
            wrong.push(key);
    }
    return {good: /** @type {import('./types').Keys} */ (good), wrong};
}

/** Says what was left out.
 * @param {string[]} wrong */
export const leftOut = wrong => wrong.length ? `Left out, as it is not understood: ${wrong.join(', ')}.` : '';
