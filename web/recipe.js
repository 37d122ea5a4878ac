// recipe.js - the state of the page, which is a recipe and nothing else, and
// how it was before.

const HISTORY = 200;
const TOGETHER = 600; // ms in which changes of the same keys are one step

/** What is of this page alone, and no part of the picture (slices.js). */
const OWN = 'slices';

const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
const sorted = ({size, ...keys}) => Object.entries(keys).sort(([a], [b]) => a < b ? -1 : 1);

export class Recipe {
    constructor(engine) {
        this.engine = engine;
        this.keys = {};
        this.before = [];
        this.after = [];
        this.hearers = [];
        this.gesture = null; // begun, then changed
        this.last = {names: '', at: 0};
        engine.on('state', message => this.take(message.recipe));
    }

    onChange(hear) {
        this.hearers.push(hear);
    }

    changed() {
        for (const hear of this.hearers)
            hear(this.keys);
    }

    /** What another page, or the server, has changed. */
    take(keys) {
        this.keys = OWN in this.keys ? {...keys, [OWN]: this.keys[OWN]} : keys;
        this.changed();
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

    remember(names) {
        const now = performance.now();
        const together = names && names === this.last.names &&
            now - this.last.at < TOGETHER;
        this.last = {names, at: now};
        if (together)
            return;
        this.before.push({...this.keys});
        this.before.splice(0, this.before.length - HISTORY);
        this.after = [];
    }

    set(changes) {
        const names = Object.keys(changes).filter(
            key => !same(this.keys[key] ?? null, changes[key]));
        if (!names.length)
            return;
        if (!this.gesture)
            this.remember(names.join());
        else if (this.gesture === 'begun')
            this.remember('');
        this.gesture &&= 'changed';
        this.apply(changes);
    }

    apply(changes) {
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

    /** Becomes another recipe whole; the size is the window's. */
    replace(keys) {
        const changes = {...keys};
        for (const key of Object.keys(this.keys))
            if (!(key in keys))
                changes[key] = null;
        delete changes.size;
        this.apply(changes);
    }

    /** To another state; steps that changed nothing are passed over. */
    step(from, to) {
        while (from.length && same(sorted(from.at(-1)), sorted(this.keys)))
            from.pop();
        if (!from.length)
            return false;
        to.push({...this.keys});
        this.last = {names: '', at: 0};
        this.replace(from.pop());
        return true;
    }

    undo() {
        return this.step(this.before, this.after);
    }

    redo() {
        return this.step(this.after, this.before);
    }
}
