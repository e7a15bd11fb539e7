#include "core/steps/dump.h"

#include <array>
#include <cstdio>
#include <string>
#include <vector>

namespace orbis {
namespace {

void add_line(std::string& text, const char* format, double x, double y, double z) {
  std::array<char, 96> line{};
  std::snprintf(line.data(), line.size(), format, x, y, z);
  text += line.data();
}

void add_triangles(std::string& text, std::span<const mesh::Triangle> triangles) {
  for (const mesh::Triangle& t : triangles) {
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  }
}

} // namespace

void dump_bytes(const StageDump& dump, std::string_view name, std::span<const std::byte> bytes) {
  if (dump) dump(name, bytes);
}

void dump_mesh(const StageDump& dump, std::string_view name, std::span<const Vec3f> positions,
               std::span<const mesh::Triangle> triangles) {
  if (!dump) return;
  std::string text;
  // Nine digits bring a float back to the bit.
  for (const Vec3f& p : positions) add_line(text, "v %.9g %.9g %.9g\n", double{p.x}, double{p.y}, double{p.z});
  add_triangles(text, triangles);
  dump(name, std::as_bytes(std::span(text)));
}

void dump_charts(const StageDump& dump, std::string_view name, const texture::CutMesh& cut) {
  if (!dump) return;
  std::vector<double> left{0}; // of a page
  for (const texture::Page& page : cut.pages) left.push_back(left.back() + page.width);
  std::vector<std::uint32_t> page_of(cut.vertices.size());
  for (std::size_t t = 0; t < cut.triangles.size(); ++t) {
    for (const mesh::Index v : cut.triangles[t]) page_of[v] = cut.page_of(t);
  }
  std::string text;
  for (std::size_t v = 0; v < cut.vertices.size(); ++v) {
    const texture::Page& page = cut.pages[page_of[v]];
    const Vec2f& uv = cut.vertices[v].uv;
    add_line(text, "v %.9g %.9g %.9g\n", left[page_of[v]] + double{uv.x} * page.width, (1 - double{uv.y}) * page.height,
             0);
  }
  add_triangles(text, cut.triangles);
  dump(name, std::as_bytes(std::span(text)));
}

} // namespace orbis
