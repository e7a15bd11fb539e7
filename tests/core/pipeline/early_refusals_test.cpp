// What cannot work is refused before the unfolding, which may take minutes: these jobs failed at its end.
#include <doctest/doctest.h>

#include "core/asset/image_codec.h"
#include "core/pipeline.h"
#include "support/defects.h"
#include "support/glb_of_mesh.h"

using namespace orbis;

namespace {

// Fails the test when the unfolding begins.
class BeforeTheWork final : public Progress {
public:
  void report(Stage stage, std::uint64_t, std::uint64_t) override { CHECK(stage <= Stage::topology); }
  [[nodiscard]] bool cancelled() const override { return false; }
};

// The place that the refusal names.
std::string refusal(Request request, const std::vector<std::pair<std::string, std::string>>& options,
                    const Limits& limits = {}) {
  for (const auto& [name, value] : options) set_option(request.options, name, value);
  BeforeTheWork progress;
  try {
    (void)process(request, limits, progress);
  } catch (const Error& error) {
    return error.where();
  }
  return "it was taken";
}

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

} // namespace

TEST_CASE("options without what they need are refused before the work") {
  const std::vector<std::byte> glb = glb_of(shapes::sphere(2));
  CHECK(refusal({glb, {}, {}}, {{"texture", "cubemap"}}) == "texture");
  CHECK(refusal({glb, {}, {}}, {{"texture", "base_color"}}) == "texture");
  CHECK(refusal({glb, {}, {}}, {{"morph_to", "b.glb"}}) == "morph_to");
  CHECK(refusal({glb, {}, {}}, {{"features", "[[[0,0,1],[0,0,2]]]"}}) == "features");
  CHECK(refusal({glb, {{"b.glb", glb}}, {}}, {{"morph_to", "b.glb"}, {"sphere_morph", "true"}}) == "sphere_morph");
}

TEST_CASE("files that cannot be used are refused before the work") {
  const std::vector<std::byte> glb = glb_of(shapes::sphere(2)), text = bytes_of("hello");
  const std::vector<std::byte> torus = glb_of(shapes::torus(10, 6));
  CHECK(refusal({glb, {{"equirectangular.png", text}}, {}}, {{"texture", "cubemap"}}) == "equirectangular.png");
  CHECK(refusal({glb, {{"b.glb", text}}, {}}, {{"morph_to", "b.glb"}}).empty());
  CHECK(refusal({glb, {{"b.glb", torus}}, {}}, {{"morph_to", "b.glb"}}) == "morph_to");
}

TEST_CASE("a remesh that cannot be is refused before the work") {
  const std::vector<std::byte> disk = glb_of(shapes::disk(4, 8)), ball = glb_of(shapes::sphere(2));
  CHECK(refusal({disk, {}, {}}, {{"remesh", "octahedral:3"}}) == "remesh");
  Limits limits;
  limits.max_triangles = 1000;
  CHECK(refusal({ball, {}, {}}, {{"remesh", "octahedral:4"}}, limits) == "remesh");
}
