// Compares the TANGENT of a result's normal-mapped primitives with Mikkelsen's own code (npm: mikktspace, WebAssembly).
//
//   npm install --prefix tests mikktspace@1.1.1   # once; not among the tests' packages
//   node tests/bench/mikktspace.mjs RESULT.glb
//
// Prints, for each primitive, how many corners of triangles there are, how many differ by more than a tenth of a degree or
// in handedness, and the largest angle. glTF's v runs down and MikkTSpace's up, so the sign of w is turned.
import {readFileSync} from 'node:fs';
import {createRequire} from 'node:module';

const {generateTangents} = createRequire(new URL('../package.json', import.meta.url))('mikktspace');

const file = readFileSync(process.argv[2]);
const jsonBytes = file.readUInt32LE(12);
const gltf = JSON.parse(file.subarray(20, 20 + jsonBytes).toString());
const binary = file.subarray(20 + jsonBytes + 8);
const components = {SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4};
const readers = {
  5120: [1, (view, at) => Math.max(view.getInt8(at) / 127, -1)],
  5121: [1, (view, at) => view.getUint8(at)],
  5122: [2, (view, at) => Math.max(view.getInt16(at, true) / 32767, -1)],
  5123: [2, (view, at) => view.getUint16(at, true)],
  5125: [4, (view, at) => view.getUint32(at, true)],
  5126: [4, (view, at) => view.getFloat32(at, true)],
};

function read(number) {
  const accessor = gltf.accessors[number], view = gltf.bufferViews[accessor.bufferView];
  const count = components[accessor.type], [size, get] = readers[accessor.componentType];
  const data = new DataView(binary.buffer, binary.byteOffset + (view.byteOffset ?? 0) + (accessor.byteOffset ?? 0));
  const stride = view.byteStride ?? size * count;
  const out = new Float64Array(accessor.count * count);
  for (let i = 0; i < accessor.count; ++i) {
    for (let c = 0; c < count; ++c) out[i * count + c] = get(data, i * stride + c * size);
  }
  return out;
}

const atCorners = (values, indices, count) =>
    Float32Array.from({length: indices.length * count}, (_, i) => values[indices[Math.floor(i / count)] * count + i % count]);

for (const mesh of gltf.meshes) {
  for (const {attributes, indices, material} of mesh.primitives) {
    const info = gltf.materials?.[material]?.normalTexture;
    if (!info || attributes.TANGENT === undefined) continue;
    const corners = read(indices);
    const own = atCorners(read(attributes.TANGENT), corners, 4);
    const theirs = generateTangents(atCorners(read(attributes.POSITION), corners, 3),
                                    atCorners(read(attributes.NORMAL), corners, 3),
                                    atCorners(read(attributes[`TEXCOORD_${info.texCoord ?? 0}`]), corners, 2));
    let differ = 0, mirrored = 0, largest = 0;
    for (let i = 0; i < corners.length; ++i) {
      const dot = own[4 * i] * theirs[4 * i] + own[4 * i + 1] * theirs[4 * i + 1] + own[4 * i + 2] * theirs[4 * i + 2];
      const angle = Math.acos(Math.min(Math.max(dot, -1), 1)) * 180 / Math.PI;
      if (angle > 0.1) ++differ;
      if (own[4 * i + 3] !== -theirs[4 * i + 3]) ++mirrored;
      largest = Math.max(largest, angle);
    }
    console.log(`${mesh.name ?? 'mesh'}: ${corners.length} corners, ${differ} differ, ${mirrored} mirrored, ` +
                `largest angle ${largest.toFixed(3)} degrees`);
  }
}
