// A job that was interrupted and taken up again gives the same bytes.
#include <doctest/doctest.h>

#include "core/pipeline.h"
#include "support/glb_of_mesh.h"
#include "support/interruption.h"
#include "support/random_mesh.h"

using namespace orbis;

namespace {

// Blobs side by side: the first two of at least 20,000 triangles, the last one small.
mesh::TriangleMesh three_blobs() {
  mesh::TriangleMesh out;
  for (const auto& [seed, levels] : {std::pair{1U, 6}, std::pair{2U, 6}, std::pair{3U, 3}}) {
    const mesh::TriangleMesh m = shapes::random_blob(seed, levels);
    const auto first = static_cast<mesh::Index>(out.positions.size());
    for (const Vec3f& p : m.positions) out.positions.push_back(p + Vec3f{4 * static_cast<float>(seed), 0, 0});
    for (const mesh::Triangle& t : m.triangles) out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return out;
}

} // namespace

TEST_CASE("a job with several components that is interrupted again and again gives the same result") {
  const std::vector<std::byte> model = glb_of(three_blobs());
  Request request{model, {}, {}};
  request.options.quality = Quality::draft;
  request.options.texture_size = 256;
  NoProgress progress;
  const Result whole = process(request, {}, progress);
  Result pieced;
  const int times =
      test::interrupted(20, [&](Checkpoints& checkpoints) { pieced = process(request, {}, progress, checkpoints); });
  CHECK(times > 2);
  CHECK(pieced.glb == whole.glb);
}
