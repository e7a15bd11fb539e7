#include "core/options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/error.h"

namespace orbis {
namespace {

constexpr std::array<OptionInfo, 22> table{{
    {"topology", "repair | strict", "repair",
     "repair: whatever has triangles is parametrized; strict: anything but one closed component of genus 0 is refused"},
    {"weld_tolerance", "a number, 0 or more", "0",
     "vertices no farther apart are one, in the model's units before node transforms; 0: exactly equal ones only"},
    {"objective", "isometric | conformal | stretch | shape-preserving", "isometric",
     "what the map keeps: lengths as far as possible, angles, texture resolution, or the paper's shape-preserving "
     "weights"},
    {"area_weight", "a number from 0 to 1", "1",
     "isometric only: 1 weighs areas as much as angles, less favours angles, 0 is conformal"},
    {"quality", "draft | standard | high", "standard",
     "all but shape-preserving: time against closeness to the least energy"},
    {"threshold", "a number in (0, 1)", "0.995",
     "shape-preserving only: relaxation stops when the best local improvement is above this"},
    {"texture", "auto | pattern | cubemap | base_color", "auto",
     "what the atlas shows: the model's own base colour where it has one, else a numbered test pattern"},
    {"texture_size", "64 to 8192", "2048", "width of the atlas' largest image in texels"},
    {"texel_density", "a number, 0 or more", "0",
     "texels per unit of length, in the model's units before node transforms, with pages as large as that takes; 0: "
     "texture_size decides"},
    {"atlas", "per-material | single", "per-material",
     "an image for each material (those that meet on one component share theirs), or one for the file"},
    {"texture_format", "png | jpeg | webp", "png", "how the atlas is stored in the result"},
    {"jpeg_quality", "1 to 100", "90", "with texture_format=jpeg or webp"},
    {"maps",
     "auto | all | names from "
     "base_color,metallic_roughness,occlusion,emissive,normal,object_normal,ambient_occlusion,position,displacement",
     "auto",
     "what is baked into the atlas: auto is the base colour and every texture that the materials have, all that and "
     "what comes from the geometry"},
    {"normal_bits", "8 | 16", "8", "bits a channel of the normal maps"},
    {"compression", "none | draco | meshopt | quantized", "none",
     "how the geometry is stored in the result; quantized: normals and tangents in 16 bits, and meshopt"},
    {"output", "glb | zip", "glb", "one GLB; or a zip of it, of each level of detail by itself, and of a manifest"},
    {"lods", "a list such as 0.25,0.05,0.01: parts of the triangles, their numbers, or deviation:0.1", "",
     "levels of detail on the same atlas, from fine to coarse; deviation: in per cent of the model's diagonal"},
    {"remesh", "none | octahedral:N | icosahedral:N, N from 1 to 8", "none",
     "a semi-regular triangulation in place of the input's: a regular polyhedron divided N times, sampled from the "
     "surface through its sphere"},
    {"sphere_morph", "true | false", "false", "a morph target 'sphere' that takes each component to its sphere"},
    {"morph_to", "the name of a file that comes with the model", "",
     "a second model: the result is one mesh that morphs from the first to it"},
    {"features", "pairs of points such as [[[0,0,1],[0,0,2]]], 256 at most", "",
     "with morph_to: points of the first model, and those of the second that they should become"},
    {"threads", "0 to 256", "0", "threads of the embedding, 0 for as many as the machine has; the result is the same"},
}};

[[noreturn]] void refuse(std::string_view name, std::string_view value, const std::string& why) {
  throw Error(ErrorCode::invalid_option,
              "option '" + std::string(name) + "' cannot be '" + std::string(value.substr(0, 64)) + "': " + why,
              std::string(name));
}

[[noreturn]] void refuse(std::string_view name, std::string_view value) {
  for (const OptionInfo& info : table) {
    if (info.name == name) refuse(name, value, "it takes " + std::string(info.values));
  }
  std::string known;
  for (const OptionInfo& info : table) known += (known.empty() ? "" : ", ") + std::string(info.name);
  throw Error(ErrorCode::invalid_option,
              "there is no option '" + std::string(name.substr(0, 64)) + "'; the options are " + known,
              std::string(name.substr(0, 64)));
}

template <class T> T number(std::string_view name, std::string_view text, T low, T high) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value >= low && value <= high)) refuse(name, text);
  return value;
}

