// store.js - the one state of the page, which all its modules read: what was set, what
// the server has computed and said, how it was before, and what is of this page alone.
//
// `set` alone changes what is shown.  The look is the server's with what was set since,
// so that nobody writes into what the server has said.  A step holds the keys that it
// changed, as they were: undo sends these alone, and takes back nothing that another page
// did.

import {lookWith} from './look.js';

export const FEW = 8; // drafts whose figures nobody could read

const HISTORY = 200;
const TOGETHER = 600; // ms in which changes of the same keys are one step

/** What is of this page alone, and no part of the picture (slices.js). */
const OWN = 'slices';

/** What only says from where the volume is seen.
 * @type {Key[]} */
const CAMERA = ['azimuth', 'elevation', 'roll', 'zoom', 'target'];

/** @typedef {import('./types').Keys} Keys */
/** @typedef {import('./types').Key} Key */
/** @typedef {import('./types').Changes} Changes */

/** @type {(a: unknown, b: unknown) => boolean} */
const same = (a, b) => JSON.stringify(a ?? null) === JSON.stringify(b ?? null);

/** The keys of a record, with their type.
 * @type {(record: Changes) => Key[]} */
const named = record => /** @type {Key[]} */ (Object.keys(record));

/** Keys with changes.
 * @param {Keys} keys
 * @param {Changes} changes
 * @returns {Keys} */
export const merged = (keys, changes) => Object.fromEntries(
    Object.entries({...keys, ...changes}).filter(([, value]) => value !== null && value !== undefined));

/** What has to be there where it is used.
 * @template T
 * @param {T|null|undefined} value
 * @returns {T} */
export function known(value) {
    if (value === null || value === undefined)
        throw new Error('The viewer has said nothing yet.');
    return value;
}

export class Store {
    /** @param {import('./types').Engine} engine */
    constructor(engine) {
        this.engine = engine;
        /** What was set, and what the server has added to it.
         * @type {Readonly<Keys>} */
        this.keys = {};
        /** Of these, what the server has added: they are never sent back.
         * @type {Readonly<Keys>} */
        this.computed = {};
        /** @type {number[]|null} */
        this.size = null; // of this page: each has its own
        /** @type {import('./types').Info|null} */
        this.info = null;
        /** @type {Readonly<import('./types').Look>|null} */
        this.answered = null; // the look of the newest state that the server has drawn
        /** @type {import('./types').Histogram|null} */
        this.histogram = null;
        /** The look with what was set, until one of both is another.
         * @type {{answered: unknown, keys: unknown, look: Readonly<import('./types').Look>|null}} */
        this.made = {answered: null, keys: null, look: null};
        this.step = 0; // of a running simulation

        // Of this page alone.
        this.tool = 'turn'; // what a drag does
        this.cube = true; // of directions, on the picture
        this.letters = true; // keys that are single letters act
        this.clipping = false; // handles of clip planes are shown
        /** @type {Blob|null} */
        this.rest = null; // the picture at rest, as a file
        this.frames = 0;
        /** Shows a line: viewer.js says how.
         * @type {(line: string, stays?: boolean, time?: number) => void} */
        this.say = () => {};

        /** @type {Changes[]} */
        this.before = [];
        /** @type {Changes[]} */
        this.after = [];
        /** @type {((keys: Readonly<Keys>) => void)[]} */
        this.hearers = [];
        /** @type {((keys: Readonly<Keys>) => void)[]} */
        this.watchers = [];
        this.moved = false; // the camera, since they were called
        /** @type {'begun'|'changed'|null} */
        this.gesture = null;
        this.last = {names: '', at: 0};
        engine.on('state', message => this.take(message));
        engine.on('picture', () => this.moved && this.shown());
    }

    /** After each change; of those that a drag makes to the camera, when it ends.
     * @param {(keys: Readonly<Keys>) => void} hear */
    onChange(hear) {
        this.hearers.push(hear);
    }

    /** After each change; in a drag of the camera with each picture, as what shows the
     * camera then is drawn with it, and the processor is left to the pictures.
     * @param {(keys: Readonly<Keys>) => void} hear */
    onCamera(hear) {
        this.watchers.push(hear);
    }

    changed() {
        for (const hear of this.hearers)
            hear(this.keys);
        this.shown();
    }

    shown() {
        this.moved = false;
        for (const hear of this.watchers)
            hear(this.keys);
    }

