#include <doctest/doctest.h>

#include <cmath>
#include <random>

#include "atlas_of.h"
#include "core/texture/alignment.h"
#include "core/texture/bake.h"
#include "core/texture/preview.h"
#include "sphere_meshes.h"

using namespace orbis;
using namespace orbis::texture;
using namespace sphere_meshes;

namespace {

// A long box-like body over a sphere mesh.
struct Model {
  SphereMesh sphere = subdivided(icosahedron(), 3);
  mesh::TriangleMesh surface;
  CutMesh cut_mesh;
  std::vector<Image> atlas;

  explicit Model(double length) : cut_mesh(atlas_of(sphere, 256)) {
    for (const Vec3d& p : sphere.points) surface.positions.push_back(Vec3f(Vec3d{length * p.x, p.y, p.z}));
    surface.triangles = sphere.triangles;
    atlas.push_back(patterned(cut_mesh));
  }
};

// Colour that is not the backdrop's gray.
bool is_painted(const Image& image, std::uint32_t x, std::uint32_t y) {
  const std::uint8_t* p = image.at(x, y);
  return std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 24;
}

std::size_t painted(const Image& image, std::uint32_t from, std::uint32_t to) {
  std::size_t n = 0;
  for (std::uint32_t y = 0; y < image.height; ++y)
    for (std::uint32_t x = from; x < to; ++x) n += is_painted(image, x, y) ? 1 : 0;
  return n;
}

mesh::ThreadPool pool(1);

} // namespace

TEST_CASE("the model fills its picture without touching the edge, the same on any number of threads") {
  const Model model(2);
  const Image picture = draw_model(model.surface, model.cut_mesh, model.atlas, 320, 240, pool);
  CHECK(picture.width == 320);
  CHECK(picture.height == 240);
  CHECK(picture.channels == 3);
  mesh::ThreadPool three(3);
  CHECK(picture.pixels == draw_model(model.surface, model.cut_mesh, model.atlas, 320, 240, three).pixels);
  CHECK(painted(picture, 0, 320) > 320 * 240 / 5);
  for (std::uint32_t x = 0; x < 320; ++x) {
    CHECK_FALSE(is_painted(picture, x, 0));
    CHECK_FALSE(is_painted(picture, x, 239));
  }
  for (std::uint32_t y = 0; y < 240; ++y) {
    CHECK_FALSE(is_painted(picture, 0, y));
    CHECK_FALSE(is_painted(picture, 319, y));
  }
}

TEST_CASE("a sphere drawn as a model and drawn as the sphere look the same") {
  const Model model(1);
  const Image as_model = draw_model(model.surface, model.cut_mesh, model.atlas, 200, 200, pool);
  const Image as_sphere = draw_sphere(model.cut_mesh, model.atlas, 200, 200, pool);
  double difference = 0;
  for (std::size_t i = 0; i < as_model.pixels.size(); ++i)
    difference += std::abs(as_model.pixels[i] - as_sphere.pixels[i]);
  CHECK(difference / static_cast<double>(as_model.pixels.size()) < 6);
}

TEST_CASE("side by side there is a sphere on the left and a model on the right") {
  const Model model(1.5);
  const Image picture =
      draw_side_by_side(model.cut_mesh, shape_of(model.surface, model.cut_mesh), model.atlas, 480, 200, pool);
  CHECK(painted(picture, 0, 200) > 8000);
  CHECK(painted(picture, 240, 480) > 8000);
}

TEST_CASE("a model that is flat, or inside out, is drawn all the same") {
  Model model(1);
  for (auto& t : model.cut_mesh.triangles) std::swap(t[1], t[2]);
  CHECK(painted(draw_model(model.surface, model.cut_mesh, model.atlas, 100, 100, pool), 0, 100) > 2000);
  for (Vec3f& p : model.surface.positions) p.z = 0;
  CHECK(painted(draw_model(model.surface, model.cut_mesh, model.atlas, 100, 100, pool), 0, 100) > 1000);
}

TEST_CASE("the best rotation undoes a rotation") {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 50; ++round) {
    SphereMesh mesh;
    std::vector<double> weights;
    for (int i = 0; i < 20; ++i) {
      mesh.points.push_back({normal(random), normal(random), normal(random)});
      weights.push_back(0.5 + std::abs(normal(random)));
    }
    const std::vector<Vec3d> before = mesh.points, after = turned(mesh, random).points;
    const Rotation rotation = best_rotation(before, after, weights);
    for (std::size_t i = 0; i < before.size(); ++i) {
      CHECK(norm(rotation(before[i]) - after[i]) < 1e-9);
      CHECK(norm(rotation.inverse(after[i]) - before[i]) < 1e-9);
    }
  }
}