template <class E, std::size_t N>
E choice(std::string_view name, std::string_view text, const std::array<std::string_view, N>& names) {
  for (std::size_t i = 0; i < N; ++i) {
    if (names[i] == text) return static_cast<E>(i);
  }
  refuse(name, text);
}

// One item at least; beside a comma it may be empty.
std::vector<std::string_view> between_commas(std::string_view list) {
  std::vector<std::string_view> items;
  for (std::size_t begin = 0, end = 0; end < list.size() || items.empty(); begin = end + 1) {
    end = std::min(list.find(',', begin), list.size());
    items.push_back(list.substr(begin, end - begin));
  }
  return items;
}

constexpr std::array<std::string_view, 4> objectives{"isometric", "conformal", "stretch", "shape-preserving"};
constexpr std::array<std::string_view, 3> qualities{"draft", "standard", "high"};
constexpr std::array<std::string_view, 4> sources{"auto", "pattern", "cubemap", "base_color"};
constexpr std::array<std::string_view, 2> pages{"per-material", "single"};
constexpr std::array<std::string_view, 3> formats{"png", "jpeg", "webp"};
constexpr std::array<std::string_view, 2> topologies{"repair", "strict"};
constexpr std::array<std::string_view, 4> compressions{"none", "draco", "meshopt", "quantized"};
constexpr std::array<std::string_view, 2> outputs{"glb", "zip"};

// "0.25", "5000" or "deviation:0.1".
LodTarget lod_target(std::string_view list, std::string_view text) {
  if (text.empty()) refuse("lods", list, "there is no level before or after one of its commas");
  const std::string item = std::string("'").append(text.substr(0, 64)).append("' ");
  constexpr std::string_view deviation = "deviation:";
  const bool is_deviation = text.starts_with(deviation);
  if (is_deviation) text.remove_prefix(deviation.size());
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !(value > 0))
    refuse("lods", list, item + "is neither a number above 0 nor 'deviation:' with one");
  if (is_deviation) {
    if (value > 100) refuse("lods", list, item + "is more than 100 per cent of the bounding box's diagonal");
    return {LodTarget::Kind::deviation, value};
  }
  if (value <= 1) return {LodTarget::Kind::ratio, value};
  if (value < 4 || value > 4e9 || value != std::floor(value))
    refuse("lods", list, item + "is neither a part up to 1 nor a whole number of triangles, four at least");
  return {LodTarget::Kind::triangles, value};
}

std::vector<LodTarget> lod_targets(std::string_view list) {
  std::vector<LodTarget> targets;
  if (list.empty()) return targets;
  for (const std::string_view item : between_commas(list)) {
    targets.push_back(lod_target(list, item));
    // Of one kind they must get coarser.
    for (const LodTarget& before : std::span(targets).first(targets.size() - 1)) {
      const LodTarget& last = targets.back();
      const bool grows = last.value > before.value;
      if (last.kind == before.kind && grows != (last.kind == LodTarget::Kind::deviation))
        refuse("lods", list, "levels go from fine to coarse: parts and numbers down, deviations up");
    }
  }
  if (targets.size() > most_lods)
    refuse("lods", list,
           "it has " + std::to_string(targets.size()) + " levels; " + std::to_string(most_lods) + " are the most");
  return targets;
}

constexpr std::array<std::string_view, 2> truths{"false", "true"};
constexpr std::array<std::string_view, 3> remesh_bases{"none", "octahedral", "icosahedral"};

// "none" or "icosahedral:5".
RemeshTarget remesh_target(std::string_view name, std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) {
    if (text != remesh_bases[0]) refuse(name, text);
    return {};
  }
  for (std::size_t i = 1; i < remesh_bases.size(); ++i) {
    if (text.substr(0, colon) != remesh_bases[i]) continue;
    const std::string_view digits = text.substr(colon + 1);
    std::uint32_t times = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), times);
    const bool is_number = error == std::errc{} && end == digits.data() + digits.size();
    if (!is_number || times < 1 || times > most_remesh_times) refuse(name, text);
    return {static_cast<RemeshTarget::Base>(i), times};
  }
  refuse(name, text);
}

