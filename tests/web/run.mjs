// run.mjs ORBIS OUT [PATTERN]: models go through orbis and come back to programs of others: gltf-transform reads and
// re-writes each result without complaint, and three.js in headless Chromium shows the same model before and after. The
// pictures (before, after, four times the difference) are in OUT. PATTERN is part of a model's path; "made" takes those
// that need no collection, "page" only the service's own page. The last line counts the tests.
import {execFileSync, spawnSync} from 'node:child_process'
import fs from 'node:fs'
import os from 'node:os'
import path from 'node:path'
import {fileURLToPath} from 'node:url'
import {externalUris} from '../e2e/external_uris.mjs'
import {roundTrip} from './round_trip.mjs'
import {testPage} from './service_page.mjs'
import {Stage} from './stage.mjs'

const here = path.dirname(fileURLToPath(import.meta.url))
const [orbis, out, pattern = ''] = process.argv.slice(2)
const scratch = fs.mkdtempSync(path.join(os.tmpdir(), 'orbis-web-'))
process.on('exit', () => fs.rmSync(scratch, {recursive: true}))

// Measured over these models: silhouettes agree to 0.9995 or better, the colours of a texture that was sampled anew to 3
// levels of 255 or better in the mean. A texture that is turned, mirrored or shifted is off by tens of levels.
const leastOverlap = 0.995, greatestDifference = 8

// --- the models ------------------------------------------------------------------------------------------------------

const made = path.join(scratch, 'made')
execFileSync(process.execPath, [path.join(here, '../e2e/make_models.mjs'), made])
const madeModels = ['crate.glb', 'crate.gltf', 'egg-quantized.glb', 'egg-draco.glb', 'strip.glb', 'sparse.glb', 'torus.glb', 'two-eggs.glb',
  'bowl.glb', 'shared-edge.glb'].map((name) => path.join(made, name))

// The collection of real models beside the checkout, where it is there: all but those that are broken, or damaged on purpose.
const shared = path.join(here, '../../../shared/data')
function glTFsBelow(directory) {
  if (!fs.existsSync(directory)) return []
  return fs.readdirSync(directory, {withFileTypes: true}).sort((a, b) => (a.name < b.name ? -1 : 1)).flatMap((entry) => {
    const file = path.join(directory, entry.name)
    return entry.isDirectory() ? glTFsBelow(file) : /\.gl(b|tf)$/.test(entry.name) ? [file] : []
  })
}
const sharedModels = ['anim', 'closed0', 'ext', 'genus', 'multi', 'nonmanifold', 'open'].flatMap((folder) => glTFsBelow(path.join(shared, folder)))

// Runs orbis on a model with the files beside it; nothing where it was refused.
function textured(model) {
  const result = path.join(scratch, `${path.basename(model)}.orbis.glb`), report = path.join(scratch, 'report.json')
  const files = externalUris(model).map((uri) => path.join(path.dirname(model), decodeURIComponent(uri)))
    .filter((file) => fs.existsSync(file)).flatMap((file) => ['--attach', file])
  const run = spawnSync(orbis, ['run', model, '-o', result, '--report', report, '--texture-size', '2048',
    ...files], {encoding: 'utf8'})
  if (run.status === 0) return {result, report: JSON.parse(fs.readFileSync(report, 'utf8'))}
  if (run.status === 2) return {refused: JSON.parse(run.stderr).detail}
  throw new Error(`orbis ended with ${run.status ?? run.signal}: ${run.stderr}`)
}

// --- the tests -------------------------------------------------------------------------------------------------------

const counts = {passed: 0, failed: 0, skipped: 0}
function tell(outcome, sentence, reason = '') {
  ++counts[outcome]
  console.log(`${{passed: 'ok     ', failed: 'FAILED ', skipped: 'skipped'}[outcome]} ${sentence}${reason ? `: ${reason}` : ''}`)
}

async function test(sentence, action) {
  try {
    tell('passed', sentence, await action())
  } catch (error) {
    tell('failed', sentence, error.message)
  }
}

fs.mkdirSync(out, {recursive: true})
const stage = await Stage.open({three: path.join(here, 'node_modules/three'), page: here})
for (const model of [...madeModels, ...sharedModels].filter((model) => model.includes(pattern))) {
  const name = path.basename(model)
  const {result, report, refused} = textured(model)
  if (refused) {
    tell('skipped', name, refused)
    continue
  }
  await test(`gltf-transform finds the same surface, and re-writes ${name}`, () => roundTrip(model, result))
  await test(`three.js shows the same ${name}`, async () => {
    const {covered, overlap, difference, picture} = await stage.compare(model, result)
    fs.writeFileSync(path.join(out, `${path.basename(path.dirname(model))}-${name}.png`), picture)
    const measured = `silhouettes ${(100 * overlap).toFixed(2)} % common, colours ${difference.toFixed(1)} apart`
    if (covered < 1000) throw new Error(`nothing is to be seen (${covered} pixels)`)
    const sameColours = report.atlas.source === 'base_color'
    if (overlap < leastOverlap || (sameColours && difference > greatestDifference)) throw new Error(measured)
    return sameColours ? measured : `${measured} (the pattern was asked for)`
  })
}
if (['', 'page', 'made'].includes(pattern)) {
  await testPage({orbis: path.resolve(orbis), browser: stage.browser, models: made, refused: path.join(made, 'nan.glb'), scratch, out}, test)
}
await stage.close()
console.log(`${counts.passed} passed, ${counts.failed} failed${counts.skipped ? `, ${counts.skipped} skipped` : ''}`)
process.exit(counts.failed ? 1 : 0)
