// A picture of the result.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/steps/delivery.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"

namespace orbis {

// The sphere and the model side by side, with the atlas on both, as PNG. The model stands as the default scene shows
// it, every mesh at each of its nodes and their instances (at the first alone where the others have more than a million
// triangles), with its own normals (flat where it has none) and base colour factors, its alpha and its sides as a glTF
// renderer takes them (canvas.h); skinned meshes in their bind pose. Without lights and normal maps of its own.
[[nodiscard]] std::vector<std::byte> preview(const asset::Asset& asset, const Surface& surface,
                                             const texture::CutMesh& cut, const Delivery& delivery,
                                             std::span<const texture::Image> pages, std::uint32_t threads);

} // namespace orbis
