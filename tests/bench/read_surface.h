// The model of a file as one surface, for the benchmarks.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace orbis::bench {

// The contents of a file; nothing where there is none.
std::vector<std::byte> bytes_of(const std::string& path);

// All triangles of the file's primitives, welded and oriented. Throws Error of code not_genus_zero unless they are one
// closed surface of genus 0, and what reading the asset throws.
mesh::TriangleMesh read_surface(const std::string& path);

} // namespace orbis::bench
