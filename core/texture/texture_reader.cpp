#include "core/texture/texture_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace orbis::texture {
namespace {

constexpr double most_taps = 4; // in each direction; a longer footprint is read on a coarser mip level

RasterPoint at(const std::array<RasterPoint, 3>& corners, const std::array<double, 3>& weights) {
  return {weights[0] * corners[0].x + weights[1] * corners[1].x + weights[2] * corners[2].x,
          weights[0] * corners[0].y + weights[1] * corners[1].y + weights[2] * corners[2].y};
}

// Source texels along one step in the page.
double length_of_step(const std::array<RasterPoint, 3>& corners, const std::array<double, 3>& weight_step) {
  const RasterPoint step = at(corners, weight_step);
  return std::hypot(step.x, step.y);
}

// Lengths that are no numbers count as none, as such coordinates do in the sampler.
std::uint32_t taps_for(double texels) {
  return texels > 1 ? static_cast<std::uint32_t>(std::ceil(std::min(texels, most_taps) - 1e-3)) : 1;
}

Light read_once(const TextureReader::Footprint& f, const std::array<double, 3>& weights) {
  const RasterPoint p = at(f.corners, weights);
  const bool magnified = f.level == 0 && f.taps_x == 1 && f.taps_y == 1;
  return f.source->nearest && magnified ? f.sampler->nearest(p.x, p.y) : f.sampler->sample(p.x, p.y, f.level);
}

} // namespace

TextureReader::TextureReader(const TexelMap& map, std::span<const std::uint32_t> shown, std::span<const CornerUv> uv,
                             std::span<const std::uint32_t> source_of, std::span<const TextureSource> sources,
                             Encoding encoding)
    : uv_(uv), source_of_(source_of), sources_(sources) {
  static const Image no_image{1, 1, 3, {0, 0, 0}};
  using Key = std::tuple<const Image*, Wrap, Wrap>; // mip levels are made once, however many sources share an image
  std::map<Key, std::size_t> numbers;
  for (const TextureSource& s : sources) {
    const Key key{s.image != nullptr ? s.image : &no_image, s.wrap_u, s.wrap_v};
    const auto [found, is_new] = numbers.emplace(key, samplers_.size());
    if (is_new) samplers_.emplace_back(*std::get<0>(key), s.wrap_u, s.wrap_v, 1, encoding);
    sampler_of_.push_back(found->second);
  }
  std::vector<std::uint32_t> levels(samplers_.size(), 1);
  for (const std::uint32_t t : shown) {
    std::uint32_t& wanted = levels[sampler_of_[source_of[t]]];
    wanted = std::max(wanted, footprint(t, map.place(t)).level + 1);
  }
  for (const auto& [key, number] : numbers)
    if (levels[number] > 1)
      samplers_[number] = Sampler(*std::get<0>(key), std::get<1>(key), std::get<2>(key), levels[number], encoding);
}

TextureReader::Footprint TextureReader::footprint(std::uint32_t triangle, const TriangleInPage& place) const {
  Footprint f;
  f.source = &sources_[source_of_[triangle]];
  f.sampler = &samplers_[sampler_of_[source_of_[triangle]]];
  if (f.source->image == nullptr) return f;
  const std::array<float, 6>& m = f.source->transform;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2f& uv = uv_[triangle][k];
    f.corners[k] = {(double{m[0]} * uv.x + double{m[1]} * uv.y + m[2]) * f.source->image->width,
                    (double{m[3]} * uv.x + double{m[4]} * uv.y + m[5]) * f.source->image->height};
  }
  f.along_x = place.along_x;
  f.along_y = place.along_y;
  double x = length_of_step(f.corners, f.along_x), y = length_of_step(f.corners, f.along_y);
  for (; std::max(x, y) > most_taps && f.level < 31; x /= 2, y /= 2) ++f.level;
  f.taps_x = taps_for(x);
  f.taps_y = taps_for(y);
  std::array<double, 3> step_x{}, step_y{};
  for (std::size_t k = 0; k < 3; ++k) {
    step_x[k] = f.along_x[k] / f.taps_x;
    step_y[k] = f.along_y[k] / f.taps_y;
    f.reach[k] = 0.5 * ((f.taps_x - 1) * std::abs(step_x[k]) + (f.taps_y - 1) * std::abs(step_y[k]));
  }
  f.step_x = at(f.corners, step_x);
  f.step_y = at(f.corners, step_y);
  return f;
}

Light TextureReader::read(const Footprint& f, const std::array<double, 3>& centre) {
  if (f.source->image == nullptr) return f.source->color;
  if (f.taps_x == 1 && f.taps_y == 1) return read_once(f, centre);
  if (centre[0] >= f.reach[0] && centre[1] >= f.reach[1] && centre[2] >= f.reach[2]) {
    const RasterPoint p = at(f.corners, centre);
    const double i = 0.5 * (f.taps_x - 1), j = 0.5 * (f.taps_y - 1);
    return f.sampler->mean({p.x - i * f.step_x.x - j * f.step_y.x, p.y - i * f.step_x.y - j * f.step_y.y, f.step_x,
                            f.step_y, f.taps_x, f.taps_y},
                           f.level);
  }
  // Some reads would be outside of the triangle, and are moved to its border.
  Light sum{};
  for (std::uint32_t j = 0; j < f.taps_y; ++j) {
    for (std::uint32_t i = 0; i < f.taps_x; ++i) {
      std::array<double, 3> weights = centre;
      double total = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = (i + 0.5) / f.taps_x - 0.5, y = (j + 0.5) / f.taps_y - 0.5;
        weights[k] = std::max(weights[k] + x * f.along_x[k] + y * f.along_y[k], 0.0);
        total += weights[k];
      }
      for (double& weight : weights) weight /= total;
      const Light light = read_once(f, weights);
      for (std::size_t c = 0; c < 4; ++c) sum[c] += light[c];
    }
  }
  const auto share = 1.0F / static_cast<float>(f.taps_x * f.taps_y);
  for (float& c : sum) c *= share;
  return sum;
}

} // namespace orbis::texture
