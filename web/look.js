// look.js - the look with what was set since the server drew it last: the next change may
// come before its answer.  A channel is as the look has it: [0, 'DAPI', 'blue', '#0000ff',
// 10, 200, 1], without a map where it is drawn alone.

/** @typedef {import('./types').Keys} Keys */
/** @typedef {import('./types').Look} Look */
/** @typedef {import('./types').Channel} Channel */
/** @typedef {import('./types').Pair} Pair */

/** What values are of: Hounsfield units, SUV, or what the file says.
 * @param {import('./types').Info} info */
export const unitOf = ({hounsfield, value_unit = ''}) => hounsfield ? 'HU' : value_unit;

/** @param {Readonly<Look>|null} look */
export const mixed = look => Boolean(look?.channels?.[0]?.[2]);

/** Two numbers, or nothing: a range of names is the server's to find.
 * @param {unknown} range
 * @returns {Pair|null} */
export const numbers = range => Array.isArray(range) && range.length === 2 && range.every(Number.isFinite)
    ? [range[0], range[1]] : null;

/** The recipe's channels: the file says what is not known of one.
 * @param {(Channel|[number])[]} channels
 * @returns {{channel: string}} */
export const listed = channels => ({channel: channels.map(([index, , map, , low = 0, high = 0, opacity]) =>
    (map ? [index, map, ...low < high ? [`${low}..${high}`] : [], opacity] : [index]).join(':')).join()});

const CHANNEL = /^(\d+)(?::([^:,]+)(?::(-?[\d.][\d.e+-]*?)\.\.(-?[\d.][\d.e+-]*))?(?::([\d.e-]+))?)?$/;

/** One of the recipe's, with what the look has of it, as far as it is known; null: it is
 * written in another way.
 * @param {string} text
 * @param {Channel[]} drawn
 * @param {boolean} alone
 * @returns {Channel|null} */
function channelOf(text, drawn, alone) {
    const [, index, map, low, high, opacity] = CHANNEL.exec(text) ?? [];
    if (index === undefined)
        return null;
    const old = drawn.find(([k]) => k === Number(index)) ?? [0, '', '', '#808080', 0, 0, 1];
    const [, name, oldMap, oldColor, oldLow, oldHigh, oldOpacity] = old;
    return [Number(index), name, map ?? (alone ? '' : oldMap), map?.startsWith('#') ? map : oldColor,
        low === undefined ? oldLow : Number(low), high === undefined ? oldHigh : Number(high),
        opacity === undefined ? oldOpacity : Number(opacity)];
}

/** @param {Channel[]|undefined} drawn
 * @param {Keys} keys */
function channelsWith(drawn, {channel}) {
    if (!drawn || channel === undefined)
        return drawn;
    const texts = `${channel}`.split(','), all = texts.map(text => channelOf(text, drawn, texts.length < 2));
    return all.every(each => each) ? /** @type {Channel[]} */ (all) : drawn;
}

/** The look of the overlay, "labels,1:#00ff00,0:0,5:0.8", as the keys of the volume's.
 * @param {Keys} keys */
export function overlayKeys({'overlay-look': text = ''}) {
    /** @param {RegExp} test */
    const of = test => text.split(',').filter(part => test.test(part)), name = /#|^[a-eg-z]\D/;
    return {colormap: of(name).join(), opacity: of(/:[^#]/).map(
        part => /** @type {import('./types').Point} */ (part.split(':').map(Number))),
    range: of(/^[^:]+$/).filter(part => !name.test(part))};
}

/** @param {Look['overlay']} overlay
 * @param {Keys} keys */
function overlayWith(overlay, keys) {
    const range = overlay && numbers(overlayKeys(keys).range.map(Number));
    return range ? {.../** @type {NonNullable<Look['overlay']>} */ (overlay), low: range[0], high: range[1]} : overlay;
}

/** Colours at values of their own say what a look spans.
 * @param {Readonly<Look>} look
 * @param {Keys} keys
 * @returns {Readonly<Look>} */
export function lookWith(look, keys) {
    const channels = channelsWith(look.channels, keys), several = mixed({...look, channels});
    const ranged = !several && !keys.colormap?.includes(':');
    const [low, high] = ranged && numbers(keys.range) || [look.low, look.high];
    const own = !several && keys.opacity;
    return {...look, low, high, ...own && {opacity: own, count: own.length},
        channels, overlay: overlayWith(look.overlay, keys)};
}
