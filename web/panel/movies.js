// movies.js - movies that the server writes: a turn, or the time steps.  All pages see how
// far it is, and can cancel it or have the file; the one that ordered it gets it unasked.

import {button, make, number, row, section, select} from '../controls.js';
import {known} from '../store.js';

const SIZES = [['', 'as it is shown'], ['1280,720', '1280 x 720'], ['1920,1080', '1920 x 1080'], ['1080,1080', '1080 x 1080'],
    ['640,480', '640 x 480']];
const KINDS = [['turntable', 'a turn'], ['movie', 'the time steps']];
const FRAMES = 120;
const LOST = 'The viewer was started again: the movie that it was writing is lost.';

/** @typedef {import('../types').Movie} Movie */

/** @param {number} bytes */
const sized = bytes => bytes < 1e6 ? `${Math.ceil(bytes / 1e3)} kB` : `${(bytes / 1e6).toFixed(1)} MB`;

export class Movies {
    /** `times` has the steps that are played, `save` keeps a file, `question` asks the user.
     * @param {import('../store.js').Store} store
     * @param {import('./time.js').Times} times
     * @param {(name: string, blob: Blob) => void} save
     * @param {(name: string, text: string, answer: string, act: () => void) => void} question */
    constructor(store, times, save, question) {
        const {engine} = store;
        this.store = store;
        this.times = times;
        this.save = save;
        this.question = question;
        /** @type {Movie|null} */
        this.movie = null; // what the server says
        this.tag = ''; // of this page's own
        this.saved = ''; // the one that this page has fetched
        this.fetching = false;
        this.known = false; // the page has seen what went before
        this.writing = false; // when the connection was lost
        this.instance = '';
        this.kind = 'turntable';
        this.frames = FRAMES;
        this.fps = 0; // as usual
        this.size = '';
        this.format = '';
        this.show = () => {};
        engine.on('movie', movie => this.hear(movie));
        engine.on('open', () => {
            this.writing = this.movie?.state === 'writing';
            this.movie = null;
            this.known = false;
            this.show();
        });
        engine.on('info', ({instance = ''}) => {
            if (this.writing && this.instance !== instance)
                store.say(LOST);
            this.writing = false;
            this.instance = instance;
        });
        engine.on('state', () => {
            this.known = true;
        });
    }

    /** What is ordered; of another size than the page's where one is chosen. */
    get order() {
        const {kind, frames, fps, size, format, times} = this;
        const way = kind === 'movie' ? {first: times.first, last: times.last, fps: times.speed}
            : {frames, ...fps && {fps}};
        return {kind, ...way, ...size && {size: size.split(',').map(Number)}, ...format && {format}};
    }

    /** As the tool, never in the place of one that is there without a word. */
    write() {
        const {movie} = this, done = movie?.state === 'done';
        const act = () => {
            this.tag = Math.random().toString(36).slice(2, 12);
            this.store.engine.ask('movie', {...this.order, tag: this.tag, ...done && {overwrite: true}});
        };
        if (done && this.saved !== JSON.stringify(movie))
            this.question('Write another movie', `${movie.name} is there, and this page has not fetched it. ` +
                'Another one takes its place.', 'Write the new one', act);
        else
            act();
    }

    /** Whether a movie that this page has ordered is still to come. */
    get comes() {
        const {movie, tag, fetching} = this;
        return fetching || (movie?.state === 'writing' && Boolean(tag) && movie.tag === tag);
    }

    cancel() {
        this.store.engine.ask('movie-cancel');
    }

    /** @param {Movie} movie */
    hear(movie) {
        const {state, text, name} = movie, own = movie.tag === this.tag && Boolean(this.tag);
        const changed = this.known && state !== this.movie?.state;
        this.movie = movie;
        this.show();
        if (changed && state === 'failed')
            this.store.say(`The movie was not written: ${text}`, false, 20000);
        else if (changed && state === 'cancelled')
            this.store.say('The movie was cancelled, and nothing of it is left.');
        else if (changed && state === 'done')
            this.store.say(`The movie ${name} is written${text && `; ${text}`}.`);
        if (state === 'done' && own) {
            this.tag = '';
            this.fetch(movie);
        }
    }

