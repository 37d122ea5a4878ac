// types.d.ts - the state of the page and what it says to the server and hears from it
// (serve/message.h), for `tsc --checkJs`, which ./dev check runs; browsers never see it.

/** A recipe: docs/viewer.md and `snowglass help config` have its keys. */
export type Keys = Record<string, any>;

/** What the page says.  Null in a recipe takes a key out. */
export type Said =
    | {t: 'hello', token: string, wants: string[]}
    | {t: 'set', n: number, recipe: Keys}
    | {t: 'moving', on: boolean}
    | {t: 'ack', n: number}
    | {t: 'ask', what: string, [more: string]: unknown};

/** The state: n is the newest message of this page that it has; `computed` are the keys
 * that the server wrote and no page, `touched` says whether any page has set one. */
export type State = {t: 'state', n: number, recipe: Keys, computed?: string[], touched?: boolean};

/** What is known of the volume, as far as keys are checked against it. */
export type Info = {keys?: string[], times: number, slices?: unknown[]};

/** A picture, or that of a pane. */
export type Frame = {
    n: number, level: number, kind: number, pane: number, width: number, height: number,
    render: number, pack: number, data: ArrayBuffer, bytes: number, blob: Blob, bitmap?: ImageBitmap};

/** What a recipe needs of an engine. */
export interface Engine {
    on(name: string, hear: (message: any) => void): void;
    set(changes: Keys): void;
    moving(on: boolean): void;
}
