// make_models.mjs DIRECTORY: writes the end-to-end tests' models there. Deterministic: the same bytes every time.
import fs from 'node:fs'
import path from 'node:path'
import draco3d from 'draco3d'
import {GltfWriter, png} from './gltf_writer.mjs'
import * as meshes from './meshes.mjs'
import * as formats from './other_formats.mjs'

const directory = process.argv[2]
fs.mkdirSync(directory, {recursive: true})
const save = (name, bytes) => fs.writeFileSync(path.join(directory, name), bytes)

function plain({positions, indices}) {
  const writer = new GltfWriter()
  const small = positions.length / 3 < 65536 ? Uint16Array.from(indices) : indices
  writer.mesh({
    attributes: {POSITION: writer.accessor(positions, 'VEC3', {bounds: true, attribute: true})},
    indices: writer.accessor(small, 'SCALAR'),
  })
  return writer
}

// A checkered cube with normals, texture coordinates and a base colour; the image in a buffer view, or at `imageUri`.
function texturedCube(imageUri) {
  const cube = meshes.cubeWithSeams()
  const writer = new GltfWriter()
  const attribute = (array, type, bounds) => writer.accessor(array, type, {attribute: true, bounds})
  writer.mesh({
    attributes: {POSITION: attribute(cube.positions, 'VEC3', true), NORMAL: attribute(cube.normals, 'VEC3'),
      TEXCOORD_0: attribute(cube.uvs, 'VEC2')},
    indices: writer.accessor(Uint8Array.from(cube.indices), 'SCALAR'),
    material: 0,
  }, {name: 'crate', extras: {owner: 'tests'}})
  const image = imageUri ? {uri: imageUri} : {bufferView: writer.view(checker()), mimeType: 'image/png'}
  Object.assign(writer.json, {
    images: [image], samplers: [{}], textures: [{source: 0, sampler: 0}],
    materials: [{name: 'checker', pbrMetallicRoughness: {baseColorTexture: {index: 0}, metallicFactor: 0}}],
  })
  return writer
}

const checker = () => png(64, 64, (x, y) => ((x >> 3) + (y >> 3)) % 2 ? [220, 40, 40] : [250, 240, 200])

// Positions as 16 bit integers, the scale in the node.
function quantized({positions, indices}) {
  const writer = new GltfWriter()
  const scale = 2 / 32767
  const coarse = Int16Array.from(positions, (x) => Math.round(x / scale))
  writer.mesh({
    attributes: {POSITION: writer.accessor(coarse, 'VEC3', {bounds: true, attribute: true})},
    indices: writer.accessor(Uint16Array.from(indices), 'SCALAR'),
  }, {scale: [scale, scale, scale]})
  Object.assign(writer.json, {extensionsUsed: ['KHR_mesh_quantization'], extensionsRequired: ['KHR_mesh_quantization']})
  return writer
}

// The tetrahedron as one triangle strip, without indices.
function strip() {
  const {positions} = meshes.tetrahedron()
  const order = [0, 2, 1, 3, 0, 2]
  const writer = new GltfWriter()
  const corners = Float32Array.from(order.flatMap((v) => [...positions.subarray(3 * v, 3 * v + 3)]))
  writer.mesh({mode: 5, attributes: {POSITION: writer.accessor(corners, 'VEC3', {bounds: true, attribute: true})}})
  return writer
}

// The tetrahedron whose accessor has no buffer view: all its positions are sparse.
function sparse() {
  const {positions, indices} = meshes.tetrahedron()
  const writer = plain({positions, indices})
  const {count, bufferView} = writer.json.accessors[0]
  const rows = writer.view(Buffer.from(Uint8Array.from({length: count}, (_, i) => i)))
  writer.json.accessors[0] = {...writer.json.accessors[0], bufferView: undefined,
    sparse: {count, indices: {bufferView: rows, componentType: 5121}, values: {bufferView}}}
  return writer
}

async function draco({positions, indices}) {
  const module = await draco3d.createEncoderModule({})
  const builder = new module.MeshBuilder(), mesh = new module.Mesh(), encoder = new module.Encoder()
  builder.AddFacesToMesh(mesh, indices.length / 3, indices)
  const id = builder.AddFloatAttributeToMesh(mesh, module.POSITION, positions.length / 3, 3, positions)
  encoder.SetAttributeQuantization(module.POSITION, 14)
  const out = new module.DracoInt8Array()
  const length = encoder.EncodeMeshToDracoBuffer(mesh, out)
  const bytes = Buffer.from(Int8Array.from({length}, (_, i) => out.GetValue(i)))
  return {bytes, id, encodedVertices: encoder.GetNumberOfEncodedPoints(), encodedFaces: encoder.GetNumberOfEncodedFaces()}
}

