// presets.js - looks by name, with pictures of the volume itself: grouped by what a file
// holds, those that suit it first.  The tool's names stand in their tips.  Some are made of
// several keys of a recipe.

import {button, make, section} from '../controls.js';
import {mixed} from '../look.js';

/** @typedef {import('../types').Changes} Changes */
/** @typedef {import('../types').Info} Info */
/** A group, a name for readers, what it is; and keys, where it is no preset of the tool.
 * @typedef {{kind: string, name: string, text: string, keys: Changes}} Preset */

const FIRST_PANE = 4;

/** What a choice of another look takes away. */
export const NO_SHAPE = {colormap: null, opacity: null, 'gradient-opacity': null, range: null,
    window: null, scale: null};

/** What a file of a look may have: serve/recipe_file.c writes it. */
const OF_LOOK = ['preset', 'colormap', 'scale', 'opacity', 'gradient-opacity', 'range', 'window', 'opacity-unit',
    'shade', 'material', 'channel'];
const BARE = [...OF_LOOK, 'version', 'tf'];

/** Whether a recipe is of a look alone.
 * @param {object} recipe */
export const isLook = recipe => Object.keys(recipe).every(key => BARE.includes(key));

/** Looks of one volume leave of several channels the first.
 * @param {import('../store.js').Store} store */
function alone({look}) {
    const first = mixed(look) && look?.channels?.[0]?.[0];
    return typeof first === 'number' ? {channel: `${first}`} : {};
}

/** @type {Record<string, string>} */
const KINDS = {ct: 'CT', mr: 'MR', pet: 'PET', microscopy: 'Microscopy', simulation: 'Simulation', general: 'General'};

/** @type {Record<string, [kind: string, name: string]>} */
const NAMES = {
    linear: ['general', 'Grey ramp'], labels: ['general', 'Segmentation'],
    'ct-bone': ['ct', 'Bone'], 'ct-bones': ['ct', 'Bone surface'], 'ct-cropped-volume-bone': ['ct', 'Bone, cut open'],
    'ct-soft': ['ct', 'Soft tissue'], 'ct-soft-tissue': ['ct', 'Skin, organs'], 'ct-muscle': ['ct', 'Muscle'],
    'ct-fat': ['ct', 'Fat'], 'ct-lung': ['ct', 'Lungs'], 'ct-chest-contrast-enhanced': ['ct', 'Chest, contrast'],
    'ct-chest-vessels': ['ct', 'Chest vessels'], 'ct-pulmonary-arteries': ['ct', 'Lung vessels'],
    'ct-cardiac': ['ct', 'Heart'], 'ct-cardiac2': ['ct', 'Heart walls'], 'ct-cardiac3': ['ct', 'Heart, solid'],
    'ct-coronary-arteries': ['ct', 'Coronaries'], 'ct-coronary-arteries-2': ['ct', 'Coronaries, veil'],
    'ct-coronary-arteries-3': ['ct', 'Coronaries, colour'], 'ct-aaa': ['ct', 'Aorta'], 'ct-aaa2': ['ct', 'Aorta, organs'],
    'ct-liver-vasculature': ['ct', 'Liver vessels'], 'ct-mip': ['ct', 'Grey, fat to bone'],
    'mr-default': ['mr', 'MR, any'], 'mr-angio': ['mr', 'Angiogram'], 'mr-mip': ['mr', 'Grey'],
    'mr-t2-brain': ['mr', 'Brain, T2'], 'dti-fa-brain': ['mr', 'Diffusion, FA'],
    signed: ['simulation', 'Both signs']};

/** @type {(kind: string, name: string, mode: 'mip'|'over', colormap: string) => Preset} */
const made = (kind, name, mode, colormap) => ({kind, name, keys: {mode, colormap},
    text: `${mode === 'mip' ? 'the largest value along each ray' : 'made from the histogram'}, in colours ${colormap}`});

const MADE = [made('pet', 'Dark on white', 'mip', 'grey_r'), made('pet', 'Hot, flat', 'mip', 'hot'),
    made('pet', 'Hot, solid', 'over', 'hot'),
    made('microscopy', 'Brightest', 'mip', 'grey'), made('microscopy', 'Brightest, fire', 'mip', 'inferno'),
    made('microscopy', 'Dark on white', 'mip', 'grey_r'),
    made('simulation', 'Viridis', 'over', 'viridis'), made('simulation', 'Inferno', 'over', 'inferno'),
    made('simulation', 'Cool to warm', 'over', 'cool-warm'), made('simulation', 'Turbo', 'over', 'turbo')];

/** What a file holds, as far as it says so.
 * @param {Info} info */
