// keys.js - the keyboard, where no field takes it.

import {zoomed} from './camera.js';
import {known} from './store.js';

export const VIEWS = ['anterior', 'posterior', 'left', 'right', 'superior', 'inferior'];
/** With what readers of images call them.
 * @type {Record<string, string>} */
export const MODE_NAMES = {over: 'translucent (over)', mip: 'maximum (mip)', minip: 'minimum (minip)', mean: 'mean',
    sum: 'sum', iso: 'surface at a value (iso)'};
export const MODES = Object.keys(MODE_NAMES);

/** @type {Record<string, [across: number, down: number]>} */
export const STEPS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

/** Of fields of text and lists all keys are their own; sliders keep those that move them,
 * what is pressed keeps Space and Enter.
 * @param {KeyboardEvent} event */
function isTaken({key, target}) {
    /** @param {string} selector */
    const at = selector => target instanceof Element && target.closest(selector);
    if (at('dialog, select, textarea, input:not([type="range"], [type="checkbox"], [type="color"])'))
        return true;
    if (at('[type="range"]'))
        return /^(Arrow|Page|Home|End)/.test(key);
    return (key === ' ' || key === 'Enter') && Boolean(at('button, summary, input'));
}

/** `store.letters` says whether single letters act, which a user may not want who speaks to
 * the machine.
 * @param {import('./store.js').Store} store
 * @param {import('./types').Actions} actions
 * @param {import('./pointer.js').Pointer} pointer */
export function listenToKeys(store, actions, pointer) {
    document.addEventListener('keydown', event => {
        const {key, ctrlKey, metaKey, altKey, shiftKey} = event, control = ctrlKey || metaKey;
        if (isTaken(event) || event.defaultPrevented || altKey || !store.info || !store.look)
            return;
        const back = control && key.toLowerCase() === 'z' && !shiftKey;
        const step = back || control && /^[zy]$/i.test(key);
        if (step)
            actions[back ? 'undo' : 'redo']();
        if (step || (!control && (store.letters || key.length > 1) && press(event, store, actions, pointer)))
            event.preventDefault();
    });
}

/** @type {Record<string, keyof import('./types').Actions>} */
const NAMED = {r: 'fit', m: 'mode', p: 'perspective', l: 'letters', ' ': 'play', c: 'command', v: 'movie', s: 'save',
    x: 'slices', h: 'lines', k: 'handles', d: 'drag', z: 'undo', Z: 'redo', '?': 'help', u: 'length', a: 'angle', e: 'ellipse',
    o: 'open', n: 'next', N: 'previous'};

/** @param {KeyboardEvent} event
 * @param {import('./store.js').Store} store
 * @param {import('./types').Actions} actions
 * @param {import('./pointer.js').Pointer} pointer */
function press(event, store, actions, pointer) {
    const {key} = event;
    if (STEPS[key]) {
        const [across, down] = STEPS[key], degrees = event.shiftKey ? 1 : 5;
        pointer.step(across * degrees, down * degrees);
    } else if (key === '+' || key === '=' || key === '-') {
        store.set(zoomed(store.keys, known(store.info), key === '-' ? 1 / 1.15 : 1.15, 0, 0, 1));
    } else if (key >= '1' && key <= '6') {
        actions.view(VIEWS[Number(key) - 1]);
    } else {
        const name = NAMED[key];
        if (name && name !== 'view' && name !== 'measure')
            actions[name]();
        return Boolean(name);
    }
    return true;
}
