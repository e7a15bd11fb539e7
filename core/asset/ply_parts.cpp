#include "core/asset/ply_parts.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <map>

#include "core/asset/corner_list.h"
#include "core/asset/vertex_color.h"

namespace orbis::asset {
namespace {

// What makes a vertex: its number in the file, and what a face adds.
struct Corner {
  std::uint32_t vertex = 0;
  Vec2f texcoord;
  PlyFaces::Color color{};

  // By bits, so that the texture coordinate NaN is one, too.
  [[nodiscard]] std::array<std::uint64_t, 2> key() const {
    return {std::uint64_t{std::bit_cast<std::uint32_t>(texcoord.x)} << 32 | std::bit_cast<std::uint32_t>(texcoord.y),
            std::bit_cast<std::uint64_t>(color)};
  }
  friend bool operator==(const Corner& a, const Corner& b) { return a.vertex == b.vertex && a.key() == b.key(); }
};

struct CornerHash {
  std::size_t operator()(const Corner& corner) const {
    std::uint64_t hash = corner.vertex;
    for (const std::uint64_t word : corner.key()) hash = (hash ^ hash >> 29) * 0x9E3779B97F4A7C15ull ^ word;
    hash *= 0x9E3779B97F4A7C15ull;
    return static_cast<std::size_t>(hash ^ hash >> 32);
  }
};

using SplitPart = CornerList<Corner, CornerHash>;

std::map<std::uint32_t, SplitPart> split(const PlyFaces& faces) {
  std::map<std::uint32_t, SplitPart> parts;
  for (std::size_t i = 0; i < faces.indices.size(); ++i) {
    const std::size_t triangle = i / 3;
    const std::uint32_t texture = faces.textures.empty() ? 0 : faces.textures[triangle];
    Corner corner{faces.indices[i], {}, {}};
    if (!faces.texcoords.empty() && texture != PlyFaces::no_texture) corner.texcoord = faces.texcoords[i];
    if (!faces.colors.empty()) corner.color = faces.colors[triangle];
    parts[texture].add(corner);
  }
  return parts;
}

Attribute gathered(const Attribute& from, const std::vector<Corner>& vertices) {
  Attribute out{from.name, from.type, from.normalized, from.components, {}};
  const std::size_t size = from.components * size_of(from.type);
  out.data.resize(vertices.size() * size);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    std::memcpy(out.data.data() + v * size, from.data.data() + vertices[v].vertex * size, size);
  }
  return out;
}

Attribute texcoords_of(const std::vector<Corner>& vertices) {
  Attribute out{"TEXCOORD_0", ComponentType::f32, false, 2, {}};
  out.data.resize(vertices.size() * 2 * sizeof(float));
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    out.set(v, 0, double{vertices[v].texcoord.x});
    out.set(v, 1, double{vertices[v].texcoord.y});
  }
  return out;
}

Attribute colors_of(const std::vector<Corner>& vertices, std::uint32_t components) {
  Attribute out = linear_colors(vertices.size(), components);
  const std::size_t size = components * sizeof(std::uint16_t);
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    std::memcpy(out.data.data() + v * size, vertices[v].color.data(), size);
  }
  return out;
}

PlyPart finished(std::uint32_t texture, SplitPart part, const PlyVertices& vertices, const PlyFaces& faces) {
  PlyPart out{texture, {}, std::move(part.indices)};
  for (const Attribute& attribute : vertices.attributes) out.attributes.push_back(gathered(attribute, part.vertices));
  if (!faces.texcoords.empty() && texture != PlyFaces::no_texture) {
    out.attributes.push_back(texcoords_of(part.vertices));
  }
  if (!faces.colors.empty()) out.attributes.push_back(colors_of(part.vertices, faces.color_components));
  return out;
}

bool stay_as_they_are(const PlyFaces& faces) {
  return faces.texcoords.empty() && faces.colors.empty() &&
         std::ranges::adjacent_find(faces.textures, std::ranges::not_equal_to()) == faces.textures.end();
}

} // namespace

std::vector<PlyPart> ply_parts(PlyVertices vertices, PlyFaces faces) {
  std::vector<PlyPart> out;
  if (stay_as_they_are(faces)) {
    const std::uint32_t texture = faces.textures.empty() ? 0 : faces.textures.front();
    out.push_back({texture, std::move(vertices.attributes), std::move(faces.indices)});
    return out;
  }
  std::map<std::uint32_t, SplitPart> parts = split(faces);
  out.reserve(parts.size());
  for (auto& [texture, part] : parts) out.push_back(finished(texture, std::move(part), vertices, faces));
  return out;
}

} // namespace orbis::asset
