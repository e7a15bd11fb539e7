// The cut surface as glTF primitives, and the proof read back from the finished file.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/report.h"
#include "core/steps/interpolate.h"
#include "core/steps/snap_and_cut.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"

namespace orbis {

// A vertex of the output: primitive of the asset, and place in its new vertex list.
struct OutputVertex {
  std::uint32_t primitive = 0, vertex = 0;
};

struct Delivery {
  std::vector<asset::NewPrimitive> primitives;    // one per primitive of the asset
  std::vector<std::vector<VertexSource>> sources; // where their vertices come from
  std::vector<OutputVertex> of_cut_vertex;        // cut vertex -> output vertex
  std::vector<OutputVertex> of_surface_vertex; // vertex of the surface -> one of its copies in the output; not of caps
  std::vector<std::uint32_t> page_of;          // primitive -> the page of the atlas that its triangles are on
  std::vector<std::vector<std::uint32_t>>
      component_of; // primitive -> its output triangles' components; no_primitive for riders
};

// Every attribute of the input at the vertices of the cut mesh, with TEXCOORD_n (the atlas; n: the first that is free
// and that no texture of the materials reads) and _SPHERE added. Riders stand behind the triangles of the surface;
// levels of detail leave them out.
enum class RiderPolicy { deliver, leave_out };
[[nodiscard]] Delivery make_delivery(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                                     RiderPolicy riders = RiderPolicy::deliver);

// Reads the finished file and proves each component's map on what it says: report.certificate at the input's
// connectivity (the caps' own points, which no file holds, are those of `sphere`), report.cut_certificate on the
// delivered triangles, joined where _SPHERE is equal to the bit; report.atlas_certificate on their texture coordinates;
// and every vertex of the surface still at its position. sphere: what was delivered. Throws Error{not_certified} where
// any of it fails.
void certify_file(std::span<const std::byte> glb, const asset::Asset& asset, const Surface& surface,
                  const CutSphere& sphere, const Delivery& delivery, Report& report);

} // namespace orbis
