// corpus.mjs ORBIS DIR OUT [OPTIONS OF orbis run…]: runs every model below DIR through `orbis run` and writes OUT/corpus.tsv
// and OUT/corpus.html, with the previews beside them. Exits 1 where a model crashed the program or hung, got an answer
// that names no reason, or a result that the Khronos validator has something to say about.
import {spawn} from 'node:child_process'
import fs from 'node:fs'
import os from 'node:os'
import path from 'node:path'
import {externalUris} from '../e2e/external_uris.mjs'
import {complaints} from '../e2e/validate.mjs'

const [orbis, folder, out, ...options] = process.argv.slice(2)
const limit = 1800 // seconds for one model: nothing takes that long, not even on a busy machine
const isModel = (name) => /\.(glb|gltf|drc|obj|ply|stl|zip)$/i.test(name)

// --- the models ------------------------------------------------------------------------------------------------------

function modelsBelow(directory) {
  const entries = fs.readdirSync(directory, {withFileTypes: true}).sort((a, b) => (a.name < b.name ? -1 : 1))
  return entries.flatMap((entry) => {
    const file = path.join(directory, entry.name)
    if (entry.isDirectory()) return modelsBelow(file)
    return entry.isFile() && isModel(entry.name) ? [file] : []
  })
}

// The files that a glTF names, where they are there; what lies beside an OBJ and is no model, since its library may name it.
function filesOf(model) {
  const directory = path.dirname(model)
  if (/\.obj$/i.test(model)) {
    return fs.readdirSync(directory, {withFileTypes: true})
      .filter((entry) => entry.isDirectory() || (entry.isFile() && !isModel(entry.name)))
      .flatMap((entry) => ['--attach', path.join(directory, entry.name)])
  }
  if (!/\.gl(tf|b)$/i.test(model)) return []
  const named = externalUris(model).filter((uri) => !uri.includes(':')).map((uri) => path.join(directory, safelyDecoded(uri)))
  return [...new Set(named)].filter((file) => fs.existsSync(file) && fs.statSync(file).isFile()).flatMap((file) => ['--attach', file])
}

function safelyDecoded(uri) {
  try {
    return decodeURIComponent(uri)
  } catch {
    return uri
  }
}

// --- one run ---------------------------------------------------------------------------------------------------------

function run(args) {
  return new Promise((resolve) => {
    const child = spawn(orbis, args, {stdio: ['ignore', 'ignore', 'pipe']})
    let messages = ''
    let hung = false
    const timer = setTimeout(() => { hung = true; child.kill('SIGKILL') }, limit * 1000)
    child.stderr.on('data', (data) => { messages += data })
    child.on('close', (status, signal) => {
      clearTimeout(timer)
      resolve({status, signal, hung, messages})
    })
  })
}

const readJson = (file) => {
  try {
    return JSON.parse(fs.readFileSync(file, 'utf8'))
  } catch {
    return null
  }
}
const parse = (text) => {
  try {
    return JSON.parse(text)
  } catch {
    return null
  }
}

const at = (value, ...keys) => keys.reduce((part, key) => part?.[key], value)
const total = (parts, key) => parts?.reduce((sum, part) => sum + part[key], 0)

function describe(name, result, report, invalid, seconds) {
  const problem = parse(result.messages)
  const outcome = result.hung ? 'HUNG' : result.signal ? 'CRASHED' : invalid.length > 0 ? 'INVALID'
    : result.status === 0 ? (report?.partial ? 'partial' : 'ok') : result.status === 2 ? 'refused' : 'FAILED'
  return {
    model: name,
    result: outcome,
    triangles: at(report, 'input', 'triangles'),
    components: at(report, 'topology', 'components'),
    genus: total(report?.components, 'genus'),
    holes: total(report?.components, 'boundary_loops'),
    repairs: report && Object.entries(report.repairs).filter(([, count]) => count > 0).map(([what, count]) =>
      `${shown(count)} ${what.replaceAll('_', ' ')}`).join(', '),
    folded: at(report, 'certificate', 'folded'),
    dirichlet: at(report, 'distortion', 'symmetric_dirichlet'),
    conformal: at(report, 'distortion', 'quasi_conformal_mean'),
    used: at(report, 'atlas', 'utilisation'),
    // The first percentile of the texel density over the median.
    density: at(report, 'atlas', 'density_median') ? report.atlas.density_p1 / report.atlas.density_median : undefined,
    seconds: report ? report.timing.wall_ms / 1000 : seconds,
    cpu: report ? report.timing.cpu_ms / 1000 : undefined,
    megabytes: report ? report.timing.peak_rss_bytes / 2 ** 20 : undefined,
    notes: report?.notes?.map(({code}) => code).filter((code, i, all) => all.indexOf(code) === i).join(' '),
    problem: problem ? `${problem.status} ${problem.type.replace('/problems/', '')}: ${problem.detail}`
      : result.status === 0 ? invalid.join('; ') : result.messages.trim(),
  }
}

