// types.d.ts - the state of the page and what it says to the server and hears from it
// (serve/message.h), for `tsc --checkJs`, which ./dev check runs; browsers never see it.

export type Pair = [number, number];
export type Vector = number[]; // of the world: three numbers
export type Point = [value: number, opacity: number];
export type Plane = [a: number, b: number, c: number, d: number];

/** Where slices cross, their window, and how they are shown: of this page alone, so that
 * no server gets it.  What is left out: beside the picture, lines, one zoom, no slab. */
export type Crossing = {at: Vector, range: Pair, colored?: boolean, layout?: 'grid' | 'slice', large?: number,
    lines?: false, apart?: true, slab?: string};

/** A recipe: docs/viewer.md and `snowglass help config` say what its keys mean. */
export type Keys = {
    size?: number[], background?: string, mode?: string, iso?: number, threshold?: number,
    preset?: string, colormap?: string, scale?: string, opacity?: Point[], 'gradient-opacity'?: Point[],
    range?: [number, number] | [string, string] | string, window?: Pair, 'opacity-unit'?: number | string,
    shade?: string, light?: string | number[], material?: number[], 'depth-darkening'?: number, occlusion?: number,
    view?: string, azimuth?: number, elevation?: number, roll?: number, zoom?: number, perspective?: number,
    fit?: string, position?: Vector, target?: Vector, up?: Vector,
    'no-labels'?: true, legend?: true | string, title?: string, annotate?: string, box?: string,
    measure?: string,
    crop?: Pair[], channel?: string | number, component?: string | number, labels?: string, clip?: Plane[],
    time?: number, 'z-scale'?: number | string, mask?: true, overlay?: true, 'overlay-look'?: string,
    slices?: Crossing};
export type Key = keyof Keys;

/** Null takes a key out. */
export type Changes = {[K in Key]?: Keys[K] | null};

/** What the page says. */
export type Said =
    | {t: 'hello', token: string, wants: string[]}
    | {t: 'set', step: number, keys: Changes}
    | {t: 'moving', on: boolean}
    | {t: 'ack', n: number, took: number}
    | {t: 'part'}
    | {t: 'ask', what: string, [more: string]: unknown};

/** The state.  `step` is the newest one of this page that it has; `keys` are those that
 * pages and the command line have set, `computed` what the server adds to a look of which a
 * part was set (serve/kept_look.h); `touched` says whether any page has set a key. */
export type State = {t: 'state', step: number, keys: Keys, computed?: Keys, touched?: boolean};

/** Where a slice lies: across `along` of the grid; which axis goes right and down, and how. */
export type SliceInfo = {axis: string, along: number, width: number, height: number,
    right: [axis: number, sign: number], down: [axis: number, sign: number]};

/** The volume.  A notebook's kernel and a running simulation leave some of it out. */
export type Info = {
    name: string, dims: number[], spacing: number[], unit: string, type: string, medical: boolean, times: number,
    min: number | null, max: number | null, middle: Vector, radius: number, matrix: number[][],
    axes: [unit: string, length: number][], view: string, views: Record<string, [back: Vector, up: Vector]>,
    presets: [name: string, text: string][], colormaps: string[], tf: boolean, fov: number,
    channels?: string[], keys?: string[], mask?: boolean, overlay?: string | null, labels?: string | null,
    slices?: SliceInfo[] | null, live?: boolean, instance?: string, file?: string, window: Pair,
    hounsfield?: boolean, value_unit?: string, opened?: number, series?: string, modality?: string,
    movies?: {formats: string[], note: string} | null};

export type Label = [value: number, name: string, color: string, opacity: number];
/** One that is drawn alone has no map. */
export type Channel = [index: number, name: string, map: string, color: string,
    low: number, high: number, opacity: number];

/** What the transfer function is, in numbers and colours. */
export type Look = {
    map?: string, preset?: string, low: number, high: number, count: number, legend?: number, opacity: Point[], gradient: Point[],
    strip: string[], text: string, shaded: boolean, labels?: Label[],
    overlay?: {low: number, high: number, labels: Label[]} | null, channels?: Channel[]};

export type Histogram = {lo: number, hi: number, counts: number[]};

/** A measure, in units of the world and of the values. */
export type Result = {kind: string, points: Vector[], length?: number, degrees?: number, unit?: string,
    area?: number, mean?: number | null, deviation?: number | null, min?: number | null,
    max?: number | null, count?: number, value_unit?: string};

/** What lies at a voxel, or how far the surface is. */
export type Probe = {n: number, value?: number | null, depth?: number | null};

/** The list of a folder: how many entries, and which is open. */
export type Listed = {name: string, count: number, others: number, beyond: number, faults: number, done: boolean,
    open: number | null};

/** An entry of it.  Of a fault `text` says why, of a recipe its volume. */
export type Entry = {
    kind: 'volume' | 'recipe' | 'fault', name: string, series: string, day: string, bytes: number, changed: number,
    text?: string, dims?: number[], type?: string, format?: string, times?: number, modality?: string,
    description?: string};

/** A picture, or that of a pane. */
export type Frame = {
    n: number, level: number, kind: number, pane: number, width: number, height: number,
    render: number, pack: number, data: ArrayBuffer, bytes: number, blob: Blob, bitmap?: ImageBitmap};

/** The movie that the server writes (serve/movies/job.h). */
export type Movie = {
    state: 'none' | 'writing' | 'done' | 'failed' | 'cancelled', name: string, tag: string, frame: number,
    frames: number, bytes: number, text: string};

/** What is heard of the server, and of the connection, by name. */
export type Heard = {
    open: undefined, closed: string, measured: number, picture: Frame, small: Frame,
    info: Info, look: Look, state: State, histogram: Histogram, said: {text: string},
    command: {text: string}, recipe: {text: string}, 'look-file': {text: string}, progress: {stage: string, part: number},
    figures: {sparse: number | null, method: string}, step: {step: number}, slice: {pane: number},
    value: {at: number[], value: number | null}, depth: {x: number, y: number, depth: number | null},
    replaced: {gone: boolean, again: boolean}, measures: {of: string, measures: Result[]}, probe: Probe,
    folder: Listed, entries: {from: number, entries: Entry[]}, cover: {entry: number, image: string | null},
    opened: {good: boolean}, times: {texts: string[]}, movie: Movie};

/** The renderer, wherever it is. */
export interface Engine {
    token: string;
    lost: Changes;
    on<K extends keyof Heard>(name: K, hear: (message: Heard[K]) => void): void;
    open(): void;
    ask(what: string, more?: object): void;
    set(changes: Changes): void;
    moving(on: boolean): void;
    flush(): void;
    fetch(name: string): Promise<Response>;
    step: number; // the newest set
    flat?: boolean; // it finds no surface
}

/** What buttons and keys do, by name. */
export type Actions = {
    view(name: string): void, measure(tool: string | null): void, length(): void, angle(): void, ellipse(): void,
    fit(): void, mode(): void, perspective(): void, letters(): void, play(): void,
    drag(): void, slices(): void, lines(): void, handles(): void, command(): void, movie(): void, link(): void, file(): void, saveLook(): void, choose(): void,
    save(): void, reset(): void, undo(): void, redo(): void, help(): void,
    open(): void, next(): void, previous(): void};

/** What an element is listened to by; one that returns true has done all. */
export type Hearer = {
    down?(event: PointerEvent): unknown, move?(event: PointerEvent): unknown, up?(event: PointerEvent): unknown,
    wheel?(event: WheelEvent): unknown, doubled?(event: MouseEvent): unknown, key?(event: KeyboardEvent): unknown};
