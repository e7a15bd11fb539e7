// Ways to damage a model, each driven by a seeded random source so that a seed always gives the same bytes.

// Mulberry32: a small, well mixed 32 bit generator.
export function randomSource(seed) {
  let state = seed >>> 0
  const next = () => {
    state = (state + 0x6d2b79f5) >>> 0
    let t = Math.imul(state ^ (state >>> 15), state | 1)
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61)
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32
  }
  return {below: (n) => Math.floor(next() * n), pick: (list) => list[Math.floor(next() * list.length)]}
}

function flipBits(bytes, random) {
  const damaged = Buffer.from(bytes)
  for (let n = 1 + random.below(16); n > 0; --n) damaged[random.below(damaged.length)] ^= 1 << random.below(8)
  return damaged
}

const truncate = (bytes, random) => bytes.subarray(0, random.below(bytes.length))

// A run of bytes copied from one place to another, over what is there.
function smear(bytes, random) {
  const damaged = Buffer.from(bytes)
  const from = random.below(bytes.length)
  bytes.copy(damaged, random.below(bytes.length), from, from + 1 + random.below(64))
  return damaged
}

const words = [0, 1, -1, 0x7fffffff, -0x80000000, 0x7f800000, 0x7fc00000, 0x00ffffff]
function setWord(bytes, random) {
  const damaged = Buffer.from(bytes)
  damaged.writeInt32LE(random.pick(words) | 0, 4 * random.below(Math.floor(bytes.length / 4)))
  return damaged
}

// Damage inside the JSON that leaves it JSON: it gets past the parser, to the code that believes it.
function damageJson(bytes, random) {
  const {json, rest} = splitGltf(bytes)
  if (!json) return flipBits(bytes, random)
  for (let n = 1 + random.below(3); n > 0; --n) damageOneValue(json, random)
  return joinGltf(json, rest)
}

const oddValues = [0, 1, -1, 2, 3, 255, 65535, 2 ** 31 - 1, 2 ** 31, 2 ** 32 - 1, 2 ** 53, 1e308, 0.5, null, true, '', 'VEC3',
  'SCALAR', [], {}, [0, 0, 0], 5120, 5123, 5126]
function damageOneValue(json, random) {
  const places = []
  const walk = (value) => {
    if (value === null || typeof value !== 'object') return
    for (const key of Object.keys(value)) {
      places.push([value, key])
      walk(value[key])
    }
  }
  walk(json)
  if (places.length === 0) return
  const [owner, key] = random.pick(places)
  if (random.below(4) > 0) owner[key] = random.pick(oddValues)
  else if (Array.isArray(owner)) owner.push(owner[key])
  else delete owner[key]
}

// The JSON of a .glb or .gltf and, of a .glb, what follows it; no JSON for anything else.
function splitGltf(bytes) {
  const isGlb = bytes.toString('latin1', 0, 4) === 'glTF'
  const end = isGlb ? 20 + bytes.readUInt32LE(12) : bytes.length
  try {
    return {json: JSON.parse(bytes.toString('utf8', isGlb ? 20 : 0, end)), rest: isGlb ? bytes.subarray(end) : null}
  } catch {
    return {}
  }
}

function joinGltf(json, rest) {
  const text = Buffer.from(JSON.stringify(json))
  if (!rest) return text
  const padded = Buffer.concat([text, Buffer.alloc(-text.length & 3, ' ')])
  const head = Buffer.alloc(20)
  head.write('glTF', 0, 'latin1')
  head.writeUInt32LE(2, 4)
  head.writeUInt32LE(20 + padded.length + rest.length, 8)
  head.writeUInt32LE(padded.length, 12)
  head.write('JSON', 16, 'latin1')
  return Buffer.concat([head, padded, rest])
}

const mutations = [flipBits, truncate, smear, setWord, damageJson, damageJson, damageJson]
export const mutate = (bytes, random) => random.pick(mutations)(bytes, random)
