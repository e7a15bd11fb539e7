#include "core/asset/output.h"

#include <algorithm>
#include <cstring>
#include <functional>

#include "core/asset/accessor_layout.h"
#include "core/asset/extensions.h"
#include "core/asset/glb.h"
#include "core/asset/meshopt_codec.h"
#include "core/asset/references.h"

namespace orbis::asset {
namespace {

std::size_t aligned(std::size_t n) { return (n + 3) / 4 * 4; }

// The stored numbers, not what normalized ones stand for. Expects at least one vertex.
std::pair<Json, Json> bounds(const Attribute& attribute) {
  Attribute raw = attribute;
  raw.normalized = false;
  Json low = Json::array(), high = Json::array();
  for (std::uint32_t c = 0; c < raw.components; ++c) {
    double least = raw.get(0, c), most = least;
    for (std::size_t v = 1; v < raw.count(); ++v) {
      least = std::min(least, raw.get(v, c));
      most = std::max(most, raw.get(v, c));
    }
    low.push_back(least);
    high.push_back(most);
  }
  return {low, high};
}

// 65535 is left out: it restarts strips in graphics interfaces.
bool fits_16_bits(std::size_t vertex_count) { return vertex_count <= 65535; }

// Keeps the marked items of a top-level array; returns the new number of each. An empty array goes away altogether,
// since glTF allows none.
std::vector<std::size_t> keep(Json& document, std::string_view array, const std::vector<bool>& marked) {
  std::vector<std::size_t> number(marked.size());
  Json kept = Json::array();
  for (std::size_t i = 0; i < marked.size(); ++i) {
    number[i] = kept.size();
    if (marked[i]) kept.push_back(std::move(document[std::string(array)][i]));
  }
  if (kept.empty()) {
    document.erase(std::string(array));
  } else {
    document[std::string(array)] = std::move(kept);
  }
  return number;
}

std::vector<bool> referenced(const Json& document, Kind kind) {
  std::vector<bool> marked(array_size(document, array_of(kind)));
  for_each_reference(document, [&](Kind k, const Json& slot) {
    if (k == kind) marked[slot.get<std::size_t>()] = true;
  });
  return marked;
}

} // namespace

Json accessor_of(const Attribute& attribute) {
  Json out{{"componentType", static_cast<int>(attribute.type)}};
  if (attribute.normalized) out["normalized"] = true;
  out["count"] = attribute.count();
  out["type"] = vector_type(attribute.components);
  if (attribute.name == "POSITION") {
    auto [low, high] = bounds(attribute);
    out["min"] = std::move(low);
    out["max"] = std::move(high);
  }
  return out;
}

Json accessor_of_indices(std::size_t count, std::size_t vertex_count) {
  const auto type = fits_16_bits(vertex_count) ? ComponentType::u16 : ComponentType::u32;
  return Json{{"componentType", static_cast<int>(type)}, {"count", count}, {"type", "SCALAR"}};
}

Output::Output(const Document& document, GeometryCoding coding)
    : json(document.json), document_(document), coding_(coding) {
  for (std::size_t i = 0; i < array_size(json, "bufferViews"); ++i) {
    views_.push_back(document_.view(i));
    // Decoded data is written as it is.
    for (const auto name : meshopt_extensions) {
      Json& view = json["bufferViews"][i];
      Json* extensions = find(view, "extensions");
      if (!extensions) continue;
      extensions->erase(std::string(name));
      if (extensions->empty()) view.erase("extensions");
    }
  }
  // One buffer takes the place of all; its size comes last.
  json["buffers"] = Json::array({Json{{"byteLength", 0}}});
}

std::size_t Output::add_view(Bytes bytes, Target target, std::size_t stride) {
  Json view{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", bytes.size()}};
  if (stride != 0) view["byteStride"] = stride;
  if (target != Target::none) view["target"] = static_cast<int>(target);
  Json& array = json["bufferViews"];
  if (!array.is_array()) array = Json::array();
  array.push_back(std::move(view));
  added_.push_back(std::move(bytes));
  views_.emplace_back(added_.back());
  return views_.size() - 1;
}

// EXT_meshopt_compression: the view is a part of a buffer that holds nothing (the second one, the fallback that readers
// who know the extension do not need), and names the compressed bytes in the first.
std::size_t Output::add_meshopt_view(Bytes encoded, std::size_t count, std::size_t stride, Target target) {
  const bool is_vertices = target == Target::vertices;
  Json stored{{"buffer", 0},          {"byteOffset", 0}, {"byteLength", encoded.size()},
              {"byteStride", stride}, {"count", count},  {"mode", is_vertices ? "ATTRIBUTES" : "TRIANGLES"}};
  const std::size_t number = add_view(std::move(encoded), target, is_vertices ? stride : 0);
  Json& view = json["bufferViews"][number];
  view["byteLength"] = count * stride;
  view["extensions"][std::string(meshopt_extensions[0])] = std::move(stored);
  return number;
}

std::size_t Output::add_accessor(Json accessor) {
  Json& array = json["accessors"];
  if (!array.is_array()) array = Json::array();
  array.push_back(std::move(accessor));
  return array.size() - 1;
}

std::size_t Output::add_attribute(const Attribute& attribute) {
  const std::size_t size = attribute.components * size_of(attribute.type), stride = aligned(size);
  Bytes padded;
  if (stride == size) {
    padded = attribute.data;
  } else {
    padded.resize(attribute.count() * stride);
    for (std::size_t v = 0; v < attribute.count(); ++v) {
      std::memcpy(padded.data() + v * stride, attribute.data.data() + v * size, size);
    }
  }
  const std::size_t view =
      coding_ == GeometryCoding::plain
          ? add_view(std::move(padded), Target::vertices, stride)
          : add_meshopt_view(encode_meshopt_vertices(padded, stride), attribute.count(), stride, Target::vertices);
  Json accessor{{"bufferView", view}};
  accessor.update(accessor_of(attribute));
  return add_accessor(std::move(accessor));
}

std::size_t Output::add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count) {
  const std::size_t size = fits_16_bits(vertex_count) ? 2 : 4;
  Json accessor;
  if (coding_ == GeometryCoding::meshopt) {
    accessor["bufferView"] =
        add_meshopt_view(encode_meshopt_triangles(indices, vertex_count), indices.size(), size, Target::indices);
  } else {
    Bytes bytes(indices.size() * size);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      for (std::size_t b = 0; b < size; ++b) bytes[i * size + b] = static_cast<std::byte>(indices[i] >> (8 * b) & 0xff);
    }
    accessor["bufferView"] = add_view(std::move(bytes), Target::indices);
  }
  accessor.update(accessor_of_indices(indices.size(), vertex_count));
  return add_accessor(std::move(accessor));
}

