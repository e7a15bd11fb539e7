// The model of a file as one surface, for the benchmarks.
#pragma once

#include <string>

#include "core/mesh/triangle_mesh.h"

namespace orbis::bench {

// All triangles of the file's primitives, welded and oriented. Throws Error of code not_genus_zero unless they are one
// closed surface of genus 0, and what reading the asset throws.
mesh::TriangleMesh read_surface(const std::string& path);

} // namespace orbis::bench
