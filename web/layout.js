// layout.js - how the picture and the slices lie: buttons, of which one is pressed.

import {button, make} from './controls.js';

/** @typedef {'picture'|'beside'|'grid'|'slice'} Name */

/** Each as boxes of a pictogram: x, y, width, height.
 * @type {[name: Name, text: string, tip: string, boxes: [number, number, number, number][]][]} */
const LAYOUTS = [
    ['picture', '3D', 'The picture alone (x: slices, or none)', [[0, 0, 18, 14]]],
    ['beside', '3D + 3', 'Three slices beside the picture', [[0, 0, 11, 14], [13, 0, 5, 4], [13, 5, 5, 4], [13, 10, 5, 4]]],
    ['grid', '2 x 2', 'Picture and slices, all of one size', [[0, 0, 8, 6], [10, 0, 8, 6], [0, 8, 8, 6], [10, 8, 8, 6]]],
    ['slice', 'Slice', 'One slice large; once more: the next one',
        [[13, 0, 5, 4], [13, 5, 5, 4], [13, 10, 5, 4], [0, 0, 11, 14]]]];

/** The first box, which is filled, is the picture.
 * @param {[number, number, number, number][]} boxes */
function pictogram(boxes) {
    return make('span', {className: 'pictogram', 'aria-hidden': 'true'}, ...boxes.map(([x, y, width, height], i) => {
        const box = make('i', {className: i ? '' : 'full'});
        for (const [name, value] of Object.entries({left: x, top: y, width, height}))
            box.style.setProperty(name, `${value}px`);
        return box;
    }));
}

/** @param {import('./slices.js').Slices} slices */
export function layouts(slices) {
    const buttons = LAYOUTS.map(([name, text, tip, boxes]) => {
        const made = button(text, tip, () => slices.arrange(name));
        made.replaceChildren(pictogram(boxes), make('span', {className: 'text', textContent: text}));
        return made;
    });
    slices.store.onChange(() => buttons.forEach((each, i) =>
        each.setAttribute('aria-pressed', `${LAYOUTS[i][0] === slices.layout}`)));
    return make('span', {className: 'layouts', role: 'group', 'aria-label': 'Layout'}, ...buttons);
}