function dracoInGltf(surface, {bytes, id}) {
  const writer = new GltfWriter()
  const vertices = surface.positions.length / 3
  const column = (c) => Array.from({length: vertices}, (_, i) => surface.positions[3 * i + c])
  writer.json.accessors.push(
    {componentType: 5126, count: vertices, type: 'VEC3', min: [0, 1, 2].map((c) => Math.min(...column(c))),
      max: [0, 1, 2].map((c) => Math.max(...column(c)))},
    {componentType: 5123, count: surface.indices.length, type: 'SCALAR'})
  writer.mesh({attributes: {POSITION: 0}, indices: 1,
    extensions: {KHR_draco_mesh_compression: {bufferView: writer.view(bytes), attributes: {POSITION: id}}}})
  const name = 'KHR_draco_mesh_compression'
  Object.assign(writer.json, {extensionsUsed: [name], extensionsRequired: [name]})
  return writer
}

const egg = meshes.ellipsoid(3)
save('egg.glb', plain(egg).glb())
save('egg.gltf', plain(egg).gltf())
save('egg-quantized.glb', quantized(egg).glb())
const encoded = await draco(egg)
save('egg.drc', encoded.bytes)
save('egg-draco.glb', dracoInGltf(egg, encoded).glb())
save('tetrahedron.glb', plain(meshes.tetrahedron()).glb())
save('strip.glb', strip().glb())
save('sparse.glb', sparse().glb())
save('crate.glb', texturedCube().glb())
const external = texturedCube('crate colours.png')
save('crate.gltf', external.gltf('crate.bin'))
save('crate.bin', external.bin())
save('crate colours.png', checker())
const library = 'newmtl checker\nKd 1 1 1\nmap_Kd crate colours.png\n'
const crateObj = formats.obj(meshes.cubeWithSeams(), {library: 'crate.mtl', material: 'checker'})
save('crate.obj', crateObj)
save('crate.mtl', library)
save('egg.obj', formats.obj(egg))
save('egg.ply', formats.ply(egg, ([x, y, z]) => [128 + 70 * x, 128 + 120 * y, 128 + 120 * z]))
save('egg.stl', formats.stl(egg))
save('crate-gltf.zip', formats.zip({'crate/crate.gltf': external.gltf('crate.bin'), 'crate/crate.bin': external.bin(),
  'crate/crate colours.png': checker()}))
save('crate-obj.zip', formats.zip({'crate.obj': crateObj, 'crate.mtl': library, 'crate colours.png': checker()}))
save('incomplete.zip', formats.zip({'crate.gltf': external.gltf('crate.bin'), 'crate.bin': external.bin()}))
save('climbing.zip', formats.zip({'egg.obj': formats.obj(egg), '../../egg.mtl': library}))
save('bomb.zip', formats.zip({'egg.obj': formats.obj(egg), 'bomb.bin': Buffer.alloc(64 << 20)}))
save('egg-81920.glb', plain(meshes.ellipsoid(6)).glb())
save('egg-327680.glb', plain(meshes.ellipsoid(7)).glb())

save('torus.glb', plain(meshes.torus()).glb())
save('two-eggs.glb', plain(meshes.together(meshes.ellipsoid(1), meshes.ellipsoid(1))).glb())
save('bowl.glb', plain(meshes.bowl()).glb())
save('shared-edge.glb', plain(meshes.sharedEdge()).glb())
const broken = Float32Array.from(egg.positions)
broken[4] = NaN
save('nan.glb', plain({positions: broken, indices: egg.indices}).glb())
const wild = plain({positions: egg.positions, indices: egg.indices.map((v, i) => (i === 7 ? 60000 : v))})
save('index-out-of-range.glb', wild.glb())
const odd = plain(egg)
Object.assign(odd.json, {extensionsUsed: ['EXT_unheard_of'], extensionsRequired: ['EXT_unheard_of']})
save('required-extension.glb', odd.glb())
save('truncated.glb', plain(egg).glb().subarray(0, 5000))
save('truncated.drc', encoded.bytes.subarray(0, 1000))
save('truncated.gltf', plain(egg).gltf().subarray(0, 5000))

const faces = {px: [230, 60, 60], nx: [60, 200, 200], py: [70, 200, 70], ny: [200, 70, 200], pz: [70, 70, 230], nz: [220, 220, 60]}
for (const [name, rgb] of Object.entries(faces)) save(`${name}.png`, png(64, 64, () => rgb))
save('equirectangular.png', png(128, 64, (x, y) => [2 * x, 4 * y, 128]))
// Noise that repeats: a small linear congruential generator, so that every run sends the same garbage.
const garbage = Buffer.alloc(8 << 20)
for (let i = 0, state = 1; i < garbage.length; ++i) {
  state = (Math.imul(state, 1664525) + 1013904223) >>> 0
  garbage[i] = state >>> 24
}
save('garbage.bin', garbage)