void Output::drop_unreferenced() {
  // Owners before what they own: a dropped texture no longer holds its image.
  for (const Kind kind : {Kind::accessor, Kind::texture, Kind::image, Kind::sampler, Kind::buffer_view}) {
    const std::vector<bool> marked = referenced(json, kind);
    if (std::find(marked.begin(), marked.end(), false) == marked.end()) continue;
    const std::vector<std::size_t> number = keep(json, array_of(kind), marked);
    for_each_reference(json, [&](Kind k, Json& slot) {
      if (k == kind) slot = number[slot.get<std::size_t>()];
    });
    if (kind != Kind::buffer_view) continue;
    std::vector<std::span<const std::byte>> kept;
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (marked[i]) kept.push_back(views_[i]);
    }
    views_ = std::move(kept);
  }
}

Bytes Output::glb() {
  Bytes bin;
  std::size_t fallback = 0;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    bin.resize(aligned(bin.size()));
    Json& view = json["bufferViews"][i];
    Json* stored = find_path(view, "extensions", meshopt_extensions[0]);
    if (stored) {
      view["buffer"] = 1;
      view["byteOffset"] = fallback;
      fallback += aligned(view["byteLength"].get<std::size_t>());
    }
    Json& place = stored ? *stored : view;
    place["buffer"] = 0;
    place["byteOffset"] = bin.size();
    bin.insert(bin.end(), views_[i].begin(), views_[i].end());
  }
  if (bin.empty()) {
    json.erase("buffers");
  } else {
    json["buffers"][0]["byteLength"] = bin.size();
    if (fallback > 0) {
      json["buffers"][1] = {{"byteLength", fallback}};
      json["buffers"][1]["extensions"][std::string(meshopt_extensions[0])] = {{"fallback", true}};
    }
  }
  return join_glb(json.dump(), bin);
}

} // namespace orbis::asset
