// A map that was interrupted and taken up again is the map, to the bit.
#include <doctest/doctest.h>

#include "core/sphere/embedding.h"
#include "support/interruption.h"
#include "support/random_mesh.h"

using namespace orbis;

namespace {

std::vector<Vec3d> map_of(const mesh::TriangleMesh& m, const sphere::TriangleEnergy& energy, Quality quality,
                          std::uint32_t threads, Checkpoints& checkpoints) {
  NoProgress progress;
  return sphere::embed_by_energy(m, energy, quality, threads, progress, checkpoints).points;
}

} // namespace

TEST_CASE("a map that is interrupted on every third level is the same as one that is not") {
  const mesh::TriangleMesh m = shapes::random_blob(7, 5);
  for (const Quality quality : {Quality::draft, Quality::standard}) {
    NoCheckpoints none;
    const std::vector<Vec3d> whole = map_of(m, sphere::SymmetricDirichlet{}, quality, 1, none);
    std::vector<Vec3d> pieced;
    // One more level is done on every run than was before.
    const int times = test::interrupted(3, [&](Checkpoints& checkpoints) {
      pieced = map_of(m, sphere::SymmetricDirichlet{}, quality, 2, checkpoints);
    });
    CHECK(times > 3);
    CHECK(pieced == whole);
  }
}

TEST_CASE("a map that is interrupted after its finest level goes on from there") {
  const mesh::TriangleMesh m = shapes::random_blob(3, 4);
  NoCheckpoints none;
  test::Interruption all({}, -1);
  const std::vector<Vec3d> whole = map_of(m, sphere::Stretch{}, Quality::standard, 1, all);
  test::Interruption finest(all.last, 1); // would be interrupted by any other checkpoint
  CHECK(map_of(m, sphere::Stretch{}, Quality::standard, 1, finest) == whole);
  CHECK(finest.last.empty());
}

TEST_CASE("a checkpoint of another surface is not taken up, and one that is cut off is refused") {
  const mesh::TriangleMesh m = shapes::random_blob(3, 4), other = shapes::random_blob(3, 3);
  test::Interruption all({}, -1);
  const std::vector<Vec3d> whole = map_of(m, sphere::SymmetricDirichlet{}, Quality::draft, 1, all);
  test::Interruption foreign(all.last, -1);
  NoCheckpoints none;
  CHECK(map_of(other, sphere::SymmetricDirichlet{}, Quality::draft, 1, foreign) ==
        map_of(other, sphere::SymmetricDirichlet{}, Quality::draft, 1, none));
  all.last.pop_back();
  test::Interruption cut_off(all.last, -1);
  CHECK_THROWS_AS(map_of(m, sphere::SymmetricDirichlet{}, Quality::draft, 1, cut_off), Error);
}
