// Writes small glTF assets: just what the tests' models need, spelled out so that a reader sees every byte's origin.
import zlib from 'node:zlib'

const COMPONENT_TYPE = new Map([
  [Int8Array, 5120], [Uint8Array, 5121], [Int16Array, 5122], [Uint16Array, 5123], [Uint32Array, 5125],
  [Float32Array, 5126],
])
const padded = (length) => (length + 3) & ~3
const bytesOf = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength)

// Collects buffer views and accessors of one asset; `json` is the glTF document that they end up in.
export class GltfWriter {
  constructor() {
    this.chunks = []
    this.length = 0
    this.json = {asset: {version: '2.0'}, scene: 0, scenes: [{nodes: [0]}], nodes: [], meshes: [],
      accessors: [], bufferViews: []}
  }

  // Appends bytes as a buffer view; returns its index.
  view(bytes, properties = {}) {
    this.json.bufferViews.push({buffer: 0, byteOffset: this.length, byteLength: bytes.length, ...properties})
    this.chunks.push(bytes, Buffer.alloc(padded(bytes.length) - bytes.length))
    this.length += padded(bytes.length)
    return this.json.bufferViews.length - 1
  }

  // Appends a typed array as an accessor of `type`; returns its index. Rows of small components are padded to four
  // bytes, as glTF asks of vertex attributes.
  accessor(array, type, {bounds = false, attribute = false, normalized} = {}) {
    const width = {SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4}[type]
    const count = array.length / width
    const rowBytes = width * array.BYTES_PER_ELEMENT
    const stride = attribute ? padded(rowBytes) : rowBytes
    const bytes = Buffer.alloc(count * stride)
    for (let i = 0; i < count; ++i) bytesOf(array.subarray(i * width, (i + 1) * width)).copy(bytes, i * stride)
    const bufferView = this.view(bytes, stride === rowBytes ? {} : {byteStride: stride})
    const accessor = {bufferView, componentType: COMPONENT_TYPE.get(array.constructor), count, type, normalized}
    if (bounds) {
      const column = (c) => Array.from({length: count}, (_, i) => array[i * width + c]).filter((x) => !Number.isNaN(x))
      accessor.min = Array.from({length: width}, (_, c) => column(c).reduce((a, b) => Math.min(a, b)))
      accessor.max = Array.from({length: width}, (_, c) => column(c).reduce((a, b) => Math.max(a, b)))
    }
    this.json.accessors.push(accessor)
    return this.json.accessors.length - 1
  }

  // One node with one mesh of one primitive.
  mesh(primitive, node = {}) {
    this.json.meshes.push({primitives: [primitive]})
    this.json.nodes.push({mesh: this.json.meshes.length - 1, ...node})
    this.json.scenes[0].nodes = this.json.nodes.map((_, i) => i)
  }

  bin() { return Buffer.concat(this.chunks) }

  // glTF JSON whose one buffer lies at `uri`, or in a data URI.
  gltf(uri = 'data:application/octet-stream;base64,' + this.bin().toString('base64')) {
    return Buffer.from(JSON.stringify({...this.json, buffers: [{uri, byteLength: this.length}]}))
  }

  glb() {
    const json = Buffer.from(JSON.stringify({...this.json, buffers: [{byteLength: this.length}]}))
    return glbOf(Buffer.concat([json, Buffer.alloc(padded(json.length) - json.length, ' ')]), this.bin())
  }
}

function glbOf(json, bin) {
  const words = (...values) => bytesOf(Uint32Array.from(values))
  const total = 12 + 8 + json.length + 8 + bin.length
  return Buffer.concat([words(0x46546c67, 2, total), words(json.length, 0x4e4f534a), json, words(bin.length, 0x004e4942), bin])
}

// An 8 bit RGB image as PNG; `colour(x, y)` gives [r, g, b].
export function png(width, height, colour) {
  const rows = Buffer.alloc(height * (1 + 3 * width))
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) rows.set(colour(x, y), y * (1 + 3 * width) + 1 + 3 * x)
  const header = Buffer.alloc(13)
  header.writeUInt32BE(width, 0)
  header.writeUInt32BE(height, 4)
  header.set([8, 2, 0, 0, 0], 8)
  return Buffer.concat([Buffer.from('\x89PNG\r\n\x1a\n', 'latin1'), pngChunk('IHDR', header),
    pngChunk('IDAT', zlib.deflateSync(rows)), pngChunk('IEND', Buffer.alloc(0))])
}

function pngChunk(type, data) {
  const body = Buffer.concat([Buffer.from(type, 'latin1'), data])
  const length = Buffer.alloc(4), crc = Buffer.alloc(4)
  length.writeUInt32BE(data.length)
  crc.writeUInt32BE(crc32(body))
  return Buffer.concat([length, body, crc])
}

export function crc32(bytes) {
  let crc = 0xffffffff
  for (const byte of bytes) {
    crc ^= byte
    for (let bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >>> 1) ^ 0xedb88320 : crc >>> 1
  }
  return (crc ^ 0xffffffff) >>> 0
}
