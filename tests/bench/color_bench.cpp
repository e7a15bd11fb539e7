// How faithfully colours were re-baked:
//
//   bench_color INPUT.glb RESULT.glb
//
// A result keeps the input's texture coordinates beside its own. So each point of its surface can be looked up in both
// images, the input's through the old coordinates and the new one through the new, both read bilinearly: no renderer
// with its own choice of mip levels lies between. Prints the PSNR of the sRGB bytes over a million points spread by
// area.
#include <cmath>
#include <cstdio>
#include <limits>
#include <vector>

#include "bench/read_surface.h"
#include "core/asset/asset.h"
#include "core/asset/image_codec.h"
#include "core/lod/samples.h"
#include "core/texture/sampler.h"

using namespace orbis;

namespace {

constexpr std::size_t sample_count = 1'000'000;

texture::Wrap wrap_of(int code) {
  return code == 33071 ? texture::Wrap::clamp : code == 33648 ? texture::Wrap::mirror : texture::Wrap::repeat;
}

// A base colour as it lies on a primitive of the result.
class Colors {
public:
  Colors(const asset::MaterialTexture& texture, const asset::Attribute& uv)
      : texture_(texture), uv_(uv),
        image_(asset::decode_image(texture.image, std::numeric_limits<std::uint64_t>::max(), "a base colour")),
        sampler_(image_, wrap_of(texture.wrap_s), wrap_of(texture.wrap_t), 1) {}

  [[nodiscard]] texture::Light at(const mesh::Triangle& corners, const std::array<double, 3>& weights) const {
    double u = 0, v = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      u += weights[k] * uv_.get(corners[k], 0);
      v += weights[k] * uv_.get(corners[k], 1);
    }
    const auto& m = texture_.transform;
    const double x = (m[0] * u + m[1] * v + m[2]) * image_.width, y = (m[3] * u + m[4] * v + m[5]) * image_.height;
    return texture_.nearest ? sampler_.nearest(x, y) : sampler_.sample(x, y, 0);
  }

private:
  const asset::MaterialTexture& texture_;
  const asset::Attribute& uv_;
  texture::Image image_;
  texture::Sampler sampler_;
};

// Adds the squared differences of a primitive; how many there are.
std::size_t compare(const asset::Asset& input, const asset::Asset& result, std::size_t number, double& squares) {
  const asset::Primitive& shown = result.primitives[number];
  const auto before = asset::material_texture(input, input.primitives[number], asset::TextureSlot::base_color);
  const auto after = asset::material_texture(result, shown, asset::TextureSlot::base_color);
  if (!before || !after) return 0;
  const asset::Attribute *old_uv = shown.find(before->uv), *new_uv = shown.find(after->uv);
  if (old_uv == nullptr || new_uv == nullptr || old_uv == new_uv) return 0;
  const Colors old_colors(*before, *old_uv), new_colors(*after, *new_uv);
  std::vector<Vec3d> positions;
  for (const Vec3f& p : shown.positions()) positions.emplace_back(p);
  std::vector<mesh::Triangle> triangles;
  for (std::size_t i = 0; i + 2 < shown.indices.size(); i += 3)
    triangles.push_back({shown.indices[i], shown.indices[i + 1], shown.indices[i + 2]});
  const std::vector<lod::Sample> samples = lod::spread_samples(positions, triangles, sample_count);
  for (const lod::Sample& s : samples) {
    const mesh::Triangle& corners = triangles[s.triangle];
    const texture::Light a = old_colors.at(corners, s.weights), b = new_colors.at(corners, s.weights);
    for (std::size_t c = 0; c < 3; ++c) {
      const int d = texture::to_srgb(a[c]) - texture::to_srgb(b[c]);
      squares += d * d;
    }
  }
  return 3 * samples.size();
}

} // namespace

int main(int count, char** arguments) {
  if (count != 3) {
    std::fprintf(stderr, "bench_color INPUT.glb RESULT.glb\n");
    return 2;
  }
  const asset::Asset input = asset::read_asset(bench::bytes_of(arguments[1]), {}, {});
  const asset::Asset result = asset::read_asset(bench::bytes_of(arguments[2]), {}, {});
  double squares = 0;
  std::size_t numbers = 0;
  for (std::size_t p = 0; p < input.primitives.size(); ++p) numbers += compare(input, result, p, squares);
  if (numbers == 0) {
    std::fprintf(stderr, "no base colour was re-baked\n");
    return 1;
  }
  std::printf("%.2f dB\n", 10 * std::log10(255.0 * 255.0 * static_cast<double>(numbers) / squares));
  return 0;
}