// A file's name, as a path below the model.
std::string file_name(std::string_view name, std::string_view text) {
  const bool is_plain =
      std::all_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) >= 32; });
  if (text.size() > 255 || !is_plain) refuse(name, text);
  return std::string(text);
}

// Reads "[[[0,0,1],[0,0,2]],…]": a JSON array of arrays of two points of three numbers.
class FeatureReader {
public:
  FeatureReader(std::string_view name, std::string_view text) : name_(name), text_(text), rest_(text) {}

  std::vector<FeaturePair> run() {
    std::vector<FeaturePair> out;
    expect('[');
    while (!accept(']')) {
      if (!out.empty()) expect(',');
      expect('[');
      const Vec3d from = point();
      expect(',');
      const Vec3d to = point();
      expect(']');
      out.push_back({from, to});
      if (out.size() > most_features) refuse(name_, text_);
    }
    skip_blanks();
    if (!rest_.empty()) refuse(name_, text_);
    return out;
  }

private:
  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size())); }
  bool accept(char c) {
    skip_blanks();
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!accept(c)) refuse(name_, text_);
  }
  double coordinate() {
    skip_blanks();
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    if (error != std::errc{} || !std::isfinite(value)) refuse(name_, text_);
    rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return value;
  }
  Vec3d point() {
    expect('[');
    const double x = coordinate();
    expect(',');
    const double y = coordinate();
    expect(',');
    const double z = coordinate();
    expect(']');
    return {x, y, z};
  }

  std::string_view name_, text_, rest_;
};

template <class E, std::size_t N> std::string text_of(E value, const std::array<std::string_view, N>& names) {
  return std::string(names.at(static_cast<std::size_t>(value)));
}

// The shortest text that reads back as the same number.
std::string text_of(double value) {
  std::array<char, 32> buffer{};
  const char* end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), static_cast<std::size_t>(end - buffer.data())};
}

std::string text_of(const std::vector<LodTarget>& targets) {
  std::string text;
  for (const LodTarget& target : targets) {
    text += text.empty() ? "" : ",";
    if (target.kind == LodTarget::Kind::deviation) text += "deviation:";
    text += text_of(target.value);
  }
  return text;
}

std::string text_of(const RemeshTarget& target) {
  std::string text = text_of(target.base, remesh_bases);
  if (target.base != RemeshTarget::Base::none) text.append(":").append(std::to_string(target.times));
  return text;
}

std::string text_of(const std::vector<FeaturePair>& features) {
  std::string text;
  const auto add = [&](const Vec3d& p) {
    text.append("[").append(text_of(p.x)).append(",").append(text_of(p.y)).append(",").append(text_of(p.z)).append("]");
  };
  for (const FeaturePair& pair : features) {
    text += text.empty() ? "[[" : ",[";
    add(pair.from);
    text += ',';
    add(pair.to);
    text += ']';
  }
  return text.empty() ? text : text + "]";
}

// Names with commas between them. "auto" may be one of them; "all" stands for it and every map that any model has.
MapSelection maps_of(std::string_view text) {
  MapSelection maps;
  maps.automatic = false;
  for (const std::string_view name : between_commas(text)) {
    if (name == "auto") {
      maps.automatic = true;
    } else if (name == "all") {
      maps.automatic = true;
      for (const Map map :
           {Map::normal, Map::object_normal, Map::ambient_occlusion, Map::position, Map::displacement}) {
        maps.named[static_cast<std::size_t>(map)] = true;
      }
    } else {
      maps.named[static_cast<std::size_t>(choice<Map>("maps", name, map_names))] = true;
    }
  }
  return maps;
}

std::string text_of(const MapSelection& maps) {
  std::string text = maps.automatic ? "auto" : "";
  for (std::size_t i = 0; i < map_names.size(); ++i) {
    if (!maps.named[i]) continue;
    if (!text.empty()) text += ',';
    text += map_names[i];
  }
  return text;
}

} // namespace

