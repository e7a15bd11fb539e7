// The same surfaces as OBJ, PLY, STL and zip.
import zlib from 'node:zlib'
import {crc32} from './gltf_writer.mjs'

const rows = (array, width) => Array.from({length: array.length / width}, (_, i) => Array.from(array.subarray(width * i, width * (i + 1))))

// OBJ with a material library; texture coordinates and normals where the surface has them.
export function obj({positions, uvs, normals, indices}, {library, material} = {}) {
  const corner = (v) => (uvs ? `${v + 1}/${v + 1}/${v + 1}` : `${v + 1}`)
  return [
    ...(library ? [`mtllib ${library}`] : []),
    ...rows(positions, 3).map((p) => `v ${p.join(' ')}`),
    ...(uvs ? rows(uvs, 2).map(([u, v]) => `vt ${u} ${1 - v}`) : []), // counted upward here
    ...(normals ? rows(normals, 3).map((n) => `vn ${n.join(' ')}`) : []),
    ...(material ? [`usemtl ${material}`] : []),
    ...rows(indices, 3).map((face) => `f ${face.map(corner).join(' ')}`),
  ].join('\n') + '\n'
}

// Binary PLY; each vertex has the colour that `colour` gives for its position.
export function ply({positions, indices}, colour) {
  const vertices = positions.length / 3, faces = indices.length / 3
  const header = `ply\nformat binary_little_endian 1.0\nelement vertex ${vertices}\n${
    ['x', 'y', 'z'].map((c) => `property float ${c}\n`).join('')}${
    ['red', 'green', 'blue'].map((c) => `property uchar ${c}\n`).join('')}element face ${faces}\nproperty list uchar int vertex_indices\nend_header\n`
  const body = Buffer.alloc(15 * vertices + 13 * faces)
  rows(positions, 3).forEach((p, v) => {
    p.forEach((x, c) => body.writeFloatLE(x, 15 * v + 4 * c))
    body.set(colour(p), 15 * v + 12)
  })
  rows(indices, 3).forEach((face, f) => {
    const at = 15 * vertices + 13 * f
    body.writeUInt8(3, at)
    face.forEach((v, c) => body.writeInt32LE(v, at + 1 + 4 * c))
  })
  return Buffer.concat([Buffer.from(header), body])
}

export function stl({positions, indices}) {
  const out = Buffer.alloc(84 + (50 * indices.length) / 3)
  out.writeUInt32LE(indices.length / 3, 80)
  indices.forEach((v, i) => {
    for (let c = 0; c < 3; ++c) out.writeFloatLE(positions[3 * v + c], 84 + 50 * Math.floor(i / 3) + 12 + 12 * (i % 3) + 4 * c)
  })
  return out
}

// {name: bytes} as a zip of deflated members.
export function zip(members) {
  const parts = [], directory = []
  let offset = 0
  for (const [name, given] of Object.entries(members)) {
    const contents = Buffer.from(given)
    const packed = zlib.deflateRawSync(contents)
    const common = Buffer.alloc(26)
    common.writeUInt16LE(20, 0)
    common.writeUInt16LE(8, 4)
    common.writeUInt32LE(0x00210000, 6)
    common.writeUInt32LE(crc32(contents), 10)
    common.writeUInt32LE(packed.length, 14)
    common.writeUInt32LE(contents.length, 18)
    common.writeUInt16LE(Buffer.byteLength(name), 22)
    const where = Buffer.alloc(14)
    where.writeUInt32LE(offset, 10)
    parts.push(Buffer.from('PK\x03\x04'), common, Buffer.from(name), packed)
    directory.push(Buffer.from('PK\x01\x02\x14\x00', 'latin1'), common, where, Buffer.from(name))
    offset += 30 + Buffer.byteLength(name) + packed.length
  }
  const entries = Buffer.concat(directory), end = Buffer.alloc(22)
  end.write('PK\x05\x06', 0, 'latin1')
  end.writeUInt16LE(Object.keys(members).length, 8)
  end.writeUInt16LE(Object.keys(members).length, 10)
  end.writeUInt32LE(entries.length, 12)
  end.writeUInt32LE(offset, 16)
  return Buffer.concat([...parts, entries, end])
}
