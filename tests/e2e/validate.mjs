// validate.mjs FILE [INPUT]: the Khronos validator's errors and warnings about FILE, one a line; exits 1 when there is one.
// A warning that INPUT, the model that FILE was made from, gets too is the model's own and is passed over.
import fs from 'node:fs'
import path from 'node:path'
import {fileURLToPath} from 'node:url'
import validator from 'gltf-validator'

async function issues(file) {
  const directory = path.dirname(file)
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    maxIssues: 100,
    externalResourceFunction: async (uri) => new Uint8Array(fs.readFileSync(path.join(directory, decodeURIComponent(uri)))),
  })
  return report.issues.messages.filter(({severity}) => severity < 2)
}

const isGltf = (name) => /\.gl(b|tf)$/i.test(name)
// The validator does not know KHR_texture_basisu. A model that names its KTX2 images as plain sources keeps them so.
const isKtx2 = ({code, message}) =>
  ['VALUE_NOT_IN_LIST', 'TEXTURE_INVALID_IMAGE_MIME_TYPE'].includes(code) && message.includes("'image/ktx2'")

// A sentence for each thing that is wrong with `file` and was not wrong with `input` already.
export async function complaints(file, input) {
  const inherited = new Set(
    input && isGltf(input) ? (await issues(input)).filter(({severity}) => severity === 1).map(({code}) => code) : [])
  return (await issues(file)).filter((issue) => !inherited.has(issue.code) && !isKtx2(issue)).map(({severity, code, message, pointer}) =>
    `${['error', 'warning'][severity]} ${code} at ${pointer || 'the file'}: ${message}`)
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [file, input] = process.argv.slice(2)
  const ours = await complaints(file, input)
  for (const complaint of ours) console.log(`${path.basename(file)}: ${complaint}`)
  process.exit(ours.length ? 1 : 0)
}