    /** The look as it is once the server has drawn what was set.
     * @returns {Readonly<import('./types').Look>|null} */
    get look() {
        const {answered, keys} = this;
        if (this.made.answered !== answered || this.made.keys !== keys)
            this.made = {answered, keys, look: answered && lookWith(answered, keys)};
        return this.made.look;
    }

    /** What was set, by pages or the command line.
     * @returns {Keys} */
    get own() {
        return Object.fromEntries(Object.entries(this.keys).filter(([key]) => !(key in this.computed)));
    }

    /** What another page, or the server, has changed.
     * @param {import('./types').State} state */
    take({keys, computed = {}}) {
        this.computed = computed;
        this.keys = {...keys, ...computed, ...this.size && {size: this.size},
            ...OWN in this.keys && {[OWN]: this.keys[OWN]}};
        this.changed();
    }

    /** Another volume is open: nothing of the one before is left but the window. */
    renew() {
        this.keys = this.size ? {size: this.size} : {};
        this.computed = {};
        this.answered = this.histogram = this.rest = null;
        this.before = [];
        this.after = [];
        this.part();
    }

    /** What follows is a step of its own, however soon it comes. */
    part() {
        this.last = {names: '', at: 0};
    }

    /** A drag is one step, however many changes it makes, and none without any. */
    begin() {
        if (this.gesture)
            return;
        this.gesture = 'begun';
        this.engine.moving(true);
    }

    end() {
        if (!this.gesture)
            return;
        this.gesture = null;
        this.engine.moving(false);
        this.changed();
    }

    /** What brings keys back to what they are now.
     * @param {Key[]} names
     * @returns {Changes} */
    now(names) {
        return Object.fromEntries(names.map(name =>
            [name, name in this.computed ? null : this.keys[name] ?? null]));
    }

    /** A step of these keys begins.
     * @param {Key[]} names */
    remember(names) {
        this.before.push(this.now(names));
        this.before.splice(0, this.before.length - HISTORY);
        this.after = [];
    }

    /** Whether a change goes on with the step before.
     * @param {string} names */
    goesOn(names) {
        const at = performance.now(), {last} = this;
        this.last = {names, at};
        return this.gesture ? this.gesture === 'changed' : names === last.names && at - last.at < TOGETHER;
    }

    /** A step of the user's; null takes a key out.
     * @param {Changes} changes */
    set(changes) {
        const names = named(changes).filter(key => !same(this.keys[key], changes[key]));
        if (!names.length)
            return;
        const step = this.before.at(-1);
        if (this.goesOn(names.join()) && step)
            Object.assign(step, {...this.now(names), ...step});
        else
            this.remember(names);
        this.gesture &&= 'changed';
        this.apply(changes);
    }

    /** The same without a step.  What the server has computed is not said to it.
     * @param {Changes} changes */
    apply(changes) {
        this.size = changes.size ?? this.size;
        const {[OWN]: _, ...sent} = changes, computed = {...this.computed};
        for (const key of named(changes))
            if (key in computed && same(computed[key], changes[key]))
                delete sent[/** @type {Exclude<Key, 'slices'>} */ (key)];
            else
                delete computed[key];
        this.computed = computed;
        this.keys = merged(this.keys, changes);
        if (named(sent).length)
            this.engine.set(sent);
        if (this.gesture && named(changes).every(key => CAMERA.includes(key)))
            this.moved = true;
        else
            this.changed();
    }

    /** Becomes another recipe whole, in one step; the size is the window's.
     * @param {Keys} keys */
    replace(keys) {
        const {size, ...changes} = keys;
        const gone = named(this.keys).filter(key => !(key in keys) && key !== 'size');
        this.part();
        this.set({...changes, ...Object.fromEntries(gone.map(key => [key, null]))});
    }

    /** Takes a step back; those that changed nothing are passed over.
     * @param {Changes[]} from
     * @param {Changes[]} to */
    go(from, to) {
        while (from.length && named(from.at(-1) ?? {}).every(key => same(this.keys[key], from.at(-1)?.[key])))
            from.pop();
        const step = from.pop();
        if (!step)
            return false;
        to.push(this.now(named(step)));
        this.part();
        this.apply(step);
        return true;
    }

    undo() {
        return this.go(this.before, this.after);
    }

    redo() {
        return this.go(this.after, this.before);
    }
}
