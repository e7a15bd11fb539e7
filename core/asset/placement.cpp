#include "core/asset/placement.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/asset/document.h"
#include "core/asset/instances.h"
#include "core/asset/nodes.h"

namespace orbis::asset {
namespace {

template <std::size_t N>
std::optional<std::array<double, N>> numbers(const JsonReader& reader, const Json& node, std::string_view key) {
  const Json* found = reader.array(node, key);
  if (!found) return std::nullopt;
  std::array<double, N> values{};
  if (found->size() != N) reader.fail(node, key, "must hold " + std::to_string(N) + " numbers");
  for (std::size_t i = 0; i < N; ++i) {
    if (!(*found)[i].is_number()) reader.fail(node, key, "must hold " + std::to_string(N) + " numbers");
    values[i] = (*found)[i].get<double>();
  }
  return values;
}

// As many are more than a picture can tell apart, and a few bytes of a file may ask for billions.
constexpr std::size_t most_instances = std::size_t{1} << 18U;

std::vector<std::size_t> root_nodes(const Json& document) {
  std::vector<std::size_t> out;
  if (const std::size_t scenes = array_size(document, "scenes"); scenes > 0) {
    const Json* chosen = find(document, "scene");
    const Json* roots = find(document["scenes"][chosen ? chosen->get<std::size_t>() : 0], "nodes");
    if (roots) {
      for (const Json& root : *roots) out.push_back(root.get<std::size_t>());
    }
    return out;
  }
  std::vector<bool> is_child(array_size(document, "nodes"));
  for (std::size_t n = 0; n < is_child.size(); ++n) {
    if (const Json* children = find(document["nodes"][n], "children")) {
      for (const Json& child : *children) is_child[child.get<std::size_t>()] = true;
    }
  }
  for (std::size_t n = 0; n < is_child.size(); ++n) {
    if (!is_child[n]) out.push_back(n);
  }
  return out;
}

} // namespace

Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
  Matrix3 c{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) c[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
  }
  return c;
}

bool mirrors(const Matrix3& m) {
  const auto& [x, y, z] = m;
  return dot(Vec3d{x[0], x[1], x[2]}, cross(Vec3d{y[0], y[1], y[2]}, Vec3d{z[0], z[1], z[2]})) < 0;
}

Vec3d Placement::operator()(const Vec3d& p) const {
  const auto row = [&](std::size_t i) { return linear[i][0] * p.x + linear[i][1] * p.y + linear[i][2] * p.z; };
  return Vec3d{row(0), row(1), row(2)} + offset;
}

Placement Placement::after(const Placement& inner) const { return {linear * inner.linear, (*this)(inner.offset)}; }

Placement placed(const Vec3d& translation, const std::array<double, 4>& rotation, const Vec3d& scale) {
  const auto [x, y, z, w] = rotation;
  const Matrix3 turned{{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                        {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                        {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
  return {turned * Matrix3{{{scale.x, 0, 0}, {0, scale.y, 0}, {0, 0, scale.z}}}, translation};
}

Placement local_placement(const JsonReader& reader, const Json& node) {
  if (const auto m = numbers<16>(reader, node, "matrix")) {
    const auto& a = *m; // column by column
    return {{{{a[0], a[4], a[8]}, {a[1], a[5], a[9]}, {a[2], a[6], a[10]}}}, {a[12], a[13], a[14]}};
  }
  const auto t = numbers<3>(reader, node, "translation").value_or(std::array<double, 3>{0, 0, 0});
  const auto s = numbers<3>(reader, node, "scale").value_or(std::array<double, 3>{1, 1, 1});
  const auto q = numbers<4>(reader, node, "rotation").value_or(std::array<double, 4>{0, 0, 0, 1});
  return placed({t[0], t[1], t[2]}, q, {s[0], s[1], s[2]});
}

std::vector<std::vector<Placement>> placements_of(const Asset& asset) {
  const Json& document = asset.document->json;
  const JsonReader reader(document);
  std::vector<std::vector<Placement>> out(array_size(document, "meshes"));
  InstanceReader instances(*asset.document);
  std::size_t left = most_instances;
  std::vector<std::pair<std::size_t, Placement>> waiting; // node, and where its parent is
  const auto add = [&](const std::vector<std::size_t>& nodes, const Placement& parent) {
    for (auto n = nodes.rbegin(); n != nodes.rend(); ++n) waiting.emplace_back(*n, parent);
  };
  add(root_nodes(document), {});
  while (!waiting.empty()) {
    const auto [n, parent] = waiting.back();
    waiting.pop_back();
    const Json& node = document["nodes"][n];
    const Placement here = parent.after(local_placement(reader, node));
    const auto mesh = reader.integer(node, "mesh");
    if (mesh && !find(node, "skin")) {
      const std::vector<Placement> of_node = left > 0 ? instances.placements(node, left) : std::vector<Placement>(1);
      for (const Placement& instance : of_node) out[*mesh].push_back(here.after(instance));
      left -= std::min(left, of_node.size());
    }
    if (const Json* children = find(node, "children")) add(children->get<std::vector<std::size_t>>(), here);
  }
  for (std::vector<Placement>& of_mesh : out) {
    if (of_mesh.empty()) of_mesh.emplace_back();
  }
  return out;
}

} // namespace orbis::asset
