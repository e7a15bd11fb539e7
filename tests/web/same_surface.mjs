// Whether two documents hold the same surface, whatever its triangles were cut into: area, centre and second moments of
// each mesh agree, and each vertex of the first's triangles is one of the second's, to the bit.
const triangleModes = new Set([4, 5, 6])
// Of the area, and of the extent: new vertices on the atlas' borders are rounded to float32.
const tolerance = 2e-5, rounding = 1.2e-7

function corners(primitive) {
  const count = (primitive.getIndices() ?? primitive.getAttribute('POSITION')).getCount()
  const at = (i) => primitive.getIndices()?.getScalar(i) ?? i
  const triangles = []
  if (primitive.getMode() === 4) for (let i = 0; i + 2 < count; i += 3) triangles.push([at(i), at(i + 1), at(i + 2)])
  else if (primitive.getMode() === 5) for (let i = 0; i + 2 < count; ++i) triangles.push([at(i), at(i + 1 + (i % 2)), at(i + 2 - (i % 2))])
  else for (let i = 1; i + 1 < count; ++i) triangles.push([at(0), at(i), at(i + 1)])
  return triangles
}

// Triangles of a mesh as [a, b, c], each three numbers.
function trianglesOf(mesh) {
  return mesh.listPrimitives().filter((primitive) => triangleModes.has(primitive.getMode())).flatMap((primitive) => {
    const positions = primitive.getAttribute('POSITION')
    return corners(primitive).map((triangle) => triangle.map((v) => positions.getElement(v, []).map(Math.fround)))
  })
}

// The integrals of 1, x and x x' over the triangles, about `centre` and in units of `extent`.
function moments(triangles, centre, extent) {
  const sum = {area: 0, first: [0, 0, 0], second: [0, 0, 0, 0, 0, 0]}
  for (const triangle of triangles) {
    const [a, b, c] = triangle.map((p) => p.map((x, i) => (x - centre[i]) / extent))
    const u = b.map((x, i) => x - a[i]), v = c.map((x, i) => x - a[i])
    const area = Math.hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]) / 2
    const total = a.map((x, i) => x + b[i] + c[i])
    sum.area += area
    for (let i = 0; i < 3; ++i) sum.first[i] += area * total[i] / 3
    // The integral of x_i x_j over a triangle: area / 12 (sum over corners of x_i x_j, and of the sums' product).
    let n = 0
    for (let i = 0; i < 3; ++i) {
      for (let j = i; j < 3; ++j) sum.second[n++] += area / 12 * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + total[i] * total[j])
    }
  }
  return [sum.area, ...sum.first, ...sum.second]
}

function box(triangles) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity]
  for (const triangle of triangles) {
    for (const point of triangle) point.forEach((x, i) => { low[i] = Math.min(low[i], x); high[i] = Math.max(high[i], x) })
  }
  return {centre: low.map((x, i) => (x + high[i]) / 2), extent: Math.hypot(...low.map((x, i) => high[i] - x)) || 1}
}

// Throws what differs.
export function expectSameSurface(before, after) {
  const [input, output] = [before, after].map((document) => document.getRoot().listMeshes().map(trianglesOf))
  let count = 0
  input.forEach((triangles, m) => {
    if (triangles.length === 0) return
    const there = new Set(output[m].flat().map(String))
    const lost = triangles.flat().filter((point) => !there.has(String(point)))
    if (lost.length > 0) throw new Error(`mesh ${m} has lost ${lost.length} corners, the first at ${lost[0]}`)
    const {centre, extent} = box(triangles)
    const wanted = moments(triangles, centre, extent), found = moments(output[m], centre, extent)
    const worst = Math.max(...wanted.map((x, i) => Math.abs(x - found[i]))) / wanted[0]
    if (worst > tolerance + rounding * Math.hypot(...centre) / extent) throw new Error(`mesh ${m} is another surface: moments ${worst.toExponential(1)} apart`)
    count += triangles.length
  })
  return `${count} triangles`
}
