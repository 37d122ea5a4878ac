// vti.js - image data in VTK's XML files (.vti) for the engine, which has no reader of
// XML: a browser has.  Such a file becomes one of NRRD under the same name.  Files that are
// not understood here stay as they are, and the engine says what it lacks.

const TEXT_MOST = 1 << 29; // bytes of a text that a browser takes

const VTK_TYPES = {Int8: ['int8', 1], UInt8: ['uint8', 1], Int16: ['int16', 2], UInt16: ['uint16', 2],
    Int32: ['int32', 4], UInt32: ['uint32', 4], Int64: ['int64', 8], UInt64: ['uint64', 8],
    Float32: ['float', 4], Float64: ['double', 8]};

const numbersOf = (element, name, usual) => (element.getAttribute(name) ?? usual).trim().split(/\s+/).map(Number);

/** Bytes from a place of a Blob; of base64, where groups may have ends of their own, the
 * place is a letter. */
async function bytesAt(data, coded, from, size) {
    if (!coded)
        return new Uint8Array(await data.slice(from, from + size).arrayBuffer());
    const text = await data.slice(from, from + 4 * Math.ceil(size / 3)).text();
    return Uint8Array.from((text.match(/[^=]+=*/g) ?? []).map(atob).join(''), each => each.charCodeAt());
}

const inflated = packed => new Response(packed.stream()
    .pipeThrough(new DecompressionStream('deflate'))).arrayBuffer();

/** Where the text ends, and what follows begins. */
async function endOfText(file) {
    const PIECE = 1 << 20, TAG = '<AppendedData';
    for (let at = 0; at < file.size; at += PIECE - 256) {
        const text = new TextDecoder('latin1').decode(await file.slice(at, at + PIECE).arrayBuffer());
        const tag = text.indexOf(TAG), begin = tag < 0 ? -1 : text.indexOf('_', text.indexOf('>', tag));
        if (begin >= 0)
            return [at + tag, at + begin + 1];
    }
    return [file.size, file.size];
}

/** The array that the file calls its scalars, or its first one. */
function arrayOf(piece) {
    for (const kind of ['PointData', 'CellData']) {
        const section = piece.getElementsByTagName(kind)[0];
        const arrays = [...section?.getElementsByTagName('DataArray') ?? []];
        const name = section?.getAttribute('Scalars');
        const array = arrays.find(each => each.getAttribute('Name') === name) ?? arrays[0];
        if (array)
            return [array, kind === 'CellData'];
    }
    return [];
}

/** The numbers from a place of a Blob: counts, then bytes or blocks of zlib. */
async function voxelsOf(data, at, {wide, little, packed, coded}) {
    const width = wide ? 8 : 4;
    const counts = async length => {
        const view = new DataView((await bytesAt(data, coded, at, length * width)).buffer);
        return Array.from({length}, (_, i) => wide ? Number(view.getBigUint64(8 * i, little))
            : view.getUint32(4 * i, little));
    };
    const [count] = await counts(1);
    if (!packed)
        return coded ? [(await bytesAt(data, coded, at, width + count)).subarray(width)]
            : [data.slice(at + width, at + width + count)];
    const sizes = (await counts(3 + count)).slice(3), total = sizes.reduce((sum, size) => sum + size, 0);
    const head = (3 + count) * width, begin = at + (coded ? 4 * Math.ceil(head / 3) : head);
    const all = coded ? new Blob([await bytesAt(data, coded, begin, total)]) : data.slice(begin, begin + total);
    const blocks = [];
    let from = 0;
    for (const size of sizes) {
        blocks.push(await inflated(all.slice(from, from + size)));
        from += size;
    }
    return blocks;
}

/** The head of an array in NRRD: an axis of one cell is flat, and its centre is the point. */
function headOf(grid, whole, cells, array, little) {
    const [type] = VTK_TYPES[array.getAttribute('type')], form = array.getAttribute('format');
    const [spacing, origin, direction] = [['Spacing', '1 1 1'], ['Origin', '0 0 0'],
        ['Direction', '1 0 0 0 1 0 0 0 1']].map(([name, usual]) => numbersOf(grid, name, usual));
    const wide = [0, 1, 2].map(i => cells && whole[2 * i + 1] > whole[2 * i]);
    const dims = wide.map((shrinks, i) => whole[2 * i + 1] - whole[2 * i] + (shrinks ? 0 : 1));
    const step = [0, 1, 2].map(j => [0, 1, 2].map(i => direction[3 * i + j] * spacing[j]));
    const corner = origin.map((at, i) => step.reduce((sum, each, j) => sum + each[i] * (whole[2 * j] +
        (wide[j] ? 0.5 : 0)), at));
    const list = numbers => `(${numbers.join(',')})`, components = Number(array.getAttribute('NumberOfComponents') ?? 1);
    const [axis, size, none, kinds] = components > 1
        ? [4, `${components} `, 'none ', 'kinds: vector domain domain domain\n'] : [3, '', '', ''];
    return {count: dims.reduce((a, b) => a * b, components), text: `NRRD0005\ntype: ${type}\ndimension: ${axis}\n` +
        `space dimension: 3\nsizes: ${size}${dims.join(' ')}\nspace directions: ${none}${step.map(list).join(' ')}\n` +
        `space origin: ${list(corner)}\n${kinds}endian: ${little ? 'little' : 'big'}\n` +
        `encoding: ${form === 'ascii' ? 'ascii' : 'raw'}\n\n`};
}

/** A file of NRRD with what one of VTI has, or null. */
async function nrrdOf(file) {
    const [end, begin] = await endOfText(file);
    if (end > TEXT_MOST)
        return null;
    const text = await file.slice(0, end).text();
    const tree = new DOMParser().parseFromString(end < file.size
        ? `${text}<AppendedData/></VTKFile>` : text, 'text/xml');
    const root = tree.documentElement, grid = root.getElementsByTagName('ImageData')[0];
    const pieces = grid?.getElementsByTagName('Piece') ?? [];
    const whole = grid && numbersOf(grid, 'WholeExtent', '');
    if (pieces.length !== 1 || `${numbersOf(pieces[0], 'Extent', '')}` !== `${whole}`)
        return null;
    const [array, cells] = arrayOf(pieces[0]), [type, width] = VTK_TYPES[array?.getAttribute('type')] ?? [];
    const compressor = root.getAttribute('compressor');
    if (!type || (compressor && compressor !== 'vtkZLibDataCompressor'))
        return null;
    const form = array.getAttribute('format'), little = root.getAttribute('byte_order') !== 'BigEndian';
    const {text: head, count} = headOf(grid, whole, cells, array, little);
    if (form === 'ascii')
        return new Blob([head, array.textContent]);
    const coding = /encoding\s*=\s*["'](\w+)/.exec(await file.slice(end, begin).text())?.[1];
    const how = {wide: root.getAttribute('header_type') === 'UInt64', little, packed: !!compressor,
        coded: form === 'binary' || coding === 'base64'};
    const voxels = form === 'appended' ? await voxelsOf(file, begin + Number(array.getAttribute('offset')), how)
        : await voxelsOf(new Blob([array.textContent.replace(/\s+/g, '')]), 0, how);
    const bytes = voxels.reduce((sum, each) => sum + (each.size ?? each.byteLength), 0);
    return bytes === width * count ? new Blob([head, ...voxels]) : null;
}

/** A volume's files as the engine opens them. */
export const readable = ({files, path}) => Promise.all(files.map(async each => {
    if (!each.file || each.name !== path || !/\.vti$/i.test(path))
        return each;
    return {...each, file: await nrrdOf(each.file).catch(() => null) ?? each.file};
}));
