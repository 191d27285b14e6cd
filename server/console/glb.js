// glb.js -- reads the binary glTF that the daemon makes: its nodes' arrays, and its extras.

const NUMBERS = { 5121: Uint8Array, 5123: Uint16Array, 5125: Uint32Array, 5126: Float32Array };
const PARTS = { SCALAR: 1, VEC3: 3, VEC4: 4 };

/** What there is to see in a response: a file's nodes and extras, or without one the JSON as extras. */
export const readSeen = (response) => (response instanceof ArrayBuffer ? readGlb(response) : { extras: response, nodes: null });

/** Where a file's (ArrayBuffer) arrays begin, and what it says of them. */
export function openGlb(file) {
  const head = new DataView(file);
  if (head.byteLength < 20 || head.getUint32(0, true) !== 0x46546c67)
    throw new Error("the response is no 3D file");
  const size = head.getUint32(12, true);
  const document = JSON.parse(new TextDecoder().decode(new Uint8Array(file, 20, size)));
  return { document, start: 20 + size + 8 };
}

/** Parses a file into {extras, nodes: {name: {at, index, color, _GAP_MM, ...}}}. */
export function readGlb(file) {
  const { document, start } = openGlb(file);
  const array = (number) => {
    const accessor = document.accessors[number];
    const view = document.bufferViews[accessor.bufferView];
    return new NUMBERS[accessor.componentType](
      file, start + view.byteOffset, accessor.count * PARTS[accessor.type]);
  };
  const nodes = {};
  for (const node of document.nodes) {
    const part = document.meshes[node.mesh].primitives[0];
    const { POSITION, COLOR_0, ...values } = part.attributes;
    const out = { at: array(POSITION) };
    if (part.indices !== undefined) out.index = array(part.indices);
    if (COLOR_0 !== undefined) out.color = array(COLOR_0);
    for (const name in values) out[name] = array(values[name]);
    nodes[node.name] = out;
  }
  return { extras: document.extras, nodes };
}
