#include <cmath>

#include "core/asset/asset.h"
#include "core/asset/document.h"
#include "core/asset/extensions.h"
#include "core/asset/materials.h"

namespace orbis::asset {
namespace {

// The image of a texture, in a format that can be decoded: a WebP image where the texture has one, else its plain
// source.
std::optional<std::size_t> image_of(const Document& document, const Json& texture) {
  const Json* webp = find_path(texture, "extensions", "EXT_texture_webp", "source");
  for (const Json* source : {webp, find(texture, "source")}) {
    if (!source) continue;
    const auto number = source->get<std::size_t>();
    const auto bytes = document.image(number);
    if (!bytes) continue;
    const std::string_view type = image_type(*bytes);
    if (type != "image/ktx2" && type != "image/avif") return number;
  }
  return std::nullopt;
}

double number_at(const JsonReader& reader, const Json& parent, std::string_view key, std::size_t i, double fallback) {
  const Json* values = reader.array(parent, key);
  if (!values) return fallback;
  if (values->size() != 2 || !values->at(i).is_number()) reader.fail(parent, key, "must hold 2 numbers");
  return values->at(i).get<double>();
}

double rotation_of(const JsonReader& reader, const Json& transform) {
  const Json* rotation = reader.member(transform, "rotation");
  if (!rotation) return 0;
  if (!rotation->is_number()) reader.fail(transform, "rotation", "must be a number");
  return rotation->get<double>();
}

// KHR_texture_transform: scale, then rotate counter-clockwise as seen with v pointing down, then move.
void read_transform(const JsonReader& reader, const Json& transform, BaseColor& out) {
  const double angle = rotation_of(reader, transform);
  const double c = std::cos(angle), s = std::sin(angle);
  const double su = number_at(reader, transform, "scale", 0, 1), sv = number_at(reader, transform, "scale", 1, 1);
  const double m[6] = {c * su,  s * sv, number_at(reader, transform, "offset", 0, 0),
                       -s * su, c * sv, number_at(reader, transform, "offset", 1, 0)};
  for (std::size_t i = 0; i < 6; ++i) out.transform[i] = static_cast<float>(m[i]);
}

void read_wrapping(const Document& document, const JsonReader& reader, const Json& texture, BaseColor& out) {
  const auto number = reader.integer(texture, "sampler");
  if (!number) return;
  const Json& sampler = document.json["samplers"][*number];
  const auto wrap = [&](std::string_view key) {
    const auto code = static_cast<int>(reader.integer(sampler, key, 65535).value_or(10497));
    if (code != 33071 && code != 33648 && code != 10497) reader.fail(sampler, key, "is none of 33071, 33648 and 10497");
    return code;
  };
  out.wrap_s = wrap("wrapS");
  out.wrap_t = wrap("wrapT");
}

} // namespace

std::optional<BaseColor> base_color(const Asset& asset, const Primitive& primitive) {
  const Document& document = *asset.document;
  if (!primitive.material) return std::nullopt;
  const Json* info = base_color_texture(document.json["materials"][*primitive.material]);
  if (!info) return std::nullopt;
  const JsonReader reader(document.json);
  const Json& texture = document.json["textures"][reader.required_integer(*info, "index")];
  const auto image = image_of(document, texture);
  if (!image) return std::nullopt;

  BaseColor out;
  std::uint64_t set = reader.integer(*info, "texCoord", 1000).value_or(0);
  if (const Json* transform = find_path(*info, "extensions", transform_extension)) {
    read_transform(reader, *transform, out);
    set = reader.integer(*transform, "texCoord", 1000).value_or(set);
  }
  out.uv = "TEXCOORD_" + std::to_string(set);
  const Attribute* uv = primitive.find(out.uv);
  if (!uv) return std::nullopt;
  read_wrapping(document, reader, texture, out);
  const auto bytes = *document.image(*image);
  out.image.assign(bytes.begin(), bytes.end());
  return out;
}

} // namespace orbis::asset
