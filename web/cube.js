// cube.js - a cube that lies as the volume does: letters of a patient's sides, or names of
// axes, and a press of a face looks from there.

import {axes, cross, dot} from './camera.js';
import {make} from './controls.js';
import {VIEWS} from './keys.js';
import {known} from './store.js';

/** @typedef {import('./types').Vector} Vector */

export const WORLD_VIEWS = ['+x', '-x', '+y', '-y', '+z', '-z'];
const SIDE = 36; // pixels
const LEAST = 0.15; // a face that is seen more narrowly cannot be pressed
const ROOM = 240; // pixels of the picture's shorter side that leave it room

export class Cube {
    /** @param {import('./store.js').Store} store
     * @param {HTMLElement} picture
     * @param {import('./types').Actions} actions */
    constructor(store, picture, actions) {
        this.store = store;
        this.picture = picture;
        /** @type {string[]} */
        this.names = [];
        this.faces = WORLD_VIEWS.map((_, i) => make('button', {type: 'button',
            onclick: () => actions.view(this.names[i])}));
        this.element = make('div', {className: 'cube', role: 'group', 'aria-label': 'Directions', hidden: true},
            ...this.faces);
        store.onCamera(() => this.draw());
    }

    /** Of a volume.
     * @param {import('./types').Info} info */
    name({medical}) {
        this.names = medical ? VIEWS : WORLD_VIEWS;
        this.faces.forEach((face, i) => {
            const name = this.names[i], text = medical ? name[0].toUpperCase() : name;
            face.textContent = text;
            face.title = `Look from ${name}`;
            face.setAttribute('aria-label', `${text}: look from ${name}`);
        });
        this.draw();
    }

    draw() {
        const {store: {info, keys, cube}, picture: {clientWidth, clientHeight}} = this;
        this.element.hidden = !info || !cube || !this.names.length || Math.min(clientWidth, clientHeight) < ROOM;
        if (this.element.hidden)
            return;
        const camera = axes(keys, known(info));
        this.faces.forEach((face, i) => this.place(face, known(info).views[this.names[i]], camera));
    }

    /** A face as a parallel projection shows it, which is its own right and down, and where
     * it lies; those behind are away.
     * @param {HTMLButtonElement} face
     * @param {[back: Vector, up: Vector]} side
     * @param {{right: Vector, up: Vector, back: Vector}} camera */
    place(face, [out, top], {right, up, back}) {
        /** @param {Vector} way */
        const see = way => [dot(way, right), -dot(way, up)];
        const numbers = [...see(cross(top, out)), ...see(top.map(x => -x)), ...see(out.map(x => x * SIDE / 2))];
        const shown = dot(out, back);
        face.hidden = shown < 1e-3;
        face.disabled = shown < LEAST;
        face.style.transform = `matrix(${numbers.map(x => x.toFixed(4)).join()})`;
        face.style.filter = `brightness(${(0.7 + 0.3 * Math.max(0, shown)).toFixed(2)})`;
    }
}