async function process_model(model, number) {
  const picture = `${String(number).padStart(4, '0')}.png`
  const scratch = fs.mkdtempSync(path.join(os.tmpdir(), 'orbis-corpus-'))
  const reportFile = path.join(scratch, 'report.json')
  const started = Date.now()
  const made = path.join(scratch, 'result.glb')
  const result = await run(['run', model, '-o', made, '--report', reportFile, '--preview', path.join(out, picture),
    ...filesOf(model), ...options])
  const seconds = (Date.now() - started) / 1000
  const invalid = result.status === 0 ? await complaints(made, model) : []
  const row = describe(path.relative(folder, model), result, readJson(reportFile), invalid, seconds)
  fs.rmSync(scratch, {recursive: true})
  return {...row, picture: fs.existsSync(path.join(out, picture)) ? picture : ''}
}

// --- the tables ------------------------------------------------------------------------------------------------------

const shown = (value) => {
  if (value === undefined || value === null) return ''
  if (typeof value !== 'number' || Number.isInteger(value)) return String(value)
  return value.toFixed(value < 10 ? 3 : 1)
}
const escaped = (text) => shown(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`)

function tsv(rows) {
  const columns = Object.keys(rows[0])
  return [columns, ...rows.map((row) => columns.map((c) => shown(row[c]).replace(/\s+/g, ' ')))].map((cells) => `${cells.join('\t')}\n`).join('')
}

function html(rows) {
  const columns = Object.keys(rows[0]).filter((c) => c !== 'picture')
  const counts = {}
  for (const {result} of rows) counts[result] = (counts[result] ?? 0) + 1
  const body = rows.map((row) => `<tr class="${row.result}"><td>${row.picture ? `<a href="${row.picture}"><img loading="lazy" src="${row.picture}" alt=""></a>` : ''}</td>${
    columns.map((c) => `<td class="${typeof row[c] === 'number' ? 'number' : ''}">${escaped(row[c])}</td>`).join('')}</tr>`)
  return `<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>orbis: ${escaped(path.basename(path.resolve(folder)))}</title><style>
  body { font: 14px/1.4 system-ui, sans-serif; margin: 1.5rem; color: #16232b; }
  table { border-collapse: collapse; } th, td { padding: .25rem .5rem; border-bottom: 1px solid #c7d3da; text-align: left; vertical-align: top; }
  th { position: sticky; top: 0; background: #fff; } .number { text-align: right; font-variant-numeric: tabular-nums; }
  img { width: 200px; display: block; } .refused { color: #6b5900; } .partial { color: #2a6f97; } .HUNG, .CRASHED, .INVALID, .FAILED { color: #a4243b; font-weight: 600; }
  td:last-child { min-width: 22rem; }
</style></head><body>
<h1>${rows.length} models</h1><p>${Object.entries(counts).map(([result, n]) => `${n} ${result}`).join(', ')}</p>
<table><thead><tr><th></th>${columns.map((c) => `<th>${c}</th>`).join('')}</tr></thead><tbody>
${body.join('\n')}
</tbody></table></body></html>
`
}

// --- the work --------------------------------------------------------------------------------------------------------

fs.mkdirSync(out, {recursive: true})
for (const name of fs.readdirSync(out)) if (/^\d{4}\.png$/.test(name)) fs.rmSync(path.join(out, name))
const rows = []
for (const model of modelsBelow(folder)) {
  const row = await process_model(model, rows.length)
  rows.push(row)
  console.log(`${row.result.padEnd(8)} ${row.seconds.toFixed(1).padStart(6)} s  ${row.model}${row.problem ? `  (${row.problem.slice(0, 160)})` : ''}`)
}
if (rows.length === 0) throw new Error(`there are no models below ${folder}`)
fs.writeFileSync(path.join(out, 'corpus.tsv'), tsv(rows))
fs.writeFileSync(path.join(out, 'corpus.html'), html(rows))
const bad = rows.filter(({result, problem}) => /[A-Z]/.test(result) || (result === 'refused' && !problem))
console.log(`${rows.length - bad.length} answered, ${bad.length} not; ${path.join(out, 'corpus.html')}`)
process.exit(bad.length ? 1 : 0)
