// What the atlas shows, and the pictures of it.
#pragma once

#include <cstddef>
#include <vector>

#include "core/asset/asset.h"
#include "core/pipeline.h"
#include "core/steps/delivery.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"

namespace orbis {

// Bakes what options.texture asks for, one image for each page; fills report.atlas.source. texture=auto takes the
// model's own base colour where any of its materials has a base colour texture that came with the request, else the
// test pattern. Throws Error: invalid_option where texture=base_color or cubemap is asked for and there is no such
// image, or not the right ones; malformed, unsupported_format or too_large for an image that cannot be read.
[[nodiscard]] std::vector<texture::Image> paint(const Request& request, const Limits& limits, const asset::Asset& asset,
                                                const Surface& surface, const texture::CutMesh& cut,
                                                const Delivery& delivery, Progress& progress, Report& report);

// The pages as options.texture_format asks for. first_png: the first page as PNG, which is made in any case.
[[nodiscard]] std::vector<asset::NewImage>
encode_atlas(std::span<const texture::Image> pages, const std::vector<std::byte>& first_png, const Options& options);

// The sphere and the model side by side, with the atlas on both, as PNG.
[[nodiscard]] std::vector<std::byte> preview(const Surface& surface, const texture::CutMesh& cut,
                                             std::span<const texture::Image> pages);

} // namespace orbis
