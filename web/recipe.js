// recipe.js - the state of the page, which is a recipe and nothing else, and how
// it was before.
//
// A step holds the keys that it changed, as they were: undo sends these alone, and
// takes back nothing that another page did.

const HISTORY = 200;
const TOGETHER = 600; // ms in which changes of the same keys are one step

/** What is of this page alone, and no part of the picture (slices.js). */
const OWN = 'slices';

/** @typedef {import('./types').Keys} Keys */

/** @type {(a: unknown, b: unknown) => boolean} */
const same = (a, b) => JSON.stringify(a ?? null) === JSON.stringify(b ?? null);

export class Recipe {
    /** @param {import('./types').Engine} engine */
    constructor(engine) {
        this.engine = engine;
        /** @type {Keys} */
        this.keys = {};
        /** @type {number[]|null} */
        this.size = null; // of this page: each has its own
        /** @type {string[]} */
        this.computed = []; // keys that the server has written, and no page (serve/kept_look.h)
        /** @type {Keys[]} */
        this.before = [];
        /** @type {Keys[]} */
        this.after = [];
        /** @type {((keys: Keys) => void)[]} */
        this.hearers = [];
        /** @type {'begun'|'changed'|null} */
        this.gesture = null;
        this.last = {names: '', at: 0};
        engine.on('state', message => this.take(message));
    }

    /** @param {(keys: Keys) => void} hear */
    onChange(hear) {
        this.hearers.push(hear);
    }

    changed() {
        for (const hear of this.hearers)
            hear(this.keys);
    }

    /** What another page, or the server, has changed.
     * @param {import('./types').State} state */
    take({recipe, computed = []}) {
        this.keys = {...recipe, ...this.size && {size: this.size},
            ...OWN in this.keys && {[OWN]: this.keys[OWN]}};
        this.computed = computed;
        this.changed();
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
     * @param {string[]} names
     * @returns {Keys} */
    now(names) {
        return Object.fromEntries(names.map(name =>
            [name, this.computed.includes(name) ? null : this.keys[name] ?? null]));
    }

    /** A step of these keys begins.
     * @param {string[]} names */
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
     * @param {Keys} changes */
    set(changes) {
        const names = Object.keys(changes).filter(key => !same(this.keys[key], changes[key]));
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

    /** The same without a step.
     * @param {Keys} changes */
    apply(changes) {
        this.size = changes.size ?? this.size;
        this.keys = {...this.keys};
        for (const [key, value] of Object.entries(changes)) {
            if (value === null || value === undefined)
                delete this.keys[key];
            else
                this.keys[key] = value;
        }
        const {[OWN]: own, ...sent} = changes;
        if (Object.keys(sent).length)
            this.engine.set(sent);
        this.changed();
    }

    /** Becomes another recipe whole, in one step; the size is the window's.
     * @param {Keys} keys */
    replace(keys) {
        const {size, ...changes} = keys;
        for (const key of Object.keys(this.keys))
            if (!(key in keys) && key !== 'size')
                changes[key] = null;
        this.part();
        this.set(changes);
    }

    /** Takes a step back; those that changed nothing are passed over.
     * @param {Keys[]} from
     * @param {Keys[]} to */
    step(from, to) {
        while (from.length && Object.entries(from.at(-1) ?? {}).every(([key, value]) => same(this.keys[key], value)))
            from.pop();
        const step = from.pop();
        if (!step)
            return false;
        to.push(this.now(Object.keys(step)));
        this.part();
        this.apply(step);
        return true;
    }

    undo() {
        return this.step(this.before, this.after);
    }

    redo() {
        return this.step(this.after, this.before);
    }
}
