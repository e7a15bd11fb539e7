#include "core/asset/check_document.h"

#include <algorithm>

#include "core/asset/accessor_layout.h"
#include "core/asset/extensions.h"
#include "core/asset/references.h"
#include "core/asset/uri.h"

namespace orbis::asset {
namespace {

void check_version(const JsonReader& reader, const Json& document) {
  const std::string& version = reader.required_text(reader.required_object(document, "asset"), "version");
  const std::string* least = reader.text(document.at("asset"), "minVersion");
  if (version.empty()) reader.fail(document.at("asset"), "version", "is empty; glTF 2.0 files say \"2.0\"");
  if (version.substr(0, 2) != "2." || (least && *least != "2.0")) {
    throw Error(ErrorCode::unsupported_format,
                "the file is glTF " + shown(least ? *least : version) +
                    "; only glTF 2.0 is read, so convert it to glTF 2.0 first",
                "/asset/version");
  }
}

void check_extensions(const JsonReader& reader, const Json& document) {
  for (const auto* key : {"extensionsUsed", "extensionsRequired"}) {
    const Json* names = reader.array(document, key);
    if (!names) continue;
    for (const Json& name : *names) {
      if (!name.is_string()) reader.fail(name, {}, "must be a string");
    }
  }
  const Json* required = find(document, "extensionsRequired");
  if (!required) return;
  for (const Json& name : *required) {
    const auto& text = name.get_ref<const std::string&>();
    if (!can_be_required(text)) {
      throw Error(ErrorCode::unsupported_feature,
                  "the file requires the extension " + shown(text) + ", which is not understood; export it without",
                  reader.pointer(name));
    }
  }
}

void check_shape(const JsonReader& reader, const Json& document) {
  for (const auto* key : {"scenes", "nodes", "meshes", "accessors", "bufferViews", "buffers", "animations", "skins",
                          "materials", "textures", "images", "samplers", "cameras"}) {
    const Json* items = reader.array(document, key);
    if (!items) continue;
    for (const Json& item : *items) {
      if (!item.is_object()) reader.fail(item, {}, "must be an object");
      reader.object(item, "extensions");
    }
  }
}

void check_references(const JsonReader& reader, const Json& document) {
  for_each_reference(document, [&](Kind kind, const Json& slot) {
    const std::string_view array = array_of(kind);
    if (!slot.is_number_unsigned()) reader.fail(slot, {}, "must be a number of /" + std::string(array));
    const std::size_t size = array_size(document, array);
    if (slot.get<std::uint64_t>() >= size) {
      reader.fail(slot, {},
                  "refers to /" + std::string(array) + "/" + slot.dump() + ", but there are only " +
                      std::to_string(size));
    }
  });
}

// The item of a top-level array that a required member refers to; check_references has held the number against its
// size.
const Json& referenced(const JsonReader& reader, const Json& document, const Json& from, std::string_view key,
                       std::string_view array) {
  const std::uint64_t number = reader.required_integer(from, key);
  return find(document, array)->at(number);
}

// [offset, offset + length) lies in a whole of `size` bytes. All are at most 2^53, so that nothing overflows.
void check_range(const JsonReader& reader, const Json& at, std::uint64_t offset, std::uint64_t length,
                 std::uint64_t size, const std::string& whole) {
  if (offset + length > size) {
    reader.fail(at, {},
                "needs bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) + ", but " + whole +
                    " ends at " + std::to_string(size));
  }
}

void check_compressed_view(const JsonReader& reader, const Json& document, const Json& view, const Json& compressed) {
  const Json& buffer = referenced(reader, document, compressed, "buffer", "buffers");
  check_range(reader, compressed, reader.integer(compressed, "byteOffset").value_or(0),
              reader.required_integer(compressed, "byteLength"), reader.required_integer(buffer, "byteLength"),
              "the buffer");
  const std::uint64_t stride = reader.required_integer(compressed, "byteStride", 256);
  const std::uint64_t count = reader.required_integer(compressed, "count", 0xffffffff);
  if (stride * count != reader.required_integer(view, "byteLength")) {
    reader.fail(compressed, "count", "times byteStride is not the byteLength of the view");
  }
  reader.required_text(compressed, "mode");
  reader.text(compressed, "filter");
}

void check_views(const JsonReader& reader, const Json& document) {
  if (const Json* buffers = find(document, "buffers")) {
    for (const Json& buffer : *buffers) {
      reader.required_integer(buffer, "byteLength");
      reader.text(buffer, "uri");
    }
  }
  const Json* views = find(document, "bufferViews");
  if (!views) return;
  for (const Json& view : *views) {
    const Json& buffer = referenced(reader, document, view, "buffer", "buffers");
    const std::uint64_t length = reader.required_integer(view, "byteLength");
    if (length == 0) reader.fail(view, "byteLength", "must not be 0");
    check_range(reader, view, reader.integer(view, "byteOffset").value_or(0), length,
                reader.required_integer(buffer, "byteLength"), "the buffer");
    if (const auto stride = reader.integer(view, "byteStride", 252); stride && (*stride < 4 || *stride % 4 != 0)) {
      reader.fail(view, "byteStride", "must be a multiple of 4 from 4 to 252");
    }
    for (const auto name : meshopt_extensions) {
      if (const Json* compressed = find_path(view, "extensions", name)) {
        check_compressed_view(reader, document, view, *compressed);
      }
    }
  }
}

ComponentType component_type(const JsonReader& reader, const Json& accessor) {
  const std::uint64_t code = reader.required_integer(accessor, "componentType");
  if (!is_component_type(code)) reader.fail(accessor, "componentType", "is none of 5120 to 5123, 5125 and 5126");
  return static_cast<ComponentType>(code);
}

// `count` elements of `size` bytes, `part_size` bytes a component, in a view.
void check_elements(const JsonReader& reader, const Json& document, const Json& at, std::uint64_t count,
                    std::uint64_t size, std::uint64_t part_size, bool strided) {
  const Json& view = referenced(reader, document, at, "bufferView", "bufferViews");
  const std::uint64_t offset = reader.integer(at, "byteOffset").value_or(0);
  const std::uint64_t stride = strided ? reader.integer(view, "byteStride").value_or(size) : size;
  if (stride < size) reader.fail(at, {}, "has elements that are larger than the byteStride of its view");
  if ((offset + reader.integer(view, "byteOffset").value_or(0)) % part_size != 0 || stride % part_size != 0) {
    reader.fail(at, {}, "is not aligned to the size of its components");
  }
  check_range(reader, at, offset, (count - 1) * stride + size, reader.required_integer(view, "byteLength"),
              "its buffer view");
}

void check_sparse(const JsonReader& reader, const Json& document, const Json& sparse, std::uint64_t total,
                  std::uint64_t size, std::uint64_t part_size) {
  const std::uint64_t count = reader.required_integer(sparse, "count");
  if (count == 0 || count > total) reader.fail(sparse, "count", "must be from 1 to the accessor's count");
  const Json& indices = reader.required_object(sparse, "indices");
  const ComponentType type = component_type(reader, indices);
  if (type != ComponentType::u8 && type != ComponentType::u16 && type != ComponentType::u32) {
    reader.fail(indices, "componentType", "must be unsigned");
  }
  check_elements(reader, document, indices, count, size_of(type), size_of(type), false);
  check_elements(reader, document, reader.required_object(sparse, "values"), count, size, part_size, false);
}

void check_accessors(const JsonReader& reader, const Json& document, const Limits& limits) {
  const Json* accessors = find(document, "accessors");
  if (!accessors) return;
  const std::uint64_t most = std::max(limits.max_vertices, 3 * limits.max_triangles);
  for (const Json& accessor : *accessors) {
    const ComponentType type = component_type(reader, accessor);
    const auto shape = shape_of(reader.required_text(accessor, "type"));
    if (!shape) reader.fail(accessor, "type", "is none of SCALAR, VEC2 to VEC4 and MAT2 to MAT4");
    const std::uint64_t count = reader.required_integer(accessor, "count", 0xffffffff);
    if (count == 0) reader.fail(accessor, "count", "must be at least 1");
    reader.flag(accessor, "normalized");
    const std::uint64_t size = element_size(type, *shape);
    if (find(accessor, "bufferView")) {
      check_elements(reader, document, accessor, count, size, size_of(type), true);
    } else if (count > most) {
      reader.fail(accessor, "count",
                  "is " + std::to_string(count) + " without a buffer view, more than the limit of " +
                      std::to_string(most),
                  ErrorCode::too_large);
    }
    if (const Json* sparse = reader.object(accessor, "sparse")) {
      check_sparse(reader, document, *sparse, count, size, size_of(type));
    }
  }
}

void check_textures(const JsonReader& reader, const Json& document) {
  if (const Json* images = find(document, "images")) {
    for (const Json& image : *images) {
      reader.text(image, "uri");
      reader.text(image, "mimeType");
    }
  }
  if (const Json* materials = find(document, "materials")) {
    for (const Json& material : *materials) {
      if (const Json* pbr = reader.object(material, "pbrMetallicRoughness")) {
        if (const Json* info = reader.object(*pbr, "baseColorTexture")) {
          reader.required_integer(*info, "index");
          reader.integer(*info, "texCoord", 1000);
        }
      }
    }
  }
}

void check_primitives(const JsonReader& reader, const Json& document) {
  const Json* meshes = find(document, "meshes");
  if (!meshes) return;
  for (const Json& mesh : *meshes) {
    const Json* primitives = reader.array(mesh, "primitives");
    if (!primitives) reader.fail(mesh, "primitives", "is missing");
    for (const Json& primitive : *primitives) {
      reader.required_object(primitive, "attributes");
      reader.integer(primitive, "mode", 6);
      const Json* targets = reader.array(primitive, "targets");
      if (targets && !std::all_of(targets->begin(), targets->end(), [](const Json& t) { return t.is_object(); })) {
        reader.fail(*targets, {}, "must hold objects");
      }
      reader.object(primitive, "extensions");
    }
  }
}

} // namespace

void check_document(const Json& document, const Limits& limits) {
  const JsonReader reader(document);
  check_version(reader, document);
  check_extensions(reader, document);
  check_shape(reader, document);
  check_references(reader, document);
  check_views(reader, document);
  check_accessors(reader, document, limits);
  check_textures(reader, document);
  check_primitives(reader, document);
}

} // namespace orbis::asset
