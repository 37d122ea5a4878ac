// keys.js - the keyboard, where no field takes it.

import {zoomed} from './camera.js';
import {make} from './controls.js';

export const VIEWS = ['anterior', 'posterior', 'left', 'right', 'superior', 'inferior'];
export const MODES = ['over', 'mip', 'minip', 'mean', 'sum', 'iso'];

const TEXTS = [['Drag', 'turn'], ['Shift or middle drag', 'move'], ['Wheel', 'zoom'],
    ['Right drag', 'window, level'], ['Ctrl right drag', 'opacity'],
    ['Ctrl drag', 'light'], ['Double click', 'turn around this point'],
    ['x', 'three slices'], ['k', 'handles of clip planes'],
    ['On a slice', 'drag: where they cross; wheel: next slice; right drag: window, level; ' +
        'Ctrl wheel: zoom; double click: alone'],
    ['Two fingers', 'move and zoom'], ['Arrows', 'as Drag: 5 degrees, Shift: 1'], ['d', 'next kind of drag'],
    ['+ -', 'zoom'], ['r', 'frame all'],
    ['1 - 6', 'front, back, left, right, top, bottom'], ['m', 'next mode'],
    ['p', 'perspective'], ['l', 'letters'], ['Space', 'play time steps'],
    ['c v', 'the command, that of a movie'], ['s', 'save the picture'], ['z Shift+z', 'undo, redo'],
    ['?', 'this help']];

export function helpTable() {
    return make('table', {}, ...TEXTS.map(([key, text]) => make('tr', {},
        make('td', {}, make('kbd', {textContent: key})), make('td', {textContent: text}))));
}

export const STEPS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

/** `actions` has what the buttons do, by name. */
export function listenToKeys(recipe, page, actions, pointer) {
    document.addEventListener('keydown', event => {
        const field = event.target.closest?.('input, select, textarea, dialog, summary');
        if (field || event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey || !page.info || !page.look)
            return;
        if (press(event, recipe, page, actions, pointer))
            event.preventDefault();
    });
}

function press(event, recipe, page, actions, pointer) {
    const {key} = event;
    if (key === ' ' && event.target.closest?.('button'))
        return false;
    if (STEPS[key]) {
        pointer.step(...STEPS[key].map(way => way * (event.shiftKey ? 1 : 5)));
    } else if (key === '+' || key === '=' || key === '-') {
        recipe.set(zoomed(recipe.keys, page.info, key === '-' ? 1 / 1.15 : 1.15, 0, 0, 1));
    } else if (key >= '1' && key <= '6') {
        actions.view(VIEWS[key - 1]);
    } else {
        const named = {r: 'fit', m: 'mode', p: 'perspective', l: 'letters', ' ': 'play',
            c: 'command', v: 'movie', s: 'save', x: 'slices', k: 'handles', d: 'drag', z: 'undo', Z: 'redo', '?': 'help'}[key];
        actions[named]?.();
        return Boolean(named);
    }
    return true;
}
