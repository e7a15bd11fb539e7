// validate.mjs FILE...: the Khronos validator's errors and warnings, one a line; exits 1 when there is one.
import fs from 'node:fs'
import path from 'node:path'
import validator from 'gltf-validator'

const names = ['error', 'warning']
let found = 0
for (const file of process.argv.slice(2)) {
  const directory = path.dirname(file)
  const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
    maxIssues: 100,
    externalResourceFunction: async (uri) => new Uint8Array(fs.readFileSync(path.join(directory, decodeURIComponent(uri)))),
  })
  for (const {severity, code, message, pointer} of report.issues.messages.filter(({severity}) => severity < 2)) {
    ++found
    console.log(`${path.basename(file)}: ${names[severity]} ${code} at ${pointer ?? 'offset'}: ${message}`)
  }
}
process.exit(found ? 1 : 0)