    /** @param {Movie} movie */
    async fetch(movie) {
        this.fetching = true;
        try {
            const answer = await this.store.engine.fetch('movie');
            if (!answer.ok)
                throw new Error(await answer.text());
            this.save(movie.name, await answer.blob());
            this.saved = JSON.stringify(movie);
        } catch (error) {
            this.store.say(`The movie cannot be fetched: ${error instanceof Error ? error.message : error}`);
        }
        this.fetching = false;
    }

    /** `command` shows the command of the same movie.
     * @param {() => void} command */
    section(command) {
        const {movies, times} = known(this.store.info);
        if (!movies)
            return '';
        const note = make('p', {className: 'faint', textContent: movies.note, hidden: !movies.note});
        if (!movies.formats.length)
            return section('Movie', false, note);
        if (times < 2)
            this.kind = 'turntable';
        if (!movies.formats.includes(this.format))
            [this.format] = movies.formats;
        /** @type {(options: string[][], key: 'kind'|'size'|'format') => HTMLSelectElement} */
        const chosen = (options, key) => {
            const list = select(options, value => {
                this[key] = value;
                this.show();
            });
            list.value = this[key];
            return list;
        };
        /** An empty field is as usual.
         * @type {(name: string, key: 'frames'|'fps', least: number, most: number, usual: number) => HTMLInputElement} */
        const count = (name, key, least, most, usual) => {
            const field = number(name, value => {
                this[key] = Math.max(least, Math.min(most, key === 'frames' ? Math.round(value) : value));
                field.value = `${this[key]}`;
            });
            field.addEventListener('change', () => {
                if (field.value === '')
                    this[key] = key === 'frames' ? usual : 0;
            });
            field.placeholder = `${usual}`;
            field.value = this[key] ? `${this[key]}` : '';
            return field;
        };
        const kind = row('Shows', chosen(KINDS, 'kind'));
        const frames = row('Frames', count('number of frames', 'frames', 1, 3600, FRAMES));
        const rate = row('Speed', count('frames a second', 'fps', 0.1, 120, 25), make('span', {className: 'faint', textContent: 'a second'}));
        const steps = make('p', {className: 'faint', textContent: 'The steps, and their speed, are those of "Time". ' +
            'One look is chosen from all of them, unless a range is set.'});
        const bar = make('progress', {'aria-label': 'How far the movie is'}), told = make('p', {className: 'faint', role: 'status'});
        const write = button('Write', 'Write the movie where the viewer runs, and fetch it', () => this.write());
        const cancel = button('Cancel', 'Cancel the movie', () => this.cancel());
        const get = button('Download', 'Fetch the movie', () => this.movie && this.fetch(this.movie));
        const drop = button('Discard', 'Take the movie away from where the viewer runs', () => this.cancel());
        kind.hidden = times < 2;
        this.show = () => {
            const {movie} = this, state = movie?.state, writing = state === 'writing', done = state === 'done';
            frames.hidden = rate.hidden = this.kind !== 'turntable';
            steps.hidden = !frames.hidden;
            bar.hidden = cancel.hidden = !writing;
            write.hidden = writing;
            get.hidden = drop.hidden = !done;
            if (movie && writing && movie.frame)
                [bar.value, bar.max] = [movie.frame, movie.frames];
            else
                bar.removeAttribute('value');
            told.textContent = !movie || state === 'none' ? '' : writing
                ? `${movie.name}: ${movie.frame ? `frame ${movie.frame} of ${movie.frames}` : 'begins'}${movie.text && `, ${movie.text}`}`
                : done ? `${movie.name}, ${sized(movie.bytes)}` : state === 'failed' ? movie.text : 'cancelled';
            told.hidden = !told.textContent;
        };
        this.show();
        return section('Movie', false, kind, frames, rate, row('Size', chosen(SIZES, 'size')),
            row('Format', chosen(movies.formats.map(name => [name, name.toUpperCase()]), 'format')), steps, note,
            bar, told, make('div', {className: 'row'}, write, cancel, get, drop,
                button('Command', 'The command that makes the same movie (v)', command)));
    }
}
