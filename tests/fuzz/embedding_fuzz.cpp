// Random meshes by the thousand, one after the other: every one has to come out certified.
//
//   fuzz_embedding [FIRST SEED] [COUNT] [MOST VERTICES]
//
// A mesh is told by its seed alone. Prints those that fail, with the reason; exits 1 if there is one.
#include <cmath>
#include <cstdio>
#include <iostream>
#include <random>
#include <string>

#include "core/sphere/certificate.h"
#include "core/sphere/embedding.h"
#include "core/sphere/snap.h"
#include "support/random_mesh.h"

using namespace orbis;

namespace {

shapes::RandomMesh mesh_of(std::uint64_t seed, double most_vertices) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit;
  const auto vertices = static_cast<std::uint32_t>(4 * std::pow(most_vertices / 4, unit(random)));
  return {seed, vertices, static_cast<std::uint32_t>(random() % 10),
          static_cast<std::uint32_t>(random() % shapes::RandomMesh::position_kinds)};
}

std::string failure(const mesh::TriangleMesh& m, Objective objective) {
  NoProgress progress;
  NoCheckpoints none;
  Options options;
  options.objective = objective;
  try {
    const sphere::Snapped snapped = sphere::snap(sphere::embed(m, options, 1, progress, none).points, m.triangles);
    std::vector<Vec3f> points;
    for (const sphere::GridPoint& p : snapped.points) points.push_back(sphere::from_grid(p));
    return sphere::certify(points, m.triangles).failure();
  } catch (const Error& e) {
    return e.message();
  }
}

} // namespace

int main(int count, char** values) {
  const std::uint64_t first = count > 1 ? std::stoull(values[1]) : 1,
                      meshes = count > 2 ? std::stoull(values[2]) : 1000;
  const double most = count > 3 ? std::stod(values[3]) : 10'000;
  constexpr std::array<Objective, 3> objectives{Objective::isometric, Objective::conformal, Objective::stretch};
  std::uint64_t failures = 0;
  for (std::uint64_t seed = first; seed < first + meshes; ++seed) {
    const shapes::RandomMesh description = mesh_of(seed, most);
    const std::string what = failure(description.make(), objectives[seed % objectives.size()]);
    if (what.empty()) continue;
    ++failures;
    std::cout << description << ", objective " << seed % objectives.size() << ": " << what << std::endl;
  }
  std::printf("%llu meshes, %llu failures\n", static_cast<unsigned long long>(meshes),
              static_cast<unsigned long long>(failures));
  return failures == 0 ? 0 : 1;
}
