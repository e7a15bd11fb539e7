// What the small renderer makes of materials: alpha, sides, flat shading.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/texture/canvas.h"

using namespace orbis;
using namespace orbis::texture;

namespace {

constexpr std::uint32_t size = 64;
mesh::ThreadPool pool(2);

// Squares that face the camera, one page of one colour each.
class Squares {
public:
  Squares() : shape_{mesh_, {}, {}, {}, {}} {}

  // distance: towards the viewer; half: half of its side; color: RGBA.
  void add(double distance, double half, const std::array<std::uint8_t, 4>& color, const Material& material) {
    const auto first = static_cast<mesh::Index>(mesh_.vertices.size()), page = static_cast<mesh::Index>(pages_.size());
    for (const auto& [x, y] : {std::array{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
      mesh_.vertices.push_back({0, {}, {}, {x < 0 ? 0.25F : 0.75F, y < 0 ? 0.25F : 0.75F}, 0});
      shape_.positions.push_back(view_x * (x * half) + view_y * (y * half) + view_z * distance);
      shape_.normals.push_back(view_z);
    }
    for (const mesh::Triangle& t : {mesh::Triangle{0, 1, 2}, mesh::Triangle{0, 2, 3}}) {
      mesh_.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      mesh_.chart.push_back(page);
      shape_.material_of.push_back(page);
    }
    mesh_.charts.push_back({0, page, 0, 0, 4, 4});
    mesh_.pages.push_back({4, 4});
    pages_.push_back({4, 4, 4, {}});
    for (std::size_t i = 0; i < 16; ++i)
      pages_.back().pixels.insert(pages_.back().pixels.end(), color.begin(), color.end());
    shape_.materials.push_back(material);
  }

  void turn_around() {
    for (mesh::Triangle& t : mesh_.triangles) std::swap(t[1], t[2]);
  }
  Shape& shape() { return shape_; }

  // The pixel in the middle of the picture.
  [[nodiscard]] std::array<int, 3> middle() const {
    Canvas canvas(size, size, pages_, pool);
    canvas.draw(shape_, {0, 0, size, size});
    const Image picture = canvas.picture();
    const std::uint8_t* p = picture.at(size / 2, size / 2 + 1);
    return {p[0], p[1], p[2]};
  }

private:
  CutMesh mesh_;
  Shape shape_;
  std::vector<Image> pages_;
};

constexpr std::array<std::uint8_t, 4> red{255, 0, 0, 255}, green{0, 255, 0, 255}, clear_red{255, 0, 0, 100};
Material with(AlphaMode mode, float cutoff = 0.5F) { return {{1, 1, 1, 1}, {mode, cutoff}, true, false}; }

bool is_red(const std::array<int, 3>& p) { return p[0] > 150 && p[1] < 120; }
bool is_green(const std::array<int, 3>& p) { return p[1] > 150 && p[0] < 120; }

} // namespace

TEST_CASE("a mask leaves out what is below its cutoff, in whatever order the triangles come") {
  for (const bool masked_first : {true, false}) {
    CAPTURE(masked_first);
    const auto picture_with = [&](float cutoff, AlphaMode mode) {
      Squares squares;
      if (masked_first) squares.add(0.5, 0.8, clear_red, with(mode, cutoff));
      squares.add(-0.5, 1, green, with(AlphaMode::opaque));
      if (!masked_first) squares.add(0.5, 0.8, clear_red, with(mode, cutoff));
      return squares.middle();
    };
    CHECK(is_green(picture_with(0.5F, AlphaMode::mask)));
    CHECK(is_red(picture_with(0.3F, AlphaMode::mask)));
    CHECK(is_red(picture_with(0.5F, AlphaMode::opaque)));
  }
}

TEST_CASE("the material's own alpha counts, too") {
  Squares squares;
  Material half = with(AlphaMode::mask);
  half.factor[3] = 0.4F;
  squares.add(0.5, 0.8, red, half);
  squares.add(-0.5, 1, green, with(AlphaMode::opaque));
  CHECK(is_green(squares.middle()));
}

TEST_CASE("what is blended lies over what is behind it, in whatever order the triangles come") {
  std::vector<std::array<int, 3>> pictures;
  for (const bool blended_first : {true, false}) {
    Squares squares;
    if (blended_first) squares.add(0.5, 0.8, clear_red, with(AlphaMode::blend));
    squares.add(-0.5, 1, green, with(AlphaMode::opaque));
    if (!blended_first) squares.add(0.5, 0.8, clear_red, with(AlphaMode::blend));
    pictures.push_back(squares.middle());
  }
  CHECK(pictures[0] == pictures[1]);
  CHECK(pictures[0][0] > 100);
  CHECK(pictures[0][1] > 100);
  Squares behind;
  behind.add(-0.5, 0.8, clear_red, with(AlphaMode::blend));
  behind.add(0.5, 1, green, with(AlphaMode::opaque));
  CHECK(is_green(behind.middle()));
}

TEST_CASE("of many blended layers the near ones are seen best") {
  for (const bool from_the_back : {true, false}) {
    Squares squares;
    for (int i = 0; i < 12; ++i) {
      const int layer = from_the_back ? i : 11 - i;
      squares.add(0.05 * layer, 1,
                  layer > 5 ? std::array<std::uint8_t, 4>{255, 0, 0, 128} : std::array<std::uint8_t, 4>{0, 255, 0, 128},
                  with(AlphaMode::blend));
    }
    CHECK(is_red(squares.middle()));
  }
}

TEST_CASE("the back of a material that has one side is not drawn") {
  Squares squares;
  squares.add(-0.5, 1, green, with(AlphaMode::opaque));
  const std::array<int, 3> front = squares.middle();
  squares.turn_around();
  CHECK(squares.middle() == front);
  squares.shape().materials[0].is_double_sided = false;
  const std::array<int, 3> nothing = squares.middle();
  CHECK(std::abs(nothing[0] - nothing[1]) < 20); // the backdrop
  squares.turn_around();
  CHECK(squares.middle() == front);
}

TEST_CASE("a flat material has the light of its triangles, whatever the normals at the vertices") {
  Squares squares;
  squares.add(0, 1, green, with(AlphaMode::opaque));
  const std::array<int, 3> ahead = squares.middle();
  for (Vec3d& n : squares.shape().normals) n = normalized(view_z * 0.2 + view_y * -1.0);
  const std::array<int, 3> leaning = squares.middle();
  CHECK(leaning[1] < ahead[1] - 30);
  squares.shape().materials[0].is_flat = true;
  CHECK(squares.middle() == ahead);
  squares.turn_around();
  CHECK(squares.middle() == ahead);
}