export function kindOf({modality = '', hounsfield, medical, type, axes, channels = [], live}) {
    if (modality === 'CT' || hounsfield)
        return 'ct';
    if (modality === 'MR')
        return 'mr';
    if (/^(PT|NM|ST)$/.test(modality))
        return 'pet';
    if (!medical && (channels.length > 1 || axes.some(([unit]) => /^([uµ]m|nm|angstrom)$/i.test(unit))))
        return 'microscopy';
    return !medical && !modality && (live || /^(float|double)/.test(type)) ? 'simulation' : 'general';
}

/** All that there are, in their groups, the first of which suits the file.
 * @param {Info} info */
export function grouped(info) {
    /** @type {Preset} */
    const usual = {kind: 'general', name: info.tf ? 'Of the file' : 'Automatic', keys: {preset: null},
        text: info.tf ? 'the look that the viewer was started with' : 'made from the histogram'};
    const named = info.presets.map(([preset, text]) => {
        const [kind, name] = NAMES[preset] ?? ['general', preset];
        return {kind, name, text: `${text} (${preset})`, keys: {preset}};
    });
    const first = kindOf(info);
    /** @type {Preset[]} */
    const all = [...named, ...MADE];
    /** @type {string[]} */
    const kinds = [...new Set([first, 'general', ...Object.keys(KINDS)])];
    return kinds.map((kind, i) => ({name: KINDS[kind], isFirst: i === 0,
        presets: [...i ? [] : [usual], ...all.filter(each => each.kind === kind)]}));
}

export class Presets {
    /** @param {import('../store.js').Store} store
     * @param {import('../types').Actions} actions */
    constructor(store, actions) {
        this.store = store;
        this.actions = actions;
        /** @type {HTMLImageElement[]} */
        this.images = []; // in the order of panes
        /** @type {[HTMLButtonElement, Preset][]} */
        this.buttons = [];
        store.engine.on('small', frame => this.show(frame));
    }

    /** When the volume is known. */
    build() {
        const {store: {info, engine}, actions} = this;
        this.images = [];
        this.buttons = [];
        if (!info)
            return '';
        const groups = grouped(info).map(({name, isFirst, presets}) => {
            const from = this.images.length, grid = make('div', {className: 'presets'},
                ...presets.map(preset => this.button(preset)));
            const group = section(name, isFirst, grid);
            const ask = () => presets.forEach(({keys: {preset, mode, colormap}}, i) => engine.ask('thumbnail',
                {preset: preset ?? '', ...colormap && {colormap}, ...mode && {mode}, pane: FIRST_PANE + from + i}));
            group.addEventListener('toggle', () => group.open && list.open && ask());
            return {group, ask};
        });
        const own = info.keys && !info.live ? [make('div', {className: 'row'},
            button('Save look', 'Save colours, opacity, range and shading as a file', actions.saveLook),
            button('Open look', 'Open such a file', actions.choose))] : [];
        const list = section('Presets', false, ...own, ...groups.map(({group}) => group));
        list.addEventListener('toggle', event => event.target === list && list.open &&
            groups.forEach(({group, ask}) => group.open && ask()));
        return list;
    }

    /** @param {Preset} preset */
    button(preset) {
        const image = make('img', {alt: '', hidden: true});
        const choose = make('button', {type: 'button', title: preset.text,
            'aria-label': `${preset.name}: ${preset.text}`, onclick: () => this.choose(preset)}, image, preset.name);
        this.images.push(image);
        this.buttons.push([choose, preset]);
        return choose;
    }

    /** The one that is chosen, if its keys are those of the state. */
    get chosen() {
        const {keys} = this.store;
        const found = this.buttons.find(([, {keys: own}]) => own.preset === undefined && !keys.preset &&
            own.colormap === keys.colormap && own.mode === (keys.mode ?? 'over'));
        return (found ?? this.buttons.find(([, {keys: own}]) => own.preset === (keys.preset ?? null)))?.[1];
    }

    /** The mode of one that had its own goes with it.
     * @param {Preset} preset */
    choose({keys}) {
        const {store, chosen} = this;
        store.set({...NO_SHAPE, preset: null, ...chosen?.keys.mode && {mode: null}, ...keys,
            ...keys.mode && {iso: null}, ...alone(store)});
    }

    /** A look of a file in the place of the one before.
     * @param {Changes} keys */
    take(keys) {
        this.store.set({...Object.fromEntries(OF_LOOK.filter(key => key !== 'channel').map(key => [key, null])),
            ...alone(this.store), ...keys});
    }

    update() {
        const {chosen} = this;
        for (const [each, preset] of this.buttons)
            each.setAttribute('aria-pressed', `${preset === chosen}`);
    }

    /** @param {import('../types').Frame} frame */
    show(frame) {
        const image = this.images[frame.pane - FIRST_PANE];
        if (!image)
            return;
        URL.revokeObjectURL(image.src);
        image.src = URL.createObjectURL(frame.blob);
        image.hidden = false;
    }
}