std::span<const OptionInfo> option_table() { return table; }

void set_option(Options& options, std::string_view name, std::string_view value) {
  if (name == "topology") {
    options.topology = choice<TopologyPolicy>(name, value, topologies);
  } else if (name == "weld_tolerance") {
    options.weld_tolerance = number<double>(name, value, 0.0, 1e30);
  } else if (name == "objective") {
    options.objective = choice<Objective>(name, value, objectives);
  } else if (name == "area_weight") {
    options.area_weight = number<double>(name, value, 0.0, 1.0);
  } else if (name == "quality") {
    options.quality = choice<Quality>(name, value, qualities);
  } else if (name == "threshold") {
    const auto t = number<double>(name, value, 0.0, 1.0);
    if (t <= 0.0 || t >= 1.0) refuse(name, value);
    options.threshold = t;
  } else if (name == "texture") {
    options.texture = choice<TextureSource>(name, value, sources);
  } else if (name == "texture_size") {
    options.texture_size = number<std::uint32_t>(name, value, 64, 8192);
  } else if (name == "texel_density") {
    options.texel_density = number<double>(name, value, 0.0, 1e30);
  } else if (name == "atlas") {
    options.atlas = choice<AtlasPages>(name, value, pages);
  } else if (name == "texture_format") {
    options.texture_format = choice<TextureFormat>(name, value, formats);
  } else if (name == "jpeg_quality") {
    options.jpeg_quality = number<std::uint32_t>(name, value, 1, 100);
  } else if (name == "maps") {
    options.maps = maps_of(value);
  } else if (name == "normal_bits") {
    if (value != "8" && value != "16") refuse(name, value);
    options.normal_bits = value == "8" ? 8 : 16;
  } else if (name == "compression") {
    options.compression = choice<Compression>(name, value, compressions);
  } else if (name == "output") {
    options.output = choice<OutputForm>(name, value, outputs);
  } else if (name == "lods") {
    options.lods = lod_targets(value);
  } else if (name == "remesh") {
    options.remesh = remesh_target(name, value);
  } else if (name == "sphere_morph") {
    options.sphere_morph = choice<int>(name, value, truths) == 1;
  } else if (name == "morph_to") {
    options.morph_to = file_name(name, value);
  } else if (name == "features") {
    options.features = value.empty() ? std::vector<FeaturePair>{} : FeatureReader(name, value).run();
  } else if (name == "threads") {
    options.threads = number<std::uint32_t>(name, value, 0, 256);
  } else {
    refuse(name, value);
  }
}

std::string get_option(const Options& options, std::string_view name) {
  if (name == "topology") return text_of(options.topology, topologies);
  if (name == "weld_tolerance") return text_of(options.weld_tolerance);
  if (name == "objective") return text_of(options.objective, objectives);
  if (name == "area_weight") return text_of(options.area_weight);
  if (name == "quality") return text_of(options.quality, qualities);
  if (name == "threshold") return text_of(options.threshold);
  if (name == "texture") return text_of(options.texture, sources);
  if (name == "texture_size") return std::to_string(options.texture_size);
  if (name == "texel_density") return text_of(options.texel_density);
  if (name == "atlas") return text_of(options.atlas, pages);
  if (name == "texture_format") return text_of(options.texture_format, formats);
  if (name == "jpeg_quality") return std::to_string(options.jpeg_quality);
  if (name == "maps") return text_of(options.maps);
  if (name == "normal_bits") return std::to_string(options.normal_bits);
  if (name == "compression") return text_of(options.compression, compressions);
  if (name == "output") return text_of(options.output, outputs);
  if (name == "lods") return text_of(options.lods);
  if (name == "remesh") return text_of(options.remesh);
  if (name == "sphere_morph") return text_of(options.sphere_morph, truths);
  if (name == "morph_to") return options.morph_to;
  if (name == "features") return text_of(options.features);
  if (name == "threads") return std::to_string(options.threads);
  refuse(name, "");
}

} // namespace orbis
