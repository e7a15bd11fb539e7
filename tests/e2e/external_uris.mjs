// external_uris.mjs FILE: the external files that a .gltf or .glb names, one a line, as the URI has them.
import fs from 'node:fs'
import {fileURLToPath} from 'node:url'

export function externalUris(file) {
  const bytes = fs.readFileSync(file)
  const isGlb = bytes.toString('latin1', 0, 4) === 'glTF' && bytes.length >= 20
  const text = isGlb ? bytes.toString('utf8', 20, 20 + bytes.readUInt32LE(12)) : bytes.toString('utf8')
  let document = null
  try {
    document = JSON.parse(text)
  } catch {
    // A broken file names nothing.
  }
  const list = (value) => (Array.isArray(value) ? value : [])
  return [...list(document?.buffers), ...list(document?.images)].map((part) => part?.uri)
    .filter((uri) => typeof uri === 'string' && !uri.startsWith('data:'))
}

if (process.argv[1] === fileURLToPath(import.meta.url)) for (const uri of externalUris(process.argv[2])) console.log(uri)
