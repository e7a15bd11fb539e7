// Small surfaces as {positions: Float32Array of x, y, z; indices: Uint32Array of triangles}, outward oriented.

const mesh = (positions, indices) => ({positions: Float32Array.from(positions), indices: Uint32Array.from(indices)})

export const tetrahedron = () =>
  mesh([1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1], [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3])

// An icosahedron whose triangles are split in four `levels` times, pushed out to the unit sphere and stretched along x
// so that nothing about it is too regular: 20 * 4^levels triangles.
export function ellipsoid(levels) {
  const g = (1 + Math.sqrt(5)) / 2
  let points = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g], [0, 1, -g],
    [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
  let triangles = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2],
    [10, 7, 6], [7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10],
    [8, 6, 7], [9, 8, 1]]
  for (let level = 0; level < levels; ++level) {
    const middles = new Map()
    const middle = (a, b) => {
      const key = a < b ? a * 0x1000000 + b : b * 0x1000000 + a
      if (!middles.has(key)) middles.set(key, points.push(points[a].map((x, i) => (x + points[b][i]) / 2)) - 1)
      return middles.get(key)
    }
    triangles = triangles.flatMap(([a, b, c]) => {
      const ab = middle(a, b), bc = middle(b, c), ca = middle(c, a)
      return [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
    })
  }
  points = points.map((p) => p.map((x, i) => (x / Math.hypot(...p)) * (i === 0 ? 1.7 : 1)))
  return mesh(points.flat(), triangles.flat())
}

export function torus(around = 24, across = 12) {
  const positions = [], indices = []
  for (let i = 0; i < around; ++i)
    for (let j = 0; j < across; ++j) {
      const u = (2 * Math.PI * i) / around, v = (2 * Math.PI * j) / across
      const radius = 2 + 0.7 * Math.cos(v)
      positions.push(radius * Math.cos(u), radius * Math.sin(u), 0.7 * Math.sin(v))
      const at = (di, dj) => ((i + di) % around) * across + ((j + dj) % across)
      indices.push(at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1))
    }
  return mesh(positions, indices)
}

// Half a sphere's worth of triangles: one boundary loop.
export function bowl() {
  const {positions, indices} = ellipsoid(2)
  const triangles = Array.from({length: indices.length / 3}, (_, t) => Array.from(indices.subarray(3 * t, 3 * t + 3)))
  return mesh(positions, triangles.filter((corners) => corners.some((v) => positions[3 * v + 2] > 0)).flat())
}

// Two surfaces side by side, in one mesh.
export function together(a, b, offset = [4, 0, 0]) {
  const moved = b.positions.map((x, i) => x + offset[i % 3])
  const first = a.positions.length / 3
  return mesh([...a.positions, ...moved], [...a.indices, ...b.indices.map((v) => v + first)])
}

// Two tetrahedra that share an edge: four triangles meet there.
export const sharedEdge = () =>
  mesh([0, 0, 0, 0, 0, 1, 1, 0, 0, 0.5, 1, 0, -1, 0, 0, -0.5, -1, 0],
    [0, 2, 1, 0, 3, 2, 0, 1, 3, 1, 2, 3, 0, 4, 1, 0, 5, 4, 0, 1, 5, 1, 4, 5])

// A cube with a vertex for every corner of every face, so that normals and texture coordinates have seams.
export function cubeWithSeams() {
  const positions = [], normals = [], uvs = [], indices = []
  for (let face = 0; face < 6; ++face) {
    const axis = face >> 1, sign = face & 1 ? -1 : 1
    for (const [s, t] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
      const p = [0, 0, 0], n = [0, 0, 0]
      p[axis] = sign
      n[axis] = sign
      p[(axis + 1) % 3] = s * sign
      p[(axis + 2) % 3] = t
      positions.push(...p)
      normals.push(...n)
      uvs.push((s + 1) / 2, (1 - t) / 2)
    }
    indices.push(...[0, 1, 2, 0, 2, 3].map((i) => 4 * face + i))
  }
  return {...mesh(positions, indices), normals: Float32Array.from(normals), uvs: Float32Array.from(uvs)}
}
