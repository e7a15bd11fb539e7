#include "core/asset/extent.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace orbis::asset {
namespace {

constexpr double farthest = 256; // diagonals

// All its digits: nobody writes a survey's coordinates as 4e+05.
std::string plain(double value) {
  std::array<char, 128> digits{}; // more than any float32 takes
  char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::fixed).ptr;
  return {digits.data(), end};
}

} // namespace

void Extent::add(const Vec3d& position) {
  const std::array<double, 3> coordinates{position.x, position.y, position.z};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double x = coordinates[i];
    axes_[i].low = std::min(axes_[i].low, x);
    axes_[i].high = std::max(axes_[i].high, x);
    axes_[i].fits_float = axes_[i].fits_float && double{static_cast<float>(x)} == x;
  }
}

Vec3d Extent::origin() const {
  const double diagonal =
      std::hypot(axes_[0].high - axes_[0].low, axes_[1].high - axes_[1].low, axes_[2].high - axes_[2].low);
  std::array<double, 3> out{};
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const Axis& axis = axes_[i];
    // False where a coordinate is infinite: that is refused later.
    const bool is_far = std::max(std::abs(axis.low), std::abs(axis.high)) > farthest * diagonal;
    if (is_far && !axis.fits_float) out[i] = double{static_cast<float>(axis.low + (axis.high - axis.low) / 2)};
  }
  return {out[0], out[1], out[2]};
}

void note_origin(const Vec3d& origin, std::vector<Asset::Note>& notes) {
  if (origin == Vec3d()) return;
  notes.push_back(
      {"origin-moved",
       "the model lies so far from its origin that float32 coordinates, which glTF has, would run together; "
       "they are measured from (" +
           plain(origin.x) + ", " + plain(origin.y) + ", " + plain(origin.z) + "), which is its nodes' translation",
       ""});
}

} // namespace orbis::asset
