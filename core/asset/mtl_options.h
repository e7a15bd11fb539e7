// The options of textures in a material library (MTL), made safe for tinyobjloader.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace orbis::asset {

// The library with each -s, -o, -t and -mm at its full count of numbers. MTL lets the last ones be left out
// ("-s 4 4 tex.png"); tinyobjloader takes three whatever they are, the file's name among them.
[[nodiscard]] std::string with_all_option_numbers(std::span<const std::byte> library);

} // namespace orbis::asset
