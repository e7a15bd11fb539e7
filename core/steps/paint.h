// Pictures that do not come from the model: the test pattern, an uploaded cube map.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/pipeline.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"
#include "core/texture/image.h"
#include "core/texture/texel_map.h"

namespace orbis {

// Whether the base colour may be the model's own: texture=auto or base_color.
[[nodiscard]] bool may_show_own_colors(const Options& options);

// "base_color", "cubemap" or "pattern": what the base colour shows. texture=auto takes the model's own colours where it
// has any, else the test pattern. Throws Error{invalid_option} where texture=base_color is asked for and there are
// none.
[[nodiscard]] std::string source_name(const Options& options, bool has_own_colors);

// The images that texture=cubemap takes; none with another texture. Throws Error: missing_resource where they did not
// come; malformed, unsupported_format or too_large for one that cannot be read.
[[nodiscard]] std::vector<texture::Image> uploaded_images(const Request& request, const Limits& limits);

// Throws now what the two above would throw when it comes to baking, after the long part of the work: for uploaded
// images, and for a model that no primitive's colours or textures give a base colour.
void check_texture(const Request& request, const asset::Asset& asset, const Limits& limits);

// A page with the uploaded images on it, or where there are none with the test pattern. map: the page's.
[[nodiscard]] texture::Image paint(std::span<const texture::Image> uploaded, const texture::TexelMap& map,
                                   const texture::CutMesh& cut, std::uint32_t page, const Progress& progress,
                                   mesh::ThreadPool& pool);

} // namespace orbis
