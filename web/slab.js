// slab.js - thick slices: the maximum, mean or minimum of some millimetres, in the words
// of the tool's --slab, such as "10mm:max"; "5:mean" where the grid has no unit.

import {make, number, row, select, short, show} from './controls.js';

const KINDS = [['', 'one slice'], ['max', 'maximum'], ['mean', 'mean'], ['min', 'minimum']];
const USUAL = 10; // mm
const SLICES = 5; // elsewhere

/** @param {string} slab
 * @returns {[thickness: number, unit: string, kind: string]} */
function parsed(slab) {
    const [, thickness = '', unit = '', kind = ''] = /^([\d.e+-]+)([^:]*):(\w+)$/.exec(slab) ?? [];
    return [Number(thickness), unit, kind];
}

/** "max 10 mm".
 * @param {string} slab */
export function slabText(slab) {
    const [thickness, unit, kind] = parsed(slab);
    return `${kind} ${short(thickness)} ${unit || 'slices'}`;
}

/** The unit that all axes have; none: slices are counted.
 * @param {import('./types').Info} info */
function unitOf({axes: [[unit], ...others]}) {
    return others.every(([each]) => each === unit) ? unit : '';
}

/** Of the panel: a row, and what keeps it as the recipe is.
 * @param {import('./slices.js').Slices} slices */
export function thickness(slices) {
    const unit = unitOf(slices.info);
    const usual = unit === 'mm' ? USUAL : unit ? SLICES * Math.max(...slices.info.spacing) : SLICES;
    /** @param {string} kind
     * @param {number} thick */
    const put = (kind, thick) => slices.set({slab: kind ? `${short(thick > 0 ? thick : usual)}${unit}:${kind}` : undefined});
    const kinds = select(KINDS, kind => put(kind, field.valueAsNumber));
    const field = number(`thickness in ${unit || 'slices'}`, value => value > 0 && put(kinds.value, value));
    return {row: row('Slab', kinds, field, make('span', {className: 'faint', textContent: unit || 'slices'})),
        follow() {
            const [thick, , kind] = parsed(slices.crossing.slab ?? '');
            show(kinds, kind);
            field.disabled = !kind;
            show(field, thick ? short(thick) : '');
        }};
}
