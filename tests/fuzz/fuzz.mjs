// fuzz.mjs BINARY [ROUNDS [FIRST_SEED]]: damaged models through `orbis run`. Whatever comes in, the program ends by itself
// within a minute, with a result (0) or a problem document (2); a crash, a hang or anything else is a failure. Round n uses
// seed FIRST_SEED + n, so a failure can be had again: fuzz.mjs BINARY 1 SEED. Failing inputs are kept in out/fuzz.
import fs from 'node:fs'
import os from 'node:os'
import path from 'node:path'
import {spawn, spawnSync} from 'node:child_process'
import {mutate, randomSource} from './mutations.mjs'

const [binary, rounds = '200', firstSeed = '1'] = process.argv.slice(2)
const here = path.dirname(new URL(import.meta.url).pathname)
const work = fs.mkdtempSync(path.join(os.tmpdir(), 'orbis-fuzz-'))
const kept = path.resolve(here, '../../out/fuzz')
process.on('exit', () => fs.rmSync(work, {recursive: true}))

const models = path.join(work, 'models')
if (spawnSync('node', [path.join(here, '../e2e/make_models.mjs'), models], {stdio: 'inherit'}).status !== 0) process.exit(1)
const seeds = ['tetrahedron.glb', 'strip.glb', 'sparse.glb', 'crate.glb', 'egg.gltf', 'egg-quantized.glb', 'egg-draco.glb', 'egg.drc']
  .map((name) => ({name, bytes: fs.readFileSync(path.join(models, name))}))

// Runs orbis on the input; resolves to 0, 2, or a description of what else happened.
function run(input) {
  return new Promise((resolve) => {
    const output = `${input}.out.glb`
    const child = spawn(binary, ['run', input, '-o', output, '--texture-size', '64'], {stdio: ['ignore', 'ignore', 'pipe']})
    let errors = ''
    let late = false
    const timer = setTimeout(() => { late = true; child.kill('SIGKILL') }, 60_000)
    child.stderr.on('data', (text) => { errors += text })
    child.on('close', (code, signal) => {
      clearTimeout(timer)
      fs.rmSync(output, {force: true})
      if (late) resolve('did not end within a minute')
      else if (signal) resolve(`was ended by ${signal}`)
      else if (code === 2 && !errors.includes('/problems/')) resolve(`refused without a problem document: ${errors}`)
      else resolve(code === 0 || code === 2 ? code : `exited with ${code}: ${errors.slice(0, 500)}`)
    })
  })
}

const tally = {passed: 0, failed: 0, textured: 0}
async function round(seed) {
  const random = randomSource(seed)
  const {name, bytes} = random.pick(seeds)
  const input = path.join(work, `${seed}-${name}`)
  fs.writeFileSync(input, mutate(bytes, random))
  const outcome = await run(input)
  if (outcome === 0 || outcome === 2) {
    ++tally.passed
    if (outcome === 0) ++tally.textured
  } else {
    ++tally.failed
    fs.mkdirSync(kept, {recursive: true})
    fs.copyFileSync(input, path.join(kept, path.basename(input)))
    console.log(`FAILED  seed ${seed} (${name}): ${outcome}; kept as out/fuzz/${path.basename(input)}`)
  }
  fs.rmSync(input)
}

let next = Number(firstSeed)
const end = next + Number(rounds)
await Promise.all(Array.from({length: os.cpus().length}, async () => {
  while (next < end) await round(next++)
}))
console.log(`${rounds} damaged models: ${tally.textured} could still be textured, the others were refused`)
// The whole campaign counts as one test; each failing input as one failure.
console.log(`${tally.failed ? 0 : 1} passed, ${tally.failed} failed`)
process.exit(tally.failed ? 1 : 0)
