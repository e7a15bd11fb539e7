// Triangles that are delivered without a place of their own on a sphere: duplicates, those without area, and those of
// components that could not be parametrized.
#pragma once

#include <vector>

#include "core/steps/delivery.h"

namespace orbis {

// An output vertex that no cut vertex stands for.
struct ExtraVertex {
  OutputVertex at;
  Vec3f sphere{};
  Vec2f uv{};
};

// Appends the riders to the delivery's indices and sources, behind the triangles of the cut surface.
//
// A duplicate gets the pieces of its twin, with the same coordinates and the attributes of its own corners. A triangle
// without area uses copies of its corners that are there, and gets the coordinates of the place where it lies. What has
// no place on any sphere becomes the primitive's left_out: it goes on looking as it did. A primitive with nothing else
// than the last two kinds stays as it was: it is not written at all.
[[nodiscard]] std::vector<ExtraVertex> add_riders(const Surface& surface, const texture::CutMesh& cut,
                                                  Delivery& delivery);

} // namespace orbis
