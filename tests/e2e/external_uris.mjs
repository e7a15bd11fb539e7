// external_uris.mjs FILE: the external files that a .gltf or .glb names, one a line, as the URI has them.
import fs from 'node:fs'

const bytes = fs.readFileSync(process.argv[2])
const isGlb = bytes.toString('latin1', 0, 4) === 'glTF'
const text = isGlb ? bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)) : bytes.toString('utf8')
let document = {}
try {
  document = JSON.parse(text)
} catch {
  // A broken file names nothing.
}
for (const {uri} of [...(document.buffers ?? []), ...(document.images ?? [])])
  if (typeof uri === 'string' && !uri.startsWith('data:')) console.log(uri)
