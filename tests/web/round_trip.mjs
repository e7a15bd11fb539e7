// A result through gltf-transform: it holds the input's surface; read, written and read again, it must stay what it is,
// and nothing may be said about it that was not said about the input.
import {NodeIO} from '@gltf-transform/core'
import {ALL_EXTENSIONS} from '@gltf-transform/extensions'
import draco3d from 'draco3d'
import {MeshoptDecoder, MeshoptEncoder} from 'meshoptimizer'
import {expectSameSurface} from './same_surface.mjs'

// Keeps what is worth a warning.
class Listener {
  heard = []
  debug() {}
  info() {}
  warn(text) { this.heard.push(text) }
  error(text) { this.heard.push(text) }
}

async function reader(listener) {
  await Promise.all([MeshoptDecoder.ready, MeshoptEncoder.ready])
  return new NodeIO().setLogger(listener).registerExtensions(ALL_EXTENSIONS).registerDependencies({
    'draco3d.decoder': await draco3d.createDecoderModule(),
    'draco3d.encoder': await draco3d.createEncoderModule(),
    'meshopt.decoder': MeshoptDecoder,
    'meshopt.encoder': MeshoptEncoder,
  })
}

// What must be the same before and after.
function summary(document) {
  const root = document.getRoot()
  return JSON.stringify({
    scenes: root.listScenes().length, nodes: root.listNodes().map((node) => node.getName()), cameras: root.listCameras().length,
    skins: root.listSkins().length, animations: root.listAnimations().map((animation) => animation.listChannels().length),
    meshes: root.listMeshes().map((mesh) => mesh.listPrimitives().map((primitive) =>
      [primitive.getMode(), primitive.getIndices()?.getCount(), primitive.listSemantics().sort(), primitive.listTargets().length])),
  })
}

// The input as gltf-transform sees it; nothing where it needs an extension that gltf-transform does not know.
async function originalOf(input, listener) {
  try {
    return await (await reader(listener)).read(input)
  } catch (error) {
    if (!error.message.startsWith('Missing required extension')) throw error
    return undefined
  }
}

export async function roundTrip(input, output) {
  const before = new Listener()
  const original = await originalOf(input, before)
  const listener = new Listener()
  const io = await reader(listener)
  const document = await io.read(output)
  const again = await io.readBinary(await io.writeBinary(document))
  const news = listener.heard.filter((text) => !before.heard.includes(text))
  if (news.length > 0) throw new Error(news.join('; '))
  if (summary(again) !== summary(document)) throw new Error('it is not the same after being written and read again')
  return original ? expectSameSurface(original, document) : 'the input itself cannot be read there'
}
