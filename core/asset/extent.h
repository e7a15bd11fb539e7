// Coordinates that lie so far from the origin that glTF's float32 would no longer tell them apart.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "core/asset/asset.h"

namespace orbis::asset {

// The bounding box of a model's positions, and the point that they are better measured from.
class Extent {
public:
  void add(const Vec3d& position);

  // A point in float32 numbers, its coordinate 0 along each axis that may stay as it is. An axis is moved where float32
  // loses something of the coordinates and the farthest one is more than 2^8 diagonals of the box away: float32's steps
  // there are up to 2^-23 of the coordinate, so that less than 2^15 of them are left along the diagonal, not four for
  // each texel of an image of 8192.
  [[nodiscard]] Vec3d origin() const;

private:
  struct Axis {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    bool fits_float = true;
  };
  std::array<Axis, 3> axes_;
};

// Tells that positions are measured from `origin`, unless that is 0.
void note_origin(const Vec3d& origin, std::vector<Asset::Note>& notes);

} // namespace orbis::asset
