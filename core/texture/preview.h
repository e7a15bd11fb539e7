// Pictures to look at: the textured model, and the sphere that it was unfolded onto.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/thread_pool.h"
#include "core/mesh/triangle_mesh.h"
#include "core/texture/atlas.h"
#include "core/texture/canvas.h"
#include "core/texture/image.h"

namespace orbis::texture {

// The surface as it is, with smooth normals.
[[nodiscard]] Shape shape_of(const mesh::TriangleMesh& surface, const CutMesh& mesh);

// surface: what the atlas was made for; mesh: the result; pages: its images. width x height pixels, 8 to 8192 each.
// RGB, the same on any number of threads. The view is from the front (+Z), a little from the right and above, with the
// model filling the picture.
[[nodiscard]] Image draw_model(const mesh::TriangleMesh& surface, const CutMesh& mesh, std::span<const Image> pages,
                               std::uint32_t width, std::uint32_t height, mesh::ThreadPool& pool);

// The sphere of the component with most texels, from the same side.
[[nodiscard]] Image draw_sphere(const CutMesh& mesh, std::span<const Image> pages, std::uint32_t width,
                                std::uint32_t height, mesh::ThreadPool& pool);

// Left the sphere, right the model: the same texture on both is the parametrization. The sphere is turned so that its
// points lie, as far as it goes, on the side of the model that they belong to. model: its mesh begins with mesh, and
// may go on with copies of its parts in other places.
[[nodiscard]] Image draw_side_by_side(const CutMesh& mesh, const Shape& model, std::span<const Image> pages,
                                      std::uint32_t width, std::uint32_t height, mesh::ThreadPool& pool);

} // namespace orbis::texture
